// Energy of an undamped gyroscopic rotor on springs: what each scheme of steps in time keeps of it.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <numbers>

#include "whirl/problem/structure.hpp"
#include "whirl/system/rotor_system.hpp"
#include "whirl/transient/steps/integrator.hpp"

using namespace whirl;

namespace {

constexpr double speed = 1000, stiffness = 1e6;

// The steel shaft with a disc of inputs/merot, reduced; no weight, no unbalance.
system::Train machine() {
  system::Train t;
  t.gravity = 0;
  t.rotor.material.modulus = {{293.15, 2.05e11}};
  t.rotor.element = rotor::BeamElement::timoshenko_linear;
  for (int k = 0; k < 20; ++k) {
    rotor::Segment s;
    s.length = 0.015;
    s.outer_mass_diameter = 0.015;
    t.rotor.segments.push_back(s);
  }
  t.rotor.discs = {{7, 0.5, 1.56e-4, 7.81e-5}};
  t.rotor.reduction = {rotor::Reduction::Type::craig_bampton, {1, 21}, 4};
  for (const int node : {1, 21}) {
    system::Support s;
    s.node = node;
    film::Linear film;
    film.stiffness = {stiffness, 0, 0, stiffness};
    s.film = film;
    t.supports.push_back(s);
  }
  return t;
}

// q'^T M q'/2 + q^T K q/2 and what the springs hold [J].
double energy(system::RotorSystem& s, Vec x) {
  problem::BlockStructure& blocks = *s.structure();
  const core::ReadArray a(x);
  const Eigen::Map<const Eigen::VectorXd> all(a.data(), a.size());
  double sum = 0;
  const auto add = [&](const problem::SparseBlock& block, Eigen::Index rate) {
    for (Eigen::Index j = rate; j < block.cols(); j += 2)
      for (problem::SparseBlock::InnerIterator it(block, j); it; ++it)
        if (it.row() % 2 == 0) sum += it.value() * all(it.row() + rate) * all(j) / 2;
  };
  add(blocks.l1(), 1);
  add(blocks.l0(), 0);
  const Eigen::VectorXd inputs = blocks.c() * all;
  for (Eigen::Index b = 0; b < 2; ++b)  // x, y, then their rates
    sum += stiffness / 2 * inputs.segment(4 * b, 2).squaredNorm();
  return sum;
}

// Relative change of the energy in five revolutions from a bent shaft at rest.
double drift(const transient::Scheme& scheme, double tolerance) {
  system::RotorSystem s(PETSC_COMM_SELF, machine(), speed);
  core::Vector x = core::make_vector(PETSC_COMM_SELF, s.size(), PETSC_DETERMINE);
  {
    const core::WriteArray a(x.get());
    for (PetscInt i = 0; i < a.size(); ++i) a[i] = 0;
    a[0] = a[4] = 1e-5;  // both ends, by the shaft's softest motions
    a[2] = -5e-6;
  }
  transient::Integrator integrator(s, {speed}, x.get(), {.scheme = scheme, .tolerance = tolerance});
  const double before = energy(s, x.get());
  for (int k = 1; k <= 5; ++k) {
    for (int i = 1; i <= 4; ++i) integrator.advance(std::numbers::pi / 2 / speed * i, 2 * std::numbers::pi / speed);
    integrator.close_revolution(2 * std::numbers::pi / speed);
  }
  integrator.state(x.get());
  return energy(s, x.get()) / before - 1;
}

}  // namespace

TEST(EnergyDrift, OfAnUndampedRotor) {
  EXPECT_LT(std::abs(drift(transient::Newmark{128}, 1e-11)), 1e-9);
  EXPECT_LT(std::abs(drift(transient::NewmarkFixedPoint{1024}, 1e-11)), 1e-9);
  EXPECT_LT(std::abs(drift(transient::Irk{2, 64}, 1e-11)), 1e-9);
  // Explicit, it loses what its steps do not resolve; a finer step loses less by the fifth power.
  const double coarse = drift(transient::RungeKutta4{512}, 1e-8), fine = drift(transient::RungeKutta4{1024}, 1e-8);
  EXPECT_LT(coarse, -1e-6);
  EXPECT_NEAR(std::log2(coarse / fine), 5, 0.5);
  // The more, the smaller the radius.
  const double some = drift(transient::GeneralizedAlpha{0.9}, 1e-4),
               more = drift(transient::GeneralizedAlpha{0.2}, 1e-4);
  EXPECT_LT(some, 0);
  EXPECT_LT(more, some);
  EXPECT_LT(drift(transient::Sdirk4{}, 1e-4), 0);
}
