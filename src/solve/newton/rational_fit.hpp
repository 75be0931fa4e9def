#pragma once
// A rational function through samples of a vector function.

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace whirl::solve {

/// Rational fit of f(lambda) [entries] with f(conj(lambda)) = conj(f(lambda)), in barycentric form with common weights,
///
///     f(lambda) = sum_j w_j f_j/(lambda - lambda_j) / sum_j w_j/(lambda - lambda_j)
///
/// The support points lambda_j are samples, chosen one by one where the fit is worst, each with its conjugate; the
/// weights make the linearised error at the other samples least. Deterministic. Source: Nakatsukasa, Sete and Trefethen
/// (2018), AAA; Lietaert et al. (2022) for common weights.
class RationalFit {
public:
  /// `points` in the closed upper half plane, `values` [entries x points]. The error is relative to the largest norm of
  /// a sample. At least two points.
  RationalFit(std::vector<std::complex<double>> points, Eigen::MatrixXcd values, double tolerance);
  /// The fit, or its derivative.
  [[nodiscard]] Eigen::VectorXcd value(std::complex<double> lambda) const;
  [[nodiscard]] Eigen::VectorXcd slope(std::complex<double> lambda) const;
  /// Largest norm of a sample.
  [[nodiscard]] double magnitude() const { return magnitude_; }

private:
  void weigh(const Eigen::MatrixXcd& sketch);
  std::vector<std::complex<double>> points_;
  Eigen::MatrixXcd values_;
  std::vector<int> supports_;  // among the points
  std::vector<std::complex<double>> at_, weights_;
  std::vector<int> sample_;  // of a term; the value is the conjugate one where at_ lies in the lower half plane
  double magnitude_ = 0;
};

}  // namespace whirl::solve
