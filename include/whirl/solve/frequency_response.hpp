#pragma once
// Linear response to harmonic forcing.

#include <complex>
#include <vector>

#include "whirl/problem/system.hpp"

namespace whirl::solve {

/// Solves (dF/dx + i omega dF/d(dx/dt)) z = b for the complex amplitude z of x = Re(z exp(i omega t)), in the real form
/// of twice the size
///
///     [ Jx         -omega Jd ] [ Re z ]   [ Re b ]
///     [ omega Jd    Jx       ] [ Im z ] = [ Im b ]
///
/// with real and imaginary parts interleaved, so that the matrix keeps its band. The symbolic factorisation is made
/// once. PETSc's own LU on one rank, MUMPS on several.
class FrequencyResponse {
public:
  explicit FrequencyResponse(problem::System& system);
  /// `right` and `amplitude` [2 x local size]: real and imaginary part of each local entry in turn, SI. Linearised at
  /// the equilibrium x. Collective.
  void solve(Vec x, double omega, const std::vector<double>& right, std::vector<double>& amplitude);

private:
  problem::System& system_;
  core::Vector rest_, rhs_, answer_, state_scale_, residual_scale_, whole_scale_;
  core::Matrix jx_, jd_, matrix_;
  core::LinearSolver solver_;
};

}  // namespace whirl::solve
