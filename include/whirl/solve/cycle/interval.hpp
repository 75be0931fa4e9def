#pragma once
// One collocation interval, condensed: the dense blocks inside the preconditioner of a periodic solution.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "whirl/problem/scaled_point.hpp"
#include "whirl/problem/structure.hpp"
#include "whirl/problem/thin_blocks.hpp"
#include "whirl/solve/cycle/scheme.hpp"

namespace whirl::solve {

/// The linearised equations of one interval of length H = h T with n states and degree m, scaled:
///
///     [ A0 | A ] [ x_start; X_1; ...; X_m ] = y,     A [mn x mn], A0 [mn x n]
///
/// block row j is the equation at point c_j: A(j,l) = value(j,l) dF/dx + slope(j,l)/H dF/d(dx/dt).
class Interval {
public:
  virtual ~Interval() = default;
  /// y := A^-1 y and y := A^-T y, column by column [mn x k].
  virtual void solve(Eigen::MatrixXd& y) const = 0;
  virtual void solve_transposed(Eigen::MatrixXd& y) const = 0;
  /// A0 x [mn x k] and A0^T y [n x k].
  [[nodiscard]] virtual Eigen::MatrixXd start(const Eigen::MatrixXd& x) const = 0;
  [[nodiscard]] virtual Eigen::MatrixXd start_transposed(const Eigen::MatrixXd& y) const = 0;
  /// A X + A0 x [mn].
  [[nodiscard]] virtual Eigen::VectorXd multiply(const Eigen::VectorXd& x_start, const Eigen::VectorXd& x) const = 0;
  /// A(j, l) for l = 1..m and A0(j) for l = 0, to assemble the whole matrix.
  [[nodiscard]] virtual Eigen::MatrixXd block(int j, int l) const = 0;
  /// Carries states over the interval: with X = -A^-1 A0 state [mn x k], state := X_m [n x k] and added += rows X
  /// [nb x k]. `rows` [nb x mn] stay the same between two linearisations.
  virtual void carry(const Eigen::MatrixXd& rows, Eigen::MatrixXd& state, Eigen::MatrixXd& added) const;
};

/// Dense interval from dF/dx and dF/d(dx/dt) [n x n] at each point; one LU of size mn.
[[nodiscard]] std::unique_ptr<Interval> make_dense_interval(const Scheme& scheme, double length,
                                                            std::vector<Eigen::MatrixXd> jx,
                                                            std::vector<Eigen::MatrixXd> jxdot);

/// What intervals of one length share: the part of F that is linear, factorised.
class LinearPart;
/// Interval by low-rank update of its linear part; `tangents` holds df/dw [r x w] at each point.
[[nodiscard]] std::unique_ptr<Interval> make_low_rank_interval(std::shared_ptr<const LinearPart> part,
                                                               std::vector<Eigen::MatrixXd> tangents);

/// What intervals of one length share where the blocks are sparse. Keeps a reference to the scheme and to the blocks.
class SparsePart;
[[nodiscard]] std::shared_ptr<const SparsePart> make_sparse_part(const Scheme& scheme, double length,
                                                                 const problem::ThinBlocks& blocks);
/// Low-rank interval of such a part, O(n) to solve; nothing is factorised before the first solution.
[[nodiscard]] std::unique_ptr<Interval> make_sparse_interval(std::shared_ptr<const SparsePart> part,
                                                             std::vector<Eigen::MatrixXd> tangents);

/// The same of a system with films that have own states behind those of `part`, from what is known at its points; O(n)
/// to factorise, to solve and to carry. `films` outlive it.
[[nodiscard]] std::unique_ptr<Interval> make_own_interval(std::shared_ptr<const LinearPart> part,
                                                          const std::vector<problem::OwnStates>& films,
                                                          const problem::ScaledPoint& scales,
                                                          const std::vector<const problem::PointState*>& points);

}  // namespace whirl::solve
