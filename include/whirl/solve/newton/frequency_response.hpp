#pragma once
// Linear response to harmonic forcing.

#include <array>
#include <memory>
#include <vector>

#include "whirl/problem/system.hpp"

namespace whirl::solve {

class Pencil;
class ShiftedSystem;

/// Solves (dF/dx + i omega dF/d(dx/dt)) z = b for the complex amplitude z of x = Re(z exp(i omega t)).
///
/// On one rank by a Pencil of one frequency, analysed anew only where the nonzeros change, and refinement for what it
/// loses without row exchanges. On several ranks, and where that does not come to rounding, by a ShiftedSystem.
class FrequencyResponse {
public:
  explicit FrequencyResponse(problem::System& system);
  ~FrequencyResponse();
  /// `right` and `amplitude` [2 x local size]: real and imaginary part of each local entry in turn, SI. Linearised at
  /// the equilibrium x. Collective; throws core::NotConverged if the matrix is singular.
  void solve(Vec x, double omega, const std::vector<double>& right, std::vector<double>& amplitude);

private:
  [[nodiscard]] bool solve_by_pencil(double omega, const double* right, double* amplitude);
  struct Copy;
  std::unique_ptr<ShiftedSystem> shifted_;
  // On one rank, of dF/dx and dF/d(dx/dt).
  std::unique_ptr<Pencil> pencil_;
  std::unique_ptr<std::array<Copy, 2>> copies_;
};

}  // namespace whirl::solve
