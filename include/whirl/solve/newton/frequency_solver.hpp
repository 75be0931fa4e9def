#pragma once
// Linear response to harmonic forcing.

#include <memory>
#include <vector>

#include "whirl/problem/system.hpp"

namespace whirl::solve {

class EliminatedResponse;
class ShiftedSystem;

/// What a core::NotConverged says where the matrix is singular.
inline constexpr const char* singular_at_frequency =
    "the equations are singular there, as at an undamped resonance: the motion grows without limit";

/// Solves (dF/dx + i omega dF/d(dx/dt)) z = b for the complex amplitude z of x = Re(z exp(i omega t)).
///
/// On one rank the kinematic equations q' = v are eliminated exactly and the rest is factorised as a complex sparse
/// matrix, analysed once. On several ranks it is a ShiftedSystem.
class FrequencySolver {
public:
  explicit FrequencySolver(problem::System& system);
  ~FrequencySolver();
  /// Takes the derivatives at the equilibrium x and the system's parameter. Collective.
  void linearise(Vec x);
  /// Factorises the matrix for a frequency [rad/s]. Collective; throws core::NotConverged if it is singular.
  void factorise(double omega);
  /// `right` and `amplitude` [2 x local size]: real and imaginary part of each local entry in turn, SI. Collective.
  void solve(const std::vector<double>& right, std::vector<double>& amplitude);
  /// All three.
  void solve(Vec x, double omega, const std::vector<double>& right, std::vector<double>& amplitude);

private:
  problem::System& system_;
  core::Vector rest_, state_scale_, residual_scale_;
  core::Matrix jx_, jd_;
  std::unique_ptr<EliminatedResponse> eliminated_;  // on one rank
  std::unique_ptr<ShiftedSystem> shifted_;          // on several
};

}  // namespace whirl::solve
