#include "study/locus/locus.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "study/bars/beyond.hpp"
#include "study/bars/film_limit.hpp"
#include "study/bars/film_mesh.hpp"
#include "study/bifurcation.hpp"
#include "study/columns.hpp"
#include "study/common.hpp"
#include "study/cycle/cycle_follower.hpp"
#include "study/cycle/cycle_record.hpp"
#include "study/equilibrium/equilibrium_branch.hpp"
#include "study/layout.hpp"
#include "study/located.hpp"
#include "study/locus/locus_follower.hpp"
#include "study/state_rows.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/hdf5.hpp"
#include "whirl/io/table.hpp"
#include "whirl/solve/bifurcation/augmented_problem.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"
#include "whirl/system/dimensionless_groups.hpp"

namespace whirl::study {
namespace {

double width(const deck::Range& range) {
  return std::abs(range.to - range.from);
}

Located bifurcation_of(const LocusOptions& options, const io::Group& branch, MPI_Comm comm) {
  if (!branch.has_group("located"))
    throw core::NotConverged(
        fmt::format("the results of '{}' hold no bifurcations to start from: compute it again", options.of));
  // Every rank follows the curve on a whole machine.
  io::Group located = branch.group("located");
  io::make_whole(located, comm);
  const std::vector<Located> all = read_located(located);
  if (static_cast<std::size_t>(options.bifurcation) > all.size())
    throw core::NotConverged(
        fmt::format("'{}' has {} bifurcations, number {} is wanted", options.of, all.size(), options.bifurcation));
  return all[static_cast<std::size_t>(options.bifurcation) - 1];
}

}  // namespace

LocusFollower::LocusFollower(Context& context, const LocusOptions& options) : context_(context), options_(options) {
  for (const auto& s : context.studies) {
    if (auto cycles = branch_called(*s, options.of)) of_cycles_ = std::move(cycles);
    if (const auto* rest = dynamic_cast<const EquilibriumBranch*>(s.get()); rest && s->name() == options.of)
      of_rest_ = &rest->given();
  }
  if (!context.earlier.has_group(io::safe_name(options.of)))
    throw core::NotConverged(fmt::format("there is no branch '{}': fewer flips were found than that", options.of));
  const io::Group& group = context.earlier.group(io::safe_name(options.of));
  seed_ = options.limit ? passing_of(options, context.results.summary().name, group, context.comm)
                        : bifurcation_of(options, group, context.comm);
  if (of_cycles_ && seed_.cycle.mesh.size() < 2)
    throw core::NotConverged(
        fmt::format("bifurcation {} of '{}' is the Hopf point where its cycles are born: follow it from the branch of "
                    "equilibria, or choose another one",
                    options.bifurcation, options.of));
  if (!options.limit && seed_.event == solve::Event::branch_point)
    throw core::NotConverged(
        fmt::format("bifurcation {} of '{}' is of a type that cannot be followed", options.bifurcation, options.of));
  if (of_cycles_) unbalance_ = of_cycles_->unbalance;
  first_ = of_cycles_ ? of_cycles_->parameter : of_rest_->parameter;
  first_range_ = options.first_range.value_or(first_.range);
  first_scale_ = width(first_range_);
  second_scale_ = width(options.second.range);
  start_second_ = value_of(context.machine, options.second.path);
  continuation_ = continuation_of(options.second, second_scale_, 200, 30);
  continuation_.max_points = options.max_points;
  continuation_.picture_tolerance = options.picture_tolerance;
  continuation_.location_tolerance = 1e-7;
  continuation_.adapt_every = of_cycles_ && of_cycles_->adapt_mesh ? of_cycles_->adapt_every : 0;
  if (of_cycles_) {
    // Folds of small cycles are flat: what Newton's method leaves there shifts all of them to the same side.
    const bool flat = cycle_options().autonomous && seed_.event == solve::Event::cyclic_fold;
    continuation_.newton.tolerance = flat ? of_cycles_->tolerance / 100 : of_cycles_->tolerance;
  } else {
    continuation_.newton.max_iterations = 20;
  }
}

void LocusFollower::begin() {
  second_value_ = start_second_;
  curve_ = {};
  system_ = make_system(seed_.cycle.parameter);
  curve_ =
      problem_at({seed_.cycle, {}, start_second_ / second_scale_}, seed_.critical, *system_, {1, 1}, seed_.cycle.mesh);
}

system::Train LocusFollower::train_at(double first, const FilmFactor& film) const {
  system::Machine machine = with_parameter(context_.machine, options_.second.path, second_value_);
  if (first_.path != "speed") machine = with_parameter(machine, first_.path, first);
  return with_film_mesh(system::train_of(machine, unbalance_), film);
}

// Conditions on equilibria are solved by every rank for itself.
MPI_Comm LocusFollower::space() const {
  return plan(context_, of_cycles_ ? Sharing::intervals : Sharing::nothing, seed_.cycle.mesh.size() - 1).space;
}

MPI_Comm LocusFollower::time(const std::vector<double>& mesh) const {
  return plan(context_, Sharing::intervals, mesh.size() - 1).time;
}

std::unique_ptr<system::RotorSystem> LocusFollower::make_system(double first, const FilmFactor& film) const {
  if (first_.path == "speed") return std::make_unique<system::RotorSystem>(space(), train_at(first, film), first);
  system::Varying varying;
  varying.train = [this, film](double p) { return train_at(p, film); };
  varying.value = first;
  varying.magnitude = std::max(std::abs(first_range_.from), std::abs(first_range_.to));
  const auto& speed = of_cycles_ ? of_cycles_->speed : of_rest_->speed;
  return std::make_unique<system::RotorSystem>(space(), std::move(varying), speed->value);
}

solve::CycleOptions LocusFollower::cycle_options() const {
  const CycleBranchOptions& o = *of_cycles_;
  solve::CycleOptions c;
  c.degree = o.degree;
  c.points = o.points == CycleBranchOptions::Points::radau ? solve::Points::radau : solve::Points::gauss;
  c.turns = o.period;
  c.autonomous = o.origin == CycleBranchOptions::Origin::hopf;
  c.parameter_scale = first_scale_;
  c.state_weight = state_weight_of(continuation_);
  c.base_intervals = o.intervals;
  c.mesh_tolerance = o.adapt_mesh ? o.mesh_tolerance : 0;
  return c;
}

core::Vector CurveProblem::state(system::RotorSystem& system, Vec at) const {
  core::Vector x = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  rest->to_state(problem->branch_part(at).get(), x.get());
  return x;
}

CurveProblem LocusFollower::problem_at(const CurvePoint& point, std::complex<double> critical,
                                       system::RotorSystem& system, const FilmFactor& film,
                                       const std::vector<double>& times) {
  CurveProblem out;
  core::Vector u;
  if (of_cycles_) {
    out.cycles = std::make_unique<solve::CycleProblem>(time(times), system, cycle_options(), times);
    if (out.autonomous()) out.cycles->set_phase_reference(point.cycle);
    out.branch = out.cycles.get();
    u = out.cycles->scatter(point.cycle);
  } else {
    out.rest = std::make_unique<solve::EquilibriumProblem>(system, first_scale_, state_weight_of(continuation_));
    out.branch = out.rest.get();
    u = out.rest->make_unknown();
    out.rest->from_state(state_in(system, point.cycle).get(), point.cycle.parameter, u.get());
  }
  const core::Vector along = solve::any_tangent(*out.branch, u.get());
  out.condition = out.cycles ? condition_of(*out.cycles, system, critical, film)
                             : solve::condition_of(system, *out.rest, seed_.event, critical);
  out.problem =
      std::make_unique<solve::AugmentedProblem>(*out.branch, *out.condition, along.get(), second(system, film));
  out.whole = out.problem->make_unknown();
  out.problem->join(u.get(), point.inner.size() > 0 ? point.inner : out.condition->start(), point.second,
                    out.whole.get());
  return out;
}

solve::SecondParameter LocusFollower::second(system::RotorSystem& system, const FilmFactor& film) {
  return {[this, &system, film](double value) {
            second_value_ = value;
            system.set_train(train_at(system.parameter(), film));
          },
          second_scale_};
}

Row LocusFollower::row_at(Vec whole, double second) const {
  const core::Vector u = curve_.problem->branch_part(whole);
  const Eigen::VectorXd inner = curve_.problem->inner(whole);
  Row row{solve::last_entry(curve_.branch->comm(), u.get()) * first_scale_, second * second_scale_, 0, 0, 0};
  if (curve_.cycles) row.period = curve_.cycles->gather(u.get()).period;
  if (seed_.event == solve::Event::hopf) row.period = 2 * std::numbers::pi / std::abs(inner(0));
  if (seed_.event == solve::Event::flip) row.angle = std::numbers::pi;
  if (seed_.event == solve::Event::neimark_sacker) row.angle = std::acos(std::clamp(inner(0), -1.0, 1.0));
  return row;
}

std::vector<Row> LocusFollower::follow(double to, double back, solve::BranchEnd& end) {
  // An interrupted run goes on from where it was; what it started from is put back below.
  const Located born = seed_;
  const double start_second = start_second_;
  const bool left = std::exchange(interrupted_, false);
  if (left) {
    seed_.cycle = read_cycle(pieces_->state().group("cycle"));
    start_second_ = pieces_->state().real("second");
  }
  begin();
  core::Vector start = std::move(curve_.whole);
  seed_ = born;
  start_second_ = start_second;
  rows_.clear();
  last_swing_.resize(0, 0);
  peak_times_.clear();
  inner_sign_ = 0;
  length_ = 0;
  spread_.clear();
  std::optional<solve::Restart> restart;
  if (left) {
    restart = restore(start.get());
    core::check(VecCopy(restart->u.get(), start.get()));
    // Whether the first step passes amplitude zero is seen by comparison with the last point.
    if (curve_.autonomous()) last_swing_ = swing(start.get());
    if (options_.limit) watch_peaks(start.get(), last_);
  }
  curve_.problem->prime(start.get());

  solve::ContinuationOptions continuation = continuation_;
  continuation.from = start_second_ / second_scale_;
  continuation.to = to;
  continuation.back = back;
  std::vector<const char*> names;
  left_ = ended_ = false;
  solve::BranchCallbacks callbacks;
  callbacks.monitors = [&](Vec whole, Vec tangent) {
    std::vector<double> values;
    names.clear();
    for (const auto& test : tests(whole, tangent)) {
      names.push_back(test.name);
      values.push_back(test.value);
    }
    return values;
  };
  callbacks.drawn = [&](Vec whole) {
    return std::vector<std::vector<double>>{{curve_.problem->first_parameter(whole)}};
  };
  callbacks.on_zero = [&](const solve::LocatedZero& zero, Vec whole) {
    if (!zero.located) return;
    const std::string type = names[zero.monitor];
    if (type == solve::generalised_flip || type == generalised_hopf)
      return record_generalised(type, zero.parameter, zero.bracket, whole);
    record(type, zero.parameter, zero.bracket, whole);
  };
  callbacks.on_event = [&](const solve::LocatedEvent& event, Vec whole) {
    if (event.event == solve::Event::fold && event.located) record(meeting, event.parameter, event.bracket, whole);
  };
  callbacks.on_suspicion = [&](const solve::Suspicion& s) { suspect(s.from, s.to, s.reason); };
  // The parameters may change what a film bears.
  bool shrunk = false;
  callbacks.limit = [&](Vec whole) {
    return std::min(FilmLimit(system_->places()).margin(films(whole)), margin_of_amplitude(whole));
  };
  callbacks.why = [&](Vec whole) -> std::string {
    shrunk = margin_of_amplitude(whole) <= FilmLimit(system_->places()).margin(films(whole));
    return shrunk ? "ends at a generalised Hopf point" : FilmLimit(system_->places()).reason(films(whole));
  };
  callbacks.on_point = [&](const solve::BranchPoint& point, Vec whole) {
    const Row before = last_;
    last_ = row_at(whole, point.parameter);
    put_others(whole, last_);
    if (options_.limit) watch_peaks(whole, before);
    if (options_.limit && point.index == 0) seed_.sensitivity = slope_of_limit(whole);
    if (curve_.autonomous()) {
      last_swing_ = swing(whole);
      last_.amplitude = amplitude_of(last_swing_);
    }
    if (point.index > 0)
      rows_.push_back(last_);
    else
      start_ = last_;
    if (point.index > 0)
      length_ +=
          std::hypot((last_.first - before.first) / first_scale_, (last_.second - before.second) / second_scale_);
    if (point.index > 0 || !second_way_) {
      CurvePoint kept = point_at(whole);
      kept.arclength = length_;
      kept.row = rows_.size();
      spread_.add(std::move(kept));
    }
    // Beyond a Bogdanov-Takens point a Hopf curve runs back on itself; beyond the strong resonances 1:1 and 1:2 a
    // Neimark-Sacker curve is one of two real multipliers with product one.
    const Eigen::VectorXd inner = curve_.problem->inner(whole);
    if (seed_.event == solve::Event::hopf) {
      if (inner_sign_ == 0) inner_sign_ = inner(0);
      ended_ = inner(0) * inner_sign_ < 0;
    }
    if (seed_.event == solve::Event::neimark_sacker) ended_ = std::abs(inner(0)) > 1;
    // A step goes on from its end, not from the points within it.
    if (!point.between) curve_.problem->update();
    context_.results.progress(fmt::format("{}: point {}, {} {:.6g} {}, {} {:.6g} {}, step {:.3g}, {:.1f} s",
                                          context_.results.summary().name, point.index + 1, first_.path,
                                          deck::from_si(last_.first, first_range_.unit), first_range_.unit,
                                          options_.second.path, deck::from_si(last_.second, options_.second.range.unit),
                                          options_.second.range.unit, point.step, context_.results.seconds()));
  };
  callbacks.checkpoint = [&](const solve::ResumePoint& at, Vec whole, Vec tangent) {
    if (curve_.autonomous()) curve_.cycles->set_phase_reference(curve_.cycle(whole));
    const double low = std::min(first_range_.from, first_range_.to),
                 high = std::max(first_range_.from, first_range_.to);
    left_ = last_.first < low || last_.first > high;
    if (!left_ && !ended_) save(at, whole, tangent);
    return !left_ && !ended_;
  };
  if (restart) {
    // The signs of the tests are those of the borders, which are other ones than those of the interrupted run.
    const core::Vector row = core::duplicate(start.get());
    solve::weighted_row(*curve_.problem, restart->tangent.get(), row.get());
    curve_.problem->linearise(restart->u.get(), row.get());
    restart->point.monitors = callbacks.monitors(restart->u.get(), restart->tangent.get());
    curve_.problem->update();
  }
  end = solve::follow_branch(*curve_.problem, std::move(start), continuation, callbacks, std::move(restart));
  if (end.limited && shrunk) {
    ended_ = end_at_generalised_hopf();
    context_.results.group().set("end", end.reason);
  }
  end.completed = end.completed || left_ || ended_;
  return std::move(rows_);
}

StudyResult LocusFollower::run() {
  const deck::Range& range = options_.second.range;
  const double from = range.from / second_scale_, to = range.to / second_scale_;
  solve::BranchEnd here;
  pieces_ = std::make_unique<Pieces>(context_.results, context_.resume);
  interrupted_ = pieces_->state().has_dataset("follower");
  if (interrupted_) unpack(pieces_->state().reals("follower"), *this);
  if (!second_way_) {
    done_ = follow(to, from, done_end_);
    if (done_end_.points == 0) throw core::NotConverged(done_end_.reason);
    std::swap(done_spread_, spread_);
  }
  second_way_ = true;
  const std::vector<Row>& rows = done_;
  const solve::BranchEnd& there = done_end_;
  const std::vector<Row> back = follow(from, to, here);
  std::vector<Row> all(back.rbegin(), back.rend());
  all.push_back(start_);
  all.insert(all.end(), rows.begin(), rows.end());
  auto& results = context_.results;
  put_groups(results.summary(), system_->train());
  auto& group = results.group();
  put_curve(all, bars_of(all, back.size()));
  using Special = io::CodimensionTwo;
  const auto& special = results.summary().codimension_two;
  const auto bar = [](const Special& c) {
    return c.more.contains("value_uncertainty") ? c.more.at("value_uncertainty") : io::no_value;
  };
  auto& points = group.child("codimension_two");
  points.put("type", column(special, &Special::type), "kind of point");
  points.put("parameter", column(special, [](const Special& c) { return c.value.value; }), first_range_.unit,
             "first parameter");
  points.put("second", column(special, [](const Special& c) { return c.second_value.value; }), range.unit,
             "second parameter");
  points.put("parameter_uncertainty", column(special, bar), first_range_.unit,
             "estimated error of the first parameter");
  points.put("second_uncertainty", column(special, &Special::uncertainty), range.unit, "of the second one");
  group.set("of", options_.of);
  group.set("parameter", first_.path);
  group.set("parameter_unit", first_range_.unit);
  group.set("second", options_.second.path);
  group.set("second_unit", range.unit);
  group.set("picture_tolerance", options_.picture_tolerance);
  group.set("start", static_cast<int>(back.size()));
  put_kind();
  results.summary().points = static_cast<long>(all.size());
  const auto status = [&](const solve::BranchEnd& end) {
    return fmt::format("ended at {:.6g} {} of {}: {}", deck::from_si(end.parameter * second_scale_, range.unit),
                       range.unit, options_.second.path, end.reason);
  };
  return results.finish(!there.completed ? status(there) : !here.completed ? status(here) : "completed", true);
}

StudyResult Locus::run(Context& context) {
  return LocusFollower(context, options).run();
}

}  // namespace whirl::study
