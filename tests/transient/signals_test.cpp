// Spectra of signals whose tones are known, and verdicts on evidence that is.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "whirl/core/petsc.hpp"
#include "whirl/transient/analysis/classify.hpp"
#include "whirl/transient/analysis/spectrum.hpp"

using namespace whirl::transient;

namespace {

constexpr double two_pi = 2 * std::numbers::pi;

template <class F>
std::vector<double> sampled(int n, double interval, F f) {
  std::vector<double> out;
  for (int k = 0; k < n; ++k) out.push_back(f(k * interval));
  return out;
}

// Forward and backward circles of an ellipse, and which of them turns which way.
TEST(FullSpectrum, PartsAnEllipseIntoCircles) {
  for (const int n : {96, 97}) {
    std::vector<double> x, y;
    const double forward = 3, backward = 1, turns = 6;
    for (int k = 0; k < n; ++k) {
      const double phase = 2 * std::numbers::pi * turns * k / n;
      x.push_back(0.3 + (forward + backward) * std::cos(phase));
      y.push_back(-0.4 + (forward - backward) * std::sin(phase));
    }
    const double interval = 0.01;
    const FullSpectrum s = full_spectrum(x, y, interval, Window::none);
    ASSERT_EQ(s.amplitude.size(), x.size());
    for (int k = 0; k < n; ++k) {
      const int line = s.first + k;
      const double wanted = line == 6 ? forward : line == -6 ? backward : line == 0 ? 0.5 : 0;
      EXPECT_NEAR(s.amplitude[static_cast<std::size_t>(k)], wanted, 1e-13) << line;
    }
    EXPECT_NEAR(s.resolution, 1 / (n * interval), 1e-14);
    EXPECT_EQ(s.first, -((n - 1) / 2));
    const FullSpectrum soft = full_spectrum(x, y, interval, Window::hann);
    EXPECT_NEAR(soft.amplitude[static_cast<std::size_t>(6 - s.first)], forward, 1e-12);
    EXPECT_NEAR(soft.amplitude[static_cast<std::size_t>(5 - s.first)], forward / 2, 1e-12);
  }
}

// On a line both circles are equal, and half of what the spectrum of one coordinate shows.
TEST(FullSpectrum, OfALineIsSymmetric) {
  std::vector<double> x, y(64, 0.0);
  for (int k = 0; k < 64; ++k) x.push_back(std::sin(0.7 * k) + 0.2 * std::cos(2.1 * k));
  const FullSpectrum both = full_spectrum(x, y, 1, Window::hann);
  const Spectrum one = amplitude_spectrum(x, 1, Window::hann);
  for (int k = 1; k < 32; ++k) {
    const double up = both.amplitude[static_cast<std::size_t>(k - both.first)];
    EXPECT_NEAR(up, both.amplitude[static_cast<std::size_t>(-k - both.first)], 1e-14);
    EXPECT_NEAR(2 * up, one.amplitude[static_cast<std::size_t>(k)], 1e-14);
  }
}

}  // namespace

TEST(Spectrum, TonesOnLinesHaveTheirAmplitudes) {
  for (const int n : {200, 225})
    for (const Window window : {Window::none, Window::hann}) {
      const double interval = 0.01, line = 1 / (n * interval);
      const auto s = amplitude_spectrum(sampled(n, interval,
                                                [&](double t) {
                                                  return -0.7 + 3 * std::cos(two_pi * 12 * line * t + 1) +
                                                         0.02 * std::sin(two_pi * 40 * line * t);
                                                }),
                                        interval, window);
      ASSERT_EQ(s.amplitude.size(), static_cast<std::size_t>(n / 2 + 1));
      EXPECT_NEAR(s.resolution, line, 1e-15);
      EXPECT_NEAR(s.amplitude[0], 0.7, 1e-14);
      EXPECT_NEAR(s.amplitude[12], 3, 1e-13);
      EXPECT_NEAR(s.amplitude[40], 0.02, 1e-13);
      EXPECT_NEAR(s.amplitude[25], 0, 1e-13);
      const auto found = tones(s, 2);
      ASSERT_EQ(found.size(), 2U);
      EXPECT_NEAR(found[0].frequency, 12 * line, window == Window::none ? 1e-12 : 1e-9);
      EXPECT_NEAR(found[1].amplitude, 0.02, 1e-12);
    }
}

