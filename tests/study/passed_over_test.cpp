// Warnings of resonances between the frequencies of transfer functions.
#include "study/linear/passed_over.hpp"

#include <gtest/gtest.h>

namespace whirl::study {
namespace {

// What is said of two functions, 1e-6 and zero at 100, 200 and 300 rad/s, that are `there` at 150 rad/s.
std::vector<std::string> said_of(const Transfer& there) {
  io::StudySummary summary;
  warn_of_passed_over(summary, {{150, 0.1}}, {there}, {100, 200, 300}, {{1e-6, 1e-22}, {2e-6, 1e-22}, {9, 9}},
                      {{"a.from.a", "m/N"}, {"b.from.a", "m/N"}}, "rad/s");
  return summary.warnings;
}

TEST(PassedOver, IsAResonanceThatReachesMoreThanTheFrequenciesBeside) {
  const auto said = said_of({{{0.006, 0.008}, 1e-22}, {1e-14, 1e-14}});
  ASSERT_EQ(said.size(), 1U);
  EXPECT_NE(said[0].find("150 rad/s (a from a reaches 1e+04 um/N there, 2 um/N at the frequencies beside it)"),
            std::string::npos)
      << said[0];
  EXPECT_TRUE(said_of({{2.1e-6, 0}, {1e-14, 1e-14}}).empty());
}

TEST(PassedOver, IsNoRoundingAndNothingWithoutAnAnswer) {
  EXPECT_TRUE(said_of({{1e-6, 1e-16}, {1e-14, 1e-14}}).empty());
  EXPECT_EQ(said_of({{1e-6, 1e-13}, {1e-14, 1e-14}}).size(), 1U);
  EXPECT_TRUE(said_of({}).empty());
}

TEST(Endless, AreToldWithTheDigitsThatAreKnown) {
  io::StudySummary summary;
  warn_of_endless(summary, {{5366.051, {true}}}, {17}, {{"a.from.a", "m/N"}}, "rad/s");
  ASSERT_EQ(summary.warnings.size(), 1U);
  EXPECT_TRUE(summary.warnings[0].starts_with("undamped resonances: 5366 +- 17 rad/s (a.from.a). "))
      << summary.warnings[0];
}

}  // namespace
}  // namespace whirl::study
