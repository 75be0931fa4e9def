// Rows of tables that studies over the speed look at.
#include "study/service_speeds.hpp"

#include <gtest/gtest.h>

#include "whirl/film/contract/options.hpp"

namespace whirl::study {
namespace {

std::vector<double> rows_of(const system::Machine& machine, double from, double to, std::size_t asked, long states,
                            io::StudySummary& summary) {
  return tabled_speeds(machine, from, to, asked, states, summary, "rad/s");
}

TEST(TabledSpeeds, RowsOfAllTablesInsideTheRange) {
  system::Machine machine;
  system::Bearing bearing;
  film::Linear film;
  film.table = {{100}, {250}, {400}};
  bearing.film = film;
  machine.bearings = {bearing};
  system::Element constant, seal;
  constant.table = {{300}};  // one row holds at all speeds
  seal.table = {{200}, {250}, {350}, {500}};
  machine.elements = {constant, seal};
  io::StudySummary summary;
  EXPECT_EQ(rows_of(machine, 100, 400, 3, 8, summary), (std::vector<double>{200, 250, 350}));
  EXPECT_EQ(rows_of(machine, 400, 100, 3, 8, summary), (std::vector<double>{200, 250, 350}));
  EXPECT_TRUE(rows_of(machine, 260, 340, 3, 8, summary).empty());
  EXPECT_TRUE(summary.warnings.empty());
}

TEST(TabledSpeeds, OfALargeMachineSomeAndAWord) {
  system::Machine machine;
  machine.elements.emplace_back();
  for (int k = 0; k <= 401; ++k) machine.elements.back().table.push_back({1.0 * k});
  io::StudySummary summary;
  EXPECT_EQ(rows_of(machine, 0, 401, 3, 100, summary).size(), 400U);
  EXPECT_TRUE(summary.warnings.empty());
  const auto few = rows_of(machine, 0, 401, 40, 100000, summary);
  EXPECT_EQ(few.size(), 40U);
  EXPECT_EQ(few.front(), 1);
  EXPECT_EQ(few.back(), 400);
  ASSERT_EQ(summary.warnings.size(), 1U);
  EXPECT_NE(summary.warnings[0].find("400 rows between 0 and 401 rad/s"), std::string::npos) << summary.warnings[0];
}

}  // namespace
}  // namespace whirl::study
