#include "whirl/study/equilibrium_branch.hpp"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "bifurcation.hpp"
#include "common.hpp"
#include "groups.hpp"
#include "located.hpp"
#include "make_plant.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/table.hpp"
#include "whirl/solve/augmented_problem.hpp"
#include "whirl/solve/equilibrium.hpp"
#include "whirl/solve/normal_form.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::study {
namespace {

using core::check;

std::unique_ptr<system::Plant> make_system(const Context& context, const EquilibriumBranchOptions& o, bool half_film) {
  PlantRequest wanted{{}, &o.parameter};
  wanted.value = o.parameter.range.from;
  wanted.speed = o.speed ? o.speed->value : 0;
  wanted.half_film = half_film;
  return make_plant(Groups::split(context.comm, context.machine).space, context.machine, wanted);
}

// The differences behind the coefficient must not decide its sign: a film with kinks has no third derivative.
void set_lyapunov(io::Bifurcation& b, system::Plant& system, Vec x, double omega) {
  b.criticality_by = "undetermined: the first Lyapunov coefficient depends on the step of its differences";
  const double fine = solve::hopf_coefficient(system, x, omega, 1),
               coarse = solve::hopf_coefficient(system, x, omega, 8);
  if (!(std::abs(fine - coarse) < 0.2 * std::min(std::abs(fine), std::abs(coarse)))) return;
  b.criticality = fine < 0 ? "supercritical" : "subcritical";
  b.criticality_by = "first Lyapunov coefficient (Kuznetsov 2004, 5.39)";
}

}  // namespace

