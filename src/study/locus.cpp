#include "whirl/study/locus.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "bifurcation.hpp"
#include "common.hpp"
#include "cycle_follower.hpp"
#include "groups.hpp"
#include "located.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/table.hpp"
#include "whirl/solve/augmented_problem.hpp"
#include "whirl/solve/normal_form.hpp"
#include "whirl/study/equilibrium_branch.hpp"
#include "whirl/system/groups.hpp"

namespace whirl::study {
namespace {

using core::check;

// Names of the monitors behind the condition's own tests.
constexpr const char* generalised_hopf = "generalised_hopf";
constexpr const char* meeting = "meeting";
constexpr const char* meeting_over_second = "meeting_over_second";

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

struct Row {
  double first = 0, second = 0, period = 0, angle = 0;
};

// Normal forms of flips on the curve, a little behind and ahead of a point of it, and what lies between the two in the
// scaled parameters.
struct FlipsBeside {
  double behind = 0, ahead = 0;
  Eigen::Vector2d moved = Eigen::Vector2d::Zero();
};

// The branch problem at the bifurcation that the curve begins with, in both parameters.
class LocusFollower {
public:
  LocusFollower(Context& context, const LocusOptions& options);
  StudyResult run();

private:
  // System, branch problem and condition at the start of the curve.
  void begin();
  void make_cycles(const CycleBranchOptions& o);
  void make_equilibria(const EquilibriumBranchOptions& o);
  void make_system(const std::optional<deck::Quantity>& speed);
  [[nodiscard]] system::Train train_at(double first) const;
  [[nodiscard]] solve::SecondParameter second();
  [[nodiscard]] Row row_at(Vec whole, double second) const;
  [[nodiscard]] std::vector<solve::CodimensionTest> tests(Vec whole, Vec tangent);
  // `error` in scaled second parameter; not a number: unknown.
  void record(const std::string& type, double second, double error, Vec whole);
  void record_flip(double second, double bracket, Vec whole);
  [[nodiscard]] FlipsBeside flips_beside(Vec whole, const std::vector<double>& mesh, double reach);
  // Whether the zero of the coefficient at `whole` is one on the doubled mesh too: its error in scaled second
  // parameter, or not a number; and whether that mesh has another one near.
  struct Verdict {
    double error = unknown;
    bool unclear = false;
  };
  [[nodiscard]] Verdict judge_flip(Vec whole, double reach);
  void suspect(double from, double to, const std::string& reason);
  // Points in one direction from the start, without it.
  std::vector<Row> follow(double to, double back, solve::BranchEnd& end);