TEST(Spectrum, AToneBetweenLinesIsReadOffExactly) {
  for (const Window window : {Window::none, Window::hann})
    for (const double offset : {-0.45, -0.2, 0.3, 0.5}) {
      const int n = 4096;
      const double f = 300 + offset;
      const auto s = amplitude_spectrum(sampled(n, 1.0 / n, [&](double t) { return 2 * std::cos(two_pi * f * t); }),
                                        1.0 / n, window);
      const auto found = tones(s, 1);
      ASSERT_EQ(found.size(), 1U);
      // The mirror image at -f remains: 1/f without a window, 1/f^3 with.
      EXPECT_NEAR(found[0].frequency, f, window == Window::none ? 3e-3 : 1e-6);
      EXPECT_NEAR(found[0].amplitude, 2, window == Window::none ? 2e-2 : 1e-5);
    }
}

TEST(Spectrum, TheHighestLineOfAnEvenRecordCountsOnce) {
  const auto s =
      amplitude_spectrum(sampled(64, 1, [](double t) { return std::cos(std::numbers::pi * t); }), 1, Window::none);
  EXPECT_NEAR(s.amplitude[32], 1, 1e-14);
}

TEST(Returns, FindThePeriod) {
  std::vector<std::vector<double>> points;
  for (int i = 0; i < 30; ++i) points.push_back({std::cos(two_pi * i / 3), 5.0 + std::sin(two_pi * i / 3)});
  const auto d = return_distances(points, 7, 0.5);
  ASSERT_EQ(d.size(), 7U);
  EXPECT_NEAR(d[0], std::sqrt(3.0) / 0.5, 1e-12);
  EXPECT_NEAR(d[2], 0, 1e-14);
  EXPECT_NEAR(d[5], 0, 1e-14);
  EXPECT_TRUE(return_distances({{1}}, 3, 1).empty());
  // The same where each rank has some entries of the points, and the first of several has none.
  const int rank = whirl::core::rank_of(PETSC_COMM_WORLD), size = whirl::core::size_of(PETSC_COMM_WORLD);
  std::vector<std::vector<double>> here(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < points[i].size(); ++j)
      if (size == 1 || rank == 1 + static_cast<int>(j) % (size - 1)) here[i].push_back(points[i][j]);
  const auto shared = return_distances(here, 7, 0.5, PETSC_COMM_WORLD);
  ASSERT_EQ(shared.size(), d.size());
  for (std::size_t k = 0; k < d.size(); ++k) EXPECT_NEAR(shared[k], d[k], 1e-14);
}

// A multiplier of -0.97: after two revolutions the motion is back within 6 % of what parts it from its cycle.
TEST(Verdicts, ASlowTransientIsNoPeriodTwo) {
  const auto evidence = [](double multiplier) {
    std::vector<std::vector<double>> points;
    double deviation = 1e-3;
    for (int k = 0; k < 24; ++k, deviation *= multiplier) points.push_back({1 + deviation, 2});
    Evidence e;
    e.size = 1;
    e.returns = return_distances(points, 4, e.size);
    e.fading = fading_of_returns(points, 4);
    return e;
  };
  const auto transient = evidence(-0.97);
  EXPECT_GT(transient.returns[0], transient.return_tolerance);
  EXPECT_LT(transient.returns[1], transient.return_tolerance);
  EXPECT_EQ(classify(transient).kind, MotionKind::unsettled);
  EXPECT_EQ(classify(evidence(-1)).name, "period-2");
}

// Points of a spiral out of a cycle, of its torus, and of a motion that hops about.
TEST(Verdicts, ASpiralIsNoTorus) {
  const auto record = [](double growth, int count) {
    std::vector<std::vector<double>> points;
    for (int i = 0; i < count; ++i) {
      const double size = std::pow(growth, i), angle = 2 * M_PI * 0.1608 * i;
      points.push_back({1 + size * std::cos(angle), 2 + 0.3 * size * std::sin(angle)});
    }
    return points;
  };
  const auto verdict = [](const std::vector<std::vector<double>>& points) {
    Evidence e;
    e.size = 1;
    e.returns = return_distances(points, 8, 1);
    e.course = course_of_returns(points);
    e.exponents = {0.001};
    e.uncertainties = {0.01};
    return classify(e);
  };
  EXPECT_EQ(verdict(record(1.0003, 400)).kind, MotionKind::unsettled) << "11 % in 350 revolutions";
  EXPECT_EQ(verdict(record(0.9997, 400)).kind, MotionKind::unsettled);
  EXPECT_EQ(verdict(record(1.00015, 400)).kind, MotionKind::unsettled) << "5 %";
  EXPECT_EQ(verdict(record(1.00001, 400)).kind, MotionKind::quasi_periodic) << "0.4 %";
  EXPECT_EQ(verdict(record(1, 400)).kind, MotionKind::quasi_periodic);
  EXPECT_EQ(verdict(record(1.0003, 60)).kind, MotionKind::quasi_periodic) << "too few to tell";
  EXPECT_EQ(verdict(record(1.6, 20)).kind, MotionKind::unsettled) << "few are enough where all grows";
  const auto course = course_of_returns(record(1.001, 801));
  ASSERT_EQ(course.size(), 8U);
  EXPECT_NEAR(course[7] / course[0], std::pow(1.001, 700), 5e-3) << "the angle within a piece is not the same in all";
  std::vector<std::vector<double>> hops;
  for (double x = 0.3; hops.size() < 400; x = 3.9 * x * (1 - x)) hops.push_back({x});
  EXPECT_EQ(verdict(hops).kind, MotionKind::quasi_periodic) << "no direction";
}

