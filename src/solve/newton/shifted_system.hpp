#pragma once
// dF/dx + i omega dF/d(dx/dt), bordered, as a real matrix of twice the size.

#include <complex>
#include <vector>

#include "whirl/core/petsc.hpp"
#include "whirl/problem/system.hpp"

namespace whirl::solve {

using ComplexVector = std::vector<std::complex<double>>;

/// [A b; c^* 0] with A = dF/dx + i omega dF/d(dx/dt), scaled, at a resting state; by MUMPS. Vectors are whole on every
/// rank [n]. Collective on the system's communicator.
class ShiftedSystem {
public:
  explicit ShiftedSystem(problem::System& system);

  /// Takes the derivatives at x (SI), dx/dt = 0, and the system's parameter.
  void linearise(Vec x);
  /// Factorises with borders b and c [n].
  void factorise(double omega, const ComplexVector& b, const ComplexVector& c);
  /// Factorises A alone.
  void factorise(double omega) { factorise(omega, {}, {}); }
  /// Solves for (x, g), or with the conjugate transpose; `corner` is the last entry of the right-hand side and of the
  /// answer where there is a border. Throws core::NotConverged if the matrix is singular.
  void solve(const ComplexVector& rhs, ComplexVector& x, std::complex<double>& corner);
  void solve_adjoint(const ComplexVector& rhs, ComplexVector& x, std::complex<double>& corner);
  /// dF/d(dx/dt) v, scaled [n].
  [[nodiscard]] ComplexVector rates_times(const ComplexVector& v) const;
  [[nodiscard]] std::size_t size() const { return state_scale_.size(); }

private:
  void solve(bool adjoint, const ComplexVector& rhs, ComplexVector& x, std::complex<double>& corner);
  problem::System& system_;
  core::Vector rest_, residual_scale_;
  std::vector<double> state_scale_;  // whole
  core::Matrix jx_, jd_, matrix_;
  core::LinearSolver solver_;
  bool bordered_ = false;
};

/// Right and left null vectors of dF/dx + i omega dF/d(dx/dt) where it is singular, A q = 0 and p^* A = 0, each of root
/// mean square one.
struct CriticalVectors {
  ComplexVector q, p;
};
/// Leaves `shifted` factorised anew. Collective.
[[nodiscard]] CriticalVectors critical_vectors(ShiftedSystem& shifted, double omega);

}  // namespace whirl::solve
