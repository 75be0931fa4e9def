#include "study/equilibrium/equilibrium_event.hpp"

#include <fmt/core.h>

#include <numbers>
#include <optional>

#include "study/bars/reduction_error.hpp"
#include "study/bars/shaft_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/common.hpp"
#include "study/equilibrium/hopf_cycles.hpp"
#include "study/equilibrium/located_elsewhere.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"
#include "whirl/solve/newton/equilibrium.hpp"

namespace whirl::study {
namespace {

using core::check;

enum Number : std::size_t { place, frequency, coefficient, numbers };

constexpr int few_harmonics = 3, more_harmonics = 5;  // of the cycles that decide on a criticality

double lyapunov(system::Plant& system, Vec x, double omega, double step) {
  double out = unknown;
  (void)has_answer(
      [&] { out = solve::hopf_coefficient(system, x, omega, step * critical_motion(system, x, omega).largest); });
  return out;
}

// Of the cycles born at the Hopf point with other cells, whose numbers are `there`; not a number if they cannot be had.
double curvature_on(const EquilibriumEvent& at, const std::array<double, 2>& film_cells,
                    const std::vector<double>& there, double largest) {
  const auto born = answer_of([&]() -> std::optional<BirthOfCycles> {
    if (there.empty()) return {};
    const auto system = at.make(film_cells);
    system->set_parameter(there[place] * at.scale);
    const core::Vector x = resampled(*system, at.system, at.system.gather(at.x));
    if (!solve::find_equilibrium(*system, x.get(), at.newton).converged) return {};
    return birth_of_cycles(*system, x.get(), there[frequency], at.scale, few_harmonics, largest);
  });
  return born ? born->curvature : unknown;
}

EquilibriumEvent::Rows shared(const EquilibriumEvent& at, const std::string& name, std::size_t n,
                              const EquilibriumEvent::Work& work) {
  if (at.share) return at.share(name, n, work);
  EquilibriumEvent::Rows out;
  for (std::size_t k = 0; k < n; ++k) out.push_back(work(k));
  return out;
}
std::vector<double> kept(const EquilibriumEvent& at, const std::string& name,
                         const std::function<std::vector<double>()>& work) {
  return shared(at, name, 1, [&](std::size_t) { return work(); }).front();
}

// Curvature, doubt and amplitudes; empty if there are no such cycles.
std::vector<double> birth_here(const EquilibriumEvent& at, double omega, int harmonics, double largest) {
  const auto found = answer_of([&]() -> std::optional<BirthOfCycles> {
    return largest > 0 ? birth_of_cycles(at.system, at.x, omega, at.scale, harmonics, largest)
                       : birth_of_cycles(at.system, at.x, omega, at.scale, harmonics);
  });
  if (!found) return {};
  std::vector<double> out{found->curvature, found->doubt(at.law.kinks)};
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

// Cycles at finite amplitudes reach over the kinks of a force that is smooth by pieces only. `there` are the numbers on
// the other meshes; these are asked as long as they can decide.
void decide_by_cycles(io::Bifurcation& b, const EquilibriumEvent& at, double omega,
                      const std::vector<std::vector<double>>& there) {
  if (!at.cycles || core::size_of(at.system.comm()) > 1) {
    b.criticality_by += "; cycles at amplitudes are asked of machines that stand on one rank only";
    return;
  }
  const std::vector<double> found = kept(at, "cycles", [&] { return birth_here(at, omega, few_harmonics, 0); });
  if (found.empty() || at.found.sensitivity == 0) {
    b.criticality_by += "; no cycles of 0.05 to 0.2 of a clearance, or smaller ones, were found";
    return;
  }
  const double curvature = found[0], smaller = found[1], largest = found.back();
  const std::vector<double> finer =
      kept(at, "cycles with more harmonics", [&] { return birth_here(at, omega, more_harmonics, largest); });
  double doubt = finer.empty() ? unknown : std::abs(finer[0] - curvature);
  Bars bars({curvature}, at.law);
  double of_meshes = 0;  // of whole directions
  for (std::size_t k = 0; k < at.meshes.size() && decided(curvature, smaller + doubt + of_meshes); ++k) {
    const FilmMesh& mesh = at.meshes[k];
    const double c = kept(at, fmt::format("cycles on mesh {}", k), [&] {
                       return std::vector<double>{curvature_on(at, mesh.factor, there[k], largest)};
                     }).front();
    bars.add(mesh.axis, mesh.spacing, {c});
    // A sign that changes with the mesh is none.
    if (!(c * curvature > 0)) doubt = std::max(doubt, std::abs(c - curvature));
    // Part of a direction does not show its error.
    if (k + 1 == at.meshes.size() || at.meshes[k + 1].axis != mesh.axis) of_meshes = bars[0].total();
  }
  const std::string before = b.criticality_by;
  for (const char* name : {"coefficient", "uncertainty"})
    b.more[fmt::format("lyapunov_{}", name)] = b.more[fmt::format("criticality_{}", name)];
  // Cycles that live where the equilibrium is unstable are supercritical.
  const double sign = at.found.sensitivity > 0 ? -1 : 1;
  put_criticality(
      b, sign * curvature, smaller + doubt + of_meshes, "supercritical", "subcritical",
      fmt::format("cycles at amplitudes {:.3g}, {:.3g}, {:.3g} of a clearance", found[2], found[3], found[4]));
  b.criticality_by += "; " + before;
}

}  // namespace

namespace {

std::vector<double> numbers_at(const EquilibriumEvent& at, const std::function<std::optional<Elsewhere>()>& locate) {
  return answer_of([&]() -> std::vector<double> {
    const auto there = locate();
    if (!there) return {};
    const bool hopf = at.found.event == solve::Event::hopf;
    if (!hopf) return {there->found->parameter, 0, there->found->quadratic};
    const double omega = there->found->critical.imag();
    return {there->found->parameter, omega, lyapunov(*there->system, there->x.get(), omega, steps_of(at.law).longer)};
  });
}

}  // namespace

std::vector<double> numbers_on(const EquilibriumEvent& at, const std::array<double, 2>& film_cells) {
  return numbers_at(at, [&] { return located_on(at, film_cells); });
}

void put_criticality(io::Bifurcation& b, double value, double uncertainty, const char* negative, const char* positive,
                     const std::string& by) {
  b.more["criticality_coefficient"] = value;
  b.more["criticality_uncertainty"] = uncertainty;
  b.criticality = "undetermined";
  if (!std::isfinite(value)) {
    b.criticality_by = by + " could not be computed";
  } else if (!std::isfinite(uncertainty)) {
    b.criticality_by = by + " has no error bar";
  } else if (!decided(value, uncertainty)) {
    b.criticality_by = by + " has an error bar that contains zero";
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
  std::vector<FilmMesh> meshes = at.meshes;
  if (hopf && at.cut) meshes.push_back(cut_shaft_mesh);
  const EquilibriumEvent::Rows elsewhere = shared(at, "on mesh", meshes.size(), [&](std::size_t k) {
    if (meshes[k].axis == Axis::shaft) return numbers_at(at, [&] { return located_on_cut_shaft(at); });
    return numbers_on(at, meshes[k].factor);
  });
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    bars.add(meshes[k].axis, meshes[k].spacing, elsewhere[k]);
    // A sign that changes with the mesh is none.
    const double c = elsewhere[k].empty() ? unknown : elsewhere[k][coefficient];
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
  if (hopf && at.law.piecewise && at.law.estimated && b.criticality == "undetermined")
    decide_by_cycles(b, at, omega, elsewhere);
  if (!hopf && here[coefficient] != 0)
    put_criticality(b, here[coefficient], error, "below", "above",
                    "second derivative of the parameter along the branch: the side on which the equilibria exist");
}

}  // namespace whirl::study
