#include "study/equilibrium/equilibrium_branch.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "study/added_branch.hpp"
#include "study/bars/beyond.hpp"
#include "study/bars/branch_brief.hpp"
#include "study/bars/film_limit.hpp"
#include "study/bars/film_mesh.hpp"
#include "study/bars/mesh_wave.hpp"
#include "study/bars/open_bore.hpp"
#include "study/bars/shaft_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/bifurcation.hpp"
#include "study/branch_state.hpp"
#include "study/brief.hpp"
#include "study/common.hpp"
#include "study/cycle/coexisting.hpp"
#include "study/cycle/cycle_record.hpp"
#include "study/equilibrium/equilibrium_event.hpp"
#include "study/layout.hpp"
#include "study/located.hpp"
#include "study/locus/curve_points.hpp"
#include "study/make_plant.hpp"
#include "study/pieces.hpp"
#include "study/service_speeds.hpp"
#include "study/state_rows.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/table.hpp"
#include "whirl/solve/bifurcation/augmented_problem.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::study {

using core::check;

std::unique_ptr<system::Plant> plant_of(const Context& context, const EquilibriumBranchOptions& o,
                                        const std::array<double, 2>& film_cells, int shaft_parts) {
  PlantRequest wanted{{}, &o.parameter};
  wanted.shaft_parts = shaft_parts;
  wanted.value = o.parameter.range.from;
  wanted.speed = o.speed ? o.speed->value : 0;
  wanted.film_cells = film_cells;
  return make_plant(plan(context, Sharing::meshes).space, context.machine, wanted);
}

solve::ContinuationOptions continuation_of(const EquilibriumBranchOptions& o) {
  const auto& range = o.parameter.range;
  const double scale = deck::number_to_si(1, range.unit);
  solve::ContinuationOptions out = continuation_of(o.parameter, scale, 100, 25);
  out.from = range.from / scale;
  out.to = range.to / scale;
  out.max_points = o.max_points;
  out.picture_tolerance = o.picture_tolerance;
  out.location_tolerance = 1e-6 * std::max(std::abs(range.from), std::abs(range.to)) / scale;
  out.newton.max_iterations = 20;
  return out;
}

