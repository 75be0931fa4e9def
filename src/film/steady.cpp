#include "film/steady.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "whirl/core/error.hpp"

namespace whirl::film {

using Map = Eigen::Map<const Eigen::VectorXd>;

namespace {

Map view(const std::vector<double>& v) {
  return {v.data(), static_cast<Eigen::Index>(v.size())};
}

}  // namespace

Steady::Steady(Film& film) : film_(film) {
  const auto n = static_cast<Eigen::Index>(film.states());
  scale_.resize(n);
  for (const StateField& f : film.state_fields()) scale_.segment(f.begin, f.end - f.begin).setConstant(f.scale);
  std::vector<Eigen::Triplet<double>> entries;
  for_entries(film.whole(), film.whole().d_states, {}, [&](int i, int j, double v) { entries.emplace_back(i, j, v); });
  matrix_.resize(n, n);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  for (const auto& e : entries) {
    const int *begin = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[e.col()],
              *end = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[e.col() + 1];
    place_.push_back(static_cast<std::size_t>(std::lower_bound(begin, end, e.row()) - matrix_.innerIndexPtr()));
  }
  lu_.analyzePattern(matrix_);
}

// Not where dg/ds is what it was: a film that is linear but for the set of its full nodes keeps its factors with the
// set.
void Steady::factor() {
  if (factored_ == here_.d_states) return;
  double* const values = matrix_.valuePtr();
  std::fill_n(values, matrix_.nonZeros(), 0.0);
  for (std::size_t k = 0; k < place_.size(); ++k) values[place_[k]] += here_.d_states[k];
  factored_.clear();
  lu_.factorize(matrix_);
  if (lu_.info() != Eigen::Success) throw core::NotConverged("the film by itself is singular");
  factored_ = here_.d_states;
  ++factorisations_;
}

// What a change of the states does to the forces, without what cancels.
std::array<double, 4> Steady::effect(const Eigen::VectorXd& step) const {
  std::array<double, 4> out{};
  for (std::size_t f = 0; f < here_.force_d_states.size(); ++f)
    out[f] = view(here_.force_d_states[f]).cwiseAbs().dot(step.cwiseAbs());
  return out;
}

// Converged by the step and not by the residual, whose rounding error grows with the square of the mesh. The last step
// is taken, so that of a smooth film what is left is its square.
void Steady::solve(const Motion& motion, std::span<const double> rates, Until until, std::vector<double>& states) {
  constexpr int most_steps = 60;
  constexpr double enough = 1e-10, not_felt = 1e-13;
  const auto n = static_cast<Eigen::Index>(states.size());
  std::vector<double> now = states;
  film_.evaluate(motion, now, rates, Need::tangents, here_);
  std::array<double, 4> before;
  before.fill(std::numeric_limits<double>::infinity());
  for (int iteration = 0; iteration < most_steps; ++iteration) {
    factor();
    const Eigen::VectorXd step = lu_.solve(view(here_.residual));
    bool last = step.cwiseQuotient(scale_).norm() <= enough * std::sqrt(static_cast<double>(n));
    if (until == Until::same_force && last) {
      // Or until rounding keeps the step from becoming smaller.
      const std::array<double, 4> moved = effect(step), all = effect(view(now));
      for (std::size_t f = 0; f < moved.size(); ++f)
        last = last && (moved[f] <= not_felt * all[f] || moved[f] > 0.5 * before[f]);
      before = moved;
    }
    for (double damping = 1.0;; damping *= 0.5) {
      if (!(damping >= 1e-6)) throw core::NotConverged("the film by itself did not relax");
      trial_ = now;
      for (Eigen::Index k = 0; k < n; ++k) trial_[static_cast<std::size_t>(k)] -= damping * step[k];
      try {
        film_.evaluate(motion, trial_, rates, Need::tangents, there_);
      } catch (const core::DomainError&) {
        continue;
      }
      if (!last && !film_.whole_steps() &&
          view(there_.residual).norm() > (1.0 - 1e-4 * damping) * view(here_.residual).norm())
        continue;
      std::swap(now, trial_);
      std::swap(here_, there_);
      break;
    }
    if (!last) continue;
    states = std::move(now);
    return;
  }
  throw core::NotConverged("the film by itself did not relax");
}

Eigen::VectorXd Steady::solve_transposed(const std::vector<double>& b) {
  factor();
  return lu_.transpose().solve(view(b));
}

}  // namespace whirl::film
