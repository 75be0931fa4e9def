#include "whirl/transient/spectrum.hpp"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>

#include "whirl/core/error.hpp"

namespace whirl::transient {

Spectrum amplitude_spectrum(std::span<const double> samples, double interval, Window window) {
  const std::size_t n = samples.size();
  core::require(n >= 2, "a spectrum needs samples");
  double mean = 0;
  for (const double s : samples) mean += s / static_cast<double>(n);
  std::vector<double> in(n);
  double gain = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double phase = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
    const double w = window == Window::hann ? (1 - std::cos(phase)) / 2 : 1;
    in[k] = w * (samples[k] - mean);
    gain += w;
  }
  std::vector<std::complex<double>> out(n / 2 + 1);
  const std::unique_ptr<std::remove_pointer_t<fftw_plan>, decltype(&fftw_destroy_plan)> plan(
      fftw_plan_dft_r2c_1d(static_cast<int>(n), in.data(), reinterpret_cast<fftw_complex*>(out.data()), FFTW_ESTIMATE),
      &fftw_destroy_plan);
  core::require(plan != nullptr, "FFTW makes a plan for every length");
  fftw_execute(plan.get());
  Spectrum s{1 / (static_cast<double>(n) * interval), {}, window};
  for (std::size_t k = 0; k < out.size(); ++k) {
    const bool once = k == 0 || 2 * k == n;  // the mean and the highest line of an even record have no mirror image
    s.amplitude.push_back((once ? 1 : 2) * std::abs(out[k]) / gain);
  }
  s.amplitude[0] = std::abs(mean);
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
    const double offset = s.window == Window::hann ? std::max(0.0, (2 * ratio - 1) / (1 + ratio)) : ratio / (1 + ratio);
    const double x = std::numbers::pi * offset;
    double amplitude = a[k] * (x > 1e-8 ? x / std::sin(x) : 1);
    if (s.window == Window::hann) amplitude *= 1 - offset * offset;
    found.push_back({(static_cast<double>(k) + (up ? offset : -offset)) * s.resolution, amplitude});
  }
  std::stable_sort(found.begin(), found.end(), [](const Tone& l, const Tone& r) { return l.amplitude > r.amplitude; });
  if (found.size() > static_cast<std::size_t>(count)) found.resize(static_cast<std::size_t>(count));
  return found;
}

}  // namespace whirl::transient
