#pragma once
// Newton's method for an extended problem, by PETSc SNES.

#include <memory>
#include <string>
#include <vector>

#include "whirl/solve/newton/extended_problem.hpp"
#include "whirl/solve/newton/replay_log.hpp"

namespace whirl::solve {

struct NewtonOptions {
  double tolerance = 1e-10;       ///< root mean square of the scaled residual at which Newton stops
  double step_tolerance = 1e-11;  ///< relative size of a step below which Newton stops
  int max_iterations = 12;
  bool searches = true;  ///< false: whole steps, which end at the first domain error
  /// Ends where so many steps in turn have lowered the residual by less than a tenth each; zero: never.
  int patience = 0;
  std::string prefix = "newton_", linear_prefix = "tangent_";  ///< of the PETSc options
  ReplayLog* replay_log = nullptr;  ///< keeps solutions and iterates; the problem may then be linearised anywhere
};

/// What came of a Newton solve; not converging is a fact, not an error.
struct NewtonResult {
  bool converged = false;
  int iterations = 0;
  /// The iterations as decisions count them: those that the first residuals foretell where the last ones are rounding,
  /// which differs between rank counts.
  int effort = 0;
  int linear_iterations = 0;
  double residual = 0;  ///< root mean square of the scaled residual at the end
  std::string reason;   ///< why it ended, with the text of a film's DomainError if one was met
};

/// Newton's method with line search `bt` (it recovers from domain errors) and right-preconditioned flexible GMRES
/// around problem.solve().
///
/// PETSc's objects are made when first wanted and kept for further solves, until the layout of the unknowns changes:
/// for small problems making them costs more than using them. All members are collective on problem.comm().
class Newton {
public:
  /// The problem outlives this.
  Newton(ExtendedProblem& problem, NewtonOptions options);
  ~Newton();
  Newton(const Newton&) = delete;
  Newton& operator=(const Newton&) = delete;

  /// Solves R(u) = 0, row . u = offset from the start in u, which holds the answer.
  NewtonResult solve(Vec u, Vec row, double offset);
  /// x = [dR/du; row]^-1 rhs for the linearisation that the problem holds (`linear_prefix`); returns the iterations
  /// of GMRES. Throws core::NotConverged if the matrix is singular.
  int solve_linear(Vec rhs, Vec x);

private:
  struct Objects;
  Objects& objects(Vec like);
  // From the iterate in u, which others led to: norms of their residuals.
  NewtonResult solve_from(Vec u, Vec row, double offset, std::vector<double> earlier);

  ExtendedProblem& problem_;
  NewtonOptions options_;
  std::unique_ptr<Objects> objects_;
};

/// One solve with objects of its own.
NewtonResult newton(ExtendedProblem& problem, Vec u, Vec row, double offset, const NewtonOptions& options);
int solve_linear(ExtendedProblem& problem, Vec rhs, Vec x, const std::string& prefix);

}  // namespace whirl::solve
