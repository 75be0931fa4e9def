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
  std::vector<solve::CodimensionTest> all = curve_.problem->tests();
  // Where the curve has an extremum in one parameter, two bifurcations of the other meet.
  all.push_back({meeting_over_second, curve_.problem->first_parameter(tangent)});
  if (seed_.event == solve::Event::hopf) {
    // Where the first Lyapunov coefficient changes its sign the cycles turn from supercritical to subcritical. Near
    // zero it is a difference of larger terms: longer steps than usual leave less rounding in its third derivatives.
    const core::Vector x = curve_.state(*system_, whole);
    all.push_back({generalised_hopf, solve::hopf_coefficient(*system_, x.get(), curve_.problem->inner(whole)(0), 8)});
  }
  return all;
}

// A Hopf curve along which another mode is unstable already is no border of stability.
void LocusFollower::put_others(Vec whole, Row& at) {
  core::Vector left = core::duplicate(whole);
  curve_.problem->residual(whole, left.get());  // sets both parameters
  solve::Stability all;
  std::vector<std::complex<double>> critical;
  if (curve_.cycles) {
    const core::Vector u = curve_.problem->branch_part(whole);
    core::Vector row = core::duplicate(u.get());
    // At a fold the matrix with the parameter fixed is singular.
    solve::weighted_row(*curve_.cycles, solve::any_tangent(*curve_.cycles, u.get()).get(), row.get());
    curve_.cycles->linearise(u.get(), row.get());
    all = cycle_stability(*curve_.cycles, *system_);
    if (!all.mesh_waves.empty()) at.mesh_wave = Row::unknown_frequency;
    const double angle = row_at(whole, 0).angle;
    if (!options_.limit) critical.push_back(std::polar(1.0, angle));
    if (seed_.event == solve::Event::neimark_sacker) critical.push_back(std::polar(1.0, -angle));
    if (curve_.autonomous()) critical.emplace_back(1);
  } else {
    all = equilibrium_stability(*system_, curve_.state(*system_, whole).get());
    for (const auto& w : all.mesh_waves) at.mesh_wave = std::max(at.mesh_wave, w.imag());
    const double omega = seed_.event == solve::Event::hopf ? curve_.problem->inner(whole)(0) : 0;
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
  if (curve_.cycles) return least_films(curve_.cycle(whole), *system_);
  return system_->observe(curve_.state(*system_, whole).get()).film_thickness;
}

}  // namespace whirl::study
