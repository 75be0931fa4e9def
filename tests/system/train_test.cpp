// The turbine-generator train against the independent reference computation (tests/reference/turbine_train).

#include <gtest/gtest.h>

#include <cmath>

#include "support/train_system.hpp"
#include "system/start.hpp"
#include "whirl/problem/taylor.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;

namespace {

constexpr double service = 377;

core::Vector equilibrium(system::RotorSystem& s) {
  core::Vector x = system::static_guess(s);
  solve::NewtonOptions o;
  o.max_iterations = 40;
  const auto r = solve::find_equilibrium(s, x.get(), o);
  EXPECT_TRUE(r.converged) << r.reason << " after " << r.iterations << ", residual " << r.residual;
  return x;
}

// A state off equilibrium, moving, the same on any number of ranks.
void disturb(const system::RotorSystem& s, Vec x, double size) {
  PetscInt begin = 0;
  core::check(VecGetOwnershipRange(x, &begin, nullptr));
  const core::WriteArray a(x);
  for (PetscInt i = 0; i < a.size(); ++i)
    a[i] += size * std::sin(3.7 * static_cast<double>(begin + i)) * ((begin + i) % 2 ? 300 : 1);
  (void)s;
}

}  // namespace

TEST(Train, DerivativesPassTheTaylorTest) {
  for (const bool guyan : {false, true}) {
    auto t = test::train({30, 10}, guyan);
    test::add_gen_pair(t, 6.3);
    system::RotorSystem s(MPI_COMM_WORLD, t, 300);
    core::Vector x = system::static_guess(s), rate = core::duplicate(x.get());
    disturb(s, x.get(), 5e-6);
    core::check(VecSet(rate.get(), 0.0));
    disturb(s, rate.get(), 1e-3);
    const auto r = problem::taylor_test(s, 0.7, x.get(), rate.get(), 1e-3);
    EXPECT_GT(r.first_difference, 1e-6);
    EXPECT_GE(r.state_order, 1.9);
    EXPECT_GE(r.rate_order, 1.9);
    EXPECT_GE(r.parameter_order, 1.9);
  }
}

// Another parameter than the speed: the clearance of one bearing. A value it cannot take changes nothing.
TEST(Train, ClearanceAsParameter) {
  system::Varying varying;
  varying.train = [](double clearance) {
    if (!(clearance > 0)) throw core::DomainError("the clearance is not positive");
    auto t = test::train({30, 10}, true);
    test::add_gen_pair(t, 6.3);
    t.supports[2].geometry.clearance = clearance;
    return t;
  };
  varying.value = varying.magnitude = 4e-4;
  system::RotorSystem s(MPI_COMM_WORLD, varying, 300);
  core::Vector x = system::static_guess(s), rate = core::duplicate(x.get());
  disturb(s, x.get(), 5e-6);
  core::check(VecSet(rate.get(), 0.0));
  disturb(s, rate.get(), 1e-3);
  const auto r = problem::taylor_test(s, 0.7, x.get(), rate.get(), 1e-3);
  EXPECT_GE(r.state_order, 1.9);
  EXPECT_GE(r.rate_order, 1.9);
  EXPECT_GE(r.parameter_order, 1.9);
  EXPECT_THROW(s.set_parameter(-1e-4), core::DomainError);
  EXPECT_EQ(s.parameter(), 4e-4);
  EXPECT_EQ(s.train().supports[2].geometry.clearance, 4e-4);
}

TEST(Train, LoadsAtServiceSpeed) {
  system::RotorSystem s(MPI_COMM_WORLD, test::train({120, 24}, false), service);
  core::Vector x = equilibrium(s);
  const auto whole = s.gather(x.get());
  const auto films = s.film_responses(whole.data(), film::Need::force);
  const double reference[] = {12418.391, 47829.622, 213406.85, 128292.09, 11698.184};
  for (int b = 0; b < 5; ++b)
    EXPECT_NEAR(films[static_cast<std::size_t>(b)].force[1], reference[b], 1e-3 * reference[b]);
}

TEST(Train, EigenvaluesAtServiceSpeed) {
  system::RotorSystem s(MPI_COMM_WORLD, test::train({120, 24}, false), service);
  core::Vector x = equilibrium(s);
  spectral::EigenOptions o;
  o.count = 60;
  o.shapes = false;
  const auto modes = spectral::modes(s, x.get(), o);
  const std::complex<double> reference[] = {
      {-0.58344247, 81.678244}, {-1.9989577, 105.89431}, {-3.7948633, 147.23537}, {-6.7011103, 186.53935}};
  for (const auto& wanted : reference) {
    double nearest = 1e9;
    for (const auto& m : modes) nearest = std::min(nearest, std::abs(m.lambda - wanted));
    EXPECT_LE(nearest, 0.05) << wanted;
  }
}
