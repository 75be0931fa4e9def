#include "cycle_follower.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::study {
namespace {

using core::check;

Event event_of(solve::Event e) {
  switch (e) {
    case solve::Event::fold:
      return Event::fold;
    case solve::Event::hopf:
      return Event::hopf;
    case solve::Event::cyclic_fold:
      return Event::cyclic_fold;
    case solve::Event::flip:
      return Event::flip;
    case solve::Event::neimark_sacker:
      return Event::neimark_sacker;
    default:
      return Event::branch_point;
  }
}

}  // namespace

double distance_of_multiplier(std::complex<double> mu) {
  return std::abs(mu) - 1;
}

void write_seeds(io::Group& group, const std::vector<FlipSeed>& seeds) {
  group.set("count", static_cast<int>(seeds.size()));
  for (std::size_t k = 0; k < seeds.size(); ++k) {
    auto& g = group.child(fmt::format("{}", k + 1));
    write_cycle(g.child("cycle"), seeds[k].cycle);
    write_cycle(g.child("direction"), seeds[k].direction);
  }
}

std::vector<FlipSeed> read_seeds(const io::Group& group) {
  std::vector<FlipSeed> seeds;
  for (std::int64_t k = 1; k <= group.integer("count"); ++k) {
    const auto& g = group.group(fmt::format("{}", k));
    seeds.push_back({read_cycle(g.group("cycle")), read_cycle(g.group("direction"))});
  }
  return seeds;
}

CycleFollower::CycleFollower(Context& context, CycleBranchOptions options, std::optional<FlipSeed> seed)
    : context_(context),
      options_(std::move(options)),
      seed_(std::move(seed)),
      unit_(options_.parameter.range.unit),
      scale_(deck::number_to_si(1, unit_)),
      record_(names_of_bearings(context.machine), clearances_of_bearings(context.machine), unit_,
              options_.multipliers) {
  const auto& range = options_.parameter.range;
  const double width = std::abs(range.to - range.from) / scale_;
  continuation_.from = (options_.start ? options_.start->value : range.from) / scale_;
  continuation_.to = range.to / scale_;
  continuation_.initial_step = options_.parameter.step ? options_.parameter.step->initial.value / scale_ : width / 200;
  continuation_.min_step = options_.parameter.step ? options_.parameter.step->min.value / scale_ : width / 1e6;
  continuation_.max_step = options_.parameter.step ? options_.parameter.step->max.value / scale_ : width / 30;
  continuation_.max_points = options_.max_points;
  continuation_.adapt_every = options_.adapt_mesh ? options_.adapt_every : 0;
  continuation_.location_tolerance = 1e-7 * std::max(std::abs(range.from), std::abs(range.to)) / scale_;
  newton_.tolerance = options_.tolerance;
  continuation_.newton = newton_;
  system_ = make_system(false);
}

std::unique_ptr<system::RotorSystem> CycleFollower::make_system(bool half_film) const {
  const double value = options_.start ? options_.start->value : options_.parameter.range.from;
  const auto train_at = [this, half_film](const system::Machine& machine) {
    system::Train t = system::train_of(machine, options_.unbalance);
    return half_film ? with_half_film_mesh(std::move(t)) : t;
  };
  if (options_.parameter.path == "speed")
    return std::make_unique<system::RotorSystem>(PETSC_COMM_SELF, train_at(context_.machine), value);
  system::Varying varying;
  varying.train = [this, train_at](double p) {
    return train_at(with_parameter(context_.machine, options_.parameter.path, p));
  };
  varying.value = value;
  varying.magnitude = std::max(std::abs(options_.parameter.range.from), std::abs(options_.parameter.range.to));
  return std::make_unique<system::RotorSystem>(PETSC_COMM_SELF, std::move(varying), options_.speed->value);
}

solve::CycleOptions CycleFollower::cycle_options() const {
  solve::CycleOptions o;
  o.degree = options_.degree;
  o.points = options_.points == CycleBranchOptions::Points::radau ? solve::Points::radau : solve::Points::gauss;
  o.turns = options_.period;
  o.autonomous = autonomous();
  o.parameter_scale = scale_;
  // A change of the root mean square state by half a clearance counts as one longest step.
  o.state_weight = std::pow(continuation_.max_step / 0.5, 2);
  o.base_intervals = options_.intervals;
  o.mesh_tolerance = options_.adapt_mesh ? options_.mesh_tolerance : 0;
  return o;
}

