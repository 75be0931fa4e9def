// The turbine-generator train against an independent computation.

#include <gtest/gtest.h>

#include "reference/turbine_train/rotor.hpp"
#include "support/turbine_train.hpp"
#include "whirl/rotor/frequencies.hpp"
#include "whirl/rotor/shaft.hpp"

using namespace whirl;
namespace ref = whirl::reference::train;

TEST(Train, MassesAndLengths) {
  const rotor::Options o = test::train_rotor();
  const auto supports = test::train_supports();
  EXPECT_NEAR(rotor::total_mass(o), ref::total_mass, ref::total_mass_within);
  for (std::size_t k = 0; k < ref::span_masses.size(); ++k)
    EXPECT_NEAR(rotor::mass_between(o, supports[k].node, supports[k + 1].node), ref::span_masses[k],
                ref::span_masses_within);
  EXPECT_NEAR(rotor::slenderness(o, supports[2].node, supports[3].node), ref::generator_slenderness,
              ref::generator_slenderness_within);
  const auto z = rotor::node_positions(o);
  EXPECT_NEAR(z.back(), ref::total_length, ref::length_within);
  EXPECT_NEAR(z[static_cast<std::size_t>(supports[3].node - 1)] - z[static_cast<std::size_t>(supports[2].node - 1)],
              ref::generator_span, ref::length_within);
}

TEST(Train, FreeFrequencies) {
  const auto found = rotor::natural_frequencies(MPI_COMM_WORLD, test::train_rotor(), {}, 8);
  ASSERT_EQ(found.size(), ref::free_free.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i] / ref::free_free[i], 1.0, 1e-6) << i;
}

TEST(Train, PinnedFrequencies) {
  std::vector<int> nodes;
  for (const auto& s : test::train_supports()) nodes.push_back(s.node);
  const auto found = rotor::natural_frequencies(MPI_COMM_WORLD, test::train_rotor(), nodes, 8);
  ASSERT_EQ(found.size(), ref::pinned.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i] / ref::pinned[i], 1.0, 1e-6) << i;
}

TEST(Train, ReactionsAndMomentsOnRigidSupports) {
  const rotor::Options o = test::train_rotor();
  auto supports = test::train_supports();
  const auto aligned = rotor::rigid_static(MPI_COMM_WORLD, o, supports, 9.81);
  for (std::size_t i = 0; i < ref::reactions.size(); ++i)
    EXPECT_NEAR(aligned.reactions[i], ref::reactions[i], ref::reactions_within) << i;
  for (std::size_t i = 0; i < ref::moments.size(); ++i)
    EXPECT_NEAR(aligned.moment[static_cast<std::size_t>(ref::moment_nodes[i] - 1)], ref::moments[i],
                ref::moments_within);
  for (auto& s : supports) s.elevation = 0;
  const auto level = rotor::rigid_static(MPI_COMM_WORLD, o, supports, 9.81);
  for (std::size_t i = 0; i < ref::reactions_level.size(); ++i)
    EXPECT_NEAR(level.reactions[i], ref::reactions_level[i], ref::reactions_level_within) << i;
}

TEST(Train, AlignmentReturnsTheTabulatedElevations) {
  auto supports = test::train_supports();
  for (auto& s : supports) s.elevation = 0;
  const rotor::AlignmentRule rule{{1, 4, 5}, {43, 100}, {5}, {10000.0}};
  const auto found = rotor::align(MPI_COMM_WORLD, test::train_rotor(), supports, rule, 9.81);
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], ref::elevations[i], ref::elevations_within) << i;
  for (std::size_t i = 0; i < found.size(); ++i) supports[i].elevation = found[i];
  const auto check = rotor::rigid_static(MPI_COMM_WORLD, test::train_rotor(), supports, 9.81);
  EXPECT_NEAR(check.moment[42], 0, 1e-2);
  EXPECT_NEAR(check.moment[99], 0, 1e-2);
  EXPECT_NEAR(check.reactions[4], 10000, 1e-2);
}
