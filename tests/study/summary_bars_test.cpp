#include "study/bars/summary_bars.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "whirl/core/error.hpp"

namespace whirl::study {
namespace {

// Values on a mesh with spacing h around the bearing.
io::StudySummary at(double h) {
  io::StudySummary s;
  s.set("mass", 7, "kg");
  s.set("load", 100 + 3 * h * h, "N");
  s.set("K.xx", 50 - 8 * h * h, "N/m");
  s.set("K.xy", 20, "N/m");  // does not move
  return s;
}

TEST(SummaryBars, PutsBarsBesideWhatMovesAndItsKin) {
  io::StudySummary s = at(1);
  SummaryBars bars(s, {});
  for (const double h : {0.5, 2.0}) bars.add(Axis::around, h, at(h));
  bars.write();
  EXPECT_TRUE(s.values[0].second.more.empty()) << "a mass has no mesh";
  EXPECT_NEAR(s.values[1].second.more.at("uncertainty"), 3 * 1.25, 1e-12);
  EXPECT_NEAR(s.values[2].second.more.at("uncertainty"), 8 * 1.25, 1e-12);
  EXPECT_NEAR(s.values[3].second.more.at("uncertainty"), 2 * 1.25, 1e-12) << "a quarter of its kin's";
  EXPECT_EQ(s.values[1].second.more.count("uncertainty_time_mesh"), 0u);
}

TEST(SummaryBars, AreUnknownWhereAnotherMeshLacksTheValue) {
  io::StudySummary s = at(1), less = at(2);
  less.values.erase(less.values.begin() + 1);
  SummaryBars bars(s, {});
  bars.add(Axis::around, 2, less);
  bars.write();
  EXPECT_TRUE(std::isnan(s.values[1].second.more.at("uncertainty")));
}

TEST(SummaryBars, ExactValuesHaveNoneWhateverOtherMeshesGave) {
  io::StudySummary s = at(1);
  s.set("peak.1.node", 7, "1");
  SummaryBars bars(s, {});
  bars.add(Axis::around, 2, [](io::StudySummary& there) {
    there.set("load", 1, "N");
    throw core::NotConverged("no equilibrium");
  });
  bars.write();
  EXPECT_TRUE(s.values[4].second.more.empty());
  EXPECT_TRUE(std::isnan(s.values[1].second.more.at("uncertainty"))) << "others keep theirs";
}

TEST(SummaryBars, ComponentsAreKin) {
  EXPECT_EQ(stem_of("bearing.B1.K.xy"), stem_of("bearing.B1.K.xx"));
  EXPECT_EQ(stem_of("bearing.B1.x"), stem_of("bearing.B1.y"));
  EXPECT_NE(stem_of("bearing.B1.K.xx"), stem_of("bearing.B1.C.xx"));
  EXPECT_NE(stem_of("load.B1"), stem_of("load.B2"));
}

}  // namespace
}  // namespace whirl::study