solve::Stability CycleFollower::stability() const {
  auto values = spectral::eigenvalues(problem_->monodromy());
  // The trivial multiplier of a self-excited cycle says nothing.
  if (autonomous())
    values.erase(std::min_element(values.begin(), values.end(),
                                  [](auto a, auto b) { return std::abs(a - 1.0) < std::abs(b - 1.0); }));
  return solve::make_stability(std::move(values), distance_of_multiplier);
}

void CycleFollower::on_point(const solve::BranchPoint& point, Vec u) {
  const solve::Cycle cycle = problem_->gather(u);
  record_.append(point, cycle, problem_->scheme(), *system_, scale_);
  report_between(last_ ? *last_ : cycle, cycle);
  last_ = cycle;
  const double mu = point.stability.values.empty() ? 0 : std::abs(point.stability.values.front());
  context_.results.progress(
      fmt::format("{}: point {}, {} {:.2f} {}, step {:.3g}, {} Newton iterations, {} intervals, |mu| {:.5f}, {:.1f} s",
                  context_.results.summary().name, point.index + 1, options_.parameter.path, point.parameter, unit_,
                  point.step, point.newton_iterations, cycle.intervals(), mu, context_.results.seconds()));
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
    record_.report(key, problem_->gather(u.get()), problem_->scheme(), *system_, stability(),
                   context_.results.summary());
  }
}

// How far the bifurcation moves when the discretisation changes: one corrected cycle at the same parameter, and the
// distance from the border there over its slope along the branch. Folds have no such slope; there the branch itself is
// moved and its parameter read off.
double CycleFollower::shift(const solve::LocatedEvent& found, const solve::Cycle& given, bool doubled_mesh,
                            bool half_film) const {
  const auto other = half_film ? make_system(true) : nullptr;
  system::RotorSystem& system = other ? *other : *system_;
  solve::Cycle cycle = given;
  if (system.size() != system_->size()) {
    cycle.x.resize(system.size(), given.x.cols());
    for (Eigen::Index k = 0; k < given.x.cols(); ++k) {
      const Eigen::VectorXd column = given.x.col(k);
      const std::vector<double> here = system.resampled(*system_, column.data());
      cycle.x.col(k) = Eigen::Map<const Eigen::VectorXd>(here.data(), system.size());
    }
  }
  solve::CycleProblem problem(context_.comm, system, cycle_options(),
                              doubled_mesh ? solve::doubled(cycle.mesh) : cycle.mesh);
  if (autonomous()) problem.set_phase_reference(cycle);
  core::Vector u = problem.scatter(cycle), row = core::duplicate(u.get());
  const bool fold = found.event == solve::Event::cyclic_fold;
  double offset = found.parameter;
  if (fold) {
    // The direction of the branch at its fold has no part in the parameter. It is that of the branch found: the other
    // discretisation is not at a fold here, and its own direction would hold the parameter instead of the amplitude.
    core::Vector at = problem_->scatter(cycle), along = core::duplicate(at.get()), own_row = core::duplicate(at.get()),
                 rhs = core::duplicate(at.get());
    check(VecCopy(at.get(), along.get()));
    solve::set_last_entry(context_.comm, along.get(), 0);
    solve::weighted_row(*problem_, along.get(), own_row.get());
    problem_->linearise(at.get(), own_row.get());
    check(VecSet(rhs.get(), 0.0));
    solve::set_last_entry(context_.comm, rhs.get(), 1);
    (void)solve::solve_linear(*problem_, rhs.get(), along.get(), "tangent_");
    const core::Vector tangent = problem.scatter(problem_->gather(along.get()));
    solve::set_last_entry(context_.comm, tangent.get(), 0);
    solve::weighted_row(problem, tangent.get(), row.get());
    check(VecScale(row.get(), 1 / std::sqrt(solve::inner(problem, tangent.get(), tangent.get()))));
    check(VecDot(row.get(), u.get(), &offset));
  } else {
    solve::parameter_row(problem, row.get());
  }
  const auto result = solve::newton(problem, u.get(), row.get(), offset, newton_);
  if (!result.converged) return std::numeric_limits<double>::quiet_NaN();
  if (fold) return std::abs(solve::last_entry(context_.comm, u.get()) - found.parameter);
  problem.linearise(u.get(), row.get());
  double nearest = std::numeric_limits<double>::infinity(), distance = 0;
  for (const auto& mu : spectral::eigenvalues(problem.monodromy())) {
    const double apart = std::min(std::abs(mu - found.critical), std::abs(mu - std::conj(found.critical)));
    if (apart < nearest) {
      nearest = apart;
      distance = distance_of_multiplier(mu);
    }
  }
  return found.sensitivity != 0 ? std::abs(distance / found.sensitivity) : std::numeric_limits<double>::quiet_NaN();
}

