// The same cycle, or its bifurcation, on other meshes of the films and of time.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "study/bars/summary_bars.hpp"
#include "study/cycle/cycle_follower.hpp"
#include "study/equilibrium/equilibrium_event.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/bifurcation/augmented_problem.hpp"
#include "whirl/study/layout_options.hpp"

namespace whirl::study {

using core::check;

namespace {

constexpr std::size_t fewest_intervals = 8;  // of a halved time mesh

}  // namespace

std::vector<double> merged(const std::vector<double>& mesh) {
  std::vector<double> out;
  if (mesh.size() / 2 < fewest_intervals) return out;
  for (std::size_t k = 0; k + 1 < mesh.size(); k += 2) out.push_back(mesh[k]);
  out.push_back(mesh.back());
  return out;
}

MeshLaw CycleFollower::law() const {
  MeshLaw law = law_of(context_.machine, context_.layout);
  law.time_order = study::order_in_time(context_.machine, order_of_scheme());
  return law;
}

bool CycleFollower::steps_are_intervals() const {
  return options_.method == CycleBranchOptions::Method::collocation || steps_of(options_) == 1;
}

std::vector<OtherMesh> time_meshes(bool halves, const LayoutOptions& layout) {
  if (layout.bars == BarsFrom::none) return {};
  return {{Axis::time, {1, 1}, 0.5}, {Axis::time, {1, 1}, halves ? 2 : 0.25}};
}

std::vector<OtherMesh> CycleFollower::meshes() const {
  std::vector<OtherMesh> out = time_meshes(
      steps_are_intervals() ? !merged(problem_->mesh()).empty() : steps_of(options_) % 2 == 0, context_.layout);
  if (system_->has_film_mesh())
    std::ranges::copy(film_meshes(context_.machine, context_.layout), std::back_inserter(out));
  return out;
}

CycleFollower::Rows CycleFollower::on_each(const std::vector<OtherMesh>& meshes, const std::string& name,
                                           const std::function<std::vector<double>(const OtherMesh&)>& work) {
  const Layout shared = layout();
  const auto row = [&](std::size_t k) {
    if (shared.count == 1) return work(meshes[k]);
    // Others do not have what this rank finds on its way.
    const solve::NewtonOptions logged = newton_;
    newton_.replay_log = nullptr;
    alone_ = true;
    std::vector<double> out = work(meshes[k]);
    alone_ = false;
    newton_ = logged;
    return out;
  };
  return distribute_numbers(shared, meshes.size(), row, *pieces_, name);
}

std::unique_ptr<solve::PeriodicProblem> CycleFollower::problem_on(const OtherMesh& mesh, system::Plant& system,
                                                                  const solve::Cycle& cycle) const {
  if (mesh.axis != Axis::time) return make_problem(system, options_.period, cycle.mesh, 1);
  if (mesh.spacing < 1) return make_problem(system, options_.period, cycle.mesh, 1 / mesh.spacing);
  if (steps_are_intervals()) {
    const std::vector<double> times = merged(cycle.mesh);
    return times.empty() ? nullptr : make_problem(system, options_.period, times, 1);
  }
  return steps_of(options_) % 2 != 0 ? nullptr : make_problem(system, options_.period, cycle.mesh, 0.5);
}

// The given cycle carried over to another mesh.
std::optional<CycleFollower::Elsewhere> CycleFollower::carried_to(const OtherMesh& mesh,
                                                                  const solve::Cycle& given) const {
  Elsewhere out;
  if (mesh.axis != Axis::time) out.other = make_system(mesh.factor);
  out.system = out.other ? out.other.get() : system_.get();
  out.cycle = on_film_of(*out.system, given);
  out.problem = problem_on(mesh, *out.system, out.cycle);
  if (!out.problem) return {};
  if (autonomous()) out.problem->set_phase_reference(out.cycle);
  out.u = out.problem->scatter(out.cycle);
  return out;
}

// Newton's method at the same parameter.
bool CycleFollower::correct_there(Elsewhere& there, const solve::Cycle& given) const {
  core::Vector row = core::duplicate(there.u.get());
  solve::parameter_row(*there.problem, row.get());
  if (!solve::newton(*there.problem, there.u.get(), row.get(), given.parameter / scale_, newton_).converged)
    return false;
  there.problem->linearise(there.u.get(), row.get());
  return true;
}

std::optional<CycleFollower::Elsewhere> CycleFollower::corrected_on(const OtherMesh& mesh,
                                                                    const solve::Cycle& given) const {
  auto there = carried_to(mesh, given);
  if (there && !correct_there(*there, given)) there.reset();
  return there;
}

io::Table multiplier_table(const std::string& unit) {
  return io::Table({{"point", "1", "row in the table of the branch, from 0"},
                    {"parameter", unit, "parameter of the branch"},
                    {"modulus", "1", "of the leading Floquet multiplier"},
                    {"uncertainty", "1", "estimated error of the modulus from film mesh and time mesh"},
                    {"uncertainty_film_mesh", "1", "that of the film mesh, with kinks"},
                    {"uncertainty_time_mesh", "1", "that of the time mesh"},
                    {"decided", "1", "1 if the modulus is farther from one than its uncertainty"}});
}

namespace {

double leading(const solve::Stability& s) {
  return s.values.empty() ? io::no_value : std::abs(s.values[0]);
}

}  // namespace

void CycleFollower::watch(const solve::BranchPoint& point, const solve::Cycle& cycle) {
  if (point.stability.values.empty()) return;
  const Watched now{point.index, point.parameter, leading(point.stability), cycle};
  const bool farther = !nearest_ || std::abs(now.modulus - 1) >= std::abs(nearest_->modulus - 1);
  leaves_ = leaves_ && farther;
  if (leaves_ || !nearest_ || !farther) nearest_ = now;
}

void CycleFollower::judge_nearest() {
  if (!nearest_ || returned_ || !record_.one_sided()) return;
  const auto& judged = multiplier_bars_.column("point");
  const auto judge = [&](const Watched& at) {
    if (std::find(judged.begin(), judged.end(), at.index) == judged.end()) judge_multiplier(at);
  };
  judge(*nearest_);
  // Doubt reaches to the next point that is decided, which the end of the branch may be.
  const int end = static_cast<int>(record_.points()) - 1;
  if (std::ranges::any_of(multiplier_bars_.column("decided"), [](double yes) { return !(yes > 0); }))
    judge({end, record_.last_parameter(), record_.modulus(end), *last_});
}

void CycleFollower::judge_multiplier(const Watched& at) {
  if (!law().estimated) return;
  const double modulus = at.modulus;
  const solve::Cycle& cycle = at.cycle;
  Bars bars({modulus}, law());
  const std::vector<OtherMesh> all = meshes();
  const Rows rows = on_each(all, fmt::format("multiplier {} on mesh", at.index), [&](const OtherMesh& mesh) {
    return answer_of([&] {
      const auto other = corrected_on(mesh, cycle);
      if (!other) return std::vector<double>{};
      return std::vector{leading(stability_of(*other->problem, *other->system))};
    });
  });
  for (std::size_t k = 0; k < all.size(); ++k) bars.add(all[k].axis, all[k].spacing, rows[k]);
  const Bar bar = bars[0];
  const double total = bar.total() + newton_.tolerance;
  multiplier_bars_.append({static_cast<double>(at.index), at.parameter, modulus, total, bar.film_mesh + bar.kinks,
                           bar.time_mesh, decided(modulus, total, 1) ? 1.0 : 0.0});
}

// Where the mesh leaves open on which side of the unit circle the leading multiplier is, and where it does not.
void CycleFollower::doubt(BranchVerdict& verdict) {
  const auto column = [this](const char* name) { return multiplier_bars_.column(name); };
  std::optional<std::size_t> worst;
  std::map<int, double> bars;
  for (std::size_t k = 0; k < multiplier_bars_.rows(); ++k) {
    const int point = static_cast<int>(column("point")[k]);
    bars[point] = column("uncertainty")[k];
    if (column("decided")[k] > 0) verdict.settle(point);
    if (column("decided")[k] > 0) continue;
    verdict.doubt(point);
    const auto apart = [&](std::size_t row) { return std::abs(column("modulus")[row] - 1); };
    if (!worst || apart(k) < apart(*worst)) worst = k;
  }
  if (!worst || verdict.text() != "undetermined") return;
  // Between two points whose bars are known the larger one holds. A bar that is not a number decides nothing.
  for (auto next = bars.begin(), last = next++; next != bars.end(); last = next++)
    for (int k = last->first + 1; k < next->first; ++k)
      if (const double m = record_.modulus(k); decided(m, last->second, 1) && decided(m, next->second, 1))
        verdict.settle(k);
  const double bar = column("uncertainty")[*worst];
  context_.results.summary().warnings.push_back(fmt::format(
      "at {:.6g} {} the largest multiplier has the modulus {:.4g}{}: this mesh does not tell whether the motion is "
      "stable there. Use more intervals, a higher degree or a finer film mesh",
      column("parameter")[*worst], unit_, column("modulus")[*worst],
      std::isfinite(bar) ? fmt::format(" +- {:.2g}", bar) : ", and other meshes have no such motion"));
}

// The direction of the branch at its fold has no part in the parameter. It is that of the branch found: another
// discretisation is not at a fold here, and its own direction would hold the parameter instead of the amplitude.
solve::Cycle CycleFollower::along(const solve::LocatedEvent& found, const solve::Cycle& given) const {
  if (found.event != solve::Event::cyclic_fold) return {};
  core::Vector at = problem_->scatter(given), along = core::duplicate(at.get()), row = core::duplicate(at.get()),
               rhs = core::duplicate(at.get());
  check(VecCopy(at.get(), along.get()));
  solve::set_last_entry(problem_->comm(), along.get(), 0);
  solve::weighted_row(*problem_, along.get(), row.get());
  problem_->linearise(at.get(), row.get());
  check(VecSet(rhs.get(), 0.0));
  solve::set_last_entry(problem_->comm(), rhs.get(), 1);
  (void)solve::solve_linear(*problem_, rhs.get(), along.get(), "tangent_");
  return problem_->gather(along.get());
}

// Folds have no cycle beyond them, so the parameter cannot be held: the cycle of the same amplitude along the branch is
// solved, and the fold sought from there.
std::optional<CycleNumbers> CycleFollower::fold_on(const OtherMesh& mesh, const solve::LocatedEvent& found,
                                                   const solve::Cycle& given, const solve::Cycle& along) const {
  const auto there = carried_to(mesh, given);
  if (!there) return {};
  solve::PeriodicProblem& problem = *there->problem;
  const Vec u = there->u.get();
  const core::Vector row = core::duplicate(u);
  // Own states of a film are resampled with the journal's place, affinely: a direction is the difference of two.
  solve::Cycle direction = along, moved = given;
  moved.x += direction.x;
  direction.x = on_film_of(*there->system, std::move(moved)).x - there->cycle.x;
  const core::Vector tangent = problem.scatter(direction);
  solve::set_last_entry(problem.comm(), tangent.get(), 0);
  solve::weighted_row(problem, tangent.get(), row.get());
  check(VecScale(row.get(), 1 / std::sqrt(solve::inner(problem, tangent.get(), tangent.get()))));
  double offset = 0;
  check(VecDot(row.get(), u, &offset));
  if (problem.has_adjoint()) {
    const auto fold = solve::refine(problem, found, u, solve::any_tangent(problem, u).get(), newton_);
    if (fold && std::abs(fold->parameter - found.parameter) < continuation_.max_step)
      return CycleNumbers{fold->parameter, 0, problem.gather(fold->u.get()).period, fold->quadratic};
  }
  if (!solve::newton(problem, u, row.get(), offset, newton_).converged) return {};
  return CycleNumbers{solve::last_entry(problem.comm(), u), 0, problem.gather(u).period, io::no_value};
}

namespace {

std::optional<std::complex<double>> nearest_multiplier(solve::PeriodicProblem& problem, std::complex<double> critical) {
  const auto apart = [&](auto mu) { return std::min(std::abs(mu - critical), std::abs(mu - std::conj(critical))); };
  const std::vector<std::complex<double>> all = problem.multipliers();
  if (all.empty()) return {};
  return *std::ranges::min_element(all, {}, apart);
}

}  // namespace

std::optional<CycleNumbers> CycleFollower::numbers_on(const OtherMesh& mesh, const solve::LocatedEvent& found,
                                                      const solve::Cycle& cycle, const solve::Cycle& along,
                                                      bool with_coefficient) const {
  return answer_of([&]() -> std::optional<CycleNumbers> {
    if (found.event == solve::Event::cyclic_fold) return fold_on(mesh, found, cycle, along);
    auto there = carried_to(mesh, cycle);
    if (!there) return {};
    // On a coarser film the bifurcation is far and the film cheap, and a normal form is that of the bifurcation: it is
    // located there, from the cycle as it was carried over or, where that is too rough, as it is at the same parameter.
    // Elsewhere the slope tells.
    solve::PeriodicProblem& problem = *there->problem;
    system::Plant& system = *there->system;
    const bool by_condition = problem.has_adjoint(),
               locate = by_condition && (with_coefficient || (mesh.axis != Axis::time && mesh.spacing > 1));
    const auto located = [&]() -> std::optional<CycleNumbers> {
      if (!locate) return {};
      const core::Vector tangent = solve::any_tangent(problem, there->u.get());
      const auto refined = solve::refine(problem, found, there->u.get(), tangent.get(), newton_);
      if (!refined) return {};
      return CycleNumbers{
          refined->parameter, std::abs(std::arg(refined->critical)), problem.gather(refined->u.get()).period,
          with_coefficient
              ? normal_form(problem, system, found.event, refined->critical, refined->u.get(), steps_of(law()).longer)
              : io::no_value};
    };
    if (const auto numbers = located()) return numbers;
    if (!correct_there(*there, cycle)) return {};
    if (const auto numbers = located()) return numbers;
    if (locate) {
      core::Vector row = core::duplicate(there->u.get());
      solve::parameter_row(problem, row.get());
      problem.linearise(there->u.get(), row.get());
    }
    // The distance from the border there over its slope along the branch.
    CycleNumbers out{io::no_value, io::no_value, io::no_value, io::no_value};
    const std::optional<std::complex<double>> nearest = nearest_multiplier(problem, found.critical);
    if (nearest) {
      const std::complex<double> mu = *nearest;
      // In time the bifurcation hardly moves; by a film it does, and angle and period with it.
      if (mesh.axis == Axis::time || !by_condition) {
        out.angle = std::abs(std::arg(mu));
        out.period = problem.gather(there->u.get()).period;
      }
      if (found.sensitivity != 0) out.place = found.parameter - distance_of_multiplier(mu) / found.sensitivity;
    }
    if (!with_coefficient || by_condition || !std::isfinite(out.place)) return out;
    solve::Cycle moved = cycle;
    moved.parameter = out.place * scale_;
    if (!correct_there(*there, moved)) return out;
    if (const auto mu = nearest_multiplier(problem, found.critical))
      out.coefficient = normal_form(problem, system, found.event, *mu, there->u.get(), steps_of(law()).longer);
    return out;
  });
}

// The cycles of twice the period that are born at the flip, which lies at `place` there.
std::optional<Parabola> CycleFollower::born_on(const OtherMesh& mesh, const solve::Cycle& flip, double place) const {
  return answer_of([&]() -> std::optional<Parabola> {
    solve::Cycle given = flip;
    given.parameter = place * scale_;
    auto there = carried_to(mesh, given);
    if (!there || !correct_there(*there, given)) return {};
    const solve::Cycle cycle = there->problem->gather(there->u.get());
    FlipSeed seed{cycle, cycle};
    seed.direction.x = there->problem->critical_motion(-1);
    const auto twice = twice_the_period(seed, steps_are_intervals() ? 1 : 1 / mesh.spacing);
    const solve::Restart leaving = leave_flip(*twice, seed);
    return parabola(*twice, leaving.u.get(), leaving.tangent.get());
  });
}

std::vector<Sample> CycleFollower::contacts_there(const solve::Cycle& last, double place) {
  const auto on = [&](const OtherMesh& mesh) {
    auto there = answer_of([&] { return carried_to(mesh, last); });
    if (!there) return std::vector{io::no_value};
    core::Vector row = core::duplicate(there->u.get());
    solve::parameter_row(*there->problem, row.get());
    return std::vector{contact_there(place, margins_, [&](double parameter) {
      double found = unknown;
      (void)has_answer([&] {
        core::Vector trial = core::duplicate(there->u.get());
        check(VecCopy(there->u.get(), trial.get()));
        if (!solve::newton(*there->problem, trial.get(), row.get(), parameter, newton_).converged) return;
        found = margin(there->orbit(trial.get()));
        std::swap(there->u, trial);
      });
      return found;
    })};
  };
  const std::vector<OtherMesh> all = meshes();
  const Rows rows = on_each(all, "contact on mesh", on);
  std::vector<Sample> out;
  for (std::size_t k = 0; k < all.size(); ++k) out.push_back({all[k].axis, all[k].spacing, rows[k].front()});
  return out;
}

double CycleFollower::time_error(const Located& at) {
  if (!law().estimated) return io::no_value;
  problem_ = make_problem(*system_, options_.period, at.cycle.mesh, 1);
  if (autonomous()) problem_->set_phase_reference(at.cycle);
  solve::LocatedEvent found;
  found.event = at.event;
  found.parameter = at.cycle.parameter / scale_;
  found.sensitivity = at.sensitivity;
  found.critical = at.critical;
  Bars bars({found.parameter}, law());
  const solve::Cycle direction = along(found, at.cycle);
  for (const OtherMesh& mesh : meshes())
    if (mesh.axis == Axis::time) {
      const auto there = numbers_on(mesh, found, at.cycle, direction, false);
      bars.add(mesh.axis, mesh.spacing, there ? std::vector{there->place} : std::vector<double>{});
    }
  return bars[0].time_mesh;
}

}  // namespace whirl::study
