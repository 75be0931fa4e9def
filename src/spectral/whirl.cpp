#include "whirl/spectral/whirl.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace whirl::spectral {

const char* name_of(Sense sense) {
  switch (sense) {
    case Sense::forward:
      return "forward";
    case Sense::backward:
      return "backward";
    default:
      return "mixed";
  }
}

Sense sense_of_whirl(const std::vector<std::complex<double>>& x, const std::vector<std::complex<double>>& y) {
  const std::complex<double> i(0, 1);
  double largest = 0;
  for (std::size_t k = 0; k < x.size(); ++k) largest = std::max(largest, std::norm(x[k]) + std::norm(y[k]));
  bool forward = false, backward = false;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (std::norm(x[k]) + std::norm(y[k]) < largest / 400) continue;
    // z = x + i y = f exp(i w t) + conj(g) exp(-i w t) with f = (x + i y)/2, g = (x - i y)/2.
    (std::abs(x[k] + i * y[k]) >= std::abs(x[k] - i * y[k]) ? forward : backward) = true;
  }
  return forward && backward ? Sense::mixed : backward ? Sense::backward : Sense::forward;
}

double log_decrement(std::complex<double> lambda) {
  if (lambda.imag() == 0)
    return lambda.real() < 0 ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
  return -2 * std::numbers::pi * lambda.real() / std::abs(lambda.imag());
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
