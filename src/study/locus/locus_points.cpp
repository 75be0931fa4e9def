// Points of codimension two on a curve of bifurcations, and which of them are none.

#include <fmt/core.h>

#include <cmath>
#include <functional>

#include "study/locus/locus_follower.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"
#include "whirl/system/dimensionless_groups.hpp"

namespace whirl::study {
namespace {

using core::check;

// The curve at `reach` behind and ahead of the point (u, inner unknowns, q), and a coefficient there.
Beside look_beside(solve::AugmentedProblem& problem, Vec u, const Eigen::VectorXd& inner, double q, double reach,
                   const solve::NewtonOptions& newton, const std::function<double(Vec)>& coefficient) {
  core::Vector here = problem.make_unknown(), row = core::duplicate(here.get());
  problem.join(u, inner, q, here.get());
  problem.prime(here.get());
  const core::Vector tangent = solve::any_tangent(problem, here.get());
  solve::weighted_row(problem, tangent.get(), row.get());
  double middle = 0;
  check(VecDot(row.get(), here.get(), &middle));
  Beside out;
  for (const bool ahead : {false, true}) {
    check(VecAXPY(here.get(), ahead ? 2 * reach : -reach, tangent.get()));
    const auto result = solve::newton(problem, here.get(), row.get(), middle + (ahead ? reach : -reach), newton);
    if (!result.converged) throw core::NotConverged(result.reason);
    problem.linearise(here.get(), row.get());
    (ahead ? out.ahead : out.behind) = coefficient(here.get());
    const Eigen::Vector2d place(problem.first_parameter(here.get()), solve::last_entry(problem.comm(), here.get()));
    out.moved += ahead ? place : Eigen::Vector2d(-place);
  }
  return out;
}

}  // namespace

void LocusFollower::record(const std::string& type, double second, double error, Vec whole) {
  record_row(type, row_at(whole, second), error);
  put_bars(context_.results.summary().codimension_two.back(), whole, error);
}

void LocusFollower::record_row(const std::string& type, const Row& row, double error) {
  io::CodimensionTwo c;
  c.type = type;
  c.parameter = first_.path;
  c.value = {deck::from_si(row.first, first_range_.unit), first_range_.unit};
  c.second_parameter = options_.second.path;
  c.second_value = {deck::from_si(row.second, options_.second.range.unit), options_.second.range.unit};
  if (!std::isnan(error)) c.uncertainty = error * second_scale_ / deck::number_to_si(1, options_.second.range.unit);
  const double speed = first_.path == "speed" ? row.first : system_->speed();
  if (const auto groups = system::dimensionless_groups(system_->train())) {
    c.more["nondimensional_speed"] = speed / groups->speed_scale;
    c.more["nondimensional_load"] = groups->load;
    c.more["nondimensional_unbalance"] = groups->unbalance;
  }
  context_.results.summary().codimension_two.push_back(std::move(c));
}

Beside LocusFollower::flips_beside(Vec whole, const std::vector<double>& mesh, double reach) {
  const auto cycle = cycles_->gather(problem_->branch_part(whole).get());
  solve::CycleProblem cycles(time(mesh), *system_, cycles_->options(), mesh);
  const core::Vector u = cycles.scatter(cycle), along = solve::any_tangent(cycles, u.get());
  const auto condition = solve::make_flip(cycles);
  solve::AugmentedProblem problem(cycles, *condition, along.get(), second(*system_));
  return look_beside(problem, u.get(), condition->start(), solve::last_entry(problem_->comm(), whole), reach,
                     continuation_.newton,
                     [&](Vec here) { return solve::flip_coefficient(cycles, problem.branch_part(here).get()); });
}

Beside LocusFollower::hopfs_beside(Vec whole, bool half_film, double step, double reach) {
  const FilmFactor film = half_film ? FilmFactor{0.5, 0.5} : FilmFactor{1, 1};
  core::Vector x = core::make_vector(system_->comm(), system_->local_size(), PETSC_DETERMINE);
  rest_->to_state(problem_->branch_part(whole).get(), x.get());
  const double first = problem_->first_parameter(whole) * first_scale_, omega = problem_->inner(whole)(0);
  std::unique_ptr<system::RotorSystem> coarse;
  if (half_film) {
    coarse = make_system(first, film);
    const std::vector<double> there = coarse->resampled(*system_, system_->gather(x.get()).data());
    x = core::make_vector(coarse->comm(), coarse->local_size(), PETSC_DETERMINE);
    const core::WriteArray to(x.get());
    for (PetscInt i = 0; i < to.size(); ++i) to[i] = there[static_cast<std::size_t>(i)];
  }
  system::RotorSystem& system = coarse ? *coarse : *system_;
  solve::EquilibriumProblem rest(system, first_scale_, std::pow(continuation_.max_step / 0.5, 2));
  core::Vector u = rest.make_unknown();
  rest.from_state(x.get(), first, u.get());
  const core::Vector along = solve::any_tangent(rest, u.get());
  const auto condition = solve::condition_of(system, rest, solve::Event::hopf, {0, omega});
  solve::AugmentedProblem problem(rest, *condition, along.get(), second(system, film));
  return look_beside(problem, u.get(), condition->start(), solve::last_entry(problem_->comm(), whole), reach,
                     continuation_.newton, [&](Vec here) {
                       rest.to_state(problem.branch_part(here).get(), x.get());
                       return solve::hopf_coefficient(system, x.get(), problem.inner(here)(0), step);
                     });
}

Beside LocusFollower::beside(Vec whole, bool other, double reach) {
  if (cycles_) return flips_beside(whole, other ? solve::doubled(cycles_->mesh()) : cycles_->mesh(), reach);
  // The length of the differences is all that a film in closed form leaves to choose.
  const bool mesh = system_->has_film_mesh();
  return hopfs_beside(whole, other && mesh, other && !mesh ? 4 : 8, reach);
}

// Where the journal stands still in its oil for a moment the force of a closed-form film has a kink, and the
// coefficient of a flip a peak as narrow as the time mesh allows: on its flanks it vanishes, too. Kinks of a force on
// the nodes of its film do the same to the coefficient of a Hopf point. Only a zero through which another
// discretisation repeats the same straight line is one of the equations.
LocusFollower::Verdict LocusFollower::judge(Vec whole, double reach) {
  Verdict verdict;
  const Beside coarse = beside(whole, false, reach);
  const double tolerance = std::abs(coarse.ahead - coarse.behind) / 4, width = coarse.moved.cwiseAbs().maxCoeff();
  const auto alike = [&](double a, double b) { return std::abs(a - b) < tolerance; };
  if (!alike(coarse.ahead, -coarse.behind)) return verdict;
  Beside fine = beside(whole, true, reach);
  if (coarse.moved.dot(fine.moved) < 0) std::swap(fine.behind, fine.ahead);
  verdict.unclear = fine.behind * fine.ahead < 0;
  // Twice the move to the doubled mesh, as for all errors of the time mesh.
  if (alike(fine.behind, coarse.behind) && alike(fine.ahead, coarse.ahead))
    verdict.error = std::abs((fine.ahead + fine.behind) / (fine.ahead - fine.behind)) * width;
  return verdict;
}

void LocusFollower::record_generalised(const std::string& type, double second_here, double bracket, Vec whole) {
  const double first_here = row_at(whole, second_here).first;
  Verdict verdict;
  double reach = continuation_.max_step / 100;
  const auto look = [&]() -> std::vector<double> {
    try {
      verdict = judge(whole, reach);
      // Kinks of a film on its mesh blur the coefficient: from farther away they matter less.
      if (std::isnan(verdict.error)) {
        const bool unclear = verdict.unclear;
        verdict = judge(whole, reach *= 10);
        verdict.unclear = verdict.unclear || unclear;
      }
    } catch (const core::NotConverged&) {
      verdict.unclear = true;
    } catch (const core::DomainError&) {
      verdict.unclear = true;
    } catch (const core::InputError&) {  // grooves that leave nothing of a coarser mesh
      verdict.unclear = true;
    }
    return {verdict.error, verdict.unclear ? 1.0 : 0.0, reach};
  };
  const std::vector<double> seen = pieces_->numbers(fmt::format("generalised {}", ++zeros_), look);
  verdict = {seen[0], seen[1] != 0};
  reach = seen[2];
  core::agree(context_.comm, [&] {
    second_value_ = second_here * second_scale_;
    system_->set_parameter(first_here);
    system_->set_train(train_at(first_here));
  });
  if (!std::isnan(verdict.error)) {
    // One straight line has one zero, however often rounding makes the coefficient cross it.
    const double scaled = first_here / first_scale_;
    for (const auto& [first, second, looked] : generalised_)
      if (std::hypot(first - scaled, second - second_here) < std::max(looked, reach)) return;
    generalised_.push_back({scaled, second_here, reach});
    record(type, second_here, verdict.error + bracket, whole);
  } else if (verdict.unclear) {
    suspect(second_here - reach, second_here + reach,
            cycles_
                ? "the coefficient of the flip changes its sign, but not alike on the doubled time mesh"
                : "the first Lyapunov coefficient changes its sign, but not alike on another film mesh or with other "
                  "differences");
  }
}

void LocusFollower::suspect(double from, double to, const std::string& reason) {
  const std::string& unit = options_.second.range.unit;
  const double factor = second_scale_ / deck::number_to_si(1, unit);
  context_.results.summary().suspected.push_back({from * factor, to * factor, unit, reason});
}

}  // namespace whirl::study
