// Tables as CSV.

#include "whirl/io/csv.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "whirl/io/table.hpp"

namespace {

using namespace whirl::io;

std::string text(const std::vector<CsvFile>& files, const std::string& name) {
  for (const auto& f : files)
    if (f.name == name) return f.text;
  return "none";
}

}  // namespace

TEST(Csv, HasTheColumnsOfATableInItsOrderWithUnitsAndNames) {
  Group tree;
  Table t({{"parameter", "rpm", ""}, {"stable", "1", ""}, Table::wide("a", "m", "", {"B1", "B,2"})});
  t.append({{3600}, {1}, {1e-6, 0.1}});
  t.append({{4000.5}, {0}, {std::numeric_limits<double>::quiet_NaN(), -1.0 / 3}});
  t.write(tree.child("branch"));
  tree.child("bearings").put("name", std::vector<std::string>{"B1", "B,2"}, "");
  tree.child("bearings").put("load", {1.5, 2}, "N", "");
  const auto files = csv_tables(tree);
  ASSERT_EQ(files.size(), 2U);
  EXPECT_EQ(text(files, "branch"),
            "parameter [rpm],stable,a.B1 [m],\"a.B,2 [m]\"\n3600,1,1e-06,0.1\n4000.5,0,nan,-0.3333333333333333\n");
  EXPECT_EQ(text(files, "bearings"), "load [N],name\n1.5,B1\n2,\"B,2\"\n");
}

// A dataset says itself what its places are: others of the same length, here two bearings, say nothing.
TEST(Csv, PlacesHaveTheLabelsOfTheirDataset) {
  Group tree;
  tree.child("bearings").put("name", std::vector<std::string>{"a", "b"}, "");
  auto& g = tree.child("response");
  g.put("speed", {1, 2, 3}, "rad/s", "");
  g.put("amplitude", {3, 2}, {1, 2, 3, 4, 5, 6}, "m", "");
  g.put("bare", {3, 2}, {1, 2, 3, 4, 5, 6}, "m", "");
  g.label("amplitude", {node_labels({6, 120})});
  EXPECT_EQ(text(csv_tables(tree), "response"),
            "speed [rad/s],amplitude.node 6 [m],amplitude.node 120 [m],bare.1 [m],bare.2 [m]\n1,1,2,1,2\n2,3,4,3,4\n"
            "3,5,6,5,6\n");
  auto& o = tree.child("orders");
  o.put("speed", {1, 2}, "rad/s", "");
  o.put("order", {0.5, 1}, "1", "");
  o.put("x", {2, 2, 2}, {1, 2, 3, 4, 5, 6, 7, 8}, "m", "");
  EXPECT_EQ(text(csv_tables(tree), "orders"), "none") << "nobody knows what is what";
  o.label_each({labels_of({0.5, 1}, "order"), {"a", "b"}});
  EXPECT_EQ(text(csv_tables(tree), "orders"),
            "order,speed [rad/s],x.order 0.5.a [m],x.order 0.5.b [m],x.order 1.a [m],x.order 1.b [m]\n0.5,1,1,2,3,4\n"
            "1,2,5,6,7,8\n");
}

TEST(Csv, TwoTablesAreNeverOneFile) {
  Group tree;
  for (const char* variant : {"a b", "a_b", "a_b_2"})
    tree.child("variants").child(safe_name(variant)).child("t").put("x", {1}, "m", "");
  std::set<std::string> names;
  for (const auto& table : csv_tables(tree)) names.insert(table.file);
  EXPECT_EQ(names, (std::set<std::string>{"variants.a_b.t.csv", "variants.a_b.t_2.csv", "variants.a_b_2.t.csv"}));
  EXPECT_EQ(csv_tables(tree).front().name, "variants.a b.t");
}

TEST(Csv, LeavesOutWhatIsNoTable) {
  Group tree;
  tree.child("odd").put("a", {1, 2}, "m", "");
  tree.child("odd").put("b", {1, 2, 3}, "m", "");
  tree.child("orbits").put("parameter", {1}, "rpm", "");
  tree.child("orbits").put("x", {1, 2, 2}, {1, 2, 3, 4}, "m", "");
  auto& seeds = tree.child("flips");
  seeds.set("restart", 1);
  seeds.child("1").put("mesh", {0, 1}, "1", "");
  tree.child("films").child("B1").child("pad1").put("theta", {0, 1}, "rad", "");
  tree.child("empty").put("x", std::vector<double>{}, "m", "");
  const auto files = csv_tables(tree);
  ASSERT_EQ(files.size(), 2U);
  EXPECT_EQ(text(files, "films.B1.pad1"), "theta [rad]\n0\n1\n");
  EXPECT_EQ(text(files, "empty"), "x [m]\n");
}
