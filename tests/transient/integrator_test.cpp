// Integration in time: order, error control, exact ends, deviations, films that end, run-up; on any number of ranks.

#include <gtest/gtest.h>

#include "solve/cycle_systems.hpp"
#include "transient/steps/stages.hpp"
#include "whirl/transient/steps/integrator.hpp"

using namespace whirl;
using problem::Drive;
using test::SmallSystem;
using transient::Integrator;

namespace {

// The state after `count` steps of one length, with a tolerance that asks for nothing and Newton's method to 1e-12;
// deviations are carried along.
Eigen::VectorXd after_steps(SmallSystem& s, const Drive& drive, const Eigen::VectorXd& x, int count, double length,
                            transient::Tangents* tangents = nullptr) {
  transient::Equations equations(s, drive);
  const solve::Tableau tableau = solve::sdirk(4);
  transient::SdirkSteps steps(equations, tableau, 1, 1e-12);
  transient::StageTangents carrier(equations, tableau);
  const core::Vector u = equations.make_state(), out = equations.make_state();
  equations.scale(s.vector(x).get(), u.get());
  for (int k = 0; k < count; ++k) {
    EXPECT_EQ(steps.step(k * length, length, u.get()).length, length);
    if (!tangents) continue;
    (void)carrier.propagate(k * length, length, steps, *tangents);
    carrier.accept(*tangents);
  }
  equations.unscale(u.get(), out.get());
  return s.gather(out.get());
}

Eigen::VectorXd state(SmallSystem& s, const Integrator& integrator) {
  const core::Vector x = s.vector(Eigen::VectorXd::Zero(s.size()));
  integrator.state(x.get());
  return s.gather(x.get());
}

// x' = -50 (x - cos(angle)) beside the manufactured oscillator: stiff, and F is not solved for x'.
struct StiffDuffing {
  template <class T>
  test::Column<T> operator()(double angle, const test::Column<T>& x, const test::Column<T>& xdot, T p) const {
    const test::Column<T> smooth =
        test::ManufacturedDuffing()(angle, test::Column<T>(x.head(2)), test::Column<T>(xdot.head(2)), p);
    test::Column<T> f(3);
    f << smooth(0), 2.0 * smooth(1) + 0.5 * smooth(0), xdot(2) + 50.0 * (x(2) - std::cos(angle)) + p * std::sin(angle);
    return f;
  }
};

Eigen::VectorXd stiff_exact(double angle, double p) {
  const Eigen::Vector2d smooth = test::ManufacturedDuffing::exact(angle, p);
  return Eigen::Vector3d(smooth(0), smooth(1), std::cos(angle));
}

constexpr double speed = 1.3;

}  // namespace

TEST(Drive, TimesOfAngles) {
  for (const Drive& d : {Drive{100, 0, 0.3}, Drive{100, 20, 0}, Drive{100, -20, 1}})
    for (const double t : {0.1, 1.0, 2.5}) EXPECT_NEAR(d.time_of(d.angle_at(t) - d.angle), t, 1e-14);
}

TEST(Integrator, HasOrderFour) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  std::vector<double> errors;
  for (const int steps : {40, 80, 160}) {
    SmallSystem s(MPI_COMM_WORLD, 2, speed, 0, test::ManufacturedDuffing());
    const double end = 3;
    const Eigen::VectorXd x = after_steps(s, {speed}, test::ManufacturedDuffing::exact(0, speed), steps, end / steps);
    errors.push_back((x - test::ManufacturedDuffing::exact(speed * end, speed)).norm());
  }
  EXPECT_GT(std::log2(errors[0] / errors[1]), 3.9);
  EXPECT_GT(std::log2(errors[1] / errors[2]), 3.9);
}

TEST(Integrator, KeepsTheToleranceAndHitsTheEnd) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  long before = 0;
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    SmallSystem s(MPI_COMM_WORLD, 3, speed, 0, StiffDuffing());
    Integrator integrator(s, {speed}, s.vector(stiff_exact(0, speed)).get(), {.tolerance = tolerance});
    for (const double end : {0.37, 2.0, 7.123}) {
      integrator.advance(end);
      EXPECT_EQ(integrator.time(), end);
      const double error = (state(s, integrator) - stiff_exact(speed * end, speed)).norm();
      EXPECT_LT(error, 20 * tolerance);
      EXPECT_GT(error, 0.0);
    }
    // The estimate is of order three: a hundredth of the tolerance costs 3.2 times the steps.
    if (before > 0) {
      EXPECT_GT(integrator.work().steps, 2 * before);
      EXPECT_LT(integrator.work().steps, 4 * before);
    }
    before = integrator.work().steps;
  }
}

