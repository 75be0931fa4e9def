#pragma once
// Spectra over the course of a motion: waterfalls and orders of a shaft whose speed changes.

#include <complex>
#include <span>
#include <vector>

#include "whirl/transient/analysis/window.hpp"

namespace whirl::transient {

/// A signal sampled at equal angles of the shaft, so many times a revolution: what turns with the shaft, or a fixed
/// multiple as fast, keeps its line however the speed changes. Source: Fyfe and Munck (1997), Mech. Syst. Signal
/// Process. 11, 187.
struct ByAngle {
  std::span<const double> samples;  ///< at the angles 2 pi (k + 1)/per_revolution
  int per_revolution = 0;
};

/// Short pieces of a record, `revolutions` long, one beginning `advance` revolutions after the other.
struct RecordPieces {
  int revolutions = 16;
  int advance = 8;
  Window window = Window::hann;
};
/// How many whole pieces a record of so many revolutions has.
[[nodiscard]] int count(const RecordPieces& pieces, int revolutions);
/// The middle of piece `k` [revolutions since the record began].
[[nodiscard]] double middle(const RecordPieces& pieces, int k);

/// c of each piece, where the signal's part of this order is Re(c exp(i order angle)): |c| is its amplitude 0-peak,
/// arg c its phase ahead of the shaft angle (which counts on from the beginning of the record, whole turns of a
/// fractional order too). order x revolutions must be a whole number, and the order less than half the samples of a
/// revolution, else core::Error. Exact where the amplitudes are constant over a piece and other orders lie on lines of
/// 1/revolutions, outside the window's main lobe.
[[nodiscard]] std::vector<std::complex<double>> order_track(const ByAngle& signal, double order,
                                                            const RecordPieces& pieces);

/// Amplitudes 0-peak [piece][line] of the orders k/revolutions up to `highest`; the first line is the magnitude of the
/// mean.
[[nodiscard]] std::vector<std::vector<double>> waterfall(const ByAngle& signal, double highest,
                                                         const RecordPieces& pieces);

}  // namespace whirl::transient
