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

Steady::Steady(Film& film) : film_(film), matrix_(film.whole(), film.whole().d_states) {
  const auto n = static_cast<Eigen::Index>(film.states());
  scale_.resize(n);
  row_weight_.resize(n);
  const std::vector<StateField> fields = film.state_fields();
  for (const StateField& f : fields)
    f.each([&](int k) {
      scale_(k) = f.scale;
      row_weight_(k) = fields.front().row_scale() / f.row_scale();
    });
  if (BandLu::pays(matrix_.pattern()))
    band_.emplace(matrix_.pattern());
  else
    lu_.analyzePattern(matrix_.pattern());
}

// Not where dg/ds is what it was: a film that is linear but for the set of its full nodes keeps its factors with the
// set.
void Steady::factor() {
  if (factored_ == here_.d_states) return;
  factored_.clear();
  const auto& matrix = matrix_.filled(here_.d_states);
  if (!band_) lu_.factorize(matrix);
  if (band_ ? !band_->factor(matrix) : lu_.info() != Eigen::Success)
    throw core::NotConverged("the film by itself is singular");
  factored_ = here_.d_states;
  ++factorisations_;
}

// Rows of several units in those of the first.
double Steady::distance(const StateResponse& at) const {
  return view(at.residual).cwiseProduct(row_weight_).norm();
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
void Steady::solve(const JournalMotion& motion, std::span<const double> rates, Until until,
                   std::vector<double>& states) {
  constexpr int most_steps = 60;
  constexpr double enough = 1e-10, not_felt = 1e-13;
  const auto n = static_cast<Eigen::Index>(states.size());
  std::vector<double> now = states;
  film_.evaluate(motion, now, rates, Need::tangents, here_);
  std::array<double, 4> before;
  before.fill(std::numeric_limits<double>::infinity());
  for (int iteration = 0; iteration < most_steps; ++iteration) {
    factor();
    const Eigen::VectorXd step =
        band_ ? band_->solve(view(here_.residual)) : Eigen::VectorXd(lu_.solve(view(here_.residual)));
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
      if (!last && !film_.whole_steps() && distance(there_) > (1.0 - 1e-4 * damping) * distance(here_)) continue;
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
  if (band_) return band_->solve_transposed(view(b));
  return lu_.transpose().solve(view(b));
}

}  // namespace whirl::film
