#pragma once
// Steps of Newton's method for problems some of whose unknowns settle by themselves.

#include <petscvec.h>

#include <functional>

#include "whirl/solve/newton/extended_problem.hpp"

namespace whirl::solve {

/// Replaces `step`, by which Newton's method is about to go from u to u - step, by one that ends where the problem
/// settles, and true; false if it settles nowhere on the way. On a part of the way to a settled point nothing is
/// settled, and a line search would see stiff films out of balance: where the whole step does not lower the residual
/// below `norm`, which it has at u, shorter ones are settled themselves. `residual` throws core::DomainError.
/// Collective.
[[nodiscard]] bool settle_step(ExtendedProblem& problem, const std::function<void(Vec u, Vec r)>& residual, Vec u,
                               double norm, Vec step);

}  // namespace whirl::solve
