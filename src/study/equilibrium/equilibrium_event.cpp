#include "study/equilibrium/equilibrium_event.hpp"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "study/bars/reduction_error.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/common.hpp"
#include "study/equilibrium/hopf_cycles.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/bifurcation/augmented_problem.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"
#include "whirl/solve/newton/equilibrium.hpp"

namespace whirl::study {
namespace {

using core::check;

enum Number : std::size_t { place, frequency, coefficient, numbers };

constexpr int few_harmonics = 3, more_harmonics = 5;  // of the cycles that decide on a criticality

double lyapunov(system::Plant& system, Vec x, double omega, double step) {
  try {
    return solve::hopf_coefficient(system, x, omega, step * critical_motion(system, x, omega).largest);
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

// The same bifurcation with other cells.
struct Elsewhere {
  std::unique_ptr<system::Plant> system;
  core::Vector x;
  std::optional<solve::Refined> found;
};

std::optional<Elsewhere> located_on(const EquilibriumEvent& at, const std::array<double, 2>& film_cells) {
  Elsewhere out{at.make(film_cells), {}, {}};
  system::Plant& system = *out.system;
  system.set_parameter(at.found.parameter * at.scale);
  out.x = resampled(system, at.system, at.system.gather(at.x));
  const bool hopf = at.found.event == solve::Event::hopf;
  // On the far side of a fold there is no equilibrium at this parameter.
  if (hopf && !solve::find_equilibrium(system, out.x.get(), at.newton).converged) return {};
  solve::EquilibriumProblem problem(system, at.scale, at.state_weight);
  core::Vector u = problem.make_unknown();
  problem.from_state(out.x.get(), at.found.parameter * at.scale, u.get());
  out.found =
      hopf ? approach(system, problem, at, out.x.get())
           : solve::refine(system, problem, at.found, u.get(), solve::any_tangent(problem, u.get()).get(), at.newton);
  if (!out.found) return {};
  problem.to_state(out.found->u.get(), out.x.get());
  system.set_parameter(out.found->parameter * at.scale);
  return out;
}

// Of the cycles born at the Hopf point with other cells; not a number if they cannot be had.
double curvature_on(const EquilibriumEvent& at, const std::array<double, 2>& film_cells, double largest) {
  const auto born = answer_of([&]() -> std::optional<BirthOfCycles> {
    const auto there = located_on(at, film_cells);
    if (!there) return {};
    return birth_of_cycles(*there->system, there->x.get(), std::abs(there->found->critical.imag()), at.scale,
                           few_harmonics, largest);
  });
  return born ? born->curvature : unknown;
}

std::vector<double> kept(const EquilibriumEvent& at, const std::string& name,
                         const std::function<std::vector<double>()>& work) {
  return at.keep ? at.keep(name, work) : work();
}

// Curvature, spread and amplitudes; empty if there are no such cycles.
std::vector<double> birth_here(const EquilibriumEvent& at, double omega, int harmonics, double largest) {
  const auto found = answer_of([&]() -> std::optional<BirthOfCycles> {
    return largest > 0 ? birth_of_cycles(at.system, at.x, omega, at.scale, harmonics, largest)
                       : birth_of_cycles(at.system, at.x, omega, at.scale, harmonics);
  });
  if (!found) return {};
  std::vector<double> out{found->curvature, found->spread};
  out.insert(out.end(), found->amplitudes.begin(), found->amplitudes.end());
  return out;
}

// The critical eigenvalue of the whole shaft at the Hopf point of the reduced one, carried to zero by its slope.
void put_reduction_error(io::Bifurcation& b, const EquilibriumEvent& at, double omega) {
  const auto* rotor = dynamic_cast<const system::RotorSystem*>(&at.system);
  if (!rotor || at.found.event != solve::Event::hopf || at.found.sensitivity == 0) return;
  const auto errors = reduction_errors(*rotor, at.x, {{0, omega}});
  if (!errors.empty()) b.more["reduction_error"] = -errors[0].real() / at.found.sensitivity;
}

// Cycles at finite amplitudes reach over the kinks of a force that is smooth by pieces only.
void decide_by_cycles(io::Bifurcation& b, const EquilibriumEvent& at, double omega) {
  if (!at.cycles) return;
  const std::vector<double> found = kept(at, "cycles", [&] { return birth_here(at, omega, few_harmonics, 0); });
  if (found.empty() || at.found.sensitivity == 0) return;
  const double curvature = found[0], spread = found[1], largest = found.back();
  const std::vector<double> finer =
      kept(at, "cycles with more harmonics", [&] { return birth_here(at, omega, more_harmonics, largest); });
  double doubt = finer.empty() ? unknown : std::abs(finer[0] - curvature);
  Bars bars({curvature}, at.law);
  for (std::size_t k = 0; k < at.meshes.size(); ++k) {
    const FilmMesh& mesh = at.meshes[k];
    const double c = kept(at, fmt::format("cycles on mesh {}", k), [&] {
                       return std::vector<double>{curvature_on(at, mesh.factor, largest)};
                     }).front();
    bars.add(mesh.axis, mesh.spacing, {c});
    // A sign that changes with the mesh is none.
    if (!(c * curvature > 0)) doubt = std::max(doubt, std::abs(c - curvature));
  }
  const std::string before = b.criticality_by;
  for (const char* name : {"coefficient", "uncertainty"})
    b.more[fmt::format("lyapunov_{}", name)] = b.more[fmt::format("criticality_{}", name)];
  // Cycles that live where the equilibrium is unstable are supercritical.
  const double sign = at.found.sensitivity > 0 ? -1 : 1;
  put_criticality(b, sign * curvature, spread + bars[0].total() + doubt, "supercritical", "subcritical",
                  fmt::format("cycles at amplitudes {:.3g}, {:.3g}, {:.3g} of a clearance, change of the parameter per "
                              "clearance^2",
                              found[2], found[3], found[4]));
  b.criticality_by += "; " + before;
}

}  // namespace

std::vector<double> numbers_on(const EquilibriumEvent& at, const std::array<double, 2>& film_cells) {
  return answer_of([&]() -> std::vector<double> {
    const auto there = located_on(at, film_cells);
    if (!there) return {};
    const bool hopf = at.found.event == solve::Event::hopf;
    if (!hopf) return {there->found->parameter, 0, there->found->quadratic};
    const double omega = there->found->critical.imag();
    return {there->found->parameter, omega, lyapunov(*there->system, there->x.get(), omega, steps_of(at.law).longer)};
  });
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
  const DifferenceSteps steps = steps_of(at.law);
  here[coefficient] = hopf ? lyapunov(at.system, at.x, omega, steps.longer) : at.found.quadratic;
  double doubt = hopf ? doubt_of_steps(lyapunov(at.system, at.x, omega, steps.shorter), here[coefficient]) : 0;
  Bars bars(here, at.law);
  for (std::size_t k = 0; k < at.meshes.size(); ++k) {
    const FilmMesh& mesh = at.meshes[k];
    const std::vector<double> there =
        kept(at, fmt::format("on mesh {}", k), [&] { return numbers_on(at, mesh.factor); });
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
  put_reduction_error(b, at, omega);
  if (hopf) b.more["uncertainty_whirl_frequency_rad_s"] = bars[frequency].total() + at.newton.tolerance * omega;
  const double error = std::isnan(doubt) ? doubt : std::max(bars[coefficient].total(), doubt);
  if (hopf)
    put_criticality(b, here[coefficient], error, "supercritical", "subcritical",
                    "first Lyapunov coefficient (Kuznetsov 2004, 5.39)");
  if (hopf && at.law.piecewise && b.criticality == "undetermined") decide_by_cycles(b, at, omega);
  if (!hopf && here[coefficient] != 0)
    put_criticality(b, here[coefficient], error, "below", "above",
                    "second derivative of the parameter along the branch: the side on which the equilibria exist");
}

}  // namespace whirl::study
