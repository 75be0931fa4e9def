#pragma once
// dF/dx + i omega dF/d(dx/dt), bordered, as a real matrix of twice the size.

#include <Eigen/Core>
#include <complex>
#include <memory>

#include "whirl/core/petsc.hpp"
#include "whirl/problem/system.hpp"

namespace whirl::solve {

class PortElimination;

using ComplexVector = Eigen::VectorXcd;

/// [A b; c^* 0] with A = dF/dx + i omega dF/d(dx/dt), scaled, at a resting state, as a real matrix with real and
/// imaginary parts interleaved,
///
///     [ Jx         -omega Jd ] [ Re z ]   [ Re b ]
///     [ omega Jd    Jx       ] [ Im z ] = [ Im b ]
///
/// Films with own states are eliminated on their ports; a machine without any is factorised as a whole (MUMPS, prefix
/// "shifted_"). Collective on the system's communicator.
class ShiftedSystem {
public:
  explicit ShiftedSystem(problem::System& system);
  ~ShiftedSystem();

  /// Takes the derivatives at x (SI), dx/dt = 0, and the system's parameter.
  void linearise(Vec x);
  /// Factorises with borders b and c [n], whole on every rank.
  void factorise(double omega, const ComplexVector& b, const ComplexVector& c);
  /// Factorises A alone.
  void factorise(double omega) { factorise(omega, {}, {}); }

  /// A zero vector of the real form, with the border's two entries at the end of the last rank if there is one.
  [[nodiscard]] core::Vector make_vector() const;
  /// Solves, or with the conjugate transpose. Throws core::NotConverged if the matrix is singular.
  void solve(Vec rhs, Vec z);
  void solve_adjoint(Vec rhs, Vec z);
  /// The same for vectors that are whole on every rank [n]: for (x, g); `corner` is the last entry of the right-hand
  /// side and of the answer where there is a border.
  void solve(const ComplexVector& rhs, ComplexVector& x, std::complex<double>& corner);
  void solve_adjoint(const ComplexVector& rhs, ComplexVector& x, std::complex<double>& corner);
  /// dF/d(dx/dt) v, scaled [n].
  [[nodiscard]] ComplexVector rates_times(const ComplexVector& v) const;
  [[nodiscard]] Eigen::Index size() const { return system_.size(); }
  [[nodiscard]] Vec state_scale() const { return state_scale_.get(); }
  [[nodiscard]] Vec residual_scale() const { return residual_scale_.get(); }

private:
  void make_matrix();
  void solve(bool adjoint, Vec rhs, Vec z);
  void solve(bool adjoint, const ComplexVector& rhs, ComplexVector& x, std::complex<double>& corner);
  problem::System& system_;
  core::Vector rest_, state_scale_, residual_scale_, row_scale_;
  core::Matrix jx_, jd_, matrix_;
  core::LinearSolver solver_;
  std::unique_ptr<PortElimination> ports_;
  bool bordered_ = false;
};

/// Right and left null vectors of dF/dx + i omega dF/d(dx/dt) where it is singular, A q = 0 and p^* A = 0, each of root
/// mean square one.
struct CriticalVectors {
  ComplexVector q, p;
};
/// Generic vectors [n] that serve as borders c and b where the null vectors q and p are not known, of length one.
[[nodiscard]] CriticalVectors generic_vectors(Eigen::Index n);
/// Leaves `shifted` factorised anew. Collective.
[[nodiscard]] CriticalVectors critical_vectors(ShiftedSystem& shifted, double omega);

}  // namespace whirl::solve
