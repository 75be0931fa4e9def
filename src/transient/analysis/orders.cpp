#include "whirl/transient/analysis/orders.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "whirl/core/error.hpp"
#include "whirl/transient/analysis/spectrum.hpp"

namespace whirl::transient {
namespace {

std::span<const double> piece(const ByAngle& signal, const RecordPieces& pieces, int k) {
  const auto first = static_cast<std::size_t>(k) * static_cast<std::size_t>(pieces.advance * signal.per_revolution);
  return signal.samples.subspan(first, static_cast<std::size_t>(pieces.revolutions * signal.per_revolution));
}

// Weight of sample i of a piece, which stands i + 1 samples behind its beginning: weights begin with that of the
// beginning itself, which is that of the end too. So they are symmetric about the middle of the piece.
std::vector<double> centred(Window window, std::size_t n) {
  std::vector<double> w = weights(window, n);
  std::rotate(w.begin(), w.begin() + 1, w.end());
  return w;
}

int revolutions(const ByAngle& signal) {
  return static_cast<int>(signal.samples.size()) / signal.per_revolution;
}

}  // namespace

int count(const RecordPieces& pieces, int revolutions) {
  return revolutions < pieces.revolutions ? 0 : (revolutions - pieces.revolutions) / pieces.advance + 1;
}

double middle(const RecordPieces& pieces, int k) {
  return k * pieces.advance + pieces.revolutions / 2.0;
}

std::vector<std::complex<double>> order_track(const ByAngle& signal, double order, const RecordPieces& pieces) {
  const double lines = order * pieces.revolutions;
  core::require(std::abs(lines - std::round(lines)) < 1e-9 && 2 * order < signal.per_revolution,
                "an order is a line of a piece, and below half the samples of a revolution");
  const auto n = static_cast<std::size_t>(pieces.revolutions * signal.per_revolution);
  // Weights that are symmetric about the middle of the piece keep the phase of an amplitude that changes.
  const std::vector<double> w = centred(pieces.window, n);
  double gain = 0;
  for (const double v : w) gain += v;
  std::vector<std::complex<double>> kernel(n), out;
  for (std::size_t i = 0; i < n; ++i) {
    // Pieces begin with whole revolutions, of which a fractional order counts the turns.
    const double angle = 2 * std::numbers::pi * static_cast<double>(i + 1) / signal.per_revolution;
    kernel[i] = std::polar(w[i] * (order == 0 ? 1 : 2) / gain, -order * angle);
  }
  for (int k = 0; k < count(pieces, revolutions(signal)); ++k) {
    const auto here = piece(signal, pieces, k);
    std::complex<double> sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += kernel[i] * here[i];
    const double begun = order * k * pieces.advance;
    out.push_back(sum * std::polar(1.0, -2 * std::numbers::pi * (begun - std::floor(begun))));
  }
  return out;
}

std::vector<std::vector<double>> waterfall(const ByAngle& signal, double highest, const RecordPieces& pieces) {
  std::vector<std::vector<double>> out;
  const auto lines = static_cast<std::size_t>(std::floor(highest * pieces.revolutions * (1 + 1e-12))) + 1;
  for (int k = 0; k < count(pieces, revolutions(signal)); ++k) {
    // The last sample goes first, to where its weight is: no amplitude depends on where a piece begins to turn.
    const auto here = piece(signal, pieces, k);
    std::vector<double> turned(here.begin(), here.end());
    std::rotate(turned.begin(), turned.end() - 1, turned.end());
    Spectrum s = amplitude_spectrum(turned, 1.0 / signal.per_revolution, pieces.window);
    s.amplitude.resize(std::min(lines, s.amplitude.size()));
    out.push_back(std::move(s.amplitude));
  }
  return out;
}

}  // namespace whirl::transient
