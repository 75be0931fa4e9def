// The loss factor of a rotor in the Jacobian: K (1 + i eta s) of a vibration with one frequency.

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "support/dense.hpp"
#include "whirl/core/error.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;
using Complex = std::complex<double>;

namespace {

system::Train machine(rotor::LossFrame frame, bool reduced) {
  system::Train t;
  rotor::Segment s;
  s.length = 0.1;
  s.outer_mass_diameter = 0.03;
  t.rotor.segments.assign(5, s);
  t.rotor.material.modulus = {{293.15, 2.1e11}};
  t.rotor.loss_factor = 0.03;
  t.rotor.loss_frame = frame;
  if (reduced) t.rotor.reduction = {rotor::Reduction::Type::craig_bampton, {1, 6}, 2};
  for (const int node : {1, 6}) {
    system::Support b;
    b.node = node;
    b.film = film::Linear{{2e6, 1e5, -1e5, 3e6}, {200, 0, 0, 200}};
    t.supports.push_back(b);
  }
  t.supports[0].has_pedestal = true;
  t.supports[0].mass = {3, 4};
  t.supports[0].stiffness = {2e7, 3e7};
  return t;
}

}  // namespace

TEST(Loss, JacobianHoldsTheComplexStiffnessOfEachSenseOfWhirl) {
  using enum rotor::LossFrame;
  const double speed = 300;
  for (const auto frame : {shaft, stationary})
    for (const bool reduced : {false, true})
      for (const double frequency : {200.0, 300.0, 450.0}) {
        system::RotorSystem s(MPI_COMM_WORLD, machine(frame, reduced), speed);
        core::Vector x = core::make_vector(MPI_COMM_WORLD, s.local_size(), PETSC_DETERMINE),
                     rest = core::duplicate(x.get()), f = core::duplicate(x.get());
        core::Matrix j = s.make_jacobian();
        const auto at_frequency = [&] {
          s.jacobian(0, x.get(), rest.get(), 1, 0, j.get());
          return test::dense(j.get());
        };
        const Eigen::MatrixXd without = at_frequency();
        Eigen::MatrixXd added;
        try {
          const system::RotorSystem::WithLoss loss(s, s.loss_at(frequency));
          added = at_frequency() - without;
          throw core::NotConverged("a solve");
        } catch (const core::NotConverged&) {
        }
        // On q alone, with v = i frequency q.
        const Eigen::Index n = s.coordinates(), rotor = s.rotor().size();
        Eigen::MatrixXcd found(n, n);
        for (Eigen::Index r = 0; r < n; ++r)
          for (Eigen::Index c = 0; c < n; ++c)
            found(r, c) = added(2 * r, 2 * c) + Complex(0, frequency) * added(2 * r, 2 * c + 1);
        const Eigen::MatrixXd k = test::dense(s.rotor().matrices().stiffness.get());
        const double sense = frame == stationary ? 1 : frequency > speed ? 1 : frequency < speed ? -1 : 0;
        // Circular motion: (1, -i) forward, (1, i) backward in each pair.
        for (const double way : {-1.0, 1.0}) {
          Eigen::VectorXcd q = Eigen::VectorXcd::Zero(n);
          for (Eigen::Index c = 0; c < rotor; c += 2) {
            const Complex a(std::sin(1.0 + static_cast<double>(c)), std::cos(2.0 * static_cast<double>(c)));
            q(c) = a;
            q(c + 1) = Complex(0, way) * a;
          }
          const Eigen::VectorXcd wanted = Complex(0, 0.03 * (way < 0 ? sense : 1)) * (k * q.head(rotor));
          EXPECT_LE(((found * q).head(rotor) - wanted).norm(), 1e-12 * (k * q.head(rotor)).norm());
        }
        EXPECT_EQ(found.bottomRows(n - rotor).norm(), 0);  // pedestals have none
        // Nothing of it is left after a solve that failed.
        EXPECT_EQ((at_frequency() - without).norm(), 0);
      }
}

TEST(Loss, AtRestNothingIsLost) {
  system::RotorSystem s(MPI_COMM_WORLD, machine(rotor::LossFrame::shaft, false), 300);
  core::Vector x = core::make_vector(MPI_COMM_WORLD, s.local_size(), PETSC_DETERMINE), rest = core::duplicate(x.get()),
               f = core::duplicate(x.get()), g = core::duplicate(x.get());
  core::check(VecSet(x.get(), 1e-6));
  s.residual(0, x.get(), rest.get(), f.get());
  const system::RotorSystem::WithLoss loss(s, s.loss_at(200));
  s.residual(0, x.get(), rest.get(), g.get());
  EXPECT_EQ((test::dense(f.get()) - test::dense(g.get())).norm(), 0);
}

// Damping of the material may vary where there is some; the Jacobian has no room for it where there is none.
TEST(Loss, InternalDampingVariesFromAPositiveValueOn) {
  const auto at = [](double p) {
    system::Train t = machine(rotor::LossFrame::shaft, false);
    t.rotor.loss_factor = 0;
    t.rotor.internal_damping = p;
    if (p < 0) throw core::DomainError("out of range");
    return t;
  };
  system::RotorSystem s(MPI_COMM_WORLD, system::Varying{at, 1e-6, 1e-6}, 300);
  core::Vector x = core::make_vector(MPI_COMM_WORLD, s.local_size(), PETSC_DETERMINE), rest = core::duplicate(x.get()),
               by = core::duplicate(x.get()), f = core::duplicate(x.get()), g = core::duplicate(x.get());
  core::check(VecSet(x.get(), 1e-6));
  s.parameter_derivative(0, x.get(), rest.get(), by.get());
  s.residual(0, x.get(), rest.get(), f.get());
  s.set_parameter(3e-6);
  s.residual(0, x.get(), rest.get(), g.get());
  const Eigen::VectorXd wanted = (test::dense(g.get()) - test::dense(f.get())) / 2e-6;
  EXPECT_GT(wanted.norm(), 0);
  EXPECT_LE((test::dense(by.get()) - wanted).norm(), 1e-7 * wanted.norm());
  system::RotorSystem none(MPI_COMM_WORLD, system::Varying{at, 0, 1e-6}, 300);
  EXPECT_THROW(none.set_parameter(1e-6), core::InputError);
}
