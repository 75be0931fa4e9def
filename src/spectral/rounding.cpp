#include "spectral/rounding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "whirl/core/dense_lu.hpp"
#include "whirl/spectral/dense.hpp"

namespace whirl::spectral {
namespace {

// Eigenvalues nearer than this part of themselves are looked at: may they be one, parted by rounding?
constexpr double nearest_part = 1e-5;
// The matrices themselves are rounded, in their assembly and, of a reduced machine, in its projection, which products
// of theirs do not show: a real part below this part of the eigenvalue has no sign.
constexpr double without_sign = 1e-12;

// |A| |x| of all vectors x: the size of the sums that A x is made of.
Eigen::MatrixXd sums(const Eigen::MatrixXd& a, const std::vector<Eigen::VectorXcd>& vectors) {
  Eigen::MatrixXd sizes(a.rows(), static_cast<Eigen::Index>(vectors.size()));
  for (std::size_t k = 0; k < vectors.size(); ++k) sizes.col(static_cast<Eigen::Index>(k)) = vectors[k].cwiseAbs();
  return a.cwiseAbs() * sizes;
}

// A x of all vectors x, by two products of real matrices: Eigen multiplies a real matrix and a complex one entry by
// entry.
Eigen::MatrixXcd images(const Eigen::MatrixXd& a, const std::vector<Eigen::VectorXcd>& vectors) {
  const auto count = static_cast<Eigen::Index>(vectors.size());
  Eigen::MatrixXd real(a.rows(), count), imaginary(a.rows(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    real.col(k) = vectors[static_cast<std::size_t>(k)].real();
    imaginary.col(k) = vectors[static_cast<std::size_t>(k)].imag();
  }
  Eigen::MatrixXcd out(a.rows(), count);
  out.real() = a * real;
  out.imag() = a * imaginary;
  return out;
}

}  // namespace

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
  Eigen::MatrixXcd of_b = images(b_, vectors_);
  for (Eigen::Index k = 0; k < n; ++k)
    if (const auto i = static_cast<std::size_t>(k); !std::isfinite(std::abs(values_[i])))
      of_b.col(k) = a_ * vectors_[i];
  return core::DenseLu<Complex>(of_b).inverse();
}

double DensePencil::newton_step(std::size_t k) const {
  const Eigen::Index n = a_.rows();
  const std::complex<double> v = values_[k];
  const Eigen::VectorXcd& x = vectors_[k];
  Eigen::Index largest = 0;
  (void)x.cwiseAbs().maxCoeff(&largest);
  Eigen::MatrixXcd step = Eigen::MatrixXcd::Zero(n + 1, n + 1);
  step.topLeftCorner(n, n) = a_ - v * b_;
  step.topRightCorner(n, 1) = -(b_ * x);
  step(n, largest) = 1;
  Eigen::VectorXcd right(n + 1);
  right << v * (b_ * x) - a_ * x, 0;
  // Rows of one size, so that pivots and errors of each row count alike.
  const Eigen::VectorXd size = a_.cwiseAbs().rowwise().sum() + std::abs(v) * b_.cwiseAbs().rowwise().sum();
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!(size(i) > 0)) continue;
    step.row(i) /= size(i);
    right(i) /= size(i);
  }
  const double moved = std::abs(core::DenseLu<Complex>(step).solve(right)(n));
  return std::isfinite(moved) ? moved : std::abs(v);
}

std::vector<bool> DensePencil::near_another(const std::vector<std::complex<double>>& values) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (values[k].imag() != 0 && std::isfinite(std::abs(values[k]))) order.push_back(k);
  std::ranges::sort(order, {}, [&](std::size_t k) { return values[k].imag(); });
  std::vector<bool> out(values.size(), false);
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const std::complex<double> a = values[order[i]], b = values[order[j]];
      const double reach = nearest_part * std::min(std::abs(a), std::abs(b));
      if (b.imag() - a.imag() > reach) break;
      if (std::abs(a - b) <= reach) out[order[i]] = out[order[j]] = true;
    }
  return out;
}

DensePencil::Doubt DensePencil::doubt() const {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  const std::vector<bool> near = near_another(values_);
  Doubt doubt{std::vector<double>(values_.size(), 0.0), std::vector<double>(values_.size(), 0.0)};
  std::vector<double>& out = doubt.rounding;
  double largest = 0;
  for (const auto& v : values_)
    if (std::isfinite(std::abs(v))) largest = std::max(largest, std::abs(v));
  const auto asked = [&](std::complex<double> v) { return std::abs(v.real()) <= asked_below * largest; };
  const bool any = std::ranges::any_of(values_, asked) || std::ranges::find(near, true) != near.end();
  const Eigen::MatrixXcd left = any ? this->left() : Eigen::MatrixXcd();
  const Eigen::MatrixXcd of_a = any ? images(a_, vectors_) : left, of_b = any ? images(b_, vectors_) : left;
  const Eigen::MatrixXd sums_a = any ? sums(a_, vectors_) : Eigen::MatrixXd(),
                        sums_b = any ? sums(b_, vectors_) : Eigen::MatrixXd();
  const double size_a = a_.norm(), size_b = b_.norm();
  constexpr double safety = 10;
  for (std::size_t k = 0; k < values_.size(); ++k) {
    if (!asked(values_[k]) && !near[k]) continue;
    const auto column = static_cast<Eigen::Index>(k);
    const double size = size_a + std::abs(values_[k]) * size_b, most = std::sqrt(eps) * size / size_b;
    const double left_over = (of_a.col(column) - values_[k] * of_b.col(column)).norm();
    const double first =
        left.size() > 0 ? (eps * size * vectors_[k].norm() + left_over) * left.row(column).norm() : 1e-11 * largest;
    const double moved = std::isfinite(first) ? std::min(first, most) : most;
    if (asked(values_[k])) out[k] = moved;
    // Rows of very different size make that bound far too large. What the eigenvalue moves by to first order, y^T (A -
    // lambda B) x with y^T B x = 1 (Stewart and Sun 1990, Matrix Perturbation Theory, ch. VI), has errors of each row
    // by itself.
    double by_rows = moved;
    if (left.size() > 0) {
      const double step = std::abs((left.row(column) * (of_a.col(column) - values_[k] * of_b.col(column)))(0)),
                   blur = eps * left.row(column).cwiseAbs().dot(
                                    (sums_a.col(column) + std::abs(values_[k]) * sums_b.col(column)).transpose());
      if (std::isfinite(step + blur)) by_rows = std::min(moved, safety * (step + blur));
    }
    if (asked(values_[k]) && !near[k]) out[k] = std::max(by_rows, without_sign * std::abs(values_[k]));
    // Of a double eigenvalue each of the two is moved to first order by what parts them.
    if (near[k]) doubt.blur[k] = std::min(by_rows, nearest_part * std::abs(values_[k]));
  }
  // The QZ algorithm is backward stable for the norm of the pencil, not row by row: with stiff springs on light masses
  // it returns growing eigenvalues that a step of Newton's method moves by about as much as they grow. Their sign means
  // nothing: a step of a tenth of the real part is asked for.
  for (std::size_t k = 0; k < values_.size(); ++k)
    if (values_[k].real() > out[k] && std::isfinite(std::abs(values_[k])))
      out[k] = std::max(out[k], std::min(safety * newton_step(k), std::abs(values_[k])));
  return doubt;
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
    const Eigen::VectorXd sizes = singular_values(std::move(x));
    out.vectors[k] = static_cast<int>((sizes.array() > 1e-3 * sizes(0)).count());
  }
  return out;
}

}  // namespace whirl::spectral
