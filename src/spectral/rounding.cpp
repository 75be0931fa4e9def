#include "spectral/rounding.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace whirl::spectral {

void DensePencil::add(std::complex<double> value, const std::vector<double>& real,
                      const std::vector<double>& imaginary) {
  values_.push_back(value);
  const auto n = static_cast<Eigen::Index>(real.size());
  Eigen::VectorXcd x = Eigen::Map<const Eigen::VectorXd>(real.data(), n).cast<std::complex<double>>();
  if (value.imag() != 0 && imaginary.size() == real.size())
    x += std::complex<double>(0, 1) * Eigen::Map<const Eigen::VectorXd>(imaginary.data(), n);
  vectors_.push_back(std::move(x));
}

std::vector<double> DensePencil::rounding() const {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  std::vector<double> out(values_.size(), 0.0);
  double largest = 0;
  for (const auto& v : values_)
    if (std::isfinite(std::abs(v))) largest = std::max(largest, std::abs(v));
  const auto asked = [&](std::complex<double> v) { return std::abs(v.real()) <= 1e-9 * largest; };
  if (std::none_of(values_.begin(), values_.end(), asked)) return out;
  // With all eigenvectors X the rows of (B X)^-1 are the left ones, scaled so that y* B x = 1. Of an infinite
  // eigenvalue B x is zero, and A x takes its place.
  const Eigen::Index n = a_.rows();
  Eigen::MatrixXcd left;
  if (static_cast<Eigen::Index>(values_.size()) == n) {
    Eigen::MatrixXcd x(n, n);
    for (Eigen::Index k = 0; k < n; ++k) x.col(k) = vectors_[static_cast<std::size_t>(k)];
    Eigen::MatrixXcd images = b_ * x;
    for (Eigen::Index k = 0; k < n; ++k)
      if (!std::isfinite(std::abs(values_[static_cast<std::size_t>(k)]))) images.col(k) = a_ * x.col(k);
    left = images.partialPivLu().inverse();
  }
  for (std::size_t k = 0; k < values_.size(); ++k) {
    if (!asked(values_[k])) continue;
    const double size = a_.norm() + std::abs(values_[k]) * b_.norm(), most = std::sqrt(eps) * size / b_.norm();
    const double first = left.size() > 0
                             ? eps * size * vectors_[k].norm() * left.row(static_cast<Eigen::Index>(k)).norm()
                             : 1e-11 * largest;
    out[k] = std::isfinite(first) ? std::min(first, most) : most;
  }
  return out;
}

}  // namespace whirl::spectral
