#pragma once
// Parts at a complex frequency whose own inverses are approximate.

#include <Eigen/Core>
#include <complex>
#include <memory>

#include "solve/newton/port_matrix.hpp"
#include "whirl/core/gate.hpp"
#include "whirl/problem/part_inverse.hpp"
#include "whirl/problem/system.hpp"

namespace whirl::solve {

/// A^-1 of A = a + lambda b, a = dF/dx and b = dF/d(dx/dt) of all parts, lambda = s + i w, by FGMRES on the real form
///
///     [ a + s b   -w b    ] [ Re y ]   [ Re r ]
///     [ w b       a + s b ] [ Im y ] = [ Im r ]
///
/// Both halves are preconditioned by the approximate inverse of a + |lambda| b. Where b^-1 a has positive eigenvalues
/// and that inverse is good, (a + i w b) (a + w b)^-1 has its eigenvalues on the arc (a + i w) / (a + w) between 1 and
/// i, so that the number of iterations depends neither on the mesh nor on the frequency.
/// The matrices are stored by pieces of diagonals, spread like the parts; nothing is assembled or factorised.
/// KSP with prefix "frequency_", by default to the relative residual 1e-12 in at most 300 iterations. Collective.
class FrequencyInverse {
public:
  /// `approximate`: of the parts of a system on `comm`.
  FrequencyInverse(MPI_Comm comm, std::unique_ptr<problem::PartInverse> approximate);
  FrequencyInverse(const FrequencyInverse&) = delete;
  FrequencyInverse& operator=(const FrequencyInverse&) = delete;

  /// For a and b, scaled, at this point; both outlive its use. Throws core::DomainError as PartInverse::set().
  void set_at(const PortMatrix& a, const PortMatrix& b, const problem::Point& at, std::complex<double> lambda);
  /// y = A^-1 r: this rank's rows of all parts [rows x columns]. Throws core::NotConverged, on all ranks, if the
  /// iterations do not come to the tolerance.
  void apply_at(const std::complex<double>* r, std::complex<double>* y, std::ptrdiff_t rows, int columns);

private:
  void multiply(Vec x, Vec y);

  std::unique_ptr<problem::PartInverse> approximate_;
  std::complex<double> lambda_;
  const PortMatrix *a_ = nullptr, *b_ = nullptr;
  Eigen::VectorXd by_a_, by_b_;  // work space
  core::Gate gate_;
  core::Matrix shell_;
  core::Vector right_, answer_;  // in real form: all real parts of a rank, then all imaginary ones
  core::LinearSolver ksp_;
};

}  // namespace whirl::solve
