// The same cycle, or its bifurcation, on other meshes of the films and of time.

#include <fmt/core.h>

#include <cmath>
#include <limits>

#include "study/bars/summary_bars.hpp"
#include "study/cycle/cycle_follower.hpp"
#include "study/equilibrium/equilibrium_event.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/bifurcation/augmented_problem.hpp"

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
  MeshLaw law = law_of(context_.machine);
  law.time_order = study::order_in_time(context_.machine, order_of_scheme());
  return law;
}

std::vector<CycleMesh> CycleFollower::meshes() const {
  std::vector<CycleMesh> out{{Axis::time, 0.5, {1, 1}}, {Axis::time, 2, {1, 1}}};
  if (system_->has_film_mesh())
    for (const FilmMesh& m : film_meshes(context_.machine, context_.layout))
      out.push_back({m.axis, m.spacing, m.factor});
  return out;
}

std::unique_ptr<solve::PeriodicProblem> CycleFollower::problem_on(const CycleMesh& mesh, system::Plant& system,
                                                                  const solve::Cycle& cycle) const {
  if (mesh.axis != Axis::time) return make_problem(system, options_.period, cycle.mesh, 1);
  if (mesh.spacing < 1) return make_problem(system, options_.period, cycle.mesh, 2);
  const int steps = steps_of(options_);
  if (options_.method == CycleBranchOptions::Method::collocation || steps == 1) {
    const std::vector<double> times = merged(cycle.mesh);
    return times.empty() ? nullptr : make_problem(system, options_.period, times, 1);
  }
  return steps % 2 != 0 ? nullptr : make_problem(system, options_.period, cycle.mesh, 0.5);
}

