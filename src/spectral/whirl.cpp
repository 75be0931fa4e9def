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
    case Sense::either:
      return "either";
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

bool turns_backward(const std::vector<std::complex<double>>& shape) {
  constexpr double rounding = 1e-5;  // a forward circle of this part of the backward one
  const auto middle = shape.begin() + static_cast<std::ptrdiff_t>(shape.size() / 2);
  return !shape.empty() &&
         whirl_energy({shape.begin(), middle}, {middle, shape.end()}).forward < 2 * rounding * rounding - 1;
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

std::optional<std::array<Combination, 2>> extremes_of_whirl(const std::vector<std::complex<double>>& a,
                                                            const std::vector<std::complex<double>>& b,
                                                            const std::vector<double>& mass) {
  using Complex = std::complex<double>;
  constexpr double dependent = 1e-6;  // square of the sine of the angle between the shapes
  const std::size_t n = a.size() / 2;
  const std::array<const std::vector<Complex>*, 2> shapes{&a, &b};
  std::array<std::array<Complex, 2>, 2> w{}, e{};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      for (std::size_t k = 0; k < n; ++k) {
        const double m = mass.empty() ? 1.0 : mass[k];
        const Complex x = std::conj((*shapes[i])[k]), y = std::conj((*shapes[i])[n + k]);
        e[i][j] += m * (x * (*shapes[j])[k] + y * (*shapes[j])[n + k]) / 2.0;
        w[i][j] += m * (y * (*shapes[j])[k] - x * (*shapes[j])[n + k]) / Complex(0, 2);
      }
  const double e0 = e[0][0].real(), e1 = e[1][1].real(), w0 = w[0][0].real(), w1 = w[1][1].real();
  const double area = e0 * e1 - std::norm(e[0][1]);
  if (!(area > dependent * e0 * e1)) return std::nullopt;
  const double half = (w0 * e1 + w1 * e0) / 2 - (w[0][1] * std::conj(e[0][1])).real();
  const double root = std::sqrt(std::max(half * half - area * (w0 * w1 - std::norm(w[0][1])), 0.0));
  std::array<Combination, 2> out{{{1, 0}, {0, 1}}};
  if (root <= 1e-12 * area) return out;  // all turn alike
  for (std::size_t k = 0; k < 2; ++k) {
    const double t = (half + (k == 0 ? -root : root)) / area;
    const Complex across = w[0][1] - t * e[0][1];
    const double first = w0 - t * e0, second = w1 - t * e1;
    // The longer one of the two rows decides.
    out[k] = std::abs(first) > std::abs(second) ? Combination{-across, first} : Combination{second, -std::conj(across)};
  }
  return out;
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
