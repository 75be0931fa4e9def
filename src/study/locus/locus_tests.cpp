// What is looked at along a curve of bifurcations: tests for points of codimension two, other unstable values, films.

#include <algorithm>
#include <cmath>
#include <complex>

#include "study/bars/film_limit.hpp"
#include "study/cycle/cycle_follower.hpp"
#include "study/locus/locus_follower.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"

namespace whirl::study {
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

// A Hopf curve along which another mode is unstable already is no border of stability.
void LocusFollower::put_others(Vec whole, Row& at) {
  core::Vector left = core::duplicate(whole);
  problem_->residual(whole, left.get());  // sets both parameters
  const core::Vector u = problem_->branch_part(whole);
  solve::Stability all;
  std::vector<std::complex<double>> critical;
  if (cycles_) {
    core::Vector row = core::duplicate(u.get());
    // At a fold the matrix with the parameter fixed is singular.
    solve::weighted_row(*cycles_, solve::any_tangent(*cycles_, u.get()).get(), row.get());
    cycles_->linearise(u.get(), row.get());
    all = cycle_stability(*cycles_, *system_);
    if (!all.mesh_waves.empty()) at.mesh_wave = Row::unknown_frequency;
    const double angle = row_at(whole, 0).angle;
    if (!options_.limit) critical.push_back(std::polar(1.0, angle));
    if (seed_.event == solve::Event::neimark_sacker) critical.push_back(std::polar(1.0, -angle));
    if (cycles_->options().autonomous) critical.emplace_back(1);
  } else {
    core::Vector x = core::make_vector(system_->comm(), system_->local_size(), PETSC_DETERMINE);
    rest_->to_state(u.get(), x.get());
    all = equilibrium_stability(*system_, x.get());
    for (const auto& w : all.mesh_waves) at.mesh_wave = std::max(at.mesh_wave, w.imag());
    const double omega = seed_.event == solve::Event::hopf ? problem_->inner(whole)(0) : 0;
    critical.emplace_back(0, omega);
    if (omega != 0) critical.emplace_back(0, -omega);
  }
  std::vector<bool> taken(all.values.size(), false);
  for (const auto& c : critical) {
    std::size_t nearest = all.values.size();
    for (std::size_t k = 0; k < all.values.size(); ++k)
      if (!taken[k] &&
          (nearest == all.values.size() || std::abs(all.values[k] - c) < std::abs(all.values[nearest] - c)))
        nearest = k;
    if (nearest < taken.size()) taken[nearest] = true;
  }
  at.others_unstable = 0;
  for (std::size_t k = 0; k < all.values.size(); ++k) at.others_unstable += !taken[k] && all.distance[k] > 0;
}

std::vector<double> LocusFollower::films(Vec whole) const {
  const core::Vector u = problem_->branch_part(whole);
  if (cycles_) return least_films(cycles_->gather(u.get()), *system_);
  core::Vector x = core::make_vector(system_->comm(), system_->local_size(), PETSC_DETERMINE);
  rest_->to_state(u.get(), x.get());
  return system_->observe(x.get()).film_thickness;
}

}  // namespace whirl::study
