#pragma once
// What a branch is made of: n equations in n + 1 unknowns.

#include <petscmat.h>
#include <petscvec.h>

#include <vector>

#include "whirl/core/petsc.hpp"
#include "whirl/problem/system.hpp"

namespace whirl::solve {

/// R(u) = 0 with u = (states, ..., parameter): one equation fewer than unknowns; an added last row makes Newton's
/// matrix square.
///
/// Unknowns and residuals are scaled to order one. The parameter is the last entry of u and lives on the last rank; the
/// last row of every residual belongs to the added row. All members are collective on comm().
///
///     [ dR/dstates  dR/dparameter ] [ du ]   [ r   ]
///     [ row                       ] [ dp ] = [ r_c ]
class ExtendedProblem {
public:
  ExtendedProblem() = default;
  ExtendedProblem(const ExtendedProblem&) = delete;
  ExtendedProblem& operator=(const ExtendedProblem&) = delete;
  virtual ~ExtendedProblem() = default;

  [[nodiscard]] virtual MPI_Comm comm() const = 0;
  /// A zero vector in the layout of u.
  [[nodiscard]] virtual core::Vector make_unknown() const = 0;
  /// Weights of the inner product <a, b> = sum weight a b that measures arclength, in the unit of the scaled parameter.
  [[nodiscard]] virtual Vec weights() const = 0;
  /// Physical value of one unit of the scaled parameter.
  [[nodiscard]] virtual double parameter_scale() const = 0;

  /// r = R(u), last row untouched. Throws core::DomainError, agreed on all ranks.
  virtual void residual(Vec u, Vec r) = 0;
  /// Takes the matrix above at u with the last row `row`, for multiply() and solve(), which may factorise it later.
  virtual void linearise(Vec u, Vec row) = 0;
  virtual void multiply(Vec v, Vec y) = 0;
  /// x = matrix^-1 rhs up to rounding; used as a preconditioner, so that lost digits come back by iteration.
  virtual void solve(Vec rhs, Vec x) = 0;

  /// The same matrix entry by entry, with the values of the last linearise(), for preconditioners that are chosen by
  /// option; the same object in every call. Null if there is none or none yet: then solve() is the only preconditioner.
  /// Collective.
  [[nodiscard]] virtual Mat matrix() { return nullptr; }
  /// The unknowns in parts, in local rows, for field splits; those that are in none are the part "border".
  [[nodiscard]] virtual std::vector<problem::Field> fields() const { return {}; }

  /// Whether settle() may find better points. Not collective.
  [[nodiscard]] virtual bool settles() const { return false; }
  /// Moves u, which Newton's method is about to try, to a better point by equations of its own; false if there is none
  /// (u is then as it was). Collective.
  virtual bool settle(Vec /*u*/) { return false; }

  /// To be called when the equations have changed otherwise than by u: what is kept of them is then stale.
  virtual void equations_changed() {}

  /// What earlier solutions left that helps to find the next ones, such as a basis of the leading multipliers: it moves
  /// answers within their tolerance. Whole on every rank; empty is none. The next call after taking one is linearise().
  [[nodiscard]] virtual std::vector<double> warm_start() { return {}; }
  virtual void take_warm_start(const std::vector<double>& /*warm*/) {}

  /// Relative residual to which Newton's linear systems are to be solved.
  [[nodiscard]] virtual double linear_tolerance() const { return 1e-9; }

  /// Adapts the discretisation to the solution u and carries u and the tangent over; true if anything changed (all
  /// layouts then differ).
  virtual bool adapt(core::Vector& /*u*/, core::Vector& /*tangent*/) { return false; }
};

/// A vector with the layout and the entries of v, and the product a . b. Collective.
[[nodiscard]] core::Vector copy(Vec v);
[[nodiscard]] double dot(Vec a, Vec b);
/// Value of the last entry of u (the scaled parameter) on all ranks / sets it.
[[nodiscard]] double last_entry(MPI_Comm comm, Vec u);
void set_last_entry(MPI_Comm comm, Vec u, double value);
/// The inner product of the problem: sum weight a b.
[[nodiscard]] double inner(const ExtendedProblem& problem, Vec a, Vec b);
/// row = weights * direction, so that row . v = <direction, v>.
void weighted_row(const ExtendedProblem& problem, Vec direction, Vec row);
/// The row that fixes the parameter: zero but for a one in the last entry.
void parameter_row(const ExtendedProblem& problem, Vec row);

}  // namespace whirl::solve