TEST(Integrator, RestartsToTheBit) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  SmallSystem s(MPI_COMM_WORLD, 3, speed, 0, StiffDuffing());
  const Eigen::VectorXd x = stiff_exact(0, speed) + Eigen::Vector3d(0.1, -0.2, 0.3);
  Integrator whole(s, {speed}, s.vector(x).get()), first(s, {speed}, s.vector(x).get());
  whole.advance(1);
  whole.restart(1, whole.step());  // as at the end of a revolution
  first.advance(1);
  Integrator second(s, {speed}, s.vector(Eigen::VectorXd::Zero(3)).get());
  core::check(VecCopy(first.scaled(), second.scaled()));
  second.restart(1, first.step());
  whole.advance(2);
  second.advance(2);
  EXPECT_EQ((state(s, whole) - state(s, second)).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(whole.step(), second.step());
}

// The motion from a state moved by h v differs from h times the deviation by a term in h^2.
TEST(Integrator, CarriesDeviationsExactly) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  SmallSystem s(MPI_COMM_WORLD, 3, speed, 0, StiffDuffing());
  s.set_scales(Eigen::Vector3d(0.5, 2, 3), Eigen::Vector3d(4, 0.1, 7));
  const Eigen::VectorXd scale = Eigen::Vector3d(0.5, 2, 3), x = stiff_exact(0, speed);
  transient::Tangents tangents(s.vector(x).get(), 3);
  std::vector<Eigen::VectorXd> starts;
  for (int k = 0; k < 3; ++k) starts.push_back(s.gather(tangents.column(k)));
  EXPECT_NEAR(starts[0].dot(starts[1]), 0, 1e-14);
  EXPECT_NEAR(starts[2].norm(), 1, 1e-14);
  const Eigen::VectorXd there = after_steps(s, {speed}, x, 17, 0.1, &tangents);
  for (int k = 0; k < 3; ++k) {
    const Eigen::VectorXd deviation = s.gather(tangents.column(k)).cwiseProduct(scale);
    std::vector<double> rest;
    for (const double h : {2e-3, 1e-3}) {
      const Eigen::VectorXd from = x + h * starts[static_cast<std::size_t>(k)].cwiseProduct(scale);
      const Eigen::VectorXd change = after_steps(s, {speed}, from, 17, 0.1) - there;
      EXPECT_GT(change.norm(), 1e-5);
      rest.push_back((change - h * deviation).norm());
    }
    EXPECT_NEAR(rest[0] / rest[1], 4, 0.1);
  }
}

// x' = -x y, 0 = y - 1 - x^2/2: deviations obey the second equation from where they are carried first, and go on to the
// bit where another integrator takes them over. Made to obey it a second time they would lag behind.
TEST(Integrator, TakesOverDeviationsAsTheyAre) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  const auto decay = []<class T>(double, const test::Column<T>& x, const test::Column<T>& xdot, T) {
    test::Column<T> f(2);
    f << xdot(0) + x(0) * x(1), x(1) - 1.0 - 0.5 * x(0) * x(0);
    return f;
  };
  SmallSystem s(MPI_COMM_WORLD, 2, 1, 1, decay);
  const core::Vector start = s.vector(Eigen::Vector2d(1, 1.5));
  Integrator whole(s, {1}, start.get());
  transient::Tangents tangents(whole.scaled(), 1), taken(whole.scaled(), 1);
  EXPECT_TRUE(tangents.are_new());
  whole.carry(&tangents);
  EXPECT_FALSE(tangents.are_new());
  const Eigen::VectorXd first = s.gather(tangents.column(0));
  EXPECT_NEAR(first(1), first(0), 1e-6 * std::abs(first(0)));  // dy = x dx
  whole.advance(0.5);
  whole.close_revolution(0);
  Integrator second(s, {1}, start.get());
  core::check(VecCopy(whole.scaled(), second.scaled()));
  second.restart(0.5, whole.step());
  core::check(VecCopy(tangents.column(0), taken.column(0)));
  taken.were_carried();
  second.carry(&taken);
  EXPECT_EQ(s.gather(taken.column(0)), s.gather(tangents.column(0)));
  whole.advance(1);
  second.advance(1);
  EXPECT_EQ(s.gather(taken.column(0)), s.gather(tangents.column(0)));
}

