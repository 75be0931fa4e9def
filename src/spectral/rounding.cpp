#include "spectral/rounding.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
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

Eigen::MatrixXcd DensePencil::left() const {
  const Eigen::Index n = a_.rows();
  if (static_cast<Eigen::Index>(values_.size()) != n) return {};
  Eigen::MatrixXcd x(n, n);
  for (Eigen::Index k = 0; k < n; ++k) x.col(k) = vectors_[static_cast<std::size_t>(k)];
  Eigen::MatrixXcd images = b_ * x;
  for (Eigen::Index k = 0; k < n; ++k)
    if (!std::isfinite(std::abs(values_[static_cast<std::size_t>(k)]))) images.col(k) = a_ * x.col(k);
  return images.partialPivLu().inverse();
}

std::vector<double> DensePencil::rounding() const {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  std::vector<double> out(values_.size(), 0.0);
  double largest = 0;
  for (const auto& v : values_)
    if (std::isfinite(std::abs(v))) largest = std::max(largest, std::abs(v));
  const auto asked = [&](std::complex<double> v) { return std::abs(v.real()) <= asked_below * largest; };
  const bool any = std::any_of(values_.begin(), values_.end(), asked);
  const Eigen::MatrixXcd left = any ? this->left() : Eigen::MatrixXcd();
  for (std::size_t k = 0; k < values_.size(); ++k) {
    if (!asked(values_[k])) continue;
    const double size = a_.norm() + std::abs(values_[k]) * b_.norm(), most = std::sqrt(eps) * size / b_.norm();
    const double left_over = (a_ * vectors_[k] - values_[k] * (b_ * vectors_[k])).norm();
    const double first =
        left.size() > 0 ? (eps * size * vectors_[k].norm() + left_over) * left.row(static_cast<Eigen::Index>(k)).norm()
                        : 1e-11 * largest;
    out[k] = std::isfinite(first) ? std::min(first, most) : most;
  }
  // A growing eigenvalue must solve each row. The QZ algorithm is backward stable for the norm of the pencil, not row
  // by row: with stiff springs on light masses it returns eigenvalues whose rows do not agree in the first digit. Their
  // sign means nothing. Componentwise backward error: Oettli and Prager (1964), Numerische Mathematik 6, 405.
  constexpr double meaningless = 0.1;
  for (std::size_t k = 0; k < values_.size(); ++k) {
    const std::complex<double> v = values_[k];
    if (!(v.real() > out[k]) || !std::isfinite(std::abs(v))) continue;
    const Eigen::VectorXd size =
        a_.cwiseAbs() * vectors_[k].cwiseAbs() + std::abs(v) * (b_.cwiseAbs() * vectors_[k].cwiseAbs());
    const Eigen::VectorXd left_over = (a_ * vectors_[k] - v * (b_ * vectors_[k])).cwiseAbs();
    if ((left_over.array() > meaningless * size.array()).any()) out[k] = std::abs(v);
  }
  return out;
}

DensePencil::Conditioning DensePencil::conditioning() const {
  const std::size_t n = values_.size();
  Conditioning out{std::vector<double>(n, std::numeric_limits<double>::quiet_NaN()), std::vector<int>(n, 1),
                   std::vector<int>(n, 1), left()};
  // Of what vibrates: how fast the overdamped decay says nothing of slow motions.
  double largest = 0;
  for (const auto& v : values_)
    if (std::isfinite(std::abs(v))) largest = std::max(largest, std::abs(v.imag()));
  const double reach = std::sqrt(std::numeric_limits<double>::epsilon()) * largest;
  for (std::size_t k = 0; k < n; ++k) {
    if (!std::isfinite(std::abs(values_[k]))) continue;
    if (out.left.size() > 0) {
      const double c = vectors_[k].norm() * (out.left.row(static_cast<Eigen::Index>(k)) * b_).norm();
      out.condition[k] = std::isfinite(c) ? c : std::numeric_limits<double>::infinity();
    }
    std::vector<std::size_t> alike;
    for (std::size_t i = 0; i < n; ++i)
      if (std::isfinite(std::abs(values_[i])) && std::abs(values_[i] - values_[k]) <= reach) alike.push_back(i);
    out.multiplicity[k] = static_cast<int>(alike.size());
    if (alike.size() == 1) continue;
    Eigen::MatrixXcd x(a_.rows(), static_cast<Eigen::Index>(alike.size()));
    for (std::size_t i = 0; i < alike.size(); ++i)
      x.col(static_cast<Eigen::Index>(i)) = vectors_[alike[i]].normalized();
    const Eigen::VectorXd sizes = Eigen::JacobiSVD<Eigen::MatrixXcd>(x).singularValues();
    out.vectors[k] = static_cast<int>((sizes.array() > 1e-3 * sizes(0)).count());
  }
  return out;
}

}  // namespace whirl::spectral
