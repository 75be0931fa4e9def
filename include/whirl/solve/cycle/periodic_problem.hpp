#pragma once
// What every solver of periodic solutions can tell a branch that follows them.

#include <Eigen/Core>
#include <complex>
#include <memory>
#include <optional>
#include <vector>

#include "whirl/solve/cycle/cycle.hpp"
#include "whirl/solve/newton/extended_problem.hpp"

namespace whirl::solve {

class Condition;
enum class Event;

/// A motion over the intervals that this rank evaluates, scaled, each rank its rows of the states: the state before
/// them [n_local] and those at their nodes [n_local x local nodes], with changes of the border unknowns ([period,]
/// parameter; scaled; empty: none).
struct Path {
  Eigen::VectorXd start;
  Eigen::MatrixXd nodes;
  Eigen::VectorXd border;
};

/// Equations of a periodic solution with unknowns u = (states at the nodes of a mesh, [period,] parameter).
///
/// Between u and people stands the Cycle, which holds the states in SI: of each rank the rows that it has of the
/// system, n_local, which are all where every rank holds a whole system. Whatever concerns the
/// linearisation is that of the last linearise(). All members are collective on comm().
class PeriodicProblem : public ExtendedProblem {
public:
  /// Where the nodes of a Cycle lie in the intervals of the mesh.
  [[nodiscard]] virtual const Scheme& scheme() const = 0;
  [[nodiscard]] virtual const std::vector<double>& mesh() const = 0;
  /// Typical magnitude of each state [n_local], SI.
  [[nodiscard]] virtual const Eigen::VectorXd& state_scale() const = 0;

  /// Between the distributed unknown and the cycle; an autonomous problem wants its phase reference first.
  /// scatter() interpolates a cycle on another mesh of the same scheme.
  [[nodiscard]] virtual Cycle gather(Vec u) const = 0;
  [[nodiscard]] virtual core::Vector scatter(const Cycle& cycle) const = 0;
  /// The motion of u dense enough to be read off between the nodes, a cycle of orbit_scheme(); the same as gather()
  /// unless the problem takes several steps from node to node.
  [[nodiscard]] virtual Cycle orbit(Vec u) { return gather(u); }
  [[nodiscard]] virtual const Scheme& orbit_scheme() const { return scheme(); }
  /// Phase reference of an autonomous cycle: integral <x - ref, ref'> ds = 0 from now on.
  virtual void set_phase_reference(const Cycle& reference) = 0;
  /// Unit of the unknown period [s]: that of the first phase reference; 0 before it.
  [[nodiscard]] virtual double period_scale() const = 0;

  /// Floquet multipliers by falling modulus: all of them, or all above a modulus that is well inside the unit circle.
  /// Throws core::NotConverged.
  [[nodiscard]] virtual std::vector<std::complex<double>> multipliers() = 0;
  /// The linearised motion v over one period with v(1) = mu v(0) for a real simple multiplier mu, at the nodes like
  /// Cycle::x [n_local x N m] (SI); the norm of the scaled v(0) is one and its sign is arbitrary but the same on every
  /// rank.
  [[nodiscard]] virtual Eigen::MatrixXd critical_motion(double mu) = 0;
  /// The start q [n_local] of the motion of a multiplier, in scaled states: M q = mu q. Empty if no such multiplier is
  /// known. Throws core::NotConverged.
  [[nodiscard]] virtual Eigen::VectorXcd multiplier_vector(std::complex<double> mu) = 0;

  // The map over one period, x(0) -> x(1), whose derivative is the monodromy matrix M.

  /// The ranks that share the rows of one state.
  [[nodiscard]] virtual MPI_Comm rows() const = 0;
  /// M v [n_local x k].
  [[nodiscard]] virtual Eigen::MatrixXd times(const Eigen::MatrixXd& v) = 0;
  /// M on every rank, where it is at hand and each rank has all rows.
  [[nodiscard]] virtual std::optional<Eigen::MatrixXd> matrix_of_period() = 0;
  /// V [n_local x p] and M V: an orthonormal basis that once belonged to the largest multipliers, so that
  /// M ~ (M V) V^T. Empty if none is known.
  virtual void dominant(Eigen::MatrixXd& v, Eigen::MatrixXd& image) = 0;
  /// The linearised motion from the scaled start v, not closed to a period: its end is M v.
  [[nodiscard]] virtual Path forward(const Eigen::VectorXd& v) const = 0;
  /// The motion from rest under -y, y [m n_local x local intervals] at the equations of the intervals, and its end
  /// after one period [n_local].
  [[nodiscard]] virtual Path forced(const Eigen::MatrixXd& y, Eigen::VectorXd& end) const = 0;
  /// dR/dx(u + step a) b of the intervals, as y of forced(), for each of the `b`; the films are evaluated once. The
  /// linearisation stays.
  [[nodiscard]] virtual std::vector<Eigen::MatrixXd> tangents(Vec u, double step, const Path& a,
                                                              const std::vector<const Path*>& b) = 0;

  /// Whether it solves transposed equations, which conditions of bifurcations want.
  [[nodiscard]] virtual bool has_adjoint() const { return false; }
  /// The condition that holds at an event with the given critical multiplier. Null where the problem solves no
  /// transposed equations, and for events without a condition.
  [[nodiscard]] virtual std::unique_ptr<Condition> condition(Event event, std::complex<double> critical);
};

}  // namespace whirl::solve
