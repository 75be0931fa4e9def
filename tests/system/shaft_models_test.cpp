// Machines whose shaft has elements with inner freedoms, or internal damping: derivatives, and the machine they
// describe.

#include <gtest/gtest.h>

#include <cmath>

#include "reference/rotor/trial_rotor.hpp"
#include "support/train_system.hpp"
#include "system/start.hpp"
#include "whirl/problem/structure.hpp"
#include "whirl/problem/taylor.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;

namespace {

// A shaft with a disc, 20 mm thick and 0.4 m long, on linear bearings that are not isotropic.
enum class Kept { all, real_modes, complex_modes };

system::Train small_machine(rotor::BeamElement element, double internal_damping, Kept kept) {
  system::Train t;
  rotor::Segment s;
  s.length = 0.05;
  s.outer_mass_diameter = 0.02;
  t.rotor.segments.assign(8, s);
  t.rotor.material.modulus = {{293.15, 2.1e11}};
  rotor::Disc d;
  d.node = 4;
  d.mass = 1;
  d.diametral_inertia = 1e-3;
  d.polar_inertia = 2e-3;
  t.rotor.discs = {d};
  t.rotor.element = element;
  t.rotor.internal_damping = internal_damping;
  if (kept == Kept::real_modes) t.rotor.reduction = {rotor::Reduction::Type::craig_bampton, {1, 4, 9}, 2};
  if (kept == Kept::complex_modes)
    t.rotor.reduction = {
        .type = rotor::Reduction::Type::craig_bampton_state, .masters = {1, 9}, .modes = 4, .speed = 400};
  for (const int node : {1, 9}) {
    system::Support b;
    b.node = node;
    b.film = film::Linear{{2e6, 1e5, -1e5, 3e6}, {200, 0, 0, 200}};
    t.supports.push_back(b);
    t.rotor.joints.push_back(node);
  }
  t.unbalance = {{4, 1e-4, 0.3}};
  return t;
}

std::vector<spectral::Mode> modes(const system::Train& t, double speed) {
  system::RotorSystem s(MPI_COMM_WORLD, t, speed);
  core::Vector x = system::static_guess(s);
  EXPECT_TRUE(solve::find_equilibrium(s, x.get(), {}).converged);
  spectral::EigenOptions o;
  o.shapes = false;
  return spectral::modes(s, x.get(), o);
}

}  // namespace

TEST(ShaftModels, DerivativesPassTheTaylorTest) {
  using enum rotor::BeamElement;
  for (const auto& [element, internal, kept] : {std::tuple{timoshenko, 1e-4, Kept::all},
                                                {timoshenko, 1e-4, Kept::real_modes},
                                                {timoshenko, 1e-6, Kept::complex_modes},
                                                {timoshenko_linear, 0.0, Kept::all},
                                                {timoshenko_hermitian, 1e-4, Kept::all},
                                                {timoshenko_hermitian, 1e-4, Kept::real_modes},
                                                {timoshenko_linear, 1e-6, Kept::complex_modes}}) {
    system::RotorSystem s(MPI_COMM_WORLD, small_machine(element, internal, kept), 300);
    core::Vector x = system::static_guess(s), rate = core::duplicate(x.get());
    PetscInt begin = 0;
    core::check(VecGetOwnershipRange(x.get(), &begin, nullptr));
    {
      const core::WriteArray xa(x.get()), ra(rate.get());
      for (PetscInt i = 0; i < xa.size(); ++i) {
        const double wave = std::sin(3.7 * static_cast<double>(begin + i)) * ((begin + i) % 2 ? 300 : 1);
        xa[i] += 5e-6 * wave;
        ra[i] = 1e-3 * wave;
      }
    }
    const auto r = problem::taylor_test(s, 0.7, x.get(), rate.get(), 1e-3);
    EXPECT_GT(r.first_difference, 1e-6);
    // Linear in states and rates: differences are exact. Quadratic in the speed through its unbalance.
    EXPECT_TRUE(r.state_order >= 1.9 || r.state_order == 0) << r.state_order;
    EXPECT_GE(r.parameter_order, 1.9);
  }
}

// The same machine by elements of order four and six. Little damping: much makes the highest modes creep instead.
TEST(ShaftModels, ElementsWithInnerFreedomsGiveTheSameModes) {
  const auto linear = modes(small_machine(rotor::BeamElement::timoshenko_linear, 1e-8, Kept::all), 500),
             hermitian = modes(small_machine(rotor::BeamElement::timoshenko_hermitian, 1e-8, Kept::all), 500);
  for (std::size_t k = 0; k < 4; ++k) {
    ASSERT_GT(linear[k].lambda.imag(), 10);
    EXPECT_LT(std::abs(linear[k].lambda - hermitian[k].lambda), 1e-3 * std::abs(hermitian[k].lambda)) << k;
  }
}

