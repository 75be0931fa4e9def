#pragma once
// Eigenvalues of a linearised system and of dense matrices, by SLEPc.

#include <petscmat.h>

#include <Eigen/Core>
#include <complex>
#include <limits>
#include <vector>

#include "whirl/problem/system.hpp"

namespace whirl::spectral {

using Complex = std::complex<double>;

/// lambda [rad/s] and its right eigenvector, whole on every rank [size of the system], SI, largest entry of the scaled
/// vector one. Of a complex pair only the member with positive imaginary part is kept.
struct Mode {
  Complex lambda;
  std::vector<Complex> shape;
  double rounding = 0;  ///< what rounding may have done to lambda, where its real part is small enough to ask [rad/s]
  std::vector<Complex> left{};  ///< y with y* (dF/dx + lambda dF/dx') = 0, y* (-dF/dx') shape = 1, SI; empty: not known
  /// Of lambda as an eigenvalue of B^-1 A, A = dF/dx, B = -dF/dx': |x| |B* y|/|y* B x| >= 1, 2-norm, states in their
  /// scales (System::scales). A relative change eps of B^-1 A moves lambda by up to condition eps |B^-1 A|. One for a
  /// normal matrix, infinite for a multiple eigenvalue without as many vectors. Not a number: not known.
  double condition = std::numeric_limits<double>::quiet_NaN();
  int multiplicity = 1;  ///< eigenvalues that rounding does not tell from this one, itself included
  int vectors = 1;       ///< independent right vectors that these have
  /// Of one that vibrates: other eigenvalues within this distance may be the same one, parted by rounding [rad/s].
  /// Estimated with EigenOptions::rounding; zero where no other is near, and of modes by transfer functions.
  double blur = 0;

  /// The real part is nothing but rounding: neither growth nor decay can be told.
  [[nodiscard]] bool neutral() const { return std::abs(lambda.real()) <= rounding; }
  /// It has fewer vectors than its multiplicity asks for: no sum of modes describes its motions.
  [[nodiscard]] bool defective() const { return vectors < multiplicity; }
};

/// Solves with the shifted matrix of a large system, for a search by shift and invert. All members are collective.
class ShiftInverse {
public:
  ShiftInverse() = default;
  ShiftInverse(const ShiftInverse&) = delete;
  ShiftInverse& operator=(const ShiftInverse&) = delete;
  virtual ~ShiftInverse() = default;
  /// Takes a new matrix, distributed like the states, rows and columns in the scales of the system.
  virtual void factorise(Mat a) = 0;
  virtual void solve(Vec rhs, Vec x) = 0;
};

struct EigenOptions {
  int count = 40;         ///< eigenvalues wanted (a complex pair counts twice), nearest to `target`
  double target = 0;      ///< real shift of the shift-and-invert transformation [1/s]
  int dense_below = 600;  ///< systems up to this size are solved as dense matrices (LAPACK), with all eigenvalues
  bool shapes = true;
  bool rounding = false;            ///< estimate Mode::rounding
  bool left = false;                ///< left vectors, condition numbers and multiplicities
  ShiftInverse* inverse = nullptr;  ///< of systems above dense_below; null: core::make_direct()
};

/// Modes of dF/dx u + lambda dF/d(dx/dt) u = 0 at the equilibrium x, sorted by ascending |imag|, then real part.
///
/// Small systems: all modes, by LAPACK on rank 0 for all. Larger ones: Krylov-Schur with shift and invert at a real
/// target (prefix modes_); such a search can miss a mode far from the target, so ask for more than are needed. Left
/// vectors come from the inverse of all right ones, of a larger system from a second search with the transposed
/// matrices, which an `inverse` of the caller's cannot serve: they are then not known.
/// Collective; throws core::NotConverged.
[[nodiscard]] std::vector<Mode> modes(problem::System& system, Vec x, const EigenOptions& options);

/// An eigenvalue [1/s] with this rank's rows of its right eigenvector, of length one over all ranks.
struct LocalMode {
  Complex lambda;
  std::vector<Complex> shape;
};

/// All lambda with (a + lambda b) u = 0 within `radius` of the real `target`, both of each complex pair, the nearest
/// first. Up to EigenOptions::dense_below rows by LAPACK, larger ones by Krylov-Schur, which looks on until it has
/// found one beyond the radius. Collective on the matrices' communicator; throws core::NotConverged, also where there
/// are more than 400.
[[nodiscard]] std::vector<LocalMode> modes_within(Mat a, Mat b, double target, double radius);

/// All eigenvalues of a dense matrix, by SLEPc's LAPACK solver, on this rank alone; sorted by falling modulus.
[[nodiscard]] std::vector<Complex> eigenvalues(const Eigen::MatrixXd& matrix);

/// The same of a matrix that every rank of `comm` has, the same on all of them: those that rank 0 finds, since what
/// they decide must not depend on the last digit of a rank's arithmetic. Collective.
[[nodiscard]] std::vector<Complex> eigenvalues(MPI_Comm comm, const Eigen::MatrixXd& matrix);

/// Eigenvalues and right eigenvectors (columns of length one) of a small dense matrix, in no order, on this rank alone.
struct Eigenpairs {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;

  /// The eigenvector whose eigenvalue is nearest to `value`.
  [[nodiscard]] Eigen::VectorXcd nearest(Complex value) const;
};

/// Throws core::NotConverged, also where the matrix is not finite.
[[nodiscard]] Eigenpairs eigenpairs(const Eigen::MatrixXd& matrix);

}  // namespace whirl::spectral
