#pragma once
// Branches recorded as plain lists.

#include <string>
#include <vector>

#include "cycle_systems.hpp"
#include "whirl/solve/branch/continuation.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::test {

struct Recorded {
  std::vector<solve::BranchPoint> points;
  std::vector<double> norms;  ///< root of <u, u> at each point
  std::vector<solve::LocatedEvent> events;
  solve::BranchEnd end;

  [[nodiscard]] std::vector<solve::LocatedEvent> of(solve::Event kind) const {
    std::vector<solve::LocatedEvent> out;
    for (const auto& e : events)
      if (e.event == kind) out.push_back(e);
    return out;
  }
};

inline solve::ContinuationOptions range(double from, double to, double step) {
  solve::ContinuationOptions o;
  o.from = from;
  o.to = to;
  o.initial_step = step;
  o.max_step = step;
  o.min_step = 1e-5 * step;
  o.location_tolerance = 1e-10;
  o.newton.tolerance = 1e-12;
  return o;
}

inline solve::BranchCallbacks recording(solve::ExtendedProblem& problem, Recorded& r) {
  solve::BranchCallbacks c;
  c.on_point = [&](const solve::BranchPoint& p, Vec u) {
    r.points.push_back(p);
    r.norms.push_back(std::sqrt(solve::inner(problem, u, u)));
  };
  c.on_event = [&r](const solve::LocatedEvent& e, Vec) { r.events.push_back(e); };
  return c;
}

/// Equilibria of `system` from the guess `x`, stability by all its eigenvalues.
inline Recorded follow(SmallSystem& system, const Eigen::VectorXd& x, const solve::ContinuationOptions& options) {
  solve::EquilibriumProblem problem(system, 1, 1);
  Recorded r;
  auto callbacks = recording(problem, r);
  const core::Vector state = system.vector(x);
  callbacks.stability = [&](Vec u) {
    core::Vector at = core::duplicate(state.get());
    problem.to_state(u, at.get());
    std::vector<Complex> all;
    spectral::EigenOptions o;
    o.shapes = false;
    for (const auto& mode : spectral::modes(system, at.get(), o)) {
      all.push_back(mode.lambda);
      if (mode.lambda.imag() > 0) all.push_back(std::conj(mode.lambda));
    }
    return solve::make_stability(std::move(all), [](Complex z) { return z.real(); });
  };
  core::Vector u = problem.make_unknown();
  problem.from_state(state.get(), options.from, u.get());
  r.end = solve::follow_branch(problem, std::move(u), options, callbacks);
  return r;
}

/// Stability of a forced cycle.
inline solve::Stability multipliers(const solve::CycleProblem& problem) {
  return solve::make_stability(spectral::eigenvalues(problem.monodromy()), [](Complex z) { return std::abs(z) - 1; });
}

/// Forced cycles from the guess `state(angle)`.
template <class F>
Recorded follow_cycles(MPI_Comm time, SmallSystem& system, F state, const solve::CycleOptions& cycle,
                       std::vector<double> mesh, const solve::ContinuationOptions& options) {
  solve::CycleProblem problem(time, system, cycle, std::move(mesh));
  Recorded r;
  auto callbacks = recording(problem, r);
  callbacks.cycles = true;
  callbacks.stability = [&](Vec) { return multipliers(problem); };
  auto guess = sampled(problem.scheme(), problem.mesh(), 1, options.from * problem.parameter_scale(), state);
  r.end = solve::follow_branch(problem, problem.scatter(guess), options, callbacks);
  return r;
}

}  // namespace whirl::test
