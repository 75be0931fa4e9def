#pragma once
// One collocation interval, condensed: the dense blocks inside the preconditioner of a periodic solution.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "whirl/solve/linear_part.hpp"
#include "whirl/solve/scheme.hpp"

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
  /// Gamma = -E A^-1 A0 [n x n]: the interval's end state per start state, E the last block row.
  [[nodiscard]] virtual Eigen::MatrixXd transition() const = 0;
  /// A(j, l) for l = 1..m and A0(j) for l = 0, to assemble the whole matrix.
  [[nodiscard]] virtual Eigen::MatrixXd block(int j, int l) const = 0;
};

/// Dense interval from dF/dx and dF/d(dx/dt) [n x n] at each point; one LU of size mn.
[[nodiscard]] std::unique_ptr<Interval> make_dense_interval(const Scheme& scheme, double length,
                                                            std::vector<Eigen::MatrixXd> jx,
                                                            std::vector<Eigen::MatrixXd> jxdot);

/// Interval by low-rank update of its linear part; `tangents` holds df/dw [r x w] at each point.
[[nodiscard]] std::unique_ptr<Interval> make_low_rank_interval(std::shared_ptr<const LinearPart> part,
                                                               std::vector<Eigen::MatrixXd> tangents);

}  // namespace whirl::solve