void CycleFollower::on_event(const solve::LocatedEvent& found, Vec u) {
  const auto& wanted = options_.detect;
  if (std::find(wanted.begin(), wanted.end(), event_of(found.event)) == wanted.end() &&
      found.event != solve::Event::branch_point)
    return;
  const solve::Cycle cycle = problem_->gather(u);
  if (found.event == solve::Event::cyclic_fold && at_simple_cycle(cycle)) return;
  io::Bifurcation b;
  if (found.event == solve::Event::flip && found.located) {
    const FlipSeed seed = seed_at(cycle);
    if (options_.follow_flips) seeds_.push_back(seed);
    const auto twice = twice_the_period(seed);
    const solve::Restart leaving = leave_flip(*twice, seed);
    set_criticality(b, *twice, leaving.u.get(), leaving.tangent.get(), found.sensitivity);
  }
  b.type = type_of(found.event);
  b.parameter = options_.parameter.path;
  b.value = found.parameter;
  b.unit = unit_;
  b.period_s = cycle.period;
  const bool over_speed = options_.parameter.path == "speed";
  put_groups(b,
             over_speed
                 ? system_->train()
                 : system::train_of(with_parameter(context_.machine, options_.parameter.path, found.parameter * scale_),
                                    options_.unbalance),
             over_speed ? found.parameter * scale_ : system_->speed());
  if (found.event != solve::Event::cyclic_fold) {
    b.more["angle_rad"] = std::abs(std::arg(found.critical));
    b.more["multiplier_modulus"] = std::abs(found.critical);
  }
  if (found.event == solve::Event::neimark_sacker) {
    const double frequency = std::abs(std::arg(found.critical)) / cycle.period;
    b.more["whirl_frequency_rad_s"] = frequency;
  }
  if (found.located) {
    // Near contact the same cycle may leave the validity of the film on another mesh: no estimate then.
    const auto estimate = [&](bool doubled_mesh, bool half_film) {
      try {
        return shift(found, cycle, doubled_mesh, half_film);
      } catch (const core::DomainError&) {
        return std::numeric_limits<double>::quiet_NaN();
      }
    };
    const double time = estimate(true, false);
    const double film = has_film_mesh(system_->train()) ? estimate(false, true) : 0;
    // Twice the change to the doubled time mesh: the rest that a yet finer one would bring is smaller than that change.
    b.more["uncertainty_time_mesh"] = 2 * time;
    b.more["uncertainty_film_mesh"] = film;
    b.uncertainty = 2 * time + film + found.bracket;
  } else {
    b.more["bracket"] = found.bracket;
    b.criticality_by = "not located: lies within the bracket";
    b.uncertainty = found.bracket;
  }
  context_.results.summary().bifurcations.push_back(b);
}

