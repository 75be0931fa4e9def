// Schemes that a deck chooses: order, energy, ends between steps, algebraic states; on any number of ranks.

#include <gtest/gtest.h>

#include "solve/cycle_systems.hpp"
#include "whirl/transient/steps/integrator.hpp"
#include "whirl/transient/steps/signal.hpp"

using namespace whirl;
using test::SmallSystem;
using transient::Integrator;
using transient::Scheme;

namespace {

constexpr double speed = 1.3;

Eigen::VectorXd state(SmallSystem& s, const Integrator& integrator) {
  const core::Vector x = s.vector(Eigen::VectorXd::Zero(s.size()));
  integrator.state(x.get());
  return s.gather(x.get());
}

// Error at the end of about two revolutions of the manufactured oscillator.
double error(const Scheme& scheme, double tolerance = 1e-9) {
  SmallSystem s(MPI_COMM_WORLD, 2, speed, 0, test::ManufacturedDuffing());
  Integrator integrator(s, {speed}, s.vector(test::ManufacturedDuffing::exact(0, speed)).get(),
                        {.scheme = scheme, .tolerance = tolerance});
  const double end = 9;
  integrator.advance(end);
  EXPECT_EQ(integrator.time(), end);
  return (state(s, integrator) - test::ManufacturedDuffing::exact(speed * end, speed)).norm();
}

template <class K>
double order(int steps, K scheme = {}) {
  std::array<double, 3> errors{};
  for (double& e : errors) {
    scheme.steps = steps;
    e = error(scheme);
    steps *= 2;
  }
  EXPECT_LT(errors[2], errors[1]);
  return std::log2(errors[1] / errors[2]);
}

// x'' + x = 0, as a rotor without damping.
struct Undamped {
  template <class T>
  test::Column<T> operator()(double, const test::Column<T>& x, const test::Column<T>& xdot, T) const {
    test::Column<T> f(2);
    f << xdot(0) - x(1), xdot(1) + x(0);
    return f;
  }
};

// Relative change of its energy in 20 periods.
double drift(const Scheme& scheme, double tolerance = 1e-10) {
  SmallSystem s(MPI_COMM_WORLD, 2, 1, 1, Undamped());
  Integrator integrator(s, {1}, s.vector(Eigen::Vector2d(1, 0)).get(), {.scheme = scheme, .tolerance = tolerance});
  for (int k = 1; k <= 20; ++k) integrator.advance(test::two_pi * k);
  return state(s, integrator).squaredNorm() - 1;
}

// x' = y - x, 0 = y - cos(angle): y has no rate.
struct Algebraic {
  template <class T>
  test::Column<T> operator()(double angle, const test::Column<T>& x, const test::Column<T>& xdot, T) const {
    test::Column<T> f(2);
    f << xdot(0) - x(1) + x(0), x(1) - std::cos(angle);
    return f;
  }
};

const std::vector<Scheme> all{transient::Sdirk4{},
                              transient::GeneralizedAlpha{},
                              transient::Bdf{},
                              transient::Irk{},
                              transient::Newmark{},
                              transient::NewmarkLinearised{},
                              transient::RungeKutta4{256},
                              transient::AdamsMoulton{}};

}  // namespace

TEST(Schemes, HaveTheirOrders) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  EXPECT_NEAR(order<transient::Newmark>(64), 2, 0.1);
  EXPECT_NEAR(order<transient::NewmarkLinearised>(128), 2, 0.1);
  EXPECT_NEAR(order<transient::AdamsMoulton>(128), 2, 0.1);
  EXPECT_NEAR(order<transient::RungeKutta4>(32), 4, 0.1);
  EXPECT_NEAR(order(32, transient::Irk{1, 0}), 2, 0.1);
  EXPECT_NEAR(order(16, transient::Irk{2, 0}), 4, 0.2);
  EXPECT_NEAR(order(8, transient::Irk{3, 0}), 6, 0.4);
}

// A hundredth of the tolerance leaves 100^(-p/(p+1)) of the error.
TEST(Schemes, KeepTheirTolerance) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  for (const Scheme& s : {Scheme(transient::GeneralizedAlpha{}), Scheme(transient::Bdf{}), Scheme(transient::Bdf{4})}) {
    const double coarse = error(s, 1e-5), fine = error(s, 1e-7);
    EXPECT_LT(coarse, 1e-2) << transient::name_of(s);
    EXPECT_LT(fine, 1e-3) << transient::name_of(s);
    EXPECT_LT(fine, coarse / 5) << transient::name_of(s);
  }
}

