// A film by itself whose equations differ in unit.
#include <gtest/gtest.h>

#include "support/two_fields.hpp"

namespace whirl::film {
namespace {

// Watts outnumber metres per second by ten orders: a step that brings the film to rest raises their plain sum of
// squares a million times over, while every field comes nearer to rest in its own measure.
TEST(Relax, MeasuresEachFieldInItsOwnUnits) {
  test::TwoFields film;
  std::vector<double> states = {0, 0};
  relax(film, {}, states);
  EXPECT_NEAR(states[0], 5, 1e-12);
  EXPECT_NEAR(states[1], 1e-5, 1e-17);
}

// The same where each slab holds a temperature and a thickness.
TEST(Relax, KnowsFieldsThatComeAgain) {
  test::TwoFields film(3, true);
  std::vector<double> states(6, 0);
  relax(film, {}, states);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(states[2 * k], 5, 1e-12) << k;
    EXPECT_NEAR(states[2 * k + 1], 1e-5, 1e-17) << k;
  }
}

}  // namespace
}  // namespace whirl::film
