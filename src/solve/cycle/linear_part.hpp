#pragma once
// The part of collocation intervals that is the same for all of one length.

#include <Eigen/Core>
#include <vector>

#include "solve/cycle/pencil.hpp"
#include "solve/cycle/time_modes.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/problem/thin_blocks.hpp"
#include "whirl/solve/cycle/scheme.hpp"

namespace whirl::solve {

/// What all intervals of one length have in common where F = L1 xdot + L0 x - B f(C x): the blocks, dense or sparse, n
/// states, r forces, w inputs.
template <class Matrix>
struct ThinPart : problem::LinearBlocks<Matrix> {
  /// Keeps a reference to the scheme and copies of the blocks.
  ThinPart(const Scheme& sc, double len, problem::LinearBlocks<Matrix> all)
      : problem::LinearBlocks<Matrix>(std::move(all)),
        scheme(sc),
        length(len),
        n(this->l1.rows()),
        r(this->b.cols()),
        w(this->c.rows()) {}

  const Scheme& scheme;
  double length;
  Eigen::Index n, r, w;
  /// -W0^-1 W00 [mn x n] and V0 - V W0^-1 W00 [mw x n], of dense blocks only.
  Eigen::MatrixXd free, inputs_free;

  /// With V = value x C: V x [mw x k] for x [mn x k], and V^T s [mn x k].
  [[nodiscard]] Eigen::MatrixXd inputs(const Eigen::MatrixXd& x) const {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(scheme.degree * w, x.cols());
    for (Eigen::Index l = 0; l < scheme.degree; ++l) {
      const Eigen::MatrixXd cx = this->c * x.middleRows(l * n, n);
      for (Eigen::Index j = 0; j < scheme.degree; ++j)
        if (scheme.value(j, l + 1) != 0) out.middleRows(j * w, w) += scheme.value(j, l + 1) * cx;
    }
    return out;
  }
  [[nodiscard]] Eigen::MatrixXd inputs_transposed(const Eigen::MatrixXd& s) const {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(scheme.degree * n, s.cols());
    for (Eigen::Index j = 0; j < scheme.degree; ++j) {
      const Eigen::MatrixXd cs = this->c.transpose() * s.middleRows(j * w, w);
      for (Eigen::Index l = 0; l < scheme.degree; ++l)
        if (scheme.value(j, l + 1) != 0) out.middleRows(l * n, n) += scheme.value(j, l + 1) * cs;
    }
    return out;
  }
};

/// The part of all intervals of one length that does not change along the cycle, for F = L1 xdot + L0 x - B f(C x):
/// factorised once per length.
///
/// With W0 = A at df/dw = 0, W00 = A0 likewise, Y = W0^-1 (I x B), V = value x C and V0 = value(:,0) x C:
///     A^-1 y = z + Y K^-1 S V z,  z = W0^-1 y,  K = I - S V Y   (Woodbury; S = df/dw at the points, block diagonal)
///     Gamma  = -E W0^-1 W00 + E Y K^-1 S (V0 - V W0^-1 W00)
/// so that an interval costs one LU of size m r (r forces) and 2 m r n^2 operations instead of those of a dense LU of
/// size mn. Of W0 itself only m (n - k) unknowns are factorised: k states whose rate is another state (q' = v) are
/// eliminated exactly.
class LinearPart : public ThinPart<Eigen::MatrixXd> {
public:
  LinearPart(const Scheme& scheme, double length, problem::DenseBlocks blocks);

  Eigen::MatrixXd y, vy;  ///< Y [mn x mr], V Y [mw x mr]

  /// x := W0^-1 x and x := W0^-T x, column by column [mn x k].
  void solve(Eigen::MatrixXd& x) const;
  void solve_transposed(Eigen::MatrixXd& x) const;
  /// Everything is at hand.
  void prepare() const {}
  /// k, the number of eliminated states.
  [[nodiscard]] Eigen::Index eliminated() const { return static_cast<Eigen::Index>(rate_row_.size()); }

private:
  void take_pairs();
  void factorise();

  // Row i reads alpha x_a' + beta x_b: i, a, and the place of b among the kept states; all other rows and states.
  std::vector<Eigen::Index> rate_row_, rate_state_, rate_of_, row_, state_;
  Eigen::ArrayXd alpha_, beta_;
  Eigen::MatrixXd value_, integral_, value_integral_;  // V, D^-1, V D^-1 [m x m]
  Eigen::MatrixXd coupling_;                           // L0_ka/alpha [(n - k) x k]
  core::DenseLu<double> lu_;
};

/// The same of sparse blocks, by time modes of the interval. The factors, Y and V Y are made when the first interval of
/// this length is solved, since a Newton step by time modes of the cycle solves none.
class SparsePart : public ThinPart<Eigen::SparseMatrix<double>> {
public:
  using ThinPart::ThinPart;
  mutable Eigen::MatrixXd y, vy;
  void prepare() const;
  void solve(Eigen::MatrixXd& x) const { apply(x, modes_.into, modes_.out, false); }
  void solve_transposed(Eigen::MatrixXd& x) const { apply(x, modes_.out, modes_.into, true); }

private:
  void apply(Eigen::MatrixXd& x, const Eigen::MatrixXd& into, const Eigen::MatrixXd& out, bool adjoint) const;
  mutable TimeModes modes_;
  mutable Pencil pencil_;
};

}  // namespace whirl::solve
