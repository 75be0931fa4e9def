#include "whirl/transient/analysis/spectrum.hpp"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>

#include "whirl/core/error.hpp"

namespace whirl::transient {

namespace {

using Plan = std::unique_ptr<std::remove_pointer_t<fftw_plan>, decltype(&fftw_destroy_plan)>;

void execute(fftw_plan made) {
  const Plan plan(made, &fftw_destroy_plan);
  core::require(plan != nullptr, "FFTW makes a plan for every length");
  fftw_execute(plan.get());
}

}  // namespace

Spectrum amplitude_spectrum(std::span<const double> samples, double interval, Window window) {
  const std::size_t n = samples.size();
  core::require(n >= 2, "a spectrum needs samples");
  double mean = 0;
  for (const double s : samples) mean += s / static_cast<double>(n);
  std::vector<double> in(n);
  const std::vector<double> w = weights(window, n);
  double gain = 0;
  for (std::size_t k = 0; k < n; ++k) {
    in[k] = w[k] * (samples[k] - mean);
    gain += w[k];
  }
  std::vector<std::complex<double>> out(n / 2 + 1);
  execute(
      fftw_plan_dft_r2c_1d(static_cast<int>(n), in.data(), reinterpret_cast<fftw_complex*>(out.data()), FFTW_ESTIMATE));
  Spectrum s{1 / (static_cast<double>(n) * interval), {}, window};
  for (std::size_t k = 0; k < out.size(); ++k) {
    const bool once = k == 0 || 2 * k == n;  // the mean and the highest line of an even record have no mirror image
    s.amplitude.push_back((once ? 1 : 2) * std::abs(out[k]) / gain);
  }
  s.amplitude[0] = std::abs(mean);
  return s;
}

FullSpectrum full_spectrum(std::span<const double> x, std::span<const double> y, double interval, Window window) {
  using Complex = std::complex<double>;
  const std::size_t n = x.size();
  core::require(n >= 2 && y.size() == n, "a full spectrum needs samples of x and y");
  Complex mean = 0;
  for (std::size_t k = 0; k < n; ++k) mean += Complex(x[k], y[k]) / static_cast<double>(n);
  std::vector<Complex> in(n), out(n);
  const std::vector<double> w = weights(window, n);
  double gain = 0;
  for (std::size_t k = 0; k < n; ++k) {
    in[k] = w[k] * (Complex(x[k], y[k]) - mean);
    gain += w[k];
  }
  execute(fftw_plan_dft_1d(static_cast<int>(n), reinterpret_cast<fftw_complex*>(in.data()),
                           reinterpret_cast<fftw_complex*>(out.data()), FFTW_FORWARD, FFTW_ESTIMATE));
  FullSpectrum s{1 / (static_cast<double>(n) * interval), -static_cast<int>((n - 1) / 2), {}};
  for (std::size_t k = 0; k < n; ++k) {
    const auto line = static_cast<std::size_t>(s.first + static_cast<int>(k + n)) % n;
    s.amplitude.push_back(line == 0 ? std::abs(mean) : std::abs(out[line]) / gain);
  }
  return s;
}

std::vector<Tone> tones(const Spectrum& s, int count) {
  std::vector<Tone> found;
  const auto& a = s.amplitude;
  for (std::size_t k = 1; k + 1 < a.size(); ++k) {
    const double left = k > 1 ? a[k - 1] : 0;  // the mean is no tone
    if (!(a[k] > left && a[k] >= a[k + 1])) continue;
    const bool up = a[k + 1] > left;
    const double ratio = (up ? a[k + 1] : left) / a[k];
    const double offset = offset_of(s.window, ratio), amplitude = a[k] / response(s.window, offset);
    found.push_back({(static_cast<double>(k) + (up ? offset : -offset)) * s.resolution, amplitude});
  }
  std::stable_sort(found.begin(), found.end(), [](const Tone& l, const Tone& r) { return l.amplitude > r.amplitude; });
  if (found.size() > static_cast<std::size_t>(count)) found.resize(static_cast<std::size_t>(count));
  return found;
}

}  // namespace whirl::transient
