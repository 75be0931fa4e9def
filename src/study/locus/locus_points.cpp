// Points of codimension two on a curve of bifurcations, and which of them are none.

#include <fmt/core.h>

#include <cmath>

#include "study/bars/summary_bars.hpp"
#include "study/locus/locus_follower.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"
#include "whirl/system/dimensionless_groups.hpp"

namespace whirl::study {
using core::check;

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

// The other discretisation is a time mesh of twice as many intervals, films of half the cells or, of films in closed
// form, differences of half the length: that is all that these leave to choose.
Beside LocusFollower::beside(Vec whole, bool other, double reach) {
  CurvePoint point = point_at(whole);
  const bool half_film = other && curve_.rest && system_->has_film_mesh();
  const double step = other && !half_film ? 4 : 8;
  const FilmFactor film = half_film ? FilmFactor{0.5, 0.5} : FilmFactor{1, 1};
  const auto coarse = half_film ? make_system(point.cycle.parameter, film) : nullptr;
  system::RotorSystem& system = coarse ? *coarse : *system_;
  const std::vector<double>& mesh = point.cycle.mesh;
  const std::vector<double> times = other && curve_.cycles ? solve::doubled(mesh) : mesh;
  const std::complex<double> critical = curve_.cycles ? -1 : std::complex<double>(0, point.inner(0));
  point.cycle = resampled(system, *system_, std::move(point.cycle));
  point.inner.resize(0);
  const CurveProblem there = problem_at(point, critical, system, film, times);
  const auto coefficient = [&](Vec at) {
    if (there.cycles) return solve::flip_coefficient(*there.cycles, there.problem->branch_part(at).get());
    return solve::hopf_coefficient(system, there.state(system, at).get(), there.problem->inner(at)(0), step);
  };
  // The curve at `reach` behind and ahead of the point, and the coefficient there.
  solve::AugmentedProblem& problem = *there.problem;
  const Vec here = there.whole.get();
  core::Vector row = core::duplicate(here);
  problem.prime(here);
  const core::Vector tangent = solve::any_tangent(problem, here);
  solve::weighted_row(problem, tangent.get(), row.get());
  double middle = 0;
  check(VecDot(row.get(), here, &middle));
  Beside out;
  for (const bool ahead : {false, true}) {
    check(VecAXPY(here, ahead ? 2 * reach : -reach, tangent.get()));
    const auto result =
        solve::newton(problem, here, row.get(), middle + (ahead ? reach : -reach), continuation_.newton);
    if (!result.converged) throw core::NotConverged(result.reason);
    problem.linearise(here, row.get());
    (ahead ? out.ahead : out.behind) = coefficient(here);
    out.moved += (ahead ? 1 : -1) * there.place(here);
  }
  return out;
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
    const bool answered = has_answer([&] {
      verdict = judge(whole, reach);
      // Kinks of a film on its mesh blur the coefficient: from farther away they matter less.
      if (std::isnan(verdict.error)) {
        const bool unclear = verdict.unclear;
        verdict = judge(whole, reach *= 10);
        verdict.unclear = verdict.unclear || unclear;
      }
    });
    verdict.unclear = verdict.unclear || !answered;
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
            curve_.cycles
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
