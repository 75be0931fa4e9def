#include "solve/newton/settle_step.hpp"

#include "whirl/core/error.hpp"

namespace whirl::solve {

using core::check;

bool settle_step(ExtendedProblem& problem, const std::function<void(Vec u, Vec r)>& residual, Vec u, double norm,
                 Vec step) {
  constexpr double shortest = 1e-3, sufficient = 1e-4;  // fall of the residual, as a line search asks for
  core::Vector end = core::duplicate(u), there = core::duplicate(u), longest;
  const auto take = [&](Vec settled) {
    check(VecWAXPY(step, -1, settled, u));
    return true;
  };
  for (double part = 1; part > shortest; part /= 2) {
    check(VecWAXPY(end.get(), -part, step, u));
    if (!problem.settle(end.get())) continue;
    try {
      residual(end.get(), there.get());
    } catch (const core::DomainError&) {
      continue;
    }
    if (core::norm(there.get()) <= (1 - sufficient * part) * norm) return take(end.get());
    if (longest) continue;
    longest = copy(end.get());
  }
  // None helps: the search may find something on the way to the longest of them.
  return longest && take(longest.get());
}

}  // namespace whirl::solve
