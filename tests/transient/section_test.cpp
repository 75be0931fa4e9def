// Where motions cross a plane: known times and points, and motions that do not notice.

#include <gtest/gtest.h>

#include "solve/cycle_systems.hpp"
#include "whirl/transient/steps/integrator.hpp"
#include "whirl/transient/steps/section.hpp"

using namespace whirl;
using test::SmallSystem;
using test::two_pi;

namespace {

double entry(Vec v, int k) {
  return core::gather(v)[static_cast<std::size_t>(k)];
}

// Times at which x_0 passes `value`, by a record of samples a revolution.
std::vector<double> crossings(SmallSystem& s, const problem::Drive& drive, const Eigen::VectorXd& x, double value,
                              transient::CrossingSense sense, double end, int samples, double tolerance,
                              std::vector<double>* ends = nullptr, std::vector<double>* heights = nullptr) {
  transient::Integrator integrator(s, drive, s.vector(x).get(), {.tolerance = tolerance});
  std::vector<double> found;
  const auto height = [&] { return entry(integrator.scaled(), 0) - value; };
  transient::Section section(integrator, height, sense, [&](double time) {
    found.push_back(time);
    if (heights) heights->push_back(height());
  });
  for (int k = 1; k <= samples; ++k) section.advance(end * k / samples);
  if (ends) *ends = core::gather(integrator.scaled());
  return found;
}

// The steady oscillation cos(angle) of a linear oscillator forced with it: crossings at known angles.
TEST(Section, IsFoundWhereTheMotionCrosses) {
  if (core::size_of(MPI_COMM_WORLD) > 2) GTEST_SKIP() << "every step of a distributed system costs messages";
  SmallSystem s(PETSC_COMM_WORLD, 2, 1.3, 0, test::LinearOscillator());
  const std::complex<double> z = 1.0 / std::complex<double>(1 - 1.3 * 1.3, 0.26);
  const double value = 0.3 * std::abs(z), end = 3 * two_pi / 1.3;
  double last = 0;
  for (const double tolerance : core::size_of(MPI_COMM_WORLD) == 1 ? std::vector{1e-6, 1e-9} : std::vector{1e-5}) {
    std::vector<double> heights;
    const auto t = crossings(s, {1.3}, test::LinearOscillator::exact(0, 1.3), value, transient::CrossingSense::rising,
                             end, 48, tolerance, nullptr, &heights);
    ASSERT_EQ(t.size(), 3U);
    double worst = 0;
    for (std::size_t k = 0; k < t.size(); ++k) {
      EXPECT_NEAR(heights[k], 0, 1e-13);
      // |z| cos(p t + arg z) = 0.3 |z| on the rising side.
      double phase = -std::acos(0.3) - std::arg(z);
      phase -= two_pi * std::floor(phase / two_pi);
      worst = std::max(worst, std::abs(t[k] - (phase + two_pi * static_cast<double>(k)) / 1.3));
    }
    EXPECT_LT(worst, 100 * tolerance);
    if (last > 0) {
      EXPECT_LT(worst, last / 50);
    }
    last = worst;
  }
}

TEST(Section, CountsTheSensesAskedFor) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  SmallSystem s(PETSC_COMM_WORLD, 2, 0.25, 1, test::HopfNormalForm());
  const auto x = test::HopfNormalForm::exact(0.1, 0.25);
  const double end = 5 * test::HopfNormalForm::period(0.25);
  for (const auto& [sense, wanted] : {std::pair(transient::CrossingSense::rising, 5),
                                      {transient::CrossingSense::falling, 5},
                                      {transient::CrossingSense::both, 10}})
    EXPECT_EQ(crossings(s, {1}, x, 0.2, sense, end, 100, 1e-8).size(), static_cast<std::size_t>(wanted));
}

// Of a self-excited cycle the returns are its period, whatever the samples.
TEST(Section, ReturnsOfACycleTakeItsPeriod) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  SmallSystem s(PETSC_COMM_WORLD, 2, 0.25, 1, test::HopfNormalForm());
  const auto t =
      crossings(s, {1}, test::HopfNormalForm::exact(0, 0.25), 0.1, transient::CrossingSense::rising, 40, 211, 1e-10);
  ASSERT_GE(t.size(), 4U);
  for (std::size_t k = 1; k < t.size(); ++k) EXPECT_NEAR(t[k] - t[k - 1], test::HopfNormalForm::period(0.25), 1e-8);
}