TEST(Schemes, KeepOrLoseEnergy) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  EXPECT_LT(std::abs(drift(transient::Newmark{32})), 1e-9);
  EXPECT_LT(std::abs(drift(transient::NewmarkLinearised{32})), 1e-9);
  EXPECT_LT(std::abs(drift(transient::Irk{2, 16})), 1e-9);
  // Runge-Kutta of order 4 loses (w h)^6/72 of the energy in a step, the predictor and corrector more.
  const double h = test::two_pi / 32;
  EXPECT_NEAR(drift(transient::RungeKutta4{32}) / (-20 * 32 * std::pow(h, 6) / 72), 1, 0.05);
  EXPECT_LT(drift(transient::AdamsMoulton{64}), -1e-2);
  EXPECT_LT(drift(transient::GeneralizedAlpha{0.8}, 1e-4), 0);
  EXPECT_LT(drift(transient::GeneralizedAlpha{0.2}, 1e-4), drift(transient::GeneralizedAlpha{0.8}, 1e-4));
  EXPECT_LT(drift(transient::Bdf{2}, 1e-4), -1e-3);
}

TEST(Schemes, TakeAlgebraicStatesOrSayWhyNot) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  for (const Scheme& scheme : all) {
    SmallSystem s(MPI_COMM_WORLD, 2, 1, 1, Algebraic());
    const auto run = [&] {
      Integrator integrator(s, {1}, s.vector(Eigen::Vector2d(0.5, 1)).get(), {.scheme = scheme, .tolerance = 1e-6});
      integrator.advance(1.5);
      return state(s, integrator);
    };
    if (!transient::is_explicit(scheme)) {
      // x = (cos + sin)/2.
      EXPECT_NEAR(run()(0), (std::cos(1.5) + std::sin(1.5)) / 2, 2e-4) << transient::name_of(scheme);
      continue;
    }
    try {
      (void)run();
      ADD_FAILURE() << transient::name_of(scheme);
    } catch (const core::InputError& e) {
      EXPECT_NE(std::string(e.what()).find("dF/d(dx/dt) is singular"), std::string::npos) << e.what();
    }
  }
}

// A wheel on a spring under a table of forces, which breaks at every sample: with the spring's force as a state of its
// own, which has no rate, Newmark's method takes the same steps as without it.
TEST(Schemes, BreaksOfForcesCostNewmarkNoOrder) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  const auto direct = []<class T>(double, const test::Column<T>& x, const test::Column<T>& xdot, T) {
    test::Column<T> f(2);
    f << xdot(0) - x(1), xdot(1) + x(0);
    return f;
  };
  const auto split = []<class T>(double, const test::Column<T>& x, const test::Column<T>& xdot, T) {
    test::Column<T> f(3);
    f << xdot(0) - x(1), xdot(1) + x(2), x(2) - x(0);
    return f;
  };
  transient::Series series;
  for (int k = 0; k <= 100; ++k) series.table.push_back({0.05 * k, std::sin(0.7 * k * k)});
  const auto end = [&](SmallSystem& s, const Eigen::VectorXd& x, const Scheme& scheme) {
    transient::Forces forces;
    forces.add(transient::make_signal(series), {{1, 1.0}});
    Integrator integrator(s, {1}, s.vector(x).get(), {.scheme = scheme, .tolerance = 1e-8, .forces = &forces});
    integrator.advance(4.9);
    return state(s, integrator);
  };
  SmallSystem whole(MPI_COMM_WORLD, 2, 1, 1, direct), parts(MPI_COMM_WORLD, 3, 1, 1, split);
  for (const Scheme& scheme : {Scheme(transient::Newmark{64}), Scheme(transient::NewmarkLinearised{64})}) {
    const Eigen::VectorXd wanted = end(whole, Eigen::Vector2d(1, 0), scheme),
                          found = end(parts, Eigen::Vector3d(1, 0, 1), scheme);
    EXPECT_LT((found.head(2) - wanted).norm(), 1e-5) << transient::name_of(scheme);
    EXPECT_NEAR(found(2), found(0), 1e-8);
  }
}