TEST(Verdicts, FollowFromTheEvidence) {
  Evidence e;
  e.size = 0.3;
  e.returns = {0.5, 1e-7, 0.5, 1e-7};
  e.exponents = {-2, -5};
  e.uncertainties = {0.1, 0.1};
  EXPECT_EQ(classify(e).name, "period-2");
  EXPECT_EQ(classify(e).period, 2);
  e.returns = {1e-6, 1e-7};
  EXPECT_EQ(classify(e).name, "period-1");
  e.exponents = {0.5, -5};
  EXPECT_EQ(classify(e).kind, MotionKind::unsettled);
  e.returns = {0.5, 0.2};
  EXPECT_EQ(classify(e).kind, MotionKind::chaotic);
  e.exponents = {0.05, -5};
  EXPECT_EQ(classify(e).kind, MotionKind::quasi_periodic);
  e.exponents = {-0.5, -5};
  EXPECT_EQ(classify(e).kind, MotionKind::unsettled);
  e.uncertainties[0] = INFINITY;  // too few revolutions to tell
  EXPECT_EQ(classify(e).kind, MotionKind::unsettled);
  e.uncertainties[0] = 0.1;
  e.exponents = {};
  EXPECT_EQ(classify(e).kind, MotionKind::unsettled);
  e.returns = {1e-6};
  EXPECT_EQ(classify(e).name, "period-1");

  e.forced = false;
  e.exponents = {0.01, -3};
  e.returns = {0.4, 1e-6};  // to a section
  EXPECT_EQ(classify(e).kind, MotionKind::limit_cycle);
  EXPECT_EQ(classify(e).period, 2);
  EXPECT_EQ(classify(e).name, "limit_cycle");
  e.fading = {0.5, 1};
  EXPECT_EQ(classify(e).kind, MotionKind::unsettled);
  e.fading = {};
  e.exponents = {1, -3};
  EXPECT_EQ(classify(e).kind, MotionKind::unsettled);
  e.exponents = {};  // returns are evidence enough
  EXPECT_EQ(classify(e).kind, MotionKind::limit_cycle);
  e.exponents = {0.01, -3};
  e.returns = {0.4, 0.2};
  EXPECT_EQ(classify(e).kind, MotionKind::unsettled);
  e.exponents = {0.01, -0.01, -3};
  e.uncertainties = {0.1, 0.1, 0.1};
  EXPECT_EQ(classify(e).kind, MotionKind::quasi_periodic);
  e.returns = {};  // no section: the exponents alone
  e.exponents = {0.01, -3};
  EXPECT_EQ(classify(e).kind, MotionKind::limit_cycle);
  EXPECT_EQ(classify(e).period, 0);
  e.exponents = {0.01, -0.01, -3};
  e.uncertainties = {0.1, 0.1, 0.1};
  EXPECT_EQ(classify(e).kind, MotionKind::quasi_periodic);
  e.exponents = {1, 0, -3};
  EXPECT_EQ(classify(e).kind, MotionKind::chaotic);
  e.exponents = {-1, -2, -3};
  EXPECT_EQ(classify(e).kind, MotionKind::unsettled);
  e.size = 1e-9;
  EXPECT_EQ(classify(e).kind, MotionKind::fixed_point);
  EXPECT_FALSE(classify(e).reason.empty());
  e.exponents = {1, -2, -3};
  EXPECT_EQ(classify(e).kind, MotionKind::unsettled);
}