// The search leaves no trace in the motion, nor in its deviations.
TEST(Section, IsNotNoticedByTheMotion) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  SmallSystem s(PETSC_COMM_WORLD, 2, 1, 2, test::VanDerPol());
  const Eigen::Vector2d start(2, 0);
  std::vector<double> with, growth[2];
  crossings(s, {1}, start, 0, transient::CrossingSense::both, 30, 60, 1e-7, &with);
  for (const bool cut : {false, true}) {
    transient::Integrator integrator(s, {1}, s.vector(start).get(), {.tolerance = 1e-7});
    transient::Tangents tangents(integrator.scaled(), 2);
    integrator.carry(&tangents);
    int found = 0;
    transient::Section section(
        integrator, [&] { return entry(integrator.scaled(), 0); }, transient::CrossingSense::both,
        [&](double) { ++found; });
    for (int k = 1; k <= 60; ++k) {
      if (cut)
        section.advance(0.5 * k);
      else
        integrator.advance(0.5 * k);
      for (const double g : tangents.orthonormalise()) growth[cut].push_back(g);
    }
    EXPECT_EQ(found > 5, cut);
  }
  EXPECT_EQ(growth[0], growth[1]);
  transient::Integrator plain(s, {1}, s.vector(start).get(), {.tolerance = 1e-7});
  for (int k = 1; k <= 60; ++k) plain.advance(0.5 * k);
  EXPECT_EQ(core::gather(plain.scaled()), with);
}

// Van der Pol's oscillator as a machine that tells its structure, whose steps keep predictions and factors.
TEST(Section, LeavesPredictionsAndFactorsAlone) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "the same on every rank";
  test::Blocks blocks;
  blocks.l1 = blocks.c = Eigen::Matrix2d::Identity();
  blocks.l0 = (Eigen::Matrix2d() << 0, -1, 1, 0).finished();
  blocks.l0p = Eigen::Matrix2d::Zero();
  blocks.b = Eigen::Vector2d(0, 1);
  const auto load = []<class T>(double, T) -> test::Column<T> { return test::Column<T>::Zero(2); };
  const auto forces = []<class T>(const test::Column<T>& w, T p) {
    test::Column<T> f(1);
    f << p * (1.0 - w(0) * w(0)) * w(1);
    return f;
  };
  test::StructuredSystem s(1, 2, blocks, load, forces);
  std::vector<double> states[2];
  for (const bool cut : {false, true}) {
    transient::Integrator integrator(s, {1}, s.vector(Eigen::Vector2d(2, 0)).get(), {.tolerance = 1e-5});
    int found = 0;
    transient::Section section(
        integrator, [&] { return entry(integrator.scaled(), 0); }, transient::CrossingSense::both,
        [&](double) { ++found; });
    for (int k = 1; k <= 60; ++k) {
      if (cut)
        section.advance(0.5 * k);
      else
        integrator.advance(0.5 * k);
      for (const double x : core::gather(integrator.scaled())) states[cut].push_back(x);
    }
    EXPECT_EQ(found > 5, cut);
  }
  EXPECT_EQ(states[0], states[1]);
}

// Schemes that go their own pace: the crossings lie on the motion that they have without a section, which goes on as it
// does without, and come nearer to the exact ones with the tolerance.
TEST(Section, LiesOnTheMotionOfSchemesWithTheirOwnPace) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "every step of a distributed system costs messages";
  const double speed = 1.3, end = 3 * two_pi / speed, value = 0.5;
  SmallSystem s(PETSC_COMM_WORLD, 2, speed, 0, test::ManufacturedDuffing());
  const core::Vector start = s.vector(test::ManufacturedDuffing::exact(0, speed));
  // exp(sin(angle)) = 0.5 where it rises.
  const double angle = two_pi + std::asin(std::log(value));
  for (const transient::Scheme& scheme :
       {transient::Scheme(transient::GeneralizedAlpha{}), transient::Scheme(transient::Bdf{3})}) {
    double last = 0;
    for (const double tolerance : {1e-5, 1e-7}) {
      const transient::IntegratorOptions options{.scheme = scheme, .tolerance = tolerance};
      transient::Integrator cut(s, {speed}, start.get(), options), plain(s, {speed}, start.get(), options);
      std::vector<double> times;
      std::vector<std::vector<double>> states;
      transient::Section section(
          cut, [&] { return entry(cut.scaled(), 0) - value; }, transient::CrossingSense::rising,
          [&](double time) {
            times.push_back(time);
            states.push_back(core::gather(cut.scaled()));
          });
      // Samples further apart than steps, so that crossings lie in steps before the last one too.
      for (int k = 1; k <= 24; ++k) section.advance(end * k / 24);
      ASSERT_EQ(times.size(), 3U) << transient::name_of(scheme);
      double worst = 0;
      for (std::size_t k = 0; k < times.size(); ++k) {
        plain.advance(times[k]);
        const std::vector<double> there = core::gather(plain.scaled());
        EXPECT_NEAR(there[0], value, 1e-12);
        for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(states[k][i], there[i], 1e-12);
        worst = std::max(worst, std::abs(times[k] - (angle + two_pi * static_cast<double>(k)) / speed));
      }
      plain.advance(cut.time());
      EXPECT_EQ(core::gather(plain.scaled()), core::gather(cut.scaled())) << transient::name_of(scheme);
      EXPECT_EQ(plain.work().steps, cut.work().steps);
      if (last > 0) {
        EXPECT_LT(worst, last / 5) << transient::name_of(scheme);
      }
      last = worst;
    }
  }
}

}  // namespace
