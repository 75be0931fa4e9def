// Transfer functions and coherence estimated from records of a system that is known.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "whirl/core/petsc.hpp"
#include "whirl/transient/analysis/estimators.hpp"

using namespace whirl::transient;

namespace {

using Record = std::vector<double>;

Record noise(std::mt19937_64& source, std::size_t n, double size = 1) {
  std::normal_distribution<double> normal(0, size);
  Record out(n);
  for (double& v : out) v = normal(source);
  return out;
}

// y_k = a x_k + b x_(k-1): a system that forgets at once, so that segments of 64 samples know it to one per cent.
struct Fir {
  double a, b;
  [[nodiscard]] Record of(const Record& x) const {
    Record y(x.size());
    for (std::size_t k = 0; k < x.size(); ++k) y[k] = a * x[k] + (k > 0 ? b * x[k - 1] : 0);
    return y;
  }
  [[nodiscard]] std::complex<double> at(double f) const { return a + b * std::polar(1.0, -2 * std::numbers::pi * f); }
};

void add(Record& to, const Record& more, double factor = 1) {
  for (std::size_t k = 0; k < to.size(); ++k) to[k] += factor * more[k];
}

}  // namespace

TEST(Estimators, SegmentsCountLessThanTheyAre) {
  EXPECT_NEAR(equivalent_averages(91, 4096), 91 / (1 + 2 * (1 - 1.0 / 91) / 36), 1e-9);
  EXPECT_NEAR(equivalent_averages(91, 4096), 86.3, 0.05);
  EXPECT_NEAR(equivalent_averages(1, 4096), 1, 1e-12);
}

// A line a cos has the power a^2/2 under its three lines; white noise of unit variance the density 2 per sample rate.
TEST(Estimators, DensitiesAreOneSided) {
  std::mt19937_64 source(1);
  Record x = noise(source, 64 * 500);
  const SpectralMatrix s = spectral_matrix({x}, 0.01, {.segments = 999});
  EXPECT_EQ(s.samples, 64);
  EXPECT_NEAR(s.resolution, 1 / 0.64, 1e-12);
  double mean = 0;
  for (std::size_t k = 2; k < 31; ++k) mean += s.lines[k](0, 0).real() / 29;
  EXPECT_NEAR(mean, 2 * 0.01, 0.03 * 0.02);
  for (std::size_t k = 0; k < x.size(); ++k)
    x[k] = 3 * std::cos(2 * std::numbers::pi * 8 * static_cast<double>(k) / 64) + 100;
  const SpectralMatrix line = spectral_matrix({x}, 0.01, {.segments = 99});
  double power = 0;
  for (const auto& m : line.lines) power += m(0, 0).real() * line.resolution;
  EXPECT_NEAR(power, 4.5, 1e-9);
}

// Two inputs that are correlated, two outputs, no noise but what a segment of finite length leaves.
TEST(Estimators, KnowASystemWithoutNoise) {
  std::mt19937_64 source(2);
  const std::size_t n = 256 * 50;
  Record f1 = noise(source, n), f2 = noise(source, n);
  add(f2, f1, 0.8);
  const Fir h11{1, 0.5}, h12{-0.3, 0.2}, h21{0.7, -0.6}, h22{2, 0.1};
  Record g1 = h11.of(f1), g2 = h21.of(f1);
  add(g1, h12.of(f2));
  add(g2, h22.of(f2));
  const SpectralMatrix s = spectral_matrix({f1, f2, g1, g2}, 1, {.segments = 99});
  for (const std::size_t k : {5UL, 40UL, 100UL}) {
    const LineEstimate e = estimate(s.lines[k], 2, s.averages, 0.95);
    const double f = s.frequency(k);
    Eigen::Matrix2cd h;
    h << h11.at(f), h12.at(f), h21.at(f), h22.at(f);
    EXPECT_LT((e.h1 - h).norm() / h.norm(), 5e-3);
    EXPECT_LT((e.h2 - h).norm() / h.norm(), 5e-3);
    EXPECT_GT(e.multiple.minCoeff(), 0.999);
    EXPECT_LT(e.radius.maxCoeff(), 1e-2);
    // One input alone explains not all of it, and its own ratio S_gf/S_ff is off by what the other one brings along.
    EXPECT_LT(e.ordinary.minCoeff(), 0.9);
    const std::complex<double> alone = s.lines[k](2, 0) / s.lines[k](0, 0);
    EXPECT_GT(std::abs(alone - h(0, 0)), 0.05);
    EXPECT_NEAR(e.input_coherence, 0.64 / 1.64, 0.25);
  }
}

// Noise at the output, of known share: bias and scatter of everything stay within the bounds as often as they say.
TEST(Estimators, BoundsHoldAsOftenAsTheySay) {
  std::mt19937_64 source(3);
  const std::size_t n = 64 * 46;
  const Fir h1{1, 0.5}, h2{0.4, -0.3};
  const double level = 1;
  int inside_h = 0, inside_multiple = 0, inside_ordinary = 0, total = 0;
  double bias = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Record f1 = noise(source, n), f2 = noise(source, n);
    Record g = h1.of(f1);
    add(g, h2.of(f2));
    add(g, noise(source, n, level));
    const SpectralMatrix s = spectral_matrix({f1, f2, g}, 1, {.segments = 91});
    for (const std::size_t k : {8UL, 16UL, 24UL}) {
      const LineEstimate e = estimate(s.lines[k], 2, s.averages, 0.95);
      const double f = s.frequency(k), own = std::norm(h1.at(f)), other = std::norm(h2.at(f));
      const double multiple = (own + other) / (own + other + level), ordinary = own / (own + other + level);
      const Bounds m = coherence_bounds(e.multiple(0), 2, s.averages, 0.95),
                   o = coherence_bounds(e.ordinary(0, 0), 1, s.averages, 0.95);
      inside_h += std::abs(e.h1(0, 0) - h1.at(f)) <= e.radius(0, 0);
      inside_multiple += m.low <= multiple && multiple <= m.high;
      inside_ordinary += o.low <= ordinary && ordinary <= o.high;
      bias += std::abs(e.h1(0, 0)) / std::abs(h1.at(f)) - 1;
      ++total;
    }
  }
  // 900 trials: 95 % +- 0.7 % (one standard deviation).
  EXPECT_NEAR(100.0 * inside_h / total, 95, 2.5);
  EXPECT_NEAR(100.0 * inside_multiple / total, 95, 2.5);
  EXPECT_NEAR(100.0 * inside_ordinary / total, 95, 2.5);
  EXPECT_NEAR(bias / total, 0, 0.01);
}

