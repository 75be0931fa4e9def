#pragma once
// One collocation interval of a system that is spread over ranks.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "solve/newton/port_elimination.hpp"
#include "whirl/core/shell.hpp"
#include "whirl/solve/cycle/scheme.hpp"

namespace whirl::solve {

/// What the intervals of one problem share: coefficients of Radau points, a Krylov method, room to work. Collective.
class SpreadStep {
public:
  SpreadStep(MPI_Comm comm, PetscInt local, const Scheme& scheme);
  [[nodiscard]] const Scheme& scheme() const { return *scheme_; }
  /// Lower triangle near the slopes (over h) at the points [m x m], and the mean of its diagonal.
  [[nodiscard]] const Eigen::MatrixXd& triangle() const { return triangle_; }
  [[nodiscard]] double shift() const { return shift_; }
  /// H/theta at point j over the length: of its own matrix, or of one that serves all points.
  [[nodiscard]] double own(Eigen::Index j, bool each) const { return 1 / (each ? triangle_(j, j) : shift_); }
  /// v [local x k] := zero in the rows of the hub of matrices with this layout.
  static void hold(const PortLayout& layout, double* v, Eigen::Index k);

private:
  friend class SpreadInterval;
  MPI_Comm comm_;
  const Scheme* scheme_;
  Eigen::MatrixXd triangle_;
  double shift_ = 0;
  core::Gate gate_;
  core::Matrix shell_;
  core::LinearSolver solver_;
  core::Vector rhs_, answer_;                       // [m local]
  core::Vector one_, other_;                        // [local]
  const class SpreadInterval* interval_ = nullptr;  // that is being solved
  bool held_ = false;
};

/// The linearised equations of one interval of length H at m Radau points, which are its nodes; this rank's rows:
///
///     J_j X_j + D_j x'_j = y_j,   x'_j = (slope(j,0) x_start + sum_l slope(j,l) X_l)/H,   J = dF/dx, D = dF/d(dx/dt)
///
/// Products are exact. FGMRES (prefix "interval_") solves them with the following preconditioner. Let A be the matrix
/// of the Runge-Kutta scheme, slope = A^-1 without its first column, and A = T U with T lower triangular and U of unit
/// diagonal: T^-1 in place of A^-1 leaves points that are solved one after the other, each a system D + H/theta J,
/// which is what elimination of the parts serves. One eliminated matrix, with the mean theta of the diagonal of T^-1,
/// serves all points of one interval, or of some. The iteration matrix is nilpotent where H J or D is small. Where J
/// jumps from point to point, as at the nodes of a film that become full, the matrix of another point is no
/// preconditioner: an entry may be a thousand times as large. There each point has its own. Source: van der Houwen and
/// de Swart (1997), SIAM J. Sci. Comput. 18, 41.
class SpreadInterval {
public:
  /// `blocks` of D + H/theta J and `rates` of D at the points [m]; all of `rates` may be one. `similar`: eliminated
  /// matrices of the points [m], whose theta are then the diagonal of the triangle, or one for all of them.
  SpreadInterval(SpreadStep& step, double length, std::vector<std::shared_ptr<const PortMatrix>> blocks,
                 std::vector<std::shared_ptr<const PortMatrix>> rates,
                 std::vector<std::shared_ptr<PortElimination>> similar)
      : step_(step),
        length_(length),
        blocks_(std::move(blocks)),
        rates_(std::move(rates)),
        similar_(std::move(similar)) {}

  /// y = equations of (x_start, X) [m local]; x_start may be null: zero.
  void multiply(const double* start, const double* x, double* y) const;
  /// x [m local x k] := X of the right-hand sides x, to the relative residual `tolerance`; with `held` only of the rows
  /// of the parts, the hub being held: x is zero there before and after. Throws core::DomainError, on all ranks, if it
  /// does not come that far.
  void solve(Eigen::MatrixXd& x, double tolerance, bool held = false) const;
  [[nodiscard]] const std::vector<std::shared_ptr<PortElimination>>& similar() const { return similar_; }

private:
  friend class SpreadStep;
  void precondition(const double* r, double* x) const;
  [[nodiscard]] double own(Eigen::Index j) const { return length_ * step_.own(j, similar_.size() > 1); }
  SpreadStep& step_;
  double length_;
  std::vector<std::shared_ptr<const PortMatrix>> blocks_, rates_;
  std::vector<std::shared_ptr<PortElimination>> similar_;
};

}  // namespace whirl::solve