// L1 x' + x = 0 with an L1 of rank two whose rows are not zero, told as structure: no scheme that needs rates has any,
// and Newmark's does without.
TEST(Schemes, SeeRowsThatDependOnEachOther) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "the same on every rank";
  test::Blocks blocks;
  blocks.l0 = Eigen::Matrix3d::Identity();
  blocks.l0p = Eigen::Matrix3d::Zero();
  blocks.b = Eigen::Vector3d::Zero();
  blocks.c = Eigen::RowVector3d::Zero();
  const auto load = []<class T>(double, T) -> test::Column<T> { return test::Column<T>::Zero(3); };
  const auto forces = []<class T>(const test::Column<T>&, T) -> test::Column<T> { return test::Column<T>::Zero(1); };
  const Eigen::Vector3d b(0, 1, 1), start(1, 2, 0);
  // Elimination leaves a zero of the first one, and something of the size of rounding of the second one.
  for (const double by : {1.0, 0.7}) {
    const Eigen::Vector3d a = by * start;
    blocks.l1 = a * a.transpose() + b * b.transpose();
    test::StructuredSystem s(1, 1, blocks, load, forces);
    const auto end = [&](const Scheme& scheme) {
      Integrator integrator(s, {1}, s.vector(start).get(), {.scheme = scheme, .tolerance = 1e-8});
      integrator.advance(1.5);
      return state(s, integrator);
    };
    EXPECT_THROW((void)end(transient::AdamsMoulton{}), core::NotConverged);
    EXPECT_LT((end(transient::Newmark{512}) - end(transient::Sdirk4{})).norm(), 2e-5);
  }
}

// Samples between the ends of steps are as good as these.
TEST(Schemes, InterpolateToTheirTolerance) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  for (const Scheme& scheme : all) {
    SmallSystem s(MPI_COMM_WORLD, 2, speed, 0, test::ManufacturedDuffing());
    Integrator integrator(s, {speed}, s.vector(test::ManufacturedDuffing::exact(0, speed)).get(),
                          {.scheme = scheme, .tolerance = 1e-6});
    double worst = 0;
    for (int k = 1; k <= 90; ++k) {
      const double t = 0.05 * k;
      integrator.advance(t, 4.5);
      worst = std::max(worst, (state(s, integrator) - test::ManufacturedDuffing::exact(speed * t, speed)).norm());
    }
    EXPECT_LT(worst, 5e-3) << transient::name_of(scheme);
  }
}

// Where nothing else limits them, steps of schemes with their own pace are a sixteenth of the revolution that the shaft
// is in, not of its first one.
TEST(Schemes, LongestStepsFollowTheSpeed) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  const auto still = []<class T>(double, const test::Column<T>& x, const test::Column<T>& xdot, T) {
    test::Column<T> f(1);
    f << xdot(0) + x(0);
    return f;
  };
  for (const Scheme& scheme : {Scheme(transient::GeneralizedAlpha{}), Scheme(transient::Bdf{})})
    for (const problem::Drive& drive : {problem::Drive{1, 0.1}, problem::Drive{4, -0.1}}) {
      SmallSystem s(MPI_COMM_WORLD, 1, drive.speed, 0, still);
      double part = 0;
      int steps = 0;
      const auto seen = [&](double time, double step) {
        part = step * drive.speed_at(time - step) / test::two_pi;
        ++steps;
        EXPECT_LT(part, (1 + 1e-6) / 16) << transient::name_of(scheme) << " " << time;
      };
      Integrator integrator(s, drive, s.vector(Eigen::VectorXd::Zero(1)).get(),
                            {.scheme = scheme, .tolerance = 1e-4, .after_step = seen});
      integrator.advance(30);
      EXPECT_GT(part, 0.9 / 16) << transient::name_of(scheme);
      EXPECT_GT(steps, 30);
    }
}

TEST(Schemes, RestartFromTheirState) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  for (const Scheme& scheme : all) {
    SmallSystem s(MPI_COMM_WORLD, 2, speed, 0, test::ManufacturedDuffing());
    const core::Vector x = s.vector(test::ManufacturedDuffing::exact(0, speed));
    const transient::IntegratorOptions options{.scheme = scheme, .tolerance = 1e-6};
    Integrator whole(s, {speed}, x.get(), options), second(s, {speed}, x.get(), options);
    whole.advance(2);
    whole.close_revolution(0);
    core::check(VecCopy(whole.scaled(), second.scaled()));
    second.restart(2, whole.step());
    whole.advance(3);
    second.advance(3);
    const bool several =
        std::holds_alternative<transient::Bdf>(scheme) || std::holds_alternative<transient::GeneralizedAlpha>(scheme);
    EXPECT_LE((state(s, whole) - state(s, second)).norm(), several ? 1e-3 : 0) << transient::name_of(scheme);
  }
}

TEST(Schemes, SameOnAnyNumberOfRanks) {
  for (const Scheme& scheme : all) {
    const auto run = [&](MPI_Comm comm) {
      SmallSystem s(comm, 2, speed, 0, test::ManufacturedDuffing());
      Integrator integrator(s, {speed}, s.vector(test::ManufacturedDuffing::exact(0, speed)).get(),
                            {.scheme = scheme, .tolerance = 1e-4});
      integrator.advance(0.1);
      return state(s, integrator);
    };
    EXPECT_LT((run(MPI_COMM_WORLD) - run(PETSC_COMM_SELF)).norm(), 1e-9) << transient::name_of(scheme);
  }
}