void CycleFollower::save(const solve::BranchPoint& point, Vec u, Vec tangent, double next_step) {
  // The next phase is measured against this cycle, in a resumed branch as in this one.
  if (autonomous()) problem_->set_phase_reference(problem_->gather(u));
  if (!options_.checkpoint) return;
  // At least once a second of work, so that a kill costs no more than that; the decision is rank 0's, for all.
  int due = context_.results.seconds() - last_saved_ >= 1;
  MPI_Bcast(&due, 1, MPI_INT, 0, context_.comm);
  if (!due) return;
  const solve::Cycle cycle = problem_->gather(u), direction = problem_->gather(tangent);
  io::Group state;
  record_.write(state.child("record"), true);
  write_cycle(state.child("cycle"), cycle);
  write_cycle(state.child("tangent"), direction);
  write_point(state.child("point"), point);
  state.set("next_step", next_step);
  state.set("largest_difference", largest_difference_);
  state.set("seconds", context_.results.seconds());
  write_summary(state.child("summary"), context_.results.summary());
  write_seeds(state.child("flips"), seeds_);
  context_.results.save_checkpoint(state);
  last_saved_ = context_.results.seconds();
}

std::optional<solve::Restart> CycleFollower::restore() {
  if (!context_.resume || !context_.results.has_checkpoint()) return std::nullopt;
  const io::Group state = context_.results.load_checkpoint();
  record_.read(state.group("record"));
  const solve::Cycle cycle = read_cycle(state.group("cycle")), direction = read_cycle(state.group("tangent"));
  problem_ = std::make_unique<solve::CycleProblem>(context_.comm, *system_, cycle_options(), cycle.mesh);
  if (autonomous()) problem_->set_phase_reference(cycle);
  read_summary(state.group("summary"), context_.results.summary());
  context_.results.add_earlier_seconds(state.real("seconds"));
  solve::Restart restart{problem_->scatter(cycle), problem_->scatter(direction), state.real("next_step"),
                         read_point(state.group("point"))};
  restart.point.stability = solve::make_stability(std::move(restart.point.stability.values), distance_of_multiplier);
  seeds_ = read_seeds(state.group("flips"));
  last_ = cycle;
  largest_difference_ = state.real("largest_difference");
  if (seed_) (void)returned(cycle);
  return restart;
}

void CycleFollower::run() {
  std::optional<solve::Restart> restart = restore();
  core::Vector u;
  if (!restart) {
    problem_ = std::make_unique<solve::CycleProblem>(context_.comm, *system_, cycle_options(),
                                                     solve::uniform_mesh(options_.intervals));
    if (seed_)
      restart = start_at_flip();
    else if (autonomous())
      restart = start_at_hopf();
    else
      u = start(*problem_);
  }
  put_groups(context_.results.summary(), system_->train());
  solve::BranchCallbacks callbacks;
  callbacks.cycles = true;
  callbacks.stability = [this](Vec) { return stability(); };
  callbacks.on_point = [this](const solve::BranchPoint& p, Vec v) { on_point(p, v); };
  callbacks.on_event = [this](const solve::LocatedEvent& e, Vec v) { on_event(e, v); };
  callbacks.checkpoint = [this](const solve::BranchPoint& p, Vec v, Vec t, double step) {
    save(p, v, t, step);
    returned_ = seed_ && returned(problem_->gather(v));
    contact_ = options_.max_eccentricity && record_.eccentricity() >= *options_.max_eccentricity;
    return !returned_ && !contact_;
  };
  const solve::BranchEnd end =
      solve::follow_branch(*problem_, std::move(u), continuation_, callbacks, std::move(restart));

  auto& results = context_.results;
  auto& group = results.group();
  record_.write(group, false);
  record_.write_orbits(group.child("orbits"), options_.orbits);
  put_bearings(group, context_.machine);
  put_bifurcations(group, results.summary().bifurcations);
  group.set("parameter", options_.parameter.path);
  group.set("parameter_unit", unit_);
  group.set("unbalance", fmt::format("{}", fmt::join(options_.unbalance, ", ")));
  group.set("period_turns", options_.period);
  results.summary().points = end.points;
  if (options_.follow_flips) write_seeds(group.child("flips"), seeds_);
  if (returned_) results.summary().set("returned", end.parameter, unit_);
  if (contact_) results.summary().set("contact", end.parameter, unit_);
  results.finish(returned_ || contact_ ? "completed" : branch_status(end, unit_), end.points > 0);
}

}  // namespace whirl::study
