#pragma once
// Linear response to harmonic forcing.

#include <memory>
#include <vector>

#include "whirl/problem/system.hpp"

namespace whirl::solve {

class EliminatedResponse;

/// Solves (dF/dx + i omega dF/d(dx/dt)) z = b for the complex amplitude z of x = Re(z exp(i omega t)).
///
/// On one rank the kinematic equations q' = v are eliminated exactly and the rest is factorised as a complex sparse
/// matrix, analysed once. On several ranks MUMPS factorises the real form of twice the size, real and imaginary parts
/// interleaved,
///
///     [ Jx         -omega Jd ] [ Re z ]   [ Re b ]
///     [ omega Jd    Jx       ] [ Im z ] = [ Im b ]
class FrequencyResponse {
public:
  explicit FrequencyResponse(problem::System& system);
  ~FrequencyResponse();
  /// `right` and `amplitude` [2 x local size]: real and imaginary part of each local entry in turn, SI. Linearised at
  /// the equilibrium x. Collective.
  void solve(Vec x, double omega, const std::vector<double>& right, std::vector<double>& amplitude);

private:
  problem::System& system_;
  core::Vector rest_, rhs_, answer_, state_scale_, residual_scale_;
  std::vector<double> whole_scale_;  // [size()] on every rank
  core::Matrix jx_, jd_, matrix_;
  core::LinearSolver solver_;
  std::unique_ptr<EliminatedResponse> eliminated_;  // on one rank
};

}  // namespace whirl::solve
