#include "equilibrium_event.hpp"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "common.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/augmented_problem.hpp"
#include "whirl/solve/equilibrium.hpp"
#include "whirl/solve/normal_form.hpp"

namespace whirl::study {
namespace {

using core::check;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

enum Number : std::size_t { place, frequency, coefficient, numbers };

double lyapunov(system::Plant& system, Vec x, double omega, double step) {
  try {
    return solve::hopf_coefficient(system, x, omega, step);
  } catch (const core::NotConverged&) {
    return unknown;
  } catch (const core::DomainError&) {
    return unknown;
  }
}

constexpr int most_looks = 8, most_halvings = 6;

struct Crossing {
  double distance = unknown, omega = unknown;  // of the eigenvalue next to the critical one, from the axis [1/s, rad/s]
};

Crossing crossing_at(system::Plant& system, Vec x, double omega) {
  const auto s = equilibrium_stability(system, x);
  double nearest = std::numeric_limits<double>::infinity();
  Crossing out;
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
std::optional<solve::Refined> approach(system::Plant& system, solve::EquilibriumProblem& problem,
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
    const Crossing here = crossing_at(system, x, std::abs(event.critical.imag()));
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

}  // namespace

std::vector<double> numbers_on(const EquilibriumEvent& at, const std::array<double, 2>& film_cells) try {
  const auto made = at.make(film_cells);
  system::Plant& system = *made;
  system.set_parameter(at.found.parameter * at.scale);
  core::Vector x = resampled(system, at.system, at.system.gather(at.x));
  const bool hopf = at.found.event == solve::Event::hopf;
  // On the far side of a fold there is no equilibrium at this parameter.
  if (hopf && !solve::find_equilibrium(system, x.get(), at.newton).converged) return {};
  solve::EquilibriumProblem problem(system, at.scale, at.state_weight);
  core::Vector u = problem.make_unknown();
  problem.from_state(x.get(), at.found.parameter * at.scale, u.get());
  const auto there =
      hopf ? approach(system, problem, at, x.get())
           : solve::refine(system, problem, at.found, u.get(), solve::any_tangent(problem, u.get()).get(), at.newton);
  if (!there) return {};
  if (!hopf) return {there->parameter, 0, there->quadratic};
  problem.to_state(there->u.get(), x.get());
  system.set_parameter(there->parameter * at.scale);
  const double omega = there->critical.imag();
  return {there->parameter, omega, lyapunov(system, x.get(), omega, long_step)};
} catch (const core::NotConverged&) {
  return {};
} catch (const core::DomainError&) {
  return {};
} catch (const core::InputError&) {  // grooves that leave nothing of a coarser mesh
  return {};
}

void put_criticality(io::Bifurcation& b, double value, double uncertainty, const char* negative, const char* positive,
                     const std::string& by) {
  b.more["criticality_coefficient"] = value;
  b.more["criticality_uncertainty"] = uncertainty;
  b.criticality = "undetermined";
  if (!std::isfinite(value)) {
    b.criticality_by = by + ": it could not be had";
  } else if (!decided(value, uncertainty)) {
    b.criticality_by = fmt::format("{}: {:.3g} +- {:.3g} may be zero", by, value, uncertainty);
  } else {
    b.criticality = value < 0 ? negative : positive;
    b.criticality_by = by;
  }
}

void describe(io::Bifurcation& b, const EquilibriumEvent& at) {
  const bool hopf = at.found.event == solve::Event::hopf, fold = at.found.event == solve::Event::fold;
  b.uncertainty = at.found.bracket;
  b.more["uncertainty_location"] = at.found.bracket;
  const double omega = std::abs(at.found.critical.imag());
  if (hopf) {
    b.period_s = 2 * std::numbers::pi / omega;
    b.more["whirl_frequency_rad_s"] = omega;
    b.more["whirl_frequency_rpm"] = omega * 30 / std::numbers::pi;
  }
  if (!at.found.located || !(hopf || fold)) return;
  std::vector<double> here(numbers, 0.0);
  here[place] = at.found.parameter;
  here[frequency] = hopf ? omega : 0;
  at.system.set_parameter(at.found.parameter * at.scale);
  here[coefficient] = hopf ? lyapunov(at.system, at.x, omega, long_step) : at.found.quadratic;
  double doubt = hopf ? std::abs(lyapunov(at.system, at.x, omega, short_step) - here[coefficient]) : 0;
  Bars bars(here, at.law);
  for (const FilmMesh& mesh : at.meshes) {
    const std::vector<double> there = numbers_on(at, mesh.factor);
    bars.add(mesh.axis, mesh.spacing, there);
    // A sign that changes with the mesh is none.
    const double c = there.empty() ? unknown : there[coefficient];
    if (!(c * here[coefficient] > 0)) doubt = std::max(doubt, std::abs(c - here[coefficient]));
  }
  at.system.set_parameter(at.found.parameter * at.scale);
  Bar bar = bars[place];
  // Newton's method leaves a residual, and no two solutions agree better.
  bar.location = at.found.bracket + at.newton.tolerance * std::abs(at.found.parameter);
  b.uncertainty = bar.total();
  for (const auto& [name, value] : bar.parts(false)) b.more[name] = value;
  if (hopf) b.more["uncertainty_whirl_frequency_rad_s"] = bars[frequency].total() + at.newton.tolerance * omega;
  const double error = std::isnan(doubt) ? doubt : std::max(bars[coefficient].total(), doubt);
  if (hopf)
    put_criticality(b, here[coefficient], error, "supercritical", "subcritical",
                    "first Lyapunov coefficient (Kuznetsov 2004, 5.39)");
  else if (here[coefficient] != 0)
    put_criticality(b, here[coefficient], error, "below", "above",
                    "second derivative of the parameter along the branch: the side on which the equilibria exist");
}

}  // namespace whirl::study