  Context& context_;
  const LocusOptions& options_;
  std::optional<CycleBranchOptions> of_cycles_;
  const EquilibriumBranchOptions* of_rest_ = nullptr;
  Located seed_;
  Parameter first_;
  std::vector<std::string> unbalance_;
  deck::Range first_range_;
  double first_scale_ = 1, second_scale_ = 1;   // SI values of one unit of the scaled parameters: widths of the ranges
  double start_second_ = 0, second_value_ = 0;  // SI: at the start, and to which the system is set
  solve::ContinuationOptions continuation_;
  std::unique_ptr<system::RotorSystem> system_;
  std::unique_ptr<solve::CycleProblem> cycles_;
  std::unique_ptr<solve::EquilibriumProblem> rest_;
  solve::ExtendedProblem* branch_ = nullptr;
  std::unique_ptr<solve::Condition> condition_;
  std::unique_ptr<solve::AugmentedProblem> problem_;
  Row start_, last_;
  bool left_ = false, ended_ = false;
};

double width(const deck::Range& range) {
  return std::abs(range.to - range.from);
}

LocusFollower::LocusFollower(Context& context, const LocusOptions& options) : context_(context), options_(options) {
  for (const auto& s : context.studies) {
    if (auto cycles = branch_called(*s, options.of)) of_cycles_ = std::move(cycles);
    if (const auto* rest = dynamic_cast<const EquilibriumBranch*>(s.get()); rest && s->name() == options.of)
      of_rest_ = &rest->options;
  }
  if (!context.earlier.has_group(io::safe_name(options.of)))
    throw core::NotConverged(fmt::format("there is no branch '{}': fewer flips were found than that", options.of));
  const io::Group& group = context.earlier.group(io::safe_name(options.of));
  if (!group.has_group("located"))
    throw core::NotConverged(
        fmt::format("the results of '{}' hold no bifurcations to start from: compute it again", options.of));
  const std::vector<Located> all = read_located(group.group("located"));
  if (static_cast<std::size_t>(options.bifurcation) > all.size())
    throw core::NotConverged(
        fmt::format("'{}' has {} bifurcations, number {} is wanted", options.of, all.size(), options.bifurcation));
  seed_ = all[static_cast<std::size_t>(options.bifurcation) - 1];
  if (of_cycles_ && seed_.cycle.mesh.size() < 2)
    throw core::NotConverged(
        fmt::format("bifurcation {} of '{}' is the Hopf point where its cycles are born: follow it from the branch of "
                    "equilibria, or choose another one",
                    options.bifurcation, options.of));
  first_ = of_cycles_ ? of_cycles_->parameter : of_rest_->parameter;
  first_range_ = options.first_range.value_or(first_.range);
  first_scale_ = width(first_range_);
  second_scale_ = width(options.second.range);
  start_second_ = value_of(context.machine, options.second.path);
  const auto& step = options.second.step;
  continuation_.initial_step = step ? step->initial.value / second_scale_ : 1.0 / 200;
  continuation_.min_step = step ? step->min.value / second_scale_ : 1e-6;
  continuation_.max_step = step ? step->max.value / second_scale_ : 1.0 / 30;
  continuation_.max_points = options.max_points;
  continuation_.location_tolerance = 1e-7;
}

void LocusFollower::begin() {
  second_value_ = start_second_;
  problem_.reset();
  condition_.reset();
  cycles_.reset();
  rest_.reset();
  if (of_cycles_)
    make_cycles(*of_cycles_);
  else
    make_equilibria(*of_rest_);
  if (!condition_)
    throw core::NotConverged(
        fmt::format("bifurcation {} of '{}' is none that can be followed", options_.bifurcation, options_.of));
}

system::Train LocusFollower::train_at(double first) const {
  system::Machine machine = with_parameter(context_.machine, options_.second.path, second_value_);
  if (first_.path != "speed") machine = with_parameter(machine, first_.path, first);
  return system::train_of(machine, unbalance_);
}

void LocusFollower::make_system(const std::optional<deck::Quantity>& speed) {
  const double value = seed_.cycle.parameter;
  if (first_.path == "speed") {
    system_ = std::make_unique<system::RotorSystem>(PETSC_COMM_SELF, train_at(value), value);
    return;
  }
  system::Varying varying;
  varying.train = [this](double p) { return train_at(p); };
  varying.value = value;
  varying.magnitude = std::max(std::abs(first_range_.from), std::abs(first_range_.to));
  system_ = std::make_unique<system::RotorSystem>(PETSC_COMM_SELF, std::move(varying), speed->value);
}

void LocusFollower::make_cycles(const CycleBranchOptions& o) {
  unbalance_ = o.unbalance;
  make_system(o.speed);
  solve::CycleOptions c;
  c.degree = o.degree;
  c.points = o.points == CycleBranchOptions::Points::radau ? solve::Points::radau : solve::Points::gauss;
  c.turns = o.period;
  c.autonomous = o.origin == CycleBranchOptions::Origin::hopf;
  c.parameter_scale = first_scale_;
  // A change of the root mean square state by half a clearance counts as one longest step.
  c.state_weight = std::pow(continuation_.max_step / 0.5, 2);
  c.base_intervals = o.intervals;
  c.mesh_tolerance = o.adapt_mesh ? o.mesh_tolerance : 0;
  continuation_.adapt_every = o.adapt_mesh ? o.adapt_every : 0;
  continuation_.newton.tolerance = o.tolerance;
  cycles_ = std::make_unique<solve::CycleProblem>(sharing_time(context_.comm, seed_.cycle.mesh.size() - 1), *system_, c,
                                                  seed_.cycle.mesh);
  if (c.autonomous) cycles_->set_phase_reference(seed_.cycle);
  branch_ = cycles_.get();
  const core::Vector u = cycles_->scatter(seed_.cycle), along = solve::any_tangent(*cycles_, u.get());
  condition_ = solve::condition_of(*cycles_, seed_.event, seed_.critical);
}

void LocusFollower::make_equilibria(const EquilibriumBranchOptions& o) {
  make_system(o.speed);
  continuation_.adapt_every = 0;
  continuation_.newton.max_iterations = 20;
  rest_ =
      std::make_unique<solve::EquilibriumProblem>(*system_, first_scale_, std::pow(continuation_.max_step / 0.5, 2));
  branch_ = rest_.get();
  condition_ = solve::condition_of(*system_, *rest_, seed_.event, seed_.critical);
}

solve::SecondParameter LocusFollower::second() {
  return {[this](double value) {
            second_value_ = value;
            system_->set_train(train_at(system_->parameter()));
          },
          second_scale_};
}

Row LocusFollower::row_at(Vec whole, double second) const {
  const core::Vector u = problem_->branch_part(whole);
  const Eigen::VectorXd inner = problem_->inner(whole);
  Row row{solve::last_entry(branch_->comm(), u.get()) * first_scale_, second * second_scale_, 0, 0};
  if (cycles_) row.period = cycles_->gather(u.get()).period;
  if (seed_.event == solve::Event::hopf) row.period = 2 * std::numbers::pi / std::abs(inner(0));
  if (seed_.event == solve::Event::flip) row.angle = std::numbers::pi;
  if (seed_.event == solve::Event::neimark_sacker) row.angle = std::acos(std::clamp(inner(0), -1.0, 1.0));
  return row;
}

std::vector<solve::CodimensionTest> LocusFollower::tests(Vec whole, Vec tangent) {
  std::vector<solve::CodimensionTest> all = problem_->tests();
  // Where the curve has an extremum in one parameter, two bifurcations of the other meet.
  all.push_back({meeting_over_second, problem_->first_parameter(tangent)});
  if (seed_.event == solve::Event::hopf) {
    // Where the first Lyapunov coefficient changes its sign the cycles turn from supercritical to subcritical. Near
    // zero it is a difference of larger terms: longer steps than usual leave less rounding in its third derivatives.
    core::Vector x = core::make_vector(system_->comm(), system_->local_size(), PETSC_DETERMINE);
    rest_->to_state(problem_->branch_part(whole).get(), x.get());
    all.push_back({generalised_hopf, solve::hopf_coefficient(*system_, x.get(), problem_->inner(whole)(0), 8)});
  }
  return all;
}

void LocusFollower::record(const std::string& type, double second, double error, Vec whole) {
  const Row row = row_at(whole, second);
  io::CodimensionTwo c;
  c.type = type;
  c.parameter = first_.path;
  c.value = {deck::from_si(row.first, first_range_.unit), first_range_.unit};
  c.second_parameter = options_.second.path;
  c.second_value = {deck::from_si(row.second, options_.second.range.unit), options_.second.range.unit};
  if (!std::isnan(error)) c.uncertainty = error * second_scale_ / deck::number_to_si(1, options_.second.range.unit);
  const double speed = first_.path == "speed" ? row.first : system_->speed();
  if (const auto groups = system::groups_of(system_->train())) {
    c.more["nondimensional_speed"] = speed / groups->speed_scale;
    c.more["nondimensional_load"] = groups->load;
    c.more["nondimensional_unbalance"] = groups->unbalance;
  }
  context_.results.summary().codimension_two.push_back(std::move(c));
}

FlipsBeside LocusFollower::flips_beside(Vec whole, const std::vector<double>& mesh, double reach) {
  const core::Vector at = problem_->branch_part(whole);
  const auto cycle = cycles_->gather(at.get());
  solve::CycleProblem cycles(sharing_time(context_.comm, mesh.size() - 1), *system_, cycles_->options(), mesh);
  const core::Vector u = cycles.scatter(cycle), along = solve::any_tangent(cycles, u.get());
  const auto condition = solve::make_flip(cycles);
  solve::AugmentedProblem problem(cycles, *condition, along.get(), second());
  core::Vector here = problem.make_unknown(), row = core::duplicate(here.get());
  problem.join(u.get(), condition->start(), solve::last_entry(cycles_->comm(), whole), here.get());
  problem.prime(here.get());
  const core::Vector tangent = solve::any_tangent(problem, here.get());
  solve::weighted_row(problem, tangent.get(), row.get());
  double middle = 0;
  check(VecDot(row.get(), here.get(), &middle));
  FlipsBeside out;
  for (const bool ahead : {false, true}) {
    check(VecAXPY(here.get(), ahead ? 2 * reach : -reach, tangent.get()));
    const auto result =
        solve::newton(problem, here.get(), row.get(), middle + (ahead ? reach : -reach), continuation_.newton);
    if (!result.converged) throw core::NotConverged(result.reason);
    problem.linearise(here.get(), row.get());
    (ahead ? out.ahead : out.behind) = solve::flip_coefficient(cycles, problem.branch_part(here.get()).get());
    const Eigen::Vector2d place(problem.first_parameter(here.get()), solve::last_entry(problem.comm(), here.get()));
    out.moved += ahead ? place : Eigen::Vector2d(-place);
  }
  return out;
}

// Where the journal stands still in its oil for a moment the force of a closed-form film has a kink, and the
// coefficient a peak as narrow as the time mesh allows: on its flanks it vanishes, too. Only a zero through which the
// doubled mesh repeats the same straight line is one of the equations.
LocusFollower::Verdict LocusFollower::judge_flip(Vec whole, double reach) {
  Verdict verdict;
  const auto mesh = cycles_->mesh();
  const FlipsBeside coarse = flips_beside(whole, mesh, reach);
  const double tolerance = std::abs(coarse.ahead - coarse.behind) / 4, width = coarse.moved.cwiseAbs().maxCoeff();
  const auto alike = [&](double a, double b) { return std::abs(a - b) < tolerance; };
  if (!alike(coarse.ahead, -coarse.behind)) return verdict;
  FlipsBeside fine = flips_beside(whole, solve::doubled(mesh), reach);
  if (coarse.moved.dot(fine.moved) < 0) std::swap(fine.behind, fine.ahead);
  verdict.unclear = fine.behind * fine.ahead < 0;
  // Twice the move to the doubled mesh, as for all errors of the time mesh.
  if (alike(fine.behind, coarse.behind) && alike(fine.ahead, coarse.ahead))
    verdict.error = std::abs((fine.ahead + fine.behind) / (fine.ahead - fine.behind)) * width;
  return verdict;
}

void LocusFollower::record_flip(double second_here, double bracket, Vec whole) {
  const double first_here = row_at(whole, second_here).first;
  Verdict verdict;
  double reach = continuation_.max_step / 100;
  try {
    verdict = judge_flip(whole, reach);
    // Kinks of a film on its mesh blur the coefficient: from farther away they matter less.
    if (std::isnan(verdict.error)) {
      const bool unclear = verdict.unclear;
      verdict = judge_flip(whole, reach *= 10);
      verdict.unclear = verdict.unclear || unclear;
    }
  } catch (const core::NotConverged&) {
    verdict.unclear = true;
  } catch (const core::DomainError&) {
    verdict.unclear = true;
  }
  core::agree(context_.comm, [&] {
    second_value_ = second_here * second_scale_;
    system_->set_parameter(first_here);
    system_->set_train(train_at(first_here));
  });
  if (!std::isnan(verdict.error))
    record(solve::generalised_flip, second_here, verdict.error + bracket, whole);
  else if (verdict.unclear)
    suspect(second_here - reach, second_here + reach,
            "the coefficient of the flip changes its sign, but not alike on the doubled time mesh");
}

void LocusFollower::suspect(double from, double to, const std::string& reason) {
  const std::string& unit = options_.second.range.unit;
  const double factor = second_scale_ / deck::number_to_si(1, unit);
  context_.results.summary().suspected.push_back({from * factor, to * factor, unit, reason});
}

std::vector<Row> LocusFollower::follow(double to, double back, solve::BranchEnd& end) {
  begin();
  core::Vector u = core::duplicate(branch_->weights());
  if (cycles_) {
    u = cycles_->scatter(seed_.cycle);
  } else {
    core::Vector x = core::make_vector(system_->comm(), system_->local_size(), PETSC_DETERMINE);
    {
      const core::WriteArray a(x.get());
      for (PetscInt i = 0; i < a.size(); ++i) a[i] = seed_.cycle.x(i, 0);
    }
    rest_->from_state(x.get(), seed_.cycle.parameter, u.get());
  }
  const core::Vector along = solve::any_tangent(*branch_, u.get());
  problem_ = std::make_unique<solve::AugmentedProblem>(*branch_, *condition_, along.get(), second());
  core::Vector start = problem_->make_unknown();
  problem_->join(u.get(), condition_->start(), start_second_ / second_scale_, start.get());
  problem_->prime(start.get());

  std::vector<Row> rows;
  solve::ContinuationOptions continuation = continuation_;
  continuation.from = start_second_ / second_scale_;
  continuation.to = to;
  continuation.back = back;
  std::vector<const char*> names;
  double inner_sign = 0;
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
  callbacks.on_zero = [&](const solve::LocatedZero& zero, Vec whole) {
    if (!zero.located) return;
    const std::string type = names[zero.monitor];
    if (type == solve::generalised_flip) return record_flip(zero.parameter, zero.bracket, whole);
    // The rounding of a Lyapunov coefficient is more than its location leaves, and not known.
    record(type, zero.parameter, type == generalised_hopf ? unknown : zero.bracket, whole);
  };
  callbacks.on_event = [&](const solve::LocatedEvent& event, Vec whole) {
    if (event.event == solve::Event::fold && event.located) record(meeting, event.parameter, event.bracket, whole);
  };
  callbacks.on_suspicion = [&](const solve::Suspicion& s) { suspect(s.from, s.to, s.reason); };
  callbacks.on_point = [&](const solve::BranchPoint& point, Vec whole) {
    last_ = row_at(whole, point.parameter);
    if (point.index > 0)
      rows.push_back(last_);
    else
      start_ = last_;
    // Beyond a Bogdanov-Takens point a Hopf curve runs back on itself; beyond the strong resonances 1:1 and 1:2 a
    // Neimark-Sacker curve is one of two real multipliers with product one.
    const Eigen::VectorXd inner = problem_->inner(whole);
    if (seed_.event == solve::Event::hopf) {
      if (inner_sign == 0) inner_sign = inner(0);
      ended_ = inner(0) * inner_sign < 0;
    }
    if (seed_.event == solve::Event::neimark_sacker) ended_ = std::abs(inner(0)) > 1;
    problem_->update();
    context_.results.progress(fmt::format("{}: point {}, {} {:.6g} {}, {} {:.6g} {}, step {:.3g}, {:.1f} s",
                                          context_.results.summary().name, point.index + 1, first_.path,
                                          deck::from_si(last_.first, first_range_.unit), first_range_.unit,
                                          options_.second.path, deck::from_si(last_.second, options_.second.range.unit),
                                          options_.second.range.unit, point.step, context_.results.seconds()));
  };
  callbacks.checkpoint = [&](const solve::BranchPoint&, Vec whole, Vec, double) {
    if (cycles_ && cycles_->options().autonomous)
      cycles_->set_phase_reference(cycles_->gather(problem_->branch_part(whole).get()));
    const double low = std::min(first_range_.from, first_range_.to),
                 high = std::max(first_range_.from, first_range_.to);
    left_ = last_.first < low || last_.first > high;
    return !left_ && !ended_;
  };
  end = solve::follow_branch(*problem_, std::move(start), continuation, callbacks);
  end.completed = end.completed || left_ || ended_;
  return rows;
}

StudyResult LocusFollower::run() {
  const deck::Range& range = options_.second.range;
  const double from = range.from / second_scale_, to = range.to / second_scale_;
  solve::BranchEnd there, here;
  const std::vector<Row> rows = follow(to, from, there);
  if (there.points == 0) throw core::NotConverged(there.reason);
  const std::vector<Row> back = follow(from, to, here);
  std::vector<Row> all(back.rbegin(), back.rend());
  all.push_back(start_);
  all.insert(all.end(), rows.begin(), rows.end());
  io::Table table({{"parameter", first_range_.unit, "first parameter, that of the branch"},
                   {"second", range.unit, "second parameter"},
                   {"period", "s", "period of the cycle, or 2 pi/omega at Hopf points"},
                   {"angle", "rad", "angle of the critical multiplier"}});
  for (const Row& row : all)
    table.append({{deck::from_si(row.first, first_range_.unit)},
                  {deck::from_si(row.second, range.unit)},
                  {row.period},
                  {row.angle}});
  auto& results = context_.results;
  put_groups(results.summary(), system_->train());
  auto& group = results.group();
  table.write(group.child("locus"));
  std::vector<std::string> types;
  std::vector<double> first, second;
  for (const auto& c : results.summary().codimension_two) {
    types.push_back(c.type);
    first.push_back(c.value.value);
    second.push_back(c.second_value.value);
  }
  auto& points = group.child("codimension_two");
  points.put("type", types, "kind of point");
  points.put("parameter", first, first_range_.unit, "first parameter");
  points.put("second", second, range.unit, "second parameter");
  group.set("bifurcation", solve::name_of(seed_.event));
  group.set("of", options_.of);
  group.set("parameter", first_.path);
  group.set("parameter_unit", first_range_.unit);
  group.set("second", options_.second.path);
  group.set("second_unit", range.unit);
  results.summary().points = static_cast<long>(all.size());
  const auto status = [&](const solve::BranchEnd& end) {
    return fmt::format("ended at {:.6g} {} of {}: {}", deck::from_si(end.parameter * second_scale_, range.unit),
                       range.unit, options_.second.path, end.reason);
  };
  return results.finish(!there.completed ? status(there) : !here.completed ? status(here) : "completed", true);
}

}  // namespace

StudyResult Locus::run(Context& context) {
  return LocusFollower(context, options).run();
}

}  // namespace whirl::study
