#include "whirl/io/brief.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "whirl/io/summary.hpp"

namespace whirl::io {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(Brief, NumbersHaveTheDigitsOfTheirBars) {
  EXPECT_EQ(reading(36.9027, 0.1649), "36.90 +- 0.16");
  EXPECT_EQ(reading(5020.9, 34.2), "5021 +- 34");
  EXPECT_EQ(reading(437.6421, 4e-8), "437.642") << "a bar below the digits shown";
  EXPECT_EQ(reading(-0.0004, 4.2e-11), "-0.0004") << "six digits without a tail of zeros";
  EXPECT_EQ(reading(1.23e-7, 2e-9), "(1.230 +- 0.020)e-07");
  EXPECT_EQ(reading(0.1 + 0.2), "0.3");
  EXPECT_EQ(reading(12345.678), "12346");
  EXPECT_EQ(reading(0), "0");
  EXPECT_EQ(reading(no_value), "-");
  EXPECT_EQ(reading(infinity), "without limit");
}

TEST(Brief, UnitsSuitTheSize) {
  EXPECT_EQ(reading({49.05, "N", {{"uncertainty", 5e-8}}}), "49.05 N");
  EXPECT_EQ(reading({213402.2, "N"}), "213.4 kN");
  EXPECT_EQ(reading({1.85e-3, "m"}), "1850 um");
  EXPECT_EQ(reading({0.25, "m"}), "250 mm");
  EXPECT_EQ(reading({9.13415e-3, "kg m"}), "9.1341 kg mm");
  EXPECT_EQ(reading({0.5, "1"}), "0.5");
  EXPECT_EQ(reading({3000, "rpm"}), "3000 rpm");
}

Brief example() {
  Brief brief;
  brief.sentences = {"", "thinnest film 36.90 +- 0.16 um in B1"};
  BriefTable table{"Bearings", {{"bearing"}, {"x", "m"}, {"load", "N"}, {"torque", "N m"}, {"value"}}, {}, "a note"};
  table.rows.push_back(
      {"B1", Quantity{5e-5, "m", {{"uncertainty", 1e-7}}}, Quantity{4e3, "N"}, {}, Quantity{2e6, "Pa"}});
  table.rows.push_back({"B2", {}, Quantity{2e4, "N"}, {}, "none"});
  brief.tables = {std::move(table), BriefTable{"Empty", {{"a"}}, {}, {}}};
  typeset(brief);
  return brief;
}

TEST(Brief, ColumnsShareAUnitAndEmptyOnesGo) {
  const Brief brief = example();
  ASSERT_EQ(brief.sentences.size(), 1U);
  ASSERT_EQ(brief.tables.size(), 1U);
  const BriefTable& t = brief.tables.front();
  ASSERT_EQ(t.columns.size(), 4U) << "no row has a torque";
  EXPECT_EQ(t.columns[1].shown, "um");
  EXPECT_EQ(t.columns[1].factor, 1e6);
  EXPECT_EQ(t.columns[2].shown, "kN") << "by the largest of the column";
  EXPECT_EQ(t.rows[0][1].text, "50.00 +- 0.10");
  EXPECT_EQ(t.rows[0][2].text, "4");
  EXPECT_EQ(t.rows[0][3].text, "2 MPa") << "a column without a unit";
  EXPECT_EQ(t.rows[1][1].text, "");
}

TEST(Brief, GoesThroughTheFile) {
  Summary all;
  StudySummary study;
  study.name = study.kind = "static";
  study.brief = example();
  study.brief.tells_stability = true;
  all.set(study);
  const Brief back = Summary::from_json(all.to_json()).studies.front().brief;
  EXPECT_EQ(back.sentences, study.brief.sentences);
  EXPECT_TRUE(back.tells_stability) << "a resumed run does not give the verdict twice";
  ASSERT_EQ(back.tables.size(), 1U);
  const BriefTable &a = study.brief.tables.front(), &b = back.tables.front();
  EXPECT_EQ(a.caption, b.caption);
  EXPECT_EQ(a.note, b.note);
  for (std::size_t c = 0; c < a.columns.size(); ++c) EXPECT_EQ(a.columns[c].shown, b.columns[c].shown);
  for (std::size_t r = 0; r < a.rows.size(); ++r)
    for (std::size_t c = 0; c < a.columns.size(); ++c) {
      EXPECT_EQ(a.rows[r][c].text, b.rows[r][c].text);
      EXPECT_EQ(a.rows[r][c].is_number(), b.rows[r][c].is_number());
      EXPECT_EQ(a.rows[r][c].quantity.bar(), b.rows[r][c].quantity.bar());
    }
}

}  // namespace
}  // namespace whirl::io