StudyResult EquilibriumBranch::run(Context& context) {
  const auto& range = options.parameter.range;
  const std::string unit = range.unit;
  const double scale = deck::number_to_si(1, unit), width = std::abs(range.to - range.from) / scale;
  solve::ContinuationOptions continuation;
  continuation.from = range.from / scale;
  continuation.to = range.to / scale;
  const auto& step = options.parameter.step;
  continuation.initial_step = step ? step->initial.value / scale : width / 100;
  continuation.min_step = step ? step->min.value / scale : width / 1e6;
  continuation.max_step = step ? step->max.value / scale : width / 25;
  continuation.beta_1 = options.parameter.beta_1;
  continuation.beta_2 = options.parameter.beta_2;
  continuation.max_points = options.max_points;
  continuation.location_tolerance = 1e-6 * std::max(std::abs(range.from), std::abs(range.to)) / scale;
  continuation.newton.max_iterations = 20;

  const auto system = make_system(context, options, false);
  // A change of the root mean square state by half a clearance counts as one longest step.
  solve::EquilibriumProblem problem(*system, scale, std::pow(continuation.max_step / 0.5, 2));
  core::Vector u = problem.make_unknown(), x = core::make_vector(system->comm(), system->local_size(), PETSC_DETERMINE);
  if (system->parameter_is_speed()) {
    Walker walker(*system);
    check(VecCopy(walker.at(range.from), x.get()));
  } else {
    x = system->guess();
  }
  problem.from_state(x.get(), range.from, u.get());

  const system::Places places = system->places();
  io::Table table({{"parameter", unit, "parameter of the branch"},
                   {"stable", "1", "1 if no eigenvalue has a positive real part"},
                   {"unstable_count", "1", "eigenvalues with positive real part"},
                   {"step", unit, "arclength from the previous point"},
                   {"leading_real", "1/s", "real part of the least stable eigenvalue"},
                   {"leading_imag", "rad/s", "its imaginary part"},
                   {"x", places.unit, places.text, {places.names.size()}},
                   {"y", places.unit, places.text, {places.names.size()}}});
  std::vector<Located> located;  // one for each bifurcation of the summary
  auto& results = context.results;
  put_groups(results.summary(), system->groups());
  solve::BranchCallbacks callbacks;
  callbacks.stability = [&](Vec v) {
    problem.to_state(v, x.get());
    return equilibrium_stability(*system, x.get());
  };
  callbacks.on_point = [&](const solve::BranchPoint& point, Vec v) {
    problem.to_state(v, x.get());
    std::vector<double> px, py;
    for (const auto& j : system->shown(system->gather(x.get()).data())) {
      px.push_back(j.position[0]);
      py.push_back(j.position[1]);
    }
    const auto& s = point.stability;
    const std::complex<double> leading = s.values.empty() ? 0.0 : s.values.front();
    table.append({{point.parameter},
                  {s.unstable() == 0 ? 1.0 : 0.0},
                  {static_cast<double>(s.unstable())},
                  {point.step},
                  {leading.real()},
                  {std::abs(leading.imag())},
                  px,
                  py});
    results.progress(fmt::format(
        "{}: point {}, {} {:.2f} {}, step {:.3g}, {} Newton iterations, leading eigenvalue {:.3f} {:+.2f}i, {:.1f} s",
        results.summary().name, point.index + 1, options.parameter.path, point.parameter, unit, point.step,
        point.newton_iterations, leading.real(), leading.imag(), results.seconds()));
  };
  callbacks.on_event = [&](const solve::LocatedEvent& found, Vec v) {
    if (!wanted(found.event, options.detect)) return;
    io::Bifurcation b = bifurcation_at(type_of(found.event), found.parameter, options.parameter.path, unit,
                                       context.machine, {}, *system);
    b.uncertainty = found.bracket;
    const double omega = std::abs(found.critical.imag());
    if (found.event == solve::Event::hopf) {
      b.period_s = 2 * std::numbers::pi / omega;
      b.more["whirl_frequency_rad_s"] = omega;
      b.more["whirl_frequency_rpm"] = omega * 30 / std::numbers::pi;
    }
    // The same equilibrium on the halved film mesh: how far the border of stability moves.
    if (found.located && found.sensitivity != 0 && system->has_film_mesh()) {
      const auto coarse = make_system(context, options, true);
      coarse->set_parameter(found.parameter * scale);
      core::Vector xc = core::make_vector(coarse->comm(), coarse->local_size(), PETSC_DETERMINE);
      problem.to_state(v, x.get());
      {
        const std::vector<double> whole = coarse->resampled(*system, system->gather(x.get()).data());
        PetscInt begin = 0;
        check(VecGetOwnershipRange(xc.get(), &begin, nullptr));
        const core::WriteArray to(xc.get());
        for (PetscInt i = 0; i < to.size(); ++i) to[i] = whole[static_cast<std::size_t>(begin + i)];
      }
      if (solve::find_equilibrium(*coarse, xc.get(), continuation.newton).converged) {
        const auto s = equilibrium_stability(*coarse, xc.get());
        double nearest = std::numeric_limits<double>::infinity(), distance = 0;
        for (std::size_t k = 0; k < s.values.size(); ++k) {
          const double apart = std::abs(std::abs(s.values[k].imag()) - omega) + std::abs(s.values[k].real());
          if (apart < nearest) {
            nearest = apart;
            distance = s.distance[k];
          }
        }
        b.more["uncertainty_film_mesh"] = std::abs(distance / found.sensitivity);
        b.uncertainty += b.more["uncertainty_film_mesh"];
      }
    }
    if (found.event == solve::Event::fold && found.quadratic != 0) {
      b.criticality = found.quadratic > 0 ? "above" : "below";
      b.criticality_by = "second derivative of the parameter along the branch: the side on which the equilibria exist";
    }
    if (found.event == solve::Event::hopf && found.located) {
      problem.to_state(v, x.get());
      system->set_parameter(found.parameter * scale);
      set_lyapunov(b, *system, x.get(), omega);
    }
    results.summary().bifurcations.push_back(b);
    if (is_followed(context, name())) {
      problem.to_state(v, x.get());
      const std::vector<double> whole = system->gather(x.get());
      located.push_back({found.event,
                         found.critical,
                         {{0, 1},
                          Eigen::Map<const Eigen::VectorXd>(whole.data(), static_cast<Eigen::Index>(whole.size())),
                          b.period_s,
                          found.parameter * scale}});
    }
  };
  callbacks.refine = [&](const solve::LocatedEvent& e, Vec v, Vec t) {
    return solve::refine(*system, problem, e, v, t, continuation.newton);
  };
  callbacks.on_suspicion = [&](const solve::Suspicion& s) {
    results.summary().suspected.push_back({s.from, s.to, unit, s.reason});
  };
  const solve::BranchEnd end = solve::follow_branch(problem, std::move(u), continuation, callbacks);

  auto& group = results.group();
  if (is_followed(context, name())) write_located(group.child("located"), located);
  table.write(group.child("branch"));
  put_places(group, context.machine, *system);
  put_bifurcations(group, results.summary().bifurcations);
  group.set("parameter", options.parameter.path);
  group.set("parameter_unit", unit);
  int k = 0;
  for (const auto& b : results.summary().bifurcations)
    if (b.type == io::BifurcationType::hopf && k++ == 0) {
      results.summary().set(
          "threshold", b.value * scale,
          deck::same_kind(unit, "rad/s") ? "rad/s" : parameter_unit(context.machine, options.parameter.path));
      results.summary().set("whirl_frequency", b.more.at("whirl_frequency_rad_s"), "rad/s");
    }
  results.summary().points = end.points;
  return results.finish(branch_status(end, unit), end.points > 0);
}

}  // namespace whirl::study
