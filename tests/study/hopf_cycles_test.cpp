#include "study/equilibrium/hopf_cycles.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace whirl::study {
namespace {

// p = p_0 + c A^2 + d A^4 with amplitudes 1/4, 1/2, 1.
BirthOfCycles born(double c, double d) {
  return {c + 1.25 * d, c + 0.3125 * d, {0.25, 0.5, 1}};
}

TEST(BirthOfCycles, OfASmoothForceTheNextTermIsOpen) {
  EXPECT_NEAR(born(2, 0.4).doubt(false), 1.25 * 0.4, 1e-12);  // which is how far the curvature is from c
  EXPECT_NEAR(born(2, 0.4).curvature - 2, born(2, 0.4).doubt(false), 1e-12);
  EXPECT_EQ(born(2, 0).doubt(false), 0);
}

// Near A = 0 there is no parabola: what cycles over several cells do is the answer, unless smaller ones contradict it.
TEST(BirthOfCycles, OfAForceWithKinksSmallerCyclesMustNotContradict) {
  EXPECT_EQ(born(-6, 2).doubt(true), 0);
  const BirthOfCycles turned = born(1, -4);
  ASSERT_LT(turned.curvature, 0);
  ASSERT_LT(turned.smaller, 0);
  EXPECT_EQ(turned.doubt(true), 0);
  const BirthOfCycles contradicted = born(3, -4);
  ASSERT_LT(contradicted.curvature * contradicted.smaller, 0);
  EXPECT_GT(contradicted.doubt(true), std::abs(contradicted.curvature));
}

}  // namespace
}  // namespace whirl::study
