#pragma once
// Newton's method for an extended problem, by PETSc SNES.

#include <functional>
#include <string>

#include "whirl/solve/extended_problem.hpp"

namespace whirl::solve {

struct NewtonOptions {
  double tolerance = 1e-10;       ///< root mean square of the scaled residual at which Newton stops
  double step_tolerance = 1e-11;  ///< relative size of a step below which Newton stops
  int max_iterations = 12;
  std::string prefix = "newton_";  ///< of the PETSc options
};

/// What came of a Newton solve; not converging is a fact, not an error.
struct NewtonResult {
  bool converged = false;
  int iterations = 0;
  int linear_iterations = 0;
  double residual = 0;  ///< root mean square of the scaled residual at the end
  std::string reason;   ///< why it ended, with the text of a film's DomainError if one was met
};

/// Solves R(u) = 0, row . u = offset from the start in u, with line search `bt` (it recovers from domain errors) and
/// right-preconditioned flexible GMRES around problem.solve(). Collective; u holds the answer.
NewtonResult newton(ExtendedProblem& problem, Vec u, Vec row, double offset, const NewtonOptions& options);

/// x = [dR/du; row]^-1 rhs for the linearisation that `problem` holds, by the same GMRES; returns its iterations.
/// Throws core::NotConverged if the matrix is singular.
int solve_linear(ExtendedProblem& problem, Vec rhs, Vec x, const std::string& prefix);

}  // namespace whirl::solve