namespace {

// Where the branch comes to its contact at `place` on other film meshes; `points` are some of its equilibria, the last
// one among them.
std::vector<Sample> contacts_there(const Context& context, const Layout& layout, Pieces& pieces,
                                   const EquilibriumBranchOptions& options, const system::Plant& system,
                                   const std::vector<CurvePoint>& points, double place, double scale,
                                   const MarginSlope& here, const solve::NewtonOptions& newton) {
  const std::vector<FilmMesh> meshes = film_meshes(context.machine, context.layout);
  const auto on = [&](std::size_t k) {
    const auto other = plant_of(context, options, meshes[k].factor);
    const FilmLimit films(other->places());
    core::Vector x;  // the solution found last
    const auto margin_from = [&](core::Vector trial) {
      double margin = unknown;
      (void)has_answer([&] {
        if (!solve::find_equilibrium(*other, trial.get(), newton).converged) return;
        margin = films.margin(other->observe(trial.get()).film_thickness);
        x = std::move(trial);
      });
      return margin;
    };
    return contact_there(place, here, [&](double parameter) {
      other->set_parameter(parameter * scale);
      double margin = unknown;
      if (x) {
        core::Vector trial = core::duplicate(x.get());
        check(VecCopy(x.get(), trial.get()));
        margin = margin_from(std::move(trial));
      }
      if (std::isfinite(margin)) return margin;
      // Where this mesh touches, that solution is none of the other's: the nearest of the branch may be.
      const auto& nearest = *std::min_element(points.begin(), points.end(), [&](const auto& a, const auto& b) {
        return std::abs(a.cycle.parameter - parameter) < std::abs(b.cycle.parameter - parameter);
      });
      const Eigen::MatrixXd& known = nearest.cycle.x;
      return margin_from(resampled(*other, system, std::vector<double>(known.data(), known.data() + known.size())));
    });
  };
  std::vector<Sample> out;
  for (const double there : distribute(layout, meshes.size(), on, pieces, "contact on mesh", no_trail))
    out.push_back({meshes[out.size()].axis, meshes[out.size()].spacing, there});
  return out;
}

// The threshold of a speed; of another parameter every limit, by the side that is stable.
void put_limits(io::StudySummary& summary, const BranchVerdict& verdict, const std::vector<BranchChange>& changes,
                double scale, const std::string& unit, bool of_speed) {
  const auto put = [&](const std::string& name, const BranchChange& c, const std::string& frequency) {
    if (c.bifurcation < 0) return;
    const auto& b = summary.bifurcations[static_cast<std::size_t>(c.bifurcation)];
    summary.set(name, b.value * scale, unit, {{"uncertainty", b.uncertainty * scale}});
    if (const auto omega = b.more.find("whirl_frequency_rad_s"); omega != b.more.end())
      summary.set(frequency, omega->second, "rad/s",
                  {{"uncertainty", more_of(b, "uncertainty_whirl_frequency_rad_s")}});
  };
  const std::vector<StabilityLimit> limits = verdict.limits();
  if (of_speed) {
    if (const int k = threshold_among(limits); k >= 0)
      put("threshold", changes[static_cast<std::size_t>(k)], "whirl_frequency");
    return;
  }
  std::array<int, 2> count{};
  for (const StabilityLimit& l : limits) {
    const std::string name =
        fmt::format("stable_{}.{}", l.stable_below ? "below" : "above", ++count[l.stable_below ? 0 : 1]);
    put(name, changes[l.change], name + ".whirl_frequency");
  }
}

// Follows the branch from `first`, or from the equilibrium that is easiest to find.
StudyResult follow_equilibria(Context& context, const EquilibriumBranchOptions& options, const solve::Cycle* first) {
  const auto& range = options.parameter.range;
  const std::string unit = range.unit;
  const double scale = deck::number_to_si(1, unit);
  solve::ContinuationOptions continuation = continuation_of(options);

  const Layout layout = plan(context, Sharing::meshes);
  const auto system = plant_of(context, options);
  const double state_weight = state_weight_of(continuation);
  solve::EquilibriumProblem problem(*system, scale, state_weight);
  core::Vector u = problem.make_unknown(), x = core::make_vector(system->comm(), system->local_size(), PETSC_DETERMINE);
  if (first) {
    x = state_in(*system, *first);
  } else if (system->parameter_is_speed()) {
    Walker walker(*system);
    check(VecCopy(walker.at(range.from), x.get()));
  } else {
    x = first_guess(*system);
    if (problem::parts_of(system->fields()).size() > 0) {
      system->set_parameter(range.from);
      if (!find_rest(*system, x.get()).converged) x = first_guess(*system);  // the branch says why
    }
  }
  problem.from_state(x.get(), range.from, u.get());
  if (system->parameter_is_speed())
    for (const double row :
         tabled_speeds(context.machine, range.from, range.to, 0, system->size(), context.results.summary(), unit))
      continuation.looks.push_back(row / scale);

  const system::ShownPlaces places = system->places();
  io::Table table(
      {{"parameter", unit, "parameter of the branch"},
       {"stable", "1", "1 if no eigenvalue has a positive real part"},
       {"unstable_count", "1", "eigenvalues with positive real part"},
       {"undamped_count", "1", "eigenvalues whose real part is rounding"},
       {"step", unit, "arclength from the previous point"},
       {"leading_real", "1/s", "real part of the least stable eigenvalue"},
       {"leading_imag", "rad/s", "its imaginary part"},
       io::Table::wide("x", places.unit, places.text, places.names),
       io::Table::wide("y", places.unit, places.text, places.names),
       io::Table::wide("film", places.unit,
                       "smallest film thickness, at mid-plane of films that do not tilt, not a number without a film",
                       places.names)});
  std::vector<Located> located;  // one for each bifurcation of the summary
  std::vector<BranchChange> changes;
  BranchVerdict verdict;
  const FilmLimit films(places);
  OpenBores bores(context.machine);
  MarginSlope margins;
  SpreadPoints spread(8);  // for the searches for a contact
  double arclength = 0;
  MissedModes missed;
  MeshWaves waves;
  auto& results = context.results;
  put_groups(results.summary(), system->groups());
  solve::BranchCallbacks callbacks;
  // A resumed branch is followed anew: Newton's method costs little beside the eigenvalues, which are kept.
  Pieces pieces(results, context.resume);
  int looks = 0;
  callbacks.stability = [&](Vec v) {
    // The place tells them apart where a step was taken otherwise than before: rounded, as decisions are.
    const double place = solve::last_entry(problem.comm(), v);
    return pieces.value(fmt::format("look {} at {:.10g}", ++looks, place), [&] {
      problem.to_state(v, x.get());
      return equilibrium_stability(*system, x.get());
    });
  };
  callbacks.on_point = [&](const solve::BranchPoint& point, Vec v) {
    problem.to_state(v, x.get());
    system->set_parameter(point.parameter * scale);  // closer looks may have left it elsewhere
    std::vector<double> px, py;
    const system::Observed seen = system->observe(x.get());
    for (const auto& j : seen.shown) {
      bores.see(px.size(), j.position[0], j.position[1], point.parameter);
      px.push_back(j.position[0]);
      py.push_back(j.position[1]);
    }
    const auto& s = point.stability;
    if (!point.between) margins.add(point.parameter, films.margin(seen.film_thickness));
    arclength += point.step;
    if (films.exists() && !point.between)
      spread.add(
          {as_cycle(*system, x.get(), point.parameter), {}, 0, arclength, static_cast<std::size_t>(point.index)});
    verdict.add(point.parameter, class_of(s), s.unstable());
    missed.add(s.missed);
    waves.add(point.parameter, s.mesh_waves);
    if (!s.mesh_waves.empty()) verdict.unresolved(point.index);
    std::complex<double> leading = s.values.empty() ? 0.0 : s.values.front();
    if (class_of(s) == StabilityClass::undamped) leading.real(0);  // the rest is rounding
    table.append({{point.parameter},
                  {s.unstable() == 0 ? 1.0 : 0.0},
                  {static_cast<double>(s.unstable())},
                  {static_cast<double>(s.neutral)},
                  {point.step},
                  {leading.real()},
                  {std::abs(leading.imag())},
                  px,
                  py,
                  film_column(seen.film_thickness, places.names.size())});
    results.progress(fmt::format(
        "{}: point {}, {} {:.2f} {}{}, step {:.3g}, {} Newton iterations, leading eigenvalue {:.3f} {:+.2f}i, {:.1f} s",
        results.summary().name, point.index + 1, options.parameter.path, point.parameter, unit,
        results.left_over(point.parameter, continuation.from, continuation.to, unit), point.step,
        point.newton_iterations, leading.real(), leading.imag(), results.seconds()));
  };
  std::function<std::unique_ptr<system::Plant>()> cut;
  if (has_shaft_mesh(context.machine, context.layout)) cut = [&] { return plant_of(context, options, {1, 1}, 2); };
  callbacks.on_event = [&](const solve::LocatedEvent& found, Vec v) {
    const bool asked = wanted(found.event, options.detect);
    changes.push_back(change_at(found, asked ? static_cast<int>(results.summary().bifurcations.size()) : -1));
    if (!asked) return;
    io::Bifurcation b = bifurcation_at(type_of(found.event), found.parameter, options.parameter.path, unit,
                                       context.machine, {}, *system);
    problem.to_state(v, x.get());
    const std::string event = fmt::format("event {}", results.summary().bifurcations.size() + 1);
    pieces.complete(event, b, [&] {
      describe(b, {*system, x.get(), found, scale, state_weight, continuation.newton,
                   film_meshes(context.machine, context.layout), law_of(context.machine, context.layout),
                   [&](const auto& cells) { return plant_of(context, options, cells); },
                   [&](const auto& name, std::size_t n, const auto& work) {
                     return distribute_numbers(layout, n, work, pieces, event + " " + name);
                   },
                   cut, !layout.large});
    });
    put_counts(b, changes.back());
    results.summary().bifurcations.push_back(b);
    if (is_followed(context, results.summary().name)) {
      problem.to_state(v, x.get());
      located.push_back({found.event, found.critical, as_cycle(*system, x.get(), found.parameter * scale, b.period_s),
                         found.sensitivity});
    }
  };
  callbacks.drawn = [&](Vec v) {
    problem.to_state(v, x.get());
    std::vector<std::vector<double>> axes;
    for (const auto& j : system->shown_at(x.get())) axes.push_back({j.position[0], j.position[1]});
    return axes;
  };
  callbacks.refine = [&](const solve::LocatedEvent& e, Vec v, Vec t) {
    return solve::refine(*system, problem, e, v, t,
                         to_refine(continuation.newton, law_of(context.machine, context.layout)));
  };
  if (films.exists()) {
    const auto thickness = [&](Vec v) {
      problem.to_state(v, x.get());
      return system->observe(x.get()).film_thickness;
    };
    callbacks.limit = [&, thickness](Vec v) { return films.margin(thickness(v)); };
    callbacks.why = [&, thickness](Vec v) { return films.reason(thickness(v)); };
  }
  callbacks.on_suspicion = [&](const solve::Suspicion& s) {
    results.summary().suspected.push_back({s.from, s.to, unit, s.reason});
  };
  const solve::BranchEnd end = solve::follow_branch(problem, std::move(u), continuation, callbacks);
  if (options.parameter.deflation) {
    system->set_parameter(range.from);
    const auto others = put_solutions(results.group(), results.summary(), [&] {
      return coexisting_equilibria(*system, *options.parameter.deflation, continuation.newton);
    });
    for (std::size_t k = 0; k < others.size(); ++k) {
      const auto shown = system->shown(others[k].x.data());
      for (std::size_t place = 0; place < shown.size(); ++place)
        for (std::size_t d = 0; d < 2; ++d)
          results.summary().set(fmt::format("solution.{}.{}.{}", k + 2, places.names[place], d == 0 ? "x" : "y"),
                                shown[place].position[d], places.unit);
    }
  }

  auto& group = results.group();
  if (is_followed(context, results.summary().name)) write_located(group.child("located"), located);
  table.write(group.child("branch"));
  put_places(group, context.machine, *system);
  put_bifurcations(group, results.summary().bifurcations);
  group.set("parameter", options.parameter.path);
  group.set("parameter_unit", unit);
  group.set("picture_tolerance", options.picture_tolerance);
  const std::string si_unit =
      deck::same_kind(unit, "rad/s") ? "rad/s" : parameter_unit(context.machine, options.parameter.path);
  put_changes(group.child("changes"), changes, unit);
  for (const BranchChange& c : changes) verdict.add(c);
  const bool rotor = system::is_rotor(context.machine);
  const bool linear = rotor && std::ranges::all_of(context.machine.bearings, [](const system::Bearing& b) {
                        return film::facts(b.film).coefficients;
                      });
  conclude(results.summary(), verdict, {false, false, 1, rotor, linear}, unit);
  put_limits(results.summary(), verdict, changes, scale, si_unit, system->parameter_is_speed());
  if (end.limited)
    put_contact(results.summary(), end.parameter, unit, end.bracket, law_of(context.machine, context.layout),
                contacts_there(context, layout, pieces, options, *system, spread.all(), end.parameter, scale, margins,
                               continuation.newton));
  warn_of_shaft_mesh(results.summary(), context.machine, context.layout);
  missed.warn(results.summary());
  waves.warn(results.summary(), unit);
  bores.warn(results.summary(), unit);
  results.summary().points = end.points;
  return results.finish(branch_status(end, unit), end.points > 0);
}

io::Brief brief_of_equilibria(const StudyResult& result) {
  const io::StudySummary& s = result.summary;
  io::Brief brief = brief_of_branch(s, "equilibrium");
  brief.tables.push_back(table_of_ends(result.group));
  if (const io::Quantity contact = Values(s)["contact"]; std::isfinite(contact.value))
    brief.sentences.push_back(
        fmt::format("The branch ends at {}, where a film becomes too thin.", io::reading(contact)));
  return brief;
}

}  // namespace

bool EquilibriumBranch::may_add(std::string_view other) const {
  return options.parameter.deflation && number_in(other, io::plain_name(name_of_solution(name(), 2))).has_value();
}

StudyResult EquilibriumBranch::run(Context& context) {
  return follow_equilibria(context, options, nullptr);
}

io::Brief EquilibriumBranch::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  return brief_of_equilibria(result);
}

std::vector<std::unique_ptr<Study>> EquilibriumBranch::further(const io::Group& result) const {
  std::vector<std::unique_ptr<Study>> beside;
  EquilibriumBranchOptions own = options;
  own.parameter.deflation.reset();
  for (std::size_t k = 2; const auto& first : solutions_in(result))
    beside.push_back(std::make_unique<AddedBranch>(
        key, name_of_solution(name(), k++),
        [own, first = read_cycle(first)](Context& context) { return follow_equilibria(context, own, &first); },
        brief_of_equilibria));
  return beside;
}

}  // namespace whirl::study
