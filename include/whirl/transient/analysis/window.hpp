#pragma once
// What multiplies a record before its Fourier transform.

#include <span>
#include <vector>

#include "whirl/deck/description.hpp"

namespace whirl::transient {

/// w_k = sum_j (-1)^j a_j cos(2 pi j k/n), k = 0 to n - 1, whose tones are a few lines wide. Sources: Harris (1978),
/// Proc. IEEE 66, 51 (Hamming 0.54, 0.46; four-term Blackman-Harris); ISO 18431-2 (flat top).
enum class Window { none, hann, hamming, blackman_harris, flat_top };
[[nodiscard]] std::span<const deck::Name<Window>> names(Window);

/// a_0, a_1, ...
[[nodiscard]] std::span<const double> coefficients(Window window);
/// w_k [n].
[[nodiscard]] std::vector<double> weights(Window window, std::size_t n);

/// Line at a distance of `offset` lines from a tone, over the tone's amplitude; long records. 1 at 0.
[[nodiscard]] double response(Window window, double offset);
/// The distance of a tone from its highest line, 0 to 1/2, by the ratio of the second highest line to it.
[[nodiscard]] double offset_of(Window window, double ratio);

/// What a spectrum with this window can tell.
struct WindowFacts {
  double main_lobe = 0;        ///< half its width in lines: tones nearer than twice that disturb each other
  double noise_bandwidth = 0;  ///< in lines: n sum w^2/(sum w)^2
  double scalloping = 0;       ///< share by which the highest line of a tone half way between lines is too low
};
[[nodiscard]] WindowFacts facts(Window window);

}  // namespace whirl::transient
