#include "transient/steps/butterworth.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace whirl::transient {

using std::numbers::pi;

ButterworthLowPass::ButterworthLowPass(double cutoff) {
  const double k = std::tan(pi * cutoff);
  for (std::size_t i = 0; i < 2; ++i) {
    // 1/(s^2 + s/q + 1) with its pair of poles at the angles pi/8 and 3 pi/8 off the imaginary axis.
    const double by_q = 2 * std::sin(pi * (2 * static_cast<double>(i) + 1) / 8);
    const double norm = 1 / (1 + by_q * k + k * k);
    sections_[i] = {k * k * norm, 2 * (k * k - 1) * norm, (1 - by_q * k + k * k) * norm};
  }
}

double ButterworthLowPass::next(double input) {
  double value = input;
  for (Section& s : sections_) {
    const double out = s.gain * (value + 2 * s.x[0] + s.x[1]) - s.a1 * s.y[0] - s.a2 * s.y[1];
    s.x = {value, s.x[0]};
    s.y = {out, s.y[0]};
    value = out;
  }
  return value;
}

double ButterworthLowPass::power_gain(double frequency) const {
  const std::complex<double> z = std::polar(1.0, -2 * pi * frequency);
  double power = 1;
  for (const Section& s : sections_)
    power *= std::norm(s.gain * (1.0 + z) * (1.0 + z) / (1.0 + s.a1 * z + s.a2 * z * z));
  return power;
}

// The sum of the squares of its answer to one pulse, which dies out within some tens of samples per cut-off period.
double ButterworthLowPass::noise_gain() const {
  ButterworthLowPass copy = *this;
  for (Section& s : copy.sections_) s.x = s.y = {};
  double sum = 0, largest = 0;
  for (int k = 0;; ++k) {
    const double y = copy.next(k == 0 ? 1 : 0);
    sum += y * y;
    largest = std::max(largest, std::abs(y));
    if (k > 1000 && std::abs(y) < 1e-15 * largest) break;
  }
  return std::sqrt(sum);
}

}  // namespace whirl::transient
