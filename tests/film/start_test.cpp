// A film of other numbers on the same mesh starts its search from where its neighbour ended.

#include <gtest/gtest.h>

#include <limits>

#include "film/sheet/banded_pad.hpp"

using namespace whirl;
using namespace whirl::film;

class Start : public testing::TestWithParam<Reynolds::Cavitation> {};

INSTANTIATE_TEST_SUITE_P(Cavitation, Start,
                         testing::Values(Reynolds::Cavitation::reynolds, Reynolds::Cavitation::mass_conserving),
                         [](const auto& i) { return i.index == 0 ? "Reynolds" : "MassConserving"; });

TEST_P(Start, SavesFactorisations) {
  Reynolds options;
  options.cavitation = GetParam();
  options.cells = {60, 16};
  const Lubricant oil{0.02, 870};
  Geometry bore{Geometry::Bore::partial_arc, 0.0625, 0.05, 1e-4, 2.6, 0, 0};
  JournalMotion motion;
  motion.position = {3e-5, -5e-5, 0, 0};
  motion.velocity = {1e-3, -2e-3, 0, 0};
  motion.speed = 300;
  const auto force = [&motion](BandedPad& pad) {
    Response r;
    r.min_thickness = std::numeric_limits<double>::infinity();
    pad.add(motion, Need::force, r);
    return r.force;
  };
  BandedPad here(make_pads(bore)[0], options, oil);
  (void)force(here);
  bore.clearance *= 1 + 1e-5;
  BandedPad cold(make_pads(bore)[0], options, oil), warm(make_pads(bore)[0], options, oil);
  warm.start_from(here);
  const auto expected = force(cold), found = force(warm);
  EXPECT_GE(cold.factorisations(), 3);
  EXPECT_LE(warm.factorisations(), 2);
  for (std::size_t d = 0; d < 2; ++d) EXPECT_NEAR(found[d], expected[d], 1e-7 * std::abs(expected[1]));
  // Nothing to start from on another mesh.
  options.cells = {30, 8};
  BandedPad coarse(make_pads(bore)[0], options, oil), other(make_pads(bore)[0], options, oil);
  coarse.start_from(here);
  EXPECT_EQ(force(coarse), force(other));
}