// The trial rotor as a machine: stable below the threshold of internal damping, unstable above.
TEST(ShaftModels, InternalDampingDestabilisesAboveItsThreshold) {
  const auto trial = reference::trial_rotor::read();
  system::Train t = small_machine(rotor::BeamElement::timoshenko, trial.internal_damping, Kept::all);
  rotor::Segment s;
  s.length = s.outer_mass_diameter = 0.015;
  t.rotor.segments.assign(20, s);
  t.rotor.material.modulus = {{293.15, 2.05e11}};
  t.rotor.material.density = 7860;
  rotor::Disc& d = t.rotor.discs.front();
  d.node = 7;
  d.mass = 0.5;
  d.diametral_inertia = 7.81e-5;
  d.polar_inertia = 1.56e-4;
  t.rotor.joints.clear();
  t.supports[1].node = 21;
  for (const auto& [damping, threshold] : trial.thresholds) {
    for (system::Support& b : t.supports) b.film = film::Linear{{1e7, 0, 0, 1e7}, {damping, 0, 0, damping}};
    const auto growth = [&](double speed) {
      double most = -1e9;
      for (const spectral::Mode& m : modes(t, speed)) most = std::max(most, m.lambda.real());
      return most;
    };
    EXPECT_LT(growth(threshold * (1 - 2e-5)), 0);
    EXPECT_GT(growth(threshold * (1 + 2e-5)), 0);
  }
}

// With all its modes a rotor reduced in state space is the whole one: modes, and the state under the weight.
TEST(ShaftModels, InStateSpaceAllModesAreTheWholeShaft) {
  const system::Train whole = small_machine(rotor::BeamElement::timoshenko, 1e-6, Kept::all);
  system::Train small = small_machine(rotor::BeamElement::timoshenko, 1e-6, Kept::complex_modes);
  small.rotor.reduction.modes = 16;
  small.rotor.reduction.speed = 500;  // that of the shape under the weight, across which internal damping acts
  const auto a = modes(whole, 500), b = modes(small, 500);
  for (std::size_t k = 0; k < 8; ++k) EXPECT_LT(std::abs(a[k].lambda - b[k].lambda), 1e-7 * std::abs(a[k].lambda)) << k;
  system::RotorSystem one(MPI_COMM_WORLD, whole, 500), other(MPI_COMM_WORLD, small, 500);
  core::Vector x = system::static_guess(one), y = system::static_guess(other);
  const std::vector<double> p = one.shaft(x.get(), 0, true), q = other.shaft(y.get(), 0, true);
  ASSERT_EQ(p.size(), q.size());
  for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(p[i], q[i], 1e-10);
}

// Where its damping varies, its modes do: a new rotor. The rows of the structure are those of the residual.
TEST(ShaftModels, InStateSpaceParametersAndBlocksAgree) {
  const auto at = [](double beta) {
    system::Train t = small_machine(rotor::BeamElement::timoshenko, 1e-6, Kept::complex_modes);
    t.rotor.stiffness_damping = beta;
    return t;
  };
  system::RotorSystem s(MPI_COMM_SELF, system::Varying{at, 1e-5, 1e-5}, 300);
  const auto first = s.made().rotors;
  s.set_parameter(1.1e-5);
  EXPECT_EQ(s.made().rotors, first + 1);
  core::Vector x = system::static_guess(s), rate = core::duplicate(x.get()), f = core::duplicate(x.get());
  {
    const core::WriteArray xa(x.get()), ra(rate.get());
    for (PetscInt i = 0; i < xa.size(); ++i) {
      xa[i] += 5e-6 * std::sin(3.7 * static_cast<double>(i));
      ra[i] = 1e-3 * std::cos(1.3 * static_cast<double>(i));
    }
  }
  const auto r = problem::taylor_test(s, 0.7, x.get(), rate.get(), 1e-3);
  EXPECT_GE(r.parameter_order, 1.9);
  s.residual(0.7, x.get(), rate.get(), f.get());
  const core::ReadArray xa(x.get()), ra(rate.get()), fa(f.get());
  problem::BlockStructure& blocks = *s.structure();
  const Eigen::Map<const Eigen::VectorXd> state(xa.data(), xa.size()), rates(ra.data(), ra.size()),
      wanted(fa.data(), fa.size());
  problem::Films films;
  Eigen::VectorXd load;
  blocks.films(blocks.c() * state, nullptr, nullptr, false, films);
  blocks.load(0.7, load);
  const Eigen::VectorXd found = blocks.l1() * rates + blocks.l0() * state - load - blocks.b() * films.forces;
  EXPECT_LT((found - wanted).norm(), 1e-12 * wanted.norm());
}
