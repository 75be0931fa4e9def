#pragma once
// The part of collocation intervals that is the same for all of one length.

#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

#include "whirl/solve/cycle/scheme.hpp"

namespace whirl::solve {

/// The part of all intervals of one length that does not change along the cycle, for F = L1 xdot + L0 x - B f(C x):
/// factorised once per length.
///
/// With W0 = A at df/dw = 0, W00 = A0 likewise, Y = W0^-1 (I x B), V = value x C and V0 = value(:,0) x C:
///     A^-1 y = z + Y K^-1 S V z,  z = W0^-1 y,  K = I - S V Y   (Woodbury; S = df/dw at the points, block diagonal)
///     Gamma  = -E W0^-1 W00 + E Y K^-1 S (V0 - V W0^-1 W00)
/// so that an interval costs one LU of size m r (r forces) and 2 m r n^2 operations instead of those of a dense LU of
/// size mn. Of W0 itself only m (n - k) unknowns are factorised: k states whose rate is another state (q' = v) are
/// eliminated exactly.
class LinearPart {
public:
  /// Keeps a reference to the scheme and copies of the matrices L1, L0 [n x n], B [n x r], C [w x n].
  LinearPart(const Scheme& scheme, double length, const Eigen::MatrixXd& l1, const Eigen::MatrixXd& l0,
             const Eigen::MatrixXd& b, const Eigen::MatrixXd& c);

  const Scheme& scheme;
  const Eigen::MatrixXd l1, l0, b, c;
  double length;
  Eigen::Index n, r, w;
  Eigen::MatrixXd w00, y, vy;   ///< W00 [mn x n], Y [mn x mr], V Y [mw x mr]
  Eigen::MatrixXd free;         ///< -W0^-1 W00 [mn x n]
  Eigen::MatrixXd inputs_free;  ///< V0 - V W0^-1 W00 [mw x n]

  /// x := W0^-1 x and x := W0^-T x, column by column [mn x k].
  void solve(Eigen::MatrixXd& x) const;
  void solve_transposed(Eigen::MatrixXd& x) const;
  /// V x [mw x k] for x [mn x k], and V^T s [mn x k].
  [[nodiscard]] Eigen::MatrixXd inputs(const Eigen::MatrixXd& x) const;
  [[nodiscard]] Eigen::MatrixXd inputs_transposed(const Eigen::MatrixXd& s) const;
  /// k, the number of eliminated states.
  [[nodiscard]] Eigen::Index eliminated() const { return static_cast<Eigen::Index>(rate_row_.size()); }

private:
  void find_rates();
  void factorise();

  // Row i reads alpha x_a' + beta x_b: i, a, and the place of b among the kept states; all other rows and states.
  std::vector<Eigen::Index> rate_row_, rate_state_, rate_of_, row_, state_;
  Eigen::ArrayXd alpha_, beta_;
  Eigen::MatrixXd value_, integral_, value_integral_;  // V, D^-1, V D^-1 [m x m]
  Eigen::MatrixXd coupling_;                           // L0_ka/alpha [(n - k) x k]
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
};

}  // namespace whirl::solve