// Van der Pol's oscillator and a stiff follower, x_2' = -200 (x_2 - x_0), told as structure. Each step is compared with
// that of an integrator which begins anew, by factors of this very step: what those of steps of other lengths are off
// by, they iterate away. A test that trusts the convergence of earlier stages leaves three times as much, a tenth of
// the tolerance.
TEST(Integrator, FactorsOfOtherStepsLeaveNoMoreThanAPartOfTheTolerance) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "the same on every rank";
  test::Blocks blocks;
  blocks.l1 = Eigen::Matrix3d::Identity();
  blocks.l0 = (Eigen::Matrix3d() << 0, -1, 0, 1, 0, 0, -200, 0, 200).finished();
  blocks.l0p = Eigen::Matrix3d::Zero();
  blocks.b = Eigen::Vector3d(0, 1, 0);
  blocks.c = Eigen::MatrixXd::Identity(2, 3);
  const auto load = []<class T>(double, T) -> test::Column<T> { return test::Column<T>::Zero(3); };
  const auto forces = []<class T>(const test::Column<T>& w, T p) {
    test::Column<T> f(1);
    f << p * (1.0 - w(0) * w(0)) * w(1);
    return f;
  };
  test::StructuredSystem s(1, 1, blocks, load, forces);
  const double tolerance = 1e-8;
  const core::Vector start = s.vector(Eigen::Vector3d(2, 0, 2));
  const transient::IntegratorOptions options{.tolerance = tolerance, .first_step = 2e-3};
  Integrator whole(s, {1}, start.get(), options), anew(s, {1}, start.get(), options);
  double worst = 0;
  int compared = 0;
  for (int k = 0; whole.time() < 12; ++k) {
    const double from = whole.time(), step = whole.step(), to = from + (k % 7 == 6 ? 0.93 : 1) * step;
    core::check(VecCopy(whole.scaled(), anew.scaled()));
    anew.restart(from, step);
    const long before = whole.work().steps, before_anew = anew.work().steps;
    whole.advance(to);
    anew.advance(to);
    if (whole.work().steps != before + 1 || anew.work().steps != before_anew + 1) continue;  // cut by its error
    ++compared;
    const Eigen::VectorXd x = state(s, whole), error = state(s, anew) - x;
    worst = std::max(worst, (error.array() / (1 + x.array().abs())).matrix().norm() / std::sqrt(3.0));
  }
  EXPECT_GT(compared, 400);
  EXPECT_LT(worst, 0.06 * tolerance);
  EXPECT_GT(worst, 0.0);
}

TEST(Integrator, EndsWhereAFilmEnds) {
  const auto film = []<class T>(double, const test::Column<T>& x, const test::Column<T>& xdot, T) {
    if (std::real(x(0)) > 1) throw core::DomainError("the film is gone");
    test::Column<T> f(2);
    f << xdot(0) - x(1), xdot(1);
    return f;
  };
  SmallSystem s(MPI_COMM_WORLD, 2, 1, 1, film);
  Integrator integrator(s, {1}, s.vector(Eigen::Vector2d(0, 0.5)).get());
  integrator.advance(1);
  try {
    integrator.advance(3);
    ADD_FAILURE() << "went through the wall";
  } catch (const core::DomainError& e) {
    EXPECT_NE(std::string(e.what()).find("the film is gone"), std::string::npos) << e.what();
  }
  EXPECT_NEAR(integrator.time(), 2, 1e-6);
  EXPECT_NEAR(state(s, integrator)(0), 1, 1e-6);
}

// A first step far too long leads Newton out of the domain; the motion itself never leaves it.
TEST(Integrator, ShortensStepsThatLeaveTheDomain) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  const auto root = []<class T>(double, const test::Column<T>& x, const test::Column<T>& xdot, T) {
    if (!(std::real(x(0)) > 0)) throw core::DomainError("negative");
    test::Column<T> f(1);
    f << xdot(0) + std::sqrt(x(0)) - 0.1;
    return f;
  };
  SmallSystem s(MPI_COMM_WORLD, 1, 1, 1, root);
  Integrator integrator(s, {1}, s.vector(Eigen::VectorXd::Constant(1, 4)).get(), {.first_step = 50});
  integrator.advance(100);
  EXPECT_GT(integrator.work().rejected, 0);
  EXPECT_NEAR(state(s, integrator)(0), 0.01, 1e-7);
}

TEST(Integrator, SameOnAnyNumberOfRanks) {
  const auto run = [](MPI_Comm comm) {
    SmallSystem s(comm, 3, speed, 0, StiffDuffing());
    Integrator integrator(s, {speed}, s.vector(stiff_exact(0, speed) + Eigen::Vector3d(0.1, 0.1, 0.1)).get(),
                          {.tolerance = 1e-5});
    transient::Tangents tangents(integrator.scaled(), 2);
    integrator.carry(&tangents);
    integrator.advance(0.3);
    Eigen::VectorXd out(5);
    const std::vector<double> growth = tangents.orthonormalise();
    out << state(s, integrator), growth[0], growth[1];
    return out;
  };
  EXPECT_LT((run(MPI_COMM_WORLD) - run(PETSC_COMM_SELF)).cwiseAbs().maxCoeff(), 1e-10);
}
