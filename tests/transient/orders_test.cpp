// Windows, orders and waterfalls of signals that are known.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "whirl/core/error.hpp"
#include "whirl/transient/analysis/orders.hpp"
#include "whirl/transient/analysis/spectrum.hpp"

using namespace whirl::transient;

namespace {

constexpr double two_pi = 2 * std::numbers::pi;
constexpr Window all[] = {Window::none, Window::hann, Window::hamming, Window::blackman_harris, Window::flat_top};

std::vector<double> tone(int n, double lines, double amplitude, double phase = 0.4) {
  std::vector<double> out;
  for (int k = 0; k < n; ++k) out.push_back(amplitude * std::cos(two_pi * lines * k / n + phase));
  return out;
}

// A tone on a line has its amplitude with every window, and its lobe ends where the window says.
TEST(Window, TonesOnLinesHaveTheirAmplitudes) {
  for (const Window w : all) {
    const auto s = amplitude_spectrum(tone(512, 100, 3), 1.0 / 512, w);
    const int lobe = static_cast<int>(facts(w).main_lobe);
    EXPECT_NEAR(s.amplitude[100], 3, 1e-12);
    EXPECT_GT(s.amplitude[static_cast<std::size_t>(100 + lobe - 1)], 1e-3);
    EXPECT_NEAR(s.amplitude[static_cast<std::size_t>(100 + lobe)], 0, 1e-12);
  }
}

// Lines beside a tone are what response() says, and tones between lines are read off: the flat top's amplitude without,
// all others' with the ratio of two lines. Frequencies within `width` lines: mirror image, and records that are not
// endless.
TEST(Window, TonesBetweenLinesAreReadOff) {
  const double width[] = {2e-3, 1e-6, 1e-4, 1e-6, 1e-4};
  for (const Window w : all)
    for (const double offset : {-0.45, -0.2, 0.05, 0.3, 0.5}) {
      const int n = 8192;
      const auto s = amplitude_spectrum(tone(n, 900 + offset, 2), 1.0 / n, w);
      const double bound = width[static_cast<int>(w)];
      for (const int line : {899, 900, 901})
        EXPECT_NEAR(s.amplitude[static_cast<std::size_t>(line)], 2 * response(w, line - 900 - offset), 4 * bound);
      const auto found = tones(s, 1);
      ASSERT_EQ(found.size(), 1U);
      EXPECT_NEAR(found[0].frequency, 900 + offset, bound) << static_cast<int>(w) << " " << offset;
      EXPECT_NEAR(found[0].amplitude, 2, 10 * bound);
    }
}

// Published figures (Harris 1978, table 1; ISO 18431-2): noise bandwidth in lines, scalloping in dB.
TEST(Window, FactsAreThoseOfTheLiterature) {
  const double bandwidth[] = {1.00, 1.50, 1.36, 2.00, 3.77}, loss[] = {3.92, 1.42, 1.78, 0.83, 0.01};
  for (const Window w : all) {
    EXPECT_NEAR(facts(w).noise_bandwidth, bandwidth[static_cast<int>(w)], 0.01);
    EXPECT_NEAR(-20 * std::log10(1 - facts(w).scalloping), loss[static_cast<int>(w)], 0.04);
  }
}

// Small beside large: 1e-4 of it ten lines away, between lines. Only the Blackman-Harris window shows it.
TEST(Window, BlackmanHarrisShowsWhatLeakageHides) {
  const int n = 1024;
  auto signal = tone(n, 200.5, 1);
  const auto small = tone(n, 215, 1e-4);
  for (int k = 0; k < n; ++k) signal[static_cast<std::size_t>(k)] += small[static_cast<std::size_t>(k)];
  EXPECT_NEAR(amplitude_spectrum(signal, 1, Window::blackman_harris).amplitude[215], 1e-4, 5e-6);
  EXPECT_GT(std::abs(amplitude_spectrum(signal, 1, Window::none).amplitude[215] - 1e-4), 1e-3);
  EXPECT_GT(std::abs(amplitude_spectrum(signal, 1, Window::hamming).amplitude[215] - 1e-4), 1e-4);
}

struct Part {
  double order, amplitude, phase, slope;  // slope: of the amplitude, per revolution
};

// Sampled at equal angles: what speed the shaft has is not seen.
std::vector<double> by_angle(int revolutions, int samples, const std::vector<Part>& parts) {
  std::vector<double> out;
  for (int k = 1; k <= revolutions * samples; ++k) {
    const double turns = static_cast<double>(k) / samples;
    double sum = 0.7;
    for (const Part& p : parts) sum += (p.amplitude + p.slope * turns) * std::cos(two_pi * p.order * turns + p.phase);
    out.push_back(sum);
  }
  return out;
}

TEST(Orders, ConstantOnesAreExact) {
  const std::vector<Part> parts{{0.5, 2, 0.3, 0}, {1, 1, -2, 0}, {2, 0.1, 1.2, 0}};
  const auto signal = by_angle(40, 16, parts);
  for (const Window w : {Window::none, Window::hann}) {
    const RecordPieces pieces{8, 3, w};
    EXPECT_EQ(count(pieces, 40), 11);
    for (const Part& p : parts) {
      const auto track = order_track({signal, 16}, p.order, pieces);
      ASSERT_EQ(track.size(), 11U);
      for (const auto& c : track) EXPECT_NEAR(std::abs(c - std::polar(p.amplitude, p.phase)), 0, 1e-13);
    }
  }
  EXPECT_THROW((void)order_track({signal, 16}, 0.3, {8, 1, Window::none}), whirl::core::Error);
  EXPECT_THROW((void)order_track({signal, 16}, 8, {8, 1, Window::none}), whirl::core::Error);
}

// Amplitudes that change evenly count as in the middle of a piece, to what a piece's ends leave over.
TEST(Orders, ChangingOnesAreThoseOfTheMiddle) {
  const auto signal = by_angle(60, 32, {{1, 1, 0.5, 0.02}, {0.5, 3, 0, -0.03}});
  const RecordPieces pieces{8, 1, Window::hann};
  const auto track = order_track({signal, 32}, 1, pieces);
  for (std::size_t k = 0; k < track.size(); ++k)
    EXPECT_NEAR(std::abs(track[k]), 1 + 0.02 * middle(pieces, static_cast<int>(k)), 1.5e-3);
}

// Under a window that vanishes at its ends the mean of a record that rises evenly is its value in the middle of the
// piece, to rounding; the rise is an odd function about it, whose lines have no real part. A row of the waterfall has
// the amplitude of the middle too, to what the mirror image of the tone leaves; a window one sample off errs by 4 %.
TEST(Orders, PiecesAreAboutTheirMiddles) {
  std::vector<double> rising;
  const int samples = 8;
  for (int k = 1; k <= 20 * samples; ++k) rising.push_back(3 + 0.25 * k / samples);
  const RecordPieces pieces{4, 2, Window::hann};
  const auto mean = order_track({rising, samples}, 0, pieces);
  ASSERT_EQ(mean.size(), 9U);
  for (std::size_t k = 0; k < mean.size(); ++k)
    EXPECT_NEAR(std::abs(mean[k] - (3 + 0.25 * middle(pieces, static_cast<int>(k)))), 0, 1e-13);
  for (const auto& c : order_track({rising, samples}, 0.5, pieces)) EXPECT_NEAR(c.real(), 0, 1e-13);
  const auto growing = by_angle(4, samples, {{1, 0.4, 0.3, 0.3}});
  EXPECT_NEAR(waterfall({growing, samples}, 2, pieces)[0][4], 1, 1e-3);
}

// A chirp, sampled in time, has no line; sampled by the angle of the shaft that makes it, one. The waterfall's rows
// hold amplitude and place of the orders at every speed.
TEST(Orders, AChirpKeepsItsOrder) {
  const double from = 100, acceleration = 40;  // rad/s, rad/s^2
  std::vector<double> angle_wise, time_wise;
  const int samples = 16, revolutions = 64;
  const auto signal = [](double angle) { return 1.5 * std::cos(2 * angle + 0.3); };
  const double turned = two_pi * revolutions,
               end = (std::sqrt(from * from + 2 * acceleration * turned) - from) / acceleration;
  for (int k = 1; k <= samples * revolutions; ++k) {
    angle_wise.push_back(signal(two_pi * k / samples));
    const double t = end * k / (samples * revolutions);
    time_wise.push_back(signal((from + acceleration * t / 2) * t));
  }
  const RecordPieces pieces{16, 16, Window::hann};
  const auto rows = waterfall({angle_wise, samples}, 4, pieces), smeared = waterfall({time_wise, samples}, 4, pieces);
  ASSERT_EQ(rows.size(), 4U);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ASSERT_EQ(rows[k].size(), 65U);
    EXPECT_NEAR(rows[k][32], 1.5, 1e-12);
    EXPECT_NEAR(rows[k][40], 0, 1e-12);
  }
  EXPECT_LT(smeared[0][32], 0.5);
}

}  // namespace
