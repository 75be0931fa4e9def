// The train on liners that give way at once: at rest it is the train on liners with states.

#include <gtest/gtest.h>

#include "support/at_rest.hpp"
#include "support/train_system.hpp"

using namespace whirl;

TEST(CondensedLiner, RestsWhereOneWithStatesDoes) {
  system::Train train = test::train_on_liners({24, 6}, 0.05);
  system::RotorSystem dynamic(MPI_COMM_WORLD, train, 377);
  for (system::Support& s : train.supports) film::as<film::Compliant>(s.film).states = film::States::condensed;
  system::RotorSystem condensed(MPI_COMM_WORLD, train, 377);
  EXPECT_GT(dynamic.own_states(), 0);
  EXPECT_EQ(condensed.own_states(), 0);
  const core::Vector x = test::equilibrium(dynamic), y = test::equilibrium(condensed);
  const auto a = dynamic.observe(x.get()), b = condensed.observe(y.get());
  const auto f = dynamic.film_responses(dynamic.gather(x.get()).data(), film::Need::force),
             g = condensed.film_responses(condensed.gather(y.get()).data(), film::Need::force);
  for (std::size_t k = 0; k < train.supports.size(); ++k) {
    const double clearance = train.supports[k].geometry.clearance;
    for (std::size_t d = 0; d < 2; ++d) {
      EXPECT_NEAR(a.shown[k].position[d], b.shown[k].position[d], 1e-8 * clearance) << k;
      EXPECT_NEAR(f[k].force[d], g[k].force[d], 1e-8 * f[k].force[1]) << k;
    }
    EXPECT_NEAR(a.film_thickness[k], b.film_thickness[k], 1e-8 * clearance) << k;
  }
  // The same on every rank, where only one has evaluated a film before.
  const auto whole = condensed.gather(y.get());
  const auto here = condensed.film_thickness(whole.data());
  for (std::size_t k = 0; k < here.size(); ++k) EXPECT_NEAR(here[k], b.film_thickness[k], 1e-10 * here[k]) << k;
}
