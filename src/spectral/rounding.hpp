#pragma once
// How far rounding may move the eigenvalues of a dense pencil.

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace whirl::spectral {

/// The pencil A x = lambda B x with what a solver found of it.
class DensePencil {
public:
  DensePencil(Eigen::MatrixXd a, Eigen::MatrixXd b) : a_(std::move(a)), b_(std::move(b)) {}
  /// The next eigenvalue with real and imaginary part of its right vector (the latter may be empty).
  void add(std::complex<double> value, const std::vector<double>& real, const std::vector<double>& imaginary);

  /// For each eigenvalue added eps (|A| + |lambda| |B|) |x| |y|/|y* B x| with the left vector y, and at most the square
  /// root of eps times |A| + |lambda| |B| over |B|, which is what rounding does to a double eigenvalue with one vector.
  /// Zero for eigenvalues whose real part exceeds 1e-9 of the largest modulus; those it cannot decide.
  /// Source: Stewart and Sun (1990), Matrix Perturbation Theory, sec. VI.2; Frobenius norms.
  [[nodiscard]] std::vector<double> rounding() const;

private:
  Eigen::MatrixXd a_, b_;
  std::vector<std::complex<double>> values_;
  std::vector<Eigen::VectorXcd> vectors_;
};

}  // namespace whirl::spectral