// The given cycle carried over to another mesh.
std::optional<CycleFollower::Elsewhere> CycleFollower::carried_to(const CycleMesh& mesh,
                                                                  const solve::Cycle& given) const {
  Elsewhere out;
  if (mesh.axis != Axis::time) out.other = make_system(mesh.film);
  system::Plant& system = out.other ? *out.other : *system_;
  const solve::Cycle cycle = on_film_of(system, given);
  out.problem = problem_on(mesh, system, cycle);
  if (!out.problem) return {};
  if (autonomous()) out.problem->set_phase_reference(cycle);
  out.u = out.problem->scatter(cycle);
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

std::optional<CycleFollower::Elsewhere> CycleFollower::corrected_on(const CycleMesh& mesh,
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

void CycleFollower::judge_multiplier(const solve::BranchPoint& point, Vec u) {
  if (point.stability.values.empty()) return;
  const auto leading = [](const solve::Stability& s) {
    return s.values.empty() ? io::no_value : std::abs(s.values[0]);
  };
  const double modulus = leading(point.stability);
  const solve::Cycle cycle = problem_->gather(u);
  Bars bars({modulus}, law());
  for (const CycleMesh& mesh : meshes()) {
    const auto there = pieces_->numbers(
        fmt::format("multiplier {} on mesh {} {:.3f}", point.index, static_cast<int>(mesh.axis), mesh.spacing), [&] {
          return answer_of([&] {
            const auto other = corrected_on(mesh, cycle);
            return other ? std::vector<double>{leading(stability_of(*other->problem))} : std::vector<double>{};
          });
        });
    bars.add(mesh.axis, mesh.spacing, there);
  }
  const Bar bar = bars[0];
  const double total = bar.total() + newton_.tolerance;
  multiplier_bars_.append({static_cast<double>(point.index), point.parameter, modulus, total, bar.film_mesh + bar.kinks,
                           bar.time_mesh, decided(modulus, total, 1) ? 1.0 : 0.0});
}

// Folds have no cycle beyond them, so the parameter cannot be held: the cycle of the same amplitude along the branch is
// solved, and the fold sought from there.
std::optional<CycleNumbers> CycleFollower::fold_on(const CycleMesh& mesh, const solve::LocatedEvent& found,
                                                   const solve::Cycle& given) const {
  const auto other = mesh.axis == Axis::time ? nullptr : make_system(mesh.film);
  system::Plant& system = other ? *other : *system_;
  const solve::Cycle cycle = on_film_of(system, given);
  const auto made = problem_on(mesh, system, cycle);
  if (!made) return {};
  solve::PeriodicProblem& problem = *made;
  if (autonomous()) problem.set_phase_reference(cycle);
  core::Vector u = problem.scatter(cycle), row = core::duplicate(u.get());
  // The direction of the branch at its fold has no part in the parameter. It is that of the branch found: the other
  // discretisation is not at a fold here, and its own direction would hold the parameter instead of the amplitude.
  core::Vector at = problem_->scatter(given), along = core::duplicate(at.get()), own_row = core::duplicate(at.get()),
               rhs = core::duplicate(at.get());
  check(VecCopy(at.get(), along.get()));
  solve::set_last_entry(problem_->comm(), along.get(), 0);
  solve::weighted_row(*problem_, along.get(), own_row.get());
  problem_->linearise(at.get(), own_row.get());
  check(VecSet(rhs.get(), 0.0));
  solve::set_last_entry(problem_->comm(), rhs.get(), 1);
  (void)solve::solve_linear(*problem_, rhs.get(), along.get(), "tangent_");
  // Own states of a film are resampled with the journal's place, affinely: a direction is the difference of two.
  solve::Cycle direction = problem_->gather(along.get()), moved = given;
  moved.x += direction.x;
  direction.x = on_film_of(system, std::move(moved)).x - cycle.x;
  const core::Vector tangent = problem.scatter(direction);
  solve::set_last_entry(problem.comm(), tangent.get(), 0);
  solve::weighted_row(problem, tangent.get(), row.get());
  check(VecScale(row.get(), 1 / std::sqrt(solve::inner(problem, tangent.get(), tangent.get()))));
  double offset = 0;
  check(VecDot(row.get(), u.get(), &offset));
  if (auto* cycles = dynamic_cast<solve::CycleProblem*>(&problem)) {
    const auto there = solve::refine(*cycles, found, u.get(), solve::any_tangent(problem, u.get()).get(), newton_);
    if (there && std::abs(there->parameter - found.parameter) < continuation_.max_step)
      return CycleNumbers{there->parameter, 0, problem.gather(there->u.get()).period, there->quadratic};
  }
  if (!solve::newton(problem, u.get(), row.get(), offset, newton_).converged) return {};
  return CycleNumbers{solve::last_entry(problem.comm(), u.get()), 0, problem.gather(u.get()).period, io::no_value};
}

std::optional<CycleNumbers> CycleFollower::numbers_on(const CycleMesh& mesh, const solve::LocatedEvent& found,
                                                      const solve::Cycle& cycle, bool with_coefficient) const {
  return answer_of([&]() -> std::optional<CycleNumbers> {
    if (found.event == solve::Event::cyclic_fold) return fold_on(mesh, found, cycle);
    auto there = carried_to(mesh, cycle);
    if (!there) return {};
    // On a coarser film the bifurcation is far and the film cheap: it is located there, from the cycle as it was
    // carried over or, where that is too rough, as it is at the same parameter. Elsewhere the slope tells.
    auto* cycles = dynamic_cast<solve::CycleProblem*>(there->problem.get());
    const bool locate = cycles && mesh.axis != Axis::time && mesh.spacing > 1;
    const auto located = [&]() -> std::optional<CycleNumbers> {
      if (!locate) return {};
      const core::Vector tangent = solve::any_tangent(*cycles, there->u.get());
      const auto refined = solve::refine(*cycles, found, there->u.get(), tangent.get(), newton_);
      if (!refined) return {};
      return CycleNumbers{refined->parameter, std::abs(std::arg(refined->critical)),
                          cycles->gather(refined->u.get()).period,
                          with_coefficient ? normal_form(*cycles, there->other ? *there->other : *system_, found.event,
                                                         refined->critical, refined->u.get(), steps_of(law()).longer)
                                           : io::no_value};
    };
    if (const auto numbers = located()) return numbers;
    if (!correct_there(*there, cycle)) return {};
    if (const auto numbers = located()) return numbers;
    if (locate) {
      core::Vector row = core::duplicate(there->u.get());
      solve::parameter_row(*there->problem, row.get());
      there->problem->linearise(there->u.get(), row.get());
    }
    // The distance from the border there over its slope along the branch.
    double nearest = std::numeric_limits<double>::infinity();
    CycleNumbers out{io::no_value, io::no_value, io::no_value, io::no_value};
    for (const auto& mu : there->problem->multipliers()) {
      const double apart = std::min(std::abs(mu - found.critical), std::abs(mu - std::conj(found.critical)));
      if (apart >= nearest) continue;
      nearest = apart;
      // In time the bifurcation hardly moves; by a film it does, and angle and period with it.
      if (mesh.axis == Axis::time || !cycles) {
        out.angle = std::abs(std::arg(mu));
        out.period = there->problem->gather(there->u.get()).period;
      }
      if (found.sensitivity != 0) out.place = found.parameter - distance_of_multiplier(mu) / found.sensitivity;
    }
    return out;
  });
}

// The cycle at the same parameter on other meshes, and how far it is from contact there.
std::vector<MarginThere> CycleFollower::margins_there(const solve::Cycle& cycle) const {
  std::vector<MarginThere> out;
  for (const CycleMesh& mesh : meshes()) {
    out.push_back({mesh.axis, mesh.spacing, io::no_value});
    // Stays unknown where there is none.
    (void)has_answer([&] {
      if (const auto there = corrected_on(mesh, cycle))
        out.back().margin = margin(there->problem->orbit(there->u.get()), there->other ? *there->other : *system_);
    });
  }
  return out;
}

double CycleFollower::time_error(const Located& at) {
  problem_ = make_problem(*system_, options_.period, at.cycle.mesh, 1);
  if (autonomous()) problem_->set_phase_reference(at.cycle);
  solve::LocatedEvent found;
  found.event = at.event;
  found.parameter = at.cycle.parameter / scale_;
  found.sensitivity = at.sensitivity;
  found.critical = at.critical;
  Bars bars({found.parameter}, law());
  for (const CycleMesh& mesh : meshes())
    if (mesh.axis == Axis::time) {
      const auto there = numbers_on(mesh, found, at.cycle, false);
      bars.add(mesh.axis, mesh.spacing, there ? std::vector{there->place} : std::vector<double>{});
    }
  return bars[0].time_mesh;
}

}  // namespace whirl::study
