#include "study/cycle/cycle_follower.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "study/bars/mesh_wave.hpp"
#include "study/bars/open_bore.hpp"
#include "study/bars/shaft_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/bifurcation.hpp"
#include "study/cycle/coexisting.hpp"
#include "study/make_plant.hpp"
#include "study/service_speeds.hpp"
#include "study/state_rows.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/solve/bifurcation/augmented_problem.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"

namespace whirl::study {

namespace {

// A multiplier so near to one is that of a self-excited cycle, or of a fold: no wave.
constexpr double trivial_within = 1e-6;
// Waves of the mesh whose multipliers are smaller mislead nobody.
constexpr double lightly_damped = 0.3;

}  // namespace

double distance_of_multiplier(std::complex<double> mu) {
  return std::abs(mu) - 1;
}

CycleFollower::CycleFollower(Context& context, CycleBranchOptions options)
    : context_(context),
      options_(std::move(options)),
      unit_(options_.parameter.range.unit),
      scale_(deck::number_to_si(1, unit_)),
      system_(make_system({1, 1})),
      record_(system_->places(), unit_, options_.multipliers),
      films_(system_->places()),
      nodes_(options_.nodes, unit_),
      shafts_(unit_),
      multiplier_bars_(multiplier_table(unit_)),
      keeps_located_(is_followed(context, context.results.summary().name)),
      limits_(context, context.results.summary().name) {
  const auto& range = options_.parameter.range;
  continuation_ = continuation_of(options_.parameter, scale_, 200, 30);
  continuation_.from = (options_.start ? options_.start->value : range.from) / scale_;
  continuation_.to = range.to / scale_;
  continuation_.max_points = options_.max_points;
  continuation_.picture_tolerance = options_.picture_tolerance;
  const bool adapt = options_.method == CycleBranchOptions::Method::collocation && options_.adapt_mesh;
  continuation_.adapt_every = adapt ? options_.adapt_every : 0;
  continuation_.location_tolerance = 1e-7 * std::max(std::abs(range.from), std::abs(range.to)) / scale_;
  newton_.tolerance = options_.tolerance;
  continuation_.newton = newton_;
  if (system_->parameter_is_speed())
    for (const double row :
         tabled_speeds(context.machine, range.from, range.to, 0,
                       static_cast<long>(system_->size()) * options_.intervals, context.results.summary(), unit_))
      continuation_.looks.push_back(row / scale_);
  if (const Layout shared = layout(); shared.shared)
    stored_ =
        core::make_vector(context_.comm, core::rank_of(shared.time) == 0 ? system_->local_size() : 0, PETSC_DETERMINE);
}

void CycleFollower::leave_from(const io::Group& flips, std::size_t which) {
  siblings_ = read_seeds(flips, stored());
  seed_ = siblings_.at(which);
}

void CycleFollower::begin_at(const io::Group& cycle) {
  first_ = read_cycle(cycle, stored());
}

SharedRows CycleFollower::stored() const {
  return {stored_.get(), stored_ ? layout().time : MPI_COMM_SELF};
}

std::unique_ptr<system::Plant> CycleFollower::make_system(const std::array<double, 2>& film_cells,
                                                          int shaft_parts) const {
  PlantRequest wanted{options_.unbalance, &options_.parameter};
  wanted.value = options_.start ? options_.start->value : options_.parameter.range.from;
  wanted.speed = options_.speed ? options_.speed->value : 0;
  wanted.film_cells = film_cells;
  wanted.shaft_parts = shaft_parts;
  return make_plant(layout(static_cast<std::size_t>(options_.intervals)).space, context_.machine, wanted);
}

solve::Stability cycle_stability(solve::PeriodicProblem& problem, system::Plant& system) {
  std::vector<std::complex<double>> values, waves;
  solve::Stability out;
  out.unknown = !has_answer([&] { values = problem.multipliers(); });
  if (out.unknown) return out;
  const bool asked = may_have_mesh_waves(system);
  const auto is_wave = [&](std::complex<double> mu) {
    std::optional<double> cells;
    (void)has_answer([&] {
      const Eigen::VectorXcd q = problem.multiplier_vector(mu);
      const std::vector<double> re = whole_of(problem.rows(), q.real()), im = whole_of(problem.rows(), q.imag());
      std::vector<std::complex<double>> shape;
      for (std::size_t k = 0; k < re.size(); ++k) shape.emplace_back(re[k], im[k]);
      cells = cells_per_wave(system, shape);
    });
    return cells.has_value();
  };
  for (const auto& mu : values)
    if (asked && mu.imag() >= 0 && std::abs(mu) > lightly_damped && std::abs(mu - 1.0) > trivial_within && is_wave(mu))
      waves.push_back(mu);
  std::erase_if(values, [&](auto mu) {
    return std::ranges::any_of(waves, [&](auto wave) { return mu == wave || mu == std::conj(wave); });
  });
  std::erase_if(waves, [](auto mu) { return distance_of_multiplier(mu) <= 0; });
  out = solve::make_stability(std::move(values), distance_of_multiplier);
  out.mesh_waves = std::move(waves);
  return out;
}

solve::Stability CycleFollower::stability_of(solve::PeriodicProblem& problem, system::Plant& system) const {
  solve::Stability out = cycle_stability(problem, system);
  // The trivial multiplier of a self-excited cycle says nothing.
  if (autonomous() && !out.values.empty()) {
    const auto apart = [](auto mu) { return std::abs(mu - 1.0); };
    const auto at = std::ranges::min_element(out.values, {}, apart) - out.values.begin();
    out.values.erase(out.values.begin() + at);
    out.distance.erase(out.distance.begin() + at);
  }
  return out;
}

CycleOrbit CycleFollower::orbit_of(Vec u) const {
  system_->set_parameter(problem_->gather(u).parameter);  // closer looks may have left it elsewhere
  return {problem_->orbit(u), problem_->orbit_scheme(), *system_};
}

double CycleFollower::room(const CycleOrbit& orbit) const {
  if (!options_.max_eccentricity) return std::numeric_limits<double>::infinity();
  return *options_.max_eccentricity - record_.eccentricity(orbit);
}

double CycleFollower::margin(const CycleOrbit& orbit) const {
  return std::min(films_.margin(least_films(orbit.cycle, orbit.system)), room(orbit));
}

void CycleFollower::add_margin(double parameter, const CycleOrbit& orbit) {
  if (films_.exists() || options_.max_eccentricity) margins_.add(parameter, margin(orbit));
}

void CycleFollower::on_point(const solve::BranchPoint& point, Vec u) {
  const solve::Cycle cycle = problem_->gather(u);
  const CycleOrbit orbit = orbit_of(u);
  record_.append(point, orbit, scale_);
  nodes_.append(point.parameter, orbit);
  limits_.see(point.monitors);
  if (!point.between) add_margin(point.parameter, orbit);
  report_between(last_ ? *last_ : cycle, cycle);
  watch(point, cycle);
  if (!point.between && (point.steps() + 1) % points_per_bar == 0 && !point.stability.values.empty())
    judge_multiplier({point.index, point.parameter, std::abs(point.stability.values[0]), cycle});
  last_ = cycle;
  if (!point.between) of_last_step_ = 1 + point.filled - std::exchange(filled_, point.filled);
  const double mu = point.stability.values.empty() ? 0 : std::abs(point.stability.values.front());
  context_.results.progress(fmt::format(
      "{}: point {}, {} {:.2f} {}{}, step {:.3g}, {} Newton iterations, {} intervals, |mu| {:.5f}, {:.1f} s",
      context_.results.summary().name, point.index + 1, options_.parameter.path, point.parameter, unit_,
      context_.results.left_over(point.parameter, continuation_.from, continuation_.to, unit_), point.step,
      point.newton_iterations, cycle.intervals(), mu, context_.results.seconds()));
}

std::vector<std::vector<double>> CycleFollower::drawn(Vec u) {
  const CycleOrbit orbit = orbit_of(u);
  auto axes = record_.drawn(orbit);
  const NodeRecord::NodeSizes nodes = nodes_.sizes(orbit);
  for (std::size_t k = 0; k < nodes.x.size(); ++k) axes.push_back({nodes.amplitude[k], nodes.x[k], nodes.y[k]});
  return axes;
}

// Cycles asked for at given parameters, solved there and not interpolated.
void CycleFollower::report_between(const solve::Cycle& a, const solve::Cycle& b) {
  for (const auto& wanted : options_.at) {
    const double p = wanted.value;
    // The branch starts and ends at its limits but for rounding.
    const double slack = 1e-10 * std::abs(p);
    if (p < std::min(a.parameter, b.parameter) - slack || p > std::max(a.parameter, b.parameter) + slack) continue;
    const std::string key = number_text(p, unit_);
    if (record_.reported(key)) continue;
    const double w = b.parameter == a.parameter ? 1 : (p - a.parameter) / (b.parameter - a.parameter);
    solve::Cycle guess = b;
    guess.x = (1 - w) * a.on(problem_->scheme(), b.mesh).x + w * b.x;
    guess.parameter = p;
    core::Vector u = problem_->scatter(guess), row = core::duplicate(u.get());
    solve::parameter_row(*problem_, row.get());
    const auto result = solve::newton(*problem_, u.get(), row.get(), p / scale_, newton_);
    if (!result.converged) continue;
    problem_->linearise(u.get(), row.get());
    report(key, u.get());
  }
}

void CycleFollower::report(const std::string& key, Vec u) {
  io::StudySummary own;
  const solve::Cycle cycle = problem_->gather(u);
  const CycleOrbit orbit = orbit_of(u);
  record_.report(key, orbit, stability_of(*problem_, *system_), own);
  shafts_.append("at", cycle.parameter / scale_, orbit);
  SummaryBars bars(own, law());
  const std::vector<OtherMesh> all = meshes();
  const Rows rows = on_each(all, fmt::format("report {} on mesh", key), [&](const OtherMesh& mesh) {
    io::StudySummary there;
    const auto answer = [&] {
      if (const auto other = corrected_on(mesh, cycle))
        record_.report(key, other->orbit(other->u.get()), stability_of(*other->problem, *other->system), there);
    };
    if (!has_answer(answer)) there = {};
    return bars.row(there);
  });
  for (std::size_t k = 0; k < all.size(); ++k) bars.add(all[k].axis, all[k].spacing, rows[k]);
  bars.write(newton_.tolerance);
  for (const auto& [name, q] : own.values) context_.results.summary().set(name, q.value, q.unit, q.more);
}

// The flip that a branch of twice the period ran back into lies between its last cycle and where the next step landed.
void CycleFollower::close_at_flip(double landed) {
  // Other methods keep their unknowns, not the orbit.
  if (record_.points() == 0 || options_.method != CycleBranchOptions::Method::collocation) return;
  const auto [low, high] = std::minmax({record_.last_parameter(), landed});
  const FlipSeed* only = nullptr;
  for (const FlipSeed& s : siblings_) {
    const double p = s.cycle.parameter / scale_;
    if (p < low || p > high || p == seed_->cycle.parameter / scale_) continue;
    if (only) return;
    only = &s;
  }
  if (!only) return;
  solve::Cycle simple = only->cycle;  // run through once it shows all that twice would
  simple.period *= 2;
  record_.close({std::move(simple), problem_->orbit_scheme(), *system_}, scale_);
}

StudyResult CycleFollower::run() {
  std::optional<solve::Restart> restart = restore();
  const bool restored = restart.has_value();
  core::Vector u;
  if (!restart) {
    problem_ = make_problem(*system_, options_.period, solve::uniform_mesh(options_.intervals), 1);
    if (seed_)
      restart = start_at_flip();
    else if (autonomous())
      restart = start_at_hopf();
    else
      u = start(*problem_);
    if (restart) record_.begin(orbit_of(restart->u.get()), scale_);
  }
  if (!restored) leaves_ = may_return();
  put_groups(context_.results.summary(), system_->groups());
  solve::BranchCallbacks callbacks;
  callbacks.cycles = true;
  callbacks.stability = [this](Vec) { return stability_of(*problem_, *system_); };
  callbacks.on_point = [this](const solve::BranchPoint& p, Vec v) { on_point(p, v); };
  callbacks.on_event = [this](const solve::LocatedEvent& e, Vec v) { on_event(e, v); };
  callbacks.drawn = [this](Vec v) { return drawn(v); };
  if (!limits_.empty()) callbacks.monitors = [&](Vec v, Vec) { return limits_.of(orbit_of(v)); };
  callbacks.on_zero = [this](const solve::LocatedZero& zero, Vec v) {
    if (zero.located) limits_.pass(zero.monitor, problem_->gather(v));
  };
  if (problem_->has_adjoint())
    callbacks.refine = [this](const solve::LocatedEvent& e, Vec v, Vec t) {
      return solve::refine(*problem_, e, v, t, newton_);
    };
  // The branch has touched, as it was asked to, or its film has become too thin.
  bool contact = false;
  if (films_.exists() || options_.max_eccentricity) {
    callbacks.limit = [this](Vec v) { return margin(orbit_of(v)); };
    callbacks.why = [this, &contact](Vec v) {
      const CycleOrbit orbit = orbit_of(v);
      const std::vector<double> films = least_films(orbit.cycle, *system_);
      contact = room(orbit) <= films_.margin(films);
      return contact ? fmt::format("the eccentricity reaches {:.6g} (max_eccentricity)", *options_.max_eccentricity)
                     : films_.reason(films);
    };
  }
  callbacks.on_suspicion = [this](const solve::Suspicion& s) {
    context_.results.summary().suspected.push_back({s.from, s.to, unit_, s.reason});
  };
  std::size_t suspicions = context_.results.summary().suspected.size();  // up to the last point
  callbacks.checkpoint = [this, &suspicions](const solve::ResumePoint& at, Vec v, Vec t) {
    save(at, v, t);
    if (!returned_) suspicions = context_.results.summary().suspected.size();
    return !returned_;
  };
  const solve::BranchEnd end =
      solve::follow_branch(*problem_, std::move(u), continuation_, callbacks, std::move(restart));

  auto& results = context_.results;
  auto& group = results.group();
  judge_nearest();
  if (returned_) {
    // The step that showed the return landed on what the branch was born of, or beyond it on the branch already
    // followed.
    for (int k = 0; k < of_last_step_; ++k) {
      record_.drop_last();
      nodes_.drop_last();
    }
    std::erase_if(changes_, [this](const auto& c) { return c.after + 1 >= static_cast<int>(record_.points()); });
    if (seed_) close_at_flip(end.parameter);
    results.summary().suspected.resize(suspicions);
    group.set("end", seed_ ? "the cycle of half the period, at a flip" : "an equilibrium, at a Hopf point");
  } else if (contact) {
    group.set("end", "contact");
  }
  record_.write(group, false);
  nodes_.write(group);
  shafts_.write(group);
  multiplier_bars_.write(group.child("multiplier_bars"));
  record_.write_orbits(group.child("orbits"), options_.orbits);
  put_places(group, context_.machine, *system_);
  put_bifurcations(group, results.summary().bifurcations);
  put_changes(group.child("changes"), changes_, unit_);
  group.set("parameter", options_.parameter.path);
  group.set("parameter_unit", unit_);
  group.set("picture_tolerance", options_.picture_tolerance);
  group.set("unbalance", fmt::format("{}", fmt::join(options_.unbalance, ", ")));
  group.set("period_turns", options_.period);
  results.summary().points = end.points - (returned_ ? of_last_step_ : 0);
  if (options_.follow_flips) write_seeds(group.child("flips"), seeds_, stored());
  if (keeps_located_) write(group.child("located"), located_);
  limits_.write(group, stored());
  if (returned_) results.summary().set("returned", end.parameter, unit_);
  if (end.limited && last_)
    put_contact(results.summary(), end.parameter, unit_, end.bracket, law(), contacts_there(*last_, end.parameter));
  BranchVerdict verdict = record_.verdict();
  for (const BranchChange& c : changes_) verdict.add(c);
  record_.warn_of_waves(results.summary());
  record_.warn_of_unknown(results.summary());
  for (const auto& wanted : options_.at)
    if (const int times = record_.passes(wanted.value / scale_); times > 1) {
      const std::string key = number_text(wanted.value, unit_);
      results.summary().warnings.push_back(fmt::format(
          "the branch passes {} {} {} times: at.{} is the first of these cycles, the table of the branch has "
          "the others beside it",
          key, unit_, times, key));
    }
  doubt(verdict);
  conclude(results.summary(), verdict, kind(), unit_);
  warn_of_shaft_mesh(results.summary(), context_.machine, context_.layout);
  if (OpenBores bores(context_.machine); !bores.empty()) {
    record_.for_samples(
        [&](std::size_t place, double x, double y, double parameter) { bores.see(place, x, y, parameter); });
    bores.warn(results.summary(), unit_);
  }
  if (options_.parameter.deflation)
    put_solutions(
        group, results.summary(), [this] { return coexisting(); }, stored());
  return results.finish(returned_ || (end.limited && contact) ? "completed" : branch_status(end, unit_),
                        end.points > 0);
}

}  // namespace whirl::study
