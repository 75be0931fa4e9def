#include "whirl/spectral/whirl.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace whirl::spectral {

namespace {

constexpr double planar_below = 0.1, clear_share = 0.9;
constexpr double still = 1e-6;

}  // namespace

const char* name_of(Sense sense) {
  switch (sense) {
    case Sense::planar:
      return "planar";
    case Sense::forward:
      return "forward";
    case Sense::backward:
      return "backward";
    default:
      return "mixed";
  }
}

WhirlEnergy whirl_energy(const std::vector<std::complex<double>>& x, const std::vector<std::complex<double>>& y,
                         const std::vector<double>& mass) {
  WhirlEnergy out;
  double total = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double m = mass.empty() ? 1.0 : mass[k];
    // |f|^2 - |b|^2 = Im(conj(y) x), |f|^2 + |b|^2 = (|x|^2 + |y|^2)/2.
    const double turning = m * (std::conj(y[k]) * x[k]).imag();
    total += m * (std::norm(x[k]) + std::norm(y[k])) / 2;
    out.whirl += std::abs(turning);
    out.forward += turning;
  }
  if (total > 0) {
    out.whirl /= total;
    out.forward /= total;
  }
  return out;
}

Sense sense_of_whirl(const WhirlEnergy& energy) {
  if (energy.whirl < planar_below) return Sense::planar;
  const double share = (energy.whirl + energy.forward) / (2 * energy.whirl);
  return share >= clear_share ? Sense::forward : share <= 1 - clear_share ? Sense::backward : Sense::mixed;
}

Sense sense_of_whirl(const std::vector<std::complex<double>>& x, const std::vector<std::complex<double>>& y,
                     const std::vector<double>& mass) {
  return sense_of_whirl(whirl_energy(x, y, mass));
}

std::vector<double> turning(const std::vector<std::complex<double>>& x, const std::vector<std::complex<double>>& y) {
  double most = 0;
  for (std::size_t k = 0; k < x.size(); ++k) most = std::max(most, std::norm(x[k]) + std::norm(y[k]));
  std::vector<double> out;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double size = std::norm(x[k]) + std::norm(y[k]);
    out.push_back(size > still * still * most ? 2 * (std::conj(y[k]) * x[k]).imag() / size : 0.0);
  }
  return out;
}

Sense sense_by_nodes(const std::vector<double>& turning) {
  const bool forward = std::any_of(turning.begin(), turning.end(), [](double t) { return t > straight; });
  const bool backward = std::any_of(turning.begin(), turning.end(), [](double t) { return t < -straight; });
  if (forward && backward) return Sense::mixed;
  return forward ? Sense::forward : backward ? Sense::backward : Sense::planar;
}

bool vibrates(std::complex<double> lambda) {
  return std::abs(lambda.imag()) > 1e-7 * std::abs(lambda);
}

double damping_ratio(std::complex<double> lambda) {
  const double size = std::abs(lambda);
  return size > 0 ? -lambda.real() / size + 0.0 : 0;
}

double log_decrement(std::complex<double> lambda) {
  if (lambda.imag() == 0)
    return lambda.real() < 0 ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
  return -2 * std::numbers::pi * lambda.real() / std::abs(lambda.imag()) + 0.0;  // no negative zero
}

double stability_factor(std::complex<double> lambda) {
  return std::pow(10.0, -log_decrement(lambda));
}

double mac(const std::vector<std::complex<double>>& a, const std::vector<std::complex<double>>& b) {
  std::complex<double> ab = 0;
  double aa = 0, bb = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    ab += std::conj(a[k]) * b[k];
    aa += std::norm(a[k]);
    bb += std::norm(b[k]);
  }
  return aa > 0 && bb > 0 ? std::norm(ab) / (aa * bb) : 0;
}

}  // namespace whirl::spectral