TEST(Estimators, ChanceHasACoherence) {
  std::mt19937_64 source(4);
  const std::size_t n = 64 * 16;
  int beyond[2] = {0, 0}, total = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const SpectralMatrix s =
        spectral_matrix({noise(source, n), noise(source, n), noise(source, n)}, 1, {.segments = 31});
    for (const std::size_t k : {8UL, 16UL, 24UL}) {
      const LineEstimate e = estimate(s.lines[k], 2, s.averages, 0.95);
      beyond[0] += e.ordinary(0, 0) > coherence_of_chance(1, s.averages, 0.95);
      beyond[1] += e.multiple(0) > coherence_of_chance(2, s.averages, 0.95);
      ++total;
    }
  }
  EXPECT_NEAR(100.0 * beyond[0] / total, 5, 2);
  EXPECT_NEAR(100.0 * beyond[1] / total, 5, 2);
}

// With noise at the input, H1 is low and H2 is not; the other way round with noise at the output.
TEST(Estimators, NoiseAtEitherEndShiftsOneOfThem) {
  std::mt19937_64 source(5);
  const std::size_t n = 64 * 2000;
  Record f = noise(source, n);
  const Fir h{1, 0.5};
  const Record g = h.of(f);
  Record loud = g;
  add(loud, noise(source, n));
  Record heard = f;
  add(heard, noise(source, n, 0.5));
  const std::size_t k = 16;
  const auto at = [&](const Record& in, const Record& out) {
    const SpectralMatrix s = spectral_matrix({in, out}, 1, {.segments = 3999});
    return estimate(s.lines[k], 1, s.averages, 0.95);
  };
  const std::complex<double> wanted = h.at(16.0 / 64);
  const LineEstimate input = at(heard, g), output = at(f, loud);
  EXPECT_NEAR(std::abs(input.h1(0, 0)) / std::abs(wanted), 1 / 1.25, 0.02);
  EXPECT_NEAR(std::abs(input.h2(0, 0)) / std::abs(wanted), 1, 0.02);
  EXPECT_NEAR(std::abs(output.h1(0, 0)) / std::abs(wanted), 1, 0.02);
  EXPECT_NEAR(std::abs(output.h2(0, 0)) / std::abs(wanted), 1 + 1 / std::norm(wanted), 0.05);
}

// Eq. (3.42) of Skarolek (2011) averages the ratios of single segments. Two inputs at once are noise to each other, and
// a ratio has no variance: more segments do not bring it nearer, while H1 gains their root.
TEST(Estimators, AMeanOfRatiosIsNoEstimate) {
  std::mt19937_64 source(6);
  const Fir h1{1, 0.5}, h2{1.2, -0.4};
  const auto errors = [&](int segments) {
    const auto half = static_cast<std::size_t>(segments + 1) / 2;
    const Record f1 = noise(source, 64 * half), f2 = noise(source, 64 * half);
    Record g = h1.of(f1);
    add(g, h2.of(f2));
    const SpectralMatrix s = spectral_matrix({f1, f2, g}, 1, {.segments = segments});
    std::vector<std::complex<double>> ratios(33);
    for (int piece = 0; piece < segments; ++piece) {
      const auto begin = static_cast<std::ptrdiff_t>(32 * piece);
      const SpectralMatrix one = spectral_matrix(
          {Record(f1.begin() + begin, f1.begin() + begin + 64), Record(g.begin() + begin, g.begin() + begin + 64)}, 1,
          {.segments = 1});
      for (std::size_t k = 0; k < 33; ++k)
        ratios[k] += one.lines[k](1, 0) / one.lines[k](0, 0) / static_cast<double>(segments);
    }
    double mean = 0, best = 0;
    for (std::size_t k = 3; k < 30; ++k) {
      const double f = s.frequency(k);
      mean += std::norm(ratios[k] - h1.at(f)) / 27;
      best += std::norm(estimate(s.lines[k], 2, s.averages, 0.95).h1(0, 0) - h1.at(f)) / 27;
    }
    return std::array<double, 2>{std::sqrt(mean), std::sqrt(best)};
  };
  double few[2] = {0, 0}, many[2] = {0, 0};
  for (int trial = 0; trial < 8; ++trial) {
    const auto a = errors(61), b = errors(61 * 16 + 1);
    for (std::size_t i = 0; i < 2; ++i) {
      few[i] += a[i] / 8;
      many[i] += b[i] / 8;
    }
  }
  EXPECT_GT(few[0], 8 * few[1]);
  EXPECT_GT(many[0], 15 * many[1]);
  EXPECT_NEAR(few[1] / many[1], 4, 1.2);  // the root of 16
}
