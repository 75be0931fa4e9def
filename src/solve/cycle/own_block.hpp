#pragma once
// The own states of one film in one collocation interval, eliminated as a chain of small blocks.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "whirl/problem/scaled_point.hpp"
#include "whirl/problem/structure.hpp"
#include "whirl/solve/cycle/scheme.hpp"

namespace whirl::solve {

/// Which states of a film see which others: state a sees a - below ... a + above. If the ends see each other (a film
/// around its bearing) these are counted around, and the last `separators` = max(below, above) states are kept for the
/// end, which leaves a band.
struct OwnShape {
  explicit OwnShape(const problem::OwnStates& film);
  Eigen::Index count, below = 0, above = 0, separators = 0;
  std::vector<std::size_t> states, rates;  ///< where each told entry stands in a band [count x width]

  [[nodiscard]] Eigen::Index interior() const { return count - separators; }
  [[nodiscard]] Eigen::Index width() const { return below + 1 + above; }
  /// The state that stands in the band of `row` at `slot`.
  [[nodiscard]] Eigen::Index column(Eigen::Index row, Eigen::Index slot) const {
    return columns[static_cast<std::size_t>(row * width() + slot)];
  }
  std::vector<Eigen::Index> columns;
};

/// Rows g(w, s, s') = 0 of one film at the m points of an interval of length H with the states at its m nodes as
/// unknowns. With s = (interior s_I, separators s_S) and the inputs eta of the film at the points
///
///     [ T_II  T_IS ] [ s_I ]         [ y_I ]     T(a, b) = value dg_a/ds_b + slope/H dg_a/ds'_b   [m x m]
///     [ T_SI  T_SS ] [ s_S ] + G eta = [ y_S ]     T_II banded, G(a) = dg_a/dw, diagonal in the points
///
/// s_I is eliminated by an LU of T_II without row exchanges between states (rounding that this costs comes back by
/// GMRES): s_I = T_II^-1 y_I - Z (eta, s_S). What is left are the separators and the forces f = F value s + F' slope/H
/// s:
///
///     Sigma s_S + Q eta = y_S - T_SI T_II^-1 y_I,    f = f_eta eta + f_s s_S + (F value + F' slope/H) T_II^-1 y_I
///
/// Cost: O(count m^3) to factorise, O(count m^2) to solve, times the square of the bandwidth and the bandwidth.
/// Everything is scaled. Inputs are ordered by input, then point; forces by point, then force.
class OwnBlock {
public:
  virtual ~OwnBlock() = default;
  /// From the tangents of film `index` at the points; `first` is its first state among all states. Not `whole` it
  /// serves eliminate() alone, of a film without separators.
  virtual void factorise(const std::vector<const problem::PointState*>& points, std::size_t index,
                         const problem::ScaledPoint& scales, Eigen::Index first, double length, bool whole) = 0;

  /// Inputs that occur at all, counted from the film's first one.
  [[nodiscard]] const std::vector<Eigen::Index>& active() const { return active_; }
  [[nodiscard]] const OwnShape& shape() const { return shape_; }
  Eigen::MatrixXd sigma, q;      ///< [m separators x m separators], [m separators x m active]
  Eigen::MatrixXd f_eta, f_own;  ///< [m forces x m active], [m forces x m separators]

  /// y [count m x columns] is ordered by state, then column, then point or node. On return the interior
  /// holds T_II^-1 y_I and the separators y_S - T_SI T_II^-1 y_I; `force` [m forces x columns] is what the interior
  /// adds.
  virtual void eliminate(Eigen::Index columns, double* y, Eigen::MatrixXd& force) const = 0;
  /// y_I -= Z (eta, s_S), y_S = s_S with eta [m active x columns] and s_S [m separators x columns].
  virtual void substitute(Eigen::Index columns, double* y, const Eigen::MatrixXd& eta,
                          const Eigen::MatrixXd& separators) const = 0;
  /// y = - A0 s: the rows' dependence on the states at the start of the interval [count x columns, leading dimension
  /// `stride`]; force = (F value_0 + F' slope_0/H) s.
  virtual void start(Eigen::Index columns, const double* s, Eigen::Index stride, double* y,
                     Eigen::MatrixXd& force) const = 0;
  /// y += factor G eta for eta [m active].
  virtual void add_inputs(double factor, const double* eta, double* y) const = 0;
  /// rows [count m] = (A s)(state, point) and force [m forces] from s [count m] and its start [count].
  virtual void multiply(const double* start, const double* s, double* rows, Eigen::VectorXd& force) const = 0;
  // The same transposed, for one right-hand side each.
  /// border [m active + m separators] = (0, y_S) - Z^T y_I.
  virtual void substitute_transposed(const double* y, Eigen::VectorXd& border) const = 0;
  /// y_I := T_II^-T (y_I - T_SI^T y_S + (F value + F' slope)^T force), y_S stays.
  virtual void eliminate_transposed(double* y, const double* force) const = 0;
  /// eta [m active] = G^T y.
  virtual void inputs_transposed(const double* y, double* eta) const = 0;
  /// s += A0^T y - (F value_0 + F' slope_0/H)^T force [count].
  virtual void start_transposed(const double* y, const double* force, double* s) const = 0;

protected:
  explicit OwnBlock(OwnShape shape) : shape_(std::move(shape)) {}
  OwnShape shape_;
  std::vector<Eigen::Index> active_;
};

[[nodiscard]] std::unique_ptr<OwnBlock> make_own_block(const Scheme& scheme, const problem::OwnStates& film);

}  // namespace whirl::solve
