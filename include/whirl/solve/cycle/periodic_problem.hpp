#pragma once
// What every solver of periodic solutions can tell a branch that follows them.

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "whirl/solve/cycle/cycle.hpp"
#include "whirl/solve/newton/extended_problem.hpp"

namespace whirl::solve {

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
};

}  // namespace whirl::solve
