#include "solve/newton/rational_fit.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/spectral/dense.hpp"

namespace whirl::solve {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;

namespace {

// A sample, or its conjugate at a point below the real axis.
VectorXcd sample_at(const MatrixXcd& values, int sample, Complex at) {
  return at.imag() < 0 ? VectorXcd(values.col(sample).conjugate()) : VectorXcd(values.col(sample));
}

// The entries enter the choice of weights through so many combinations of them.
constexpr Index combinations = 12;

}  // namespace

RationalFit::RationalFit(std::vector<Complex> points, MatrixXcd values, double tolerance)
    : points_(std::move(points)), values_(std::move(values)) {
  magnitude_ = values_.colwise().norm().maxCoeff();
  MatrixXcd sketch = values_;
  if (values_.rows() > combinations) {
    Eigen::MatrixXd mix(combinations, values_.rows());
    for (Index i = 0; i < mix.size(); ++i) mix.data()[i] = std::cos(1.3 * static_cast<double>(i * i) + 0.4);
    sketch = mix.cast<Complex>() * values_;
  }
  const double size = std::max(sketch.colwise().norm().maxCoeff(), 1e-300);
  const VectorXcd mean = sketch.rowwise().mean();
  const auto n = static_cast<int>(points_.size());
  VectorXcd term;
  // With more supports than other samples the weights would be free.
  while (2 * (static_cast<int>(supports_.size()) + 1) <= n + 1) {
    int worst = -1;
    double most = 0;
    for (int i = 0; i < n; ++i) {
      if (std::find(supports_.begin(), supports_.end(), i) != supports_.end()) continue;
      VectorXcd fit = mean;
      if (!supports_.empty()) {
        fit.setZero();
        Complex sum = 0;
        for (std::size_t k = 0; k < at_.size(); ++k) {
          const Complex w = weights_[k] / (points_[static_cast<std::size_t>(i)] - at_[k]);
          sum += w;
          fit += w * sample_at(sketch, sample_[k], at_[k]);
        }
        fit /= sum;
      }
      const double error = (fit - sketch.col(i)).norm();
      if (error > most || worst < 0) most = error, worst = i;
    }
    if (!supports_.empty() && most <= tolerance * size) return;
    supports_.push_back(worst);
    weigh(sketch);
  }
}

// The weights are the right singular vector of the least singular value of (f_i - f_j)/(lambda_i - lambda_j).
void RationalFit::weigh(const MatrixXcd& sketch) {
  at_.clear();
  sample_.clear();
  for (const int s : supports_) {
    const Complex point = points_[static_cast<std::size_t>(s)];
    at_.push_back(point);
    sample_.push_back(s);
    if (point.imag() == 0) continue;
    at_.push_back(std::conj(point));
    sample_.push_back(s);
  }
  const auto columns = static_cast<Index>(at_.size());
  std::vector<Complex> rows;
  std::vector<int> of_row;
  for (int i = 0; i < static_cast<int>(points_.size()); ++i) {
    if (std::find(supports_.begin(), supports_.end(), i) != supports_.end()) continue;
    rows.push_back(points_[static_cast<std::size_t>(i)]);
    of_row.push_back(i);
    if (rows.back().imag() == 0) continue;
    rows.push_back(std::conj(rows.back()));
    of_row.push_back(i);
  }
  const Index m = sketch.rows();
  MatrixXcd loewner(m * static_cast<Index>(rows.size()), columns);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (Index c = 0; c < columns; ++c) {
      const Complex at = at_[static_cast<std::size_t>(c)];
      loewner.block(static_cast<Index>(i) * m, c, m, 1) =
          (sample_at(sketch, of_row[i], rows[i]) - sample_at(sketch, sample_[static_cast<std::size_t>(c)], at)) /
          (rows[i] - at);
    }
  // Columns of one length: those of a support beside another sample are long.
  const Eigen::VectorXd lengths = loewner.colwise().norm().transpose().cwiseMax(1e-300);
  loewner = loewner * lengths.cwiseInverse().cast<Complex>().asDiagonal();
  VectorXcd w = spectral::least_direction(std::move(loewner));
  w.array() /= lengths.array();
  weights_.assign(w.begin(), w.end());
}

VectorXcd RationalFit::value(Complex lambda) const {
  VectorXcd sum = VectorXcd::Zero(values_.rows());
  Complex weight = 0;
  for (std::size_t k = 0; k < at_.size(); ++k) {
    const auto f = values_.col(sample_[k]);
    if (lambda == at_[k]) return sample_at(values_, sample_[k], at_[k]);
    const Complex w = weights_[k] / (lambda - at_[k]);
    weight += w;
    if (at_[k].imag() < 0)
      sum += w * f.conjugate();
    else
      sum += w * f;
  }
  return sum / weight;
}

// f' = sum w_j [f(lambda), lambda_j]/(lambda - lambda_j) / sum w_j/(lambda - lambda_j) with divided differences [., .].
VectorXcd RationalFit::slope(Complex lambda) const {
  for (const Complex& at : at_)
    if (lambda == at) lambda += 1e-7 * (1 + std::abs(at));
  const VectorXcd here = value(lambda);
  VectorXcd sum = VectorXcd::Zero(values_.rows());
  Complex weight = 0;
  for (std::size_t k = 0; k < at_.size(); ++k) {
    const VectorXcd f = sample_at(values_, sample_[k], at_[k]);
    const Complex w = weights_[k] / (lambda - at_[k]);
    weight += w;
    sum += w * (here - f) / (lambda - at_[k]);
  }
  return sum / weight;
}

}  // namespace whirl::solve
