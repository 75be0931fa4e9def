#include "study/equilibrium/located_elsewhere.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/common.hpp"
#include "study/make_plant.hpp"
#include "whirl/solve/bifurcation/augmented_problem.hpp"
#include "whirl/solve/newton/equilibrium.hpp"

namespace whirl::study {
namespace {

constexpr int most_looks = 8, most_halvings = 6;
constexpr int most_trials = 40, most_false_positions = 12;
// A place that stands in a bar is wanted to a hundredth of what the meshes differ by.
constexpr double place_tolerance = 1e-6,
                 difference_tolerance = 1e-2;  // of the parameter; of its change from mesh to mesh

struct CriticalEigenvalue {
  double distance = unknown, omega = unknown;  // of the eigenvalue next to the critical one, from the axis [1/s, rad/s]
};

CriticalEigenvalue crossing_at(system::Plant& system, Vec x, double omega) {
  const auto s = equilibrium_stability(system, x);
  double nearest = std::numeric_limits<double>::infinity();
  CriticalEigenvalue out;
  for (std::size_t k = 0; k < s.values.size(); ++k) {
    const double apart = std::abs(std::abs(s.values[k].imag()) - omega) + std::abs(s.values[k].real());
    if (apart >= nearest) continue;
    nearest = apart;
    out = {s.distance[k], std::abs(s.values[k].imag())};
  }
  return out;
}

// The Hopf point on the branch through x, where Newton's method for it does not arrive from the parameter of the other
// mesh: it begins anew from where the secant on the real part of the eigenvalue crosses zero, each time nearer. The
// equilibrium moves along, so that the frequency is that of the Hopf point and not of the other mesh's parameter.
std::optional<solve::Refined> approached(system::Plant& system, solve::EquilibriumProblem& problem,
                                         const EquilibriumEvent& at, Vec x) {
  solve::LocatedEvent event = at.found;
  double p = event.parameter, slope = event.sensitivity, last_p = p, last_distance = 0;
  core::Vector u = problem.make_unknown(), trial = core::duplicate(x);
  for (int look = 0;; ++look) {
    problem.from_state(x, p * at.scale, u.get());
    const core::Vector tangent = solve::any_tangent(problem, u.get());
    if (auto there = solve::refine(system, problem, event, u.get(), tangent.get(), at.newton)) return there;
    if (look == most_looks) return {};
    system.set_parameter(p * at.scale);
    const CriticalEigenvalue here = crossing_at(system, x, std::abs(event.critical.imag()));
    if (look > 0) slope = (here.distance - last_distance) / (p - last_p);
    if (!std::isfinite(here.distance / slope)) return {};
    last_p = p;
    last_distance = here.distance;
    event.critical = {0, here.omega};
    double step = -here.distance / slope;
    for (int halvings = 0;; ++halvings, step /= 2) {
      if (halvings > most_halvings) return {};
      core::check(VecCopy(x, trial.get()));
      system.set_parameter((last_p + step) * at.scale);
      if (solve::find_equilibrium(system, trial.get(), at.newton).converged) break;
    }
    core::check(VecCopy(trial.get(), x));
    p = last_p + step;
  }
}

// The same where the tangents of films jump. The real part of the eigenvalue then jumps too, and may pass zero in a
// jump: there is no root to converge to. Its sign is asked instead, first in growing steps, then between two places of
// different sign (false position, then halves).
std::optional<solve::Refined> enclose(system::Plant& system, solve::EquilibriumProblem& problem,
                                      const EquilibriumEvent& at, Vec x) {
  double omega = std::abs(at.found.critical.imag());
  core::Vector trial = core::duplicate(x);
  // The distance there; x and omega move along.
  const auto look = [&](double parameter) {
    core::check(VecCopy(x, trial.get()));
    system.set_parameter(parameter * at.scale);
    if (!solve::find_equilibrium(system, trial.get(), at.newton).converged) return unknown;
    core::check(VecCopy(trial.get(), x));
    const CriticalEigenvalue crossing = crossing_at(system, x, omega);
    omega = crossing.omega;
    return crossing.distance;
  };
  const double here = at.found.parameter;
  double p0 = here, d0 = look(p0), p1 = p0, d1 = d0, step = -d0 / at.found.sensitivity;
  if (!std::isfinite(step)) return {};
  for (int k = 0; k < most_looks && d1 * d0 > 0; ++k, step *= 2) {
    p0 = p1, d0 = d1;
    p1 = p0 + step;
    d1 = look(p1);
  }
  if (!(d1 * d0 <= 0)) return {};
  for (int k = 0; k < most_trials && d1 != 0; ++k) {
    const double nearest = (p0 - here) * (p1 - here) > 0 ? std::min(std::abs(p0 - here), std::abs(p1 - here)) : 0;
    const double tolerance = std::max(place_tolerance * std::abs(here), difference_tolerance * nearest);
    if (std::abs(p1 - p0) <= tolerance) break;
    double p = k < most_false_positions ? (p0 * d1 - p1 * d0) / (d1 - d0) : (p0 + p1) / 2;
    // A secant that has found the place does not enclose it: a step of half the tolerance beyond does.
    if (std::abs(p - p1) < tolerance / 2) p = p1 + std::copysign(tolerance / 2, p0 - p1);
    const double d = look(p);
    if (!std::isfinite(d)) return {};
    if (d * d1 < 0) {
      p0 = p1, d0 = d1;
    } else {
      d0 /= 2;
    }
    p1 = p, d1 = d;
  }
  core::Vector u = problem.make_unknown();
  problem.from_state(x, p1 * at.scale, u.get());
  return solve::Refined{std::move(u), p1, std::abs(p1 - p0), 0, {0, omega}};
}

// From the guess x.
std::optional<Elsewhere> located_from(const EquilibriumEvent& at, Elsewhere out) {
  system::Plant& system = *out.system;
  const bool hopf = at.found.event == solve::Event::hopf;
  // On the far side of a fold there is no equilibrium at this parameter.
  if (hopf && !solve::find_equilibrium(system, out.x.get(), at.newton).converged) return {};
  solve::EquilibriumProblem problem(system, at.scale, at.state_weight);
  core::Vector u = problem.make_unknown();
  problem.from_state(out.x.get(), at.found.parameter * at.scale, u.get());
  if (hopf && !at.law.kinks) {
    out.found = approached(system, problem, at, out.x.get());
  } else {
    out.found = solve::refine(system, problem, at.found, u.get(), solve::any_tangent(problem, u.get()).get(),
                              to_refine(at.newton, at.law));
    if (hopf && !out.found) out.found = enclose(system, problem, at, out.x.get());
  }
  if (!out.found) return {};
  problem.to_state(out.found->u.get(), out.x.get());
  system.set_parameter(out.found->parameter * at.scale);
  return out;
}

}  // namespace

std::optional<Elsewhere> located_on(const EquilibriumEvent& at, const std::array<double, 2>& film_cells) {
  Elsewhere out{at.make(film_cells), {}, {}};
  out.system->set_parameter(at.found.parameter * at.scale);
  out.x = resampled(*out.system, at.system, at.system.gather(at.x));
  return located_from(at, std::move(out));
}

std::optional<Elsewhere> located_on_cut_shaft(const EquilibriumEvent& at) {
  Elsewhere out{at.cut(), {}, {}};
  out.system->set_parameter(at.found.parameter * at.scale);
  out.x = find_rest(*out.system);
  return located_from(at, std::move(out));
}

}  // namespace whirl::study
