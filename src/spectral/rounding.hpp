#pragma once
// Left vectors of a dense pencil: condition numbers, and how far rounding may move its eigenvalues.

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace whirl::spectral {

/// The pencil A x = lambda B x with what a solver found of it.
class DensePencil {
public:
  /// Which of these vibrate and have another one within 1e-5 of their size.
  [[nodiscard]] static std::vector<bool> near_another(const std::vector<std::complex<double>>& values);
  /// Rounding is estimated for eigenvalues whose real part is below this part of the largest modulus.
  static constexpr double asked_below = 1e-7;
  DensePencil(Eigen::MatrixXd a, Eigen::MatrixXd b) : a_(std::move(a)), b_(std::move(b)) {}
  /// The next eigenvalue with real and imaginary part of its right vector (the latter may be empty).
  void add(std::complex<double> value, const std::vector<double>& real, const std::vector<double>& imaginary);

  /// For each eigenvalue added (eps (|A| + |lambda| |B|) |x| + |A x - lambda B x|) |y|/|y* B x| with the left vector y:
  /// what rounding may have done, and what the solver has left. At most the square root of eps times |A| + |lambda| |B|
  /// over |B|, which is what rounding does to a double eigenvalue with one vector. Zero for eigenvalues whose real part
  /// exceeds asked_below of the largest modulus; those it cannot decide. At least 1e-12 |lambda|: the matrices are
  /// rounded too. Of one that grows at least ten times what a step of Newton's method moves it by. Source: Stewart and
  /// Sun (1990), Matrix Perturbation Theory, sec. VI.2; Frobenius norms.
  ///
  /// `blur` for eigenvalues that vibrate and have another one within 1e-5 of their size, whatever their real parts: by
  /// as much rounding may part a double one. It is ten times |y* (A x - lambda B x)| + eps |y| (|A| + |lambda| |B|)
  /// |x|, row by row, and at most the bound above. Zero for all others.
  struct Doubt {
    std::vector<double> rounding, blur;
  };
  [[nodiscard]] Doubt doubt() const;

  /// What Mode tells of the same name, for each eigenvalue added.
  struct Conditioning {
    std::vector<double> condition;
    std::vector<int> multiplicity, vectors;
    Eigen::MatrixXcd left;  ///< rows y* with y* B x = 1; empty if not all eigenvalues were added
  };
  /// An eigenvalue is multiple where another one lies within sqrt(eps) of the largest, as far as rounding parts a
  /// double one with one vector. Vectors of length one count as dependent below 1e-3 of their largest singular value:
  /// those of a double eigenvalue that rounding parts differ by that part over the scale of the rates. Source:
  /// Wilkinson (1965), The Algebraic Eigenvalue Problem, ch. 2.
  [[nodiscard]] Conditioning conditioning() const;

private:
  /// With all eigenvectors X the rows of (B X)^-1 are the left ones, scaled so that y* B x = 1. Of an infinite
  /// eigenvalue B x is zero, and A x takes its place. Empty if not all eigenvalues were added.
  [[nodiscard]] Eigen::MatrixXcd left() const;
  /// How far a step of Newton's method for (lambda, x), with rows of one size, moves eigenvalue k. Source: Tisseur
  /// (2001), SIAM J. Matrix Anal. Appl. 22, 1038.
  [[nodiscard]] double newton_step(std::size_t k) const;
  Eigen::MatrixXd a_, b_;
  std::vector<std::complex<double>> values_;
  std::vector<Eigen::VectorXcd> vectors_;
};

}  // namespace whirl::spectral
