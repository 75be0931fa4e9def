#pragma once
// Amplitude spectra of sampled signals, by FFTW.

#include <span>
#include <vector>

#include "whirl/transient/analysis/window.hpp"

namespace whirl::transient {

/// Amplitudes 0-peak over frequency; the first line is the magnitude of the mean.
struct Spectrum {
  double resolution = 0;          ///< between lines [1/unit of the sampling interval]
  std::vector<double> amplitude;  ///< [n/2 + 1], in the unit of the signal
  Window window = Window::none;
};

/// Spectrum of n equidistant samples: a tone a cos(2 pi f t) on a line of the spectrum has the amplitude a.
[[nodiscard]] Spectrum amplitude_spectrum(std::span<const double> samples, double interval, Window window);

/// Amplitudes 0-peak of the circles that an orbit is made of, over the frequency with its sign: positive ones turn from
/// x to y. An ellipse of one frequency has two lines, whose sum and difference are its semi-axes. Source: Goldman and
/// Muszynska (1999).
struct FullSpectrum {
  double resolution = 0;          ///< between lines [1/unit of the sampling interval]
  int first = 0;                  ///< number of the first line, -n/2 rounded up: its frequency over the resolution
  std::vector<double> amplitude;  ///< [n], ascending in frequency; that of zero is the distance of the mean from (0, 0)
};

/// Of n equidistant samples of x and y.
[[nodiscard]] FullSpectrum full_spectrum(std::span<const double> x, std::span<const double> y, double interval,
                                         Window window);

/// A tone read off a spectrum.
struct Tone {
  double frequency = 0, amplitude = 0;
};

/// The `count` highest lines that tower above their neighbours, the highest first, each with the frequency and the
/// amplitude of a single tone between two lines, by the ratio of the two highest lines (exact for an isolated one in a
/// long record). Two tones need a distance of twice the window's main lobe; of a flat top the ratio tells the frequency
/// least, and the amplitude best. Source: Grandke (1983), IEEE Trans. Instrum. Meas. 32, 350.
[[nodiscard]] std::vector<Tone> tones(const Spectrum& spectrum, int count);

}  // namespace whirl::transient
