#include "film/use/steady.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/core/error.hpp"

namespace whirl::film {

using Map = Eigen::Map<const Eigen::VectorXd>;

namespace {

constexpr double enough = 1e-10;
// A last step by its own derivatives leaves its square in the states, and itself in the derivatives, times how much
// these bend.
constexpr double nearly = 3e-5, not_in_tangents = 1e-7;

Map view(const std::vector<double>& v) {
  return {v.data(), static_cast<Eigen::Index>(v.size())};
}

}  // namespace

Steady::Steady(Film& film) : film_(film), matrix_(film.whole(), film.whole().d_states), lu_(film) {
  const auto n = static_cast<Eigen::Index>(film.states());
  scale_.resize(n);
  row_weight_.resize(n);
  const std::vector<StateField> fields = film.state_fields();
  for (const StateField& f : fields)
    f.each([&](int k) {
      scale_(k) = f.scale;
      row_weight_(k) = fields.front().row_scale() / f.row_scale();
    });
  if (core::BandLu::pays(matrix_.pattern())) band_.emplace(matrix_.pattern(), scale_);
  // Measured with bands of 20 and 90.
  price_ = band_ ? 1.0 + core::BandLu::bandwidth(matrix_.pattern()) / 16.0 : 12.0;
}

// Not where dg/ds is what it was: a film that is linear but for the set of its full nodes keeps its factors with the
// set.
void Steady::factor() {
  if (factored_ == linear_.d_states) return;
  factored_.clear();
  const auto& matrix = matrix_.filled(linear_.d_states);
  if (!(band_ ? band_->factor(matrix) : lu_->compute(matrix)))
    throw core::NotConverged("the film by itself is singular");
  factored_ = linear_.d_states;
  factored_at_ = view(now_);
  ++factorisations_;
}

void Steady::linearise(std::span<const double> states) {
  film_.evaluate(motion_, states, rates_, Need::tangents, linear_);
  at_ = &linear_;
}

Eigen::VectorXd Steady::step(const std::vector<double>& residual) {
  return band_ ? band_->solve(view(residual)) : Eigen::VectorXd(lu_->solve(Eigen::MatrixXd(view(residual))));
}

double Steady::size(const Eigen::VectorXd& step) const {
  return step.cwiseQuotient(scale_).norm() / std::sqrt(static_cast<double>(step.size()));
}

// Rows of several units in those of the first.
double Steady::distance(const StateResponse& at) const {
  return view(at.residual).cwiseProduct(row_weight_).norm();
}

// What a change of the states does to the forces, without what cancels.
std::array<double, 4> Steady::effect(const Eigen::VectorXd& step) const {
  std::array<double, 4> out{};
  for (Eigen::Index f = 0; f < linear_.forces.rows(); ++f)
    out[static_cast<std::size_t>(f)] = linear_.forces.row(f).cwiseAbs().dot(step.cwiseAbs());
  return out;
}

// With kept factors, whose derivatives may be those of another motion, the last step tells what the next does.
std::pair<std::array<double, 4>, std::array<double, 4>> Steady::effect_by_steps(
    const std::array<double, 4>& force_before) const {
  const std::array<double, 4>& force = at_->journal.force;
  const double load = std::hypot(force[0], force[1]);
  std::array<double, 4> moved{}, all = {load, load, std::abs(force[2]), std::abs(force[3])};
  for (std::size_t f = 0; f < film_.ports().size(); ++f) moved[f] = contraction_ * std::abs(force[f] - force_before[f]);
  return {moved, all};
}

// Whether steps that each leave `contraction` of the one before, the last of `size`, end before Newton's would.
bool Steady::pays(double contraction, double size) const {
  constexpr double newton_steps = 1.5;
  if (!(contraction < 0.3)) return false;
  return std::log(std::max(size / enough, 10.0)) / -std::log(contraction) <= newton_steps * price_;
}

// What the film would answer there differs from what its derivatives say by the square of the step.
void Steady::take_last(const Eigen::VectorXd& step, std::vector<double>& states) {
  for (Eigen::Index k = 0; k < step.size(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    states[i] = now_[i] - step[k];
  }
  const auto ports = film_.ports();
  for (std::size_t f = 0; f < ports.size(); ++f)
    linear_.journal.force[static_cast<std::size_t>(ports[f])] -=
        linear_.forces.row(static_cast<Eigen::Index>(f)).dot(step);
  linear_.journal.min_thickness = film_.least_thickness(motion_, states);
}

// Converged by the step and not by the residual, whose rounding error grows with the square of the mesh. The last step
// is taken, so that of a smooth film what is left is its square, or with kept factors the share that they leave.
// Tangents want derivatives and factors at the end in any case: kept factors then lead only near enough for these.
void Steady::solve(const JournalMotion& motion, std::span<const double> rates, Until until, Need need,
                   std::vector<double>& states, double error) {
  constexpr int most_steps = 60;
  constexpr double not_felt = 1e-13;
  const bool may_keep = !film_.whole_steps();
  motion_ = motion;
  rates_.assign(rates.begin(), rates.end());
  now_ = states;
  const bool linear_ends = may_keep && need == Need::tangents && until == Until::same_force;
  const auto near = [&](double s) { return s <= nearly && s * bend_ <= not_in_tangents; };
  bool keep = may_keep && !factored_.empty() && !(linear_ends && near(error));
  const auto refresh = [&] {
    linearise(now_);
    factor();
    contraction_ = unknown;
    keep = false;
  };
  if (keep) {
    film_.evaluate(motion_, now_, rates_, Need::force, here_);
    at_ = &here_;
  } else {
    linearise(now_);
  }
  double size_before = unknown;
  std::array<double, 4> before, force_before;
  before.fill(unknown);
  force_before.fill(unknown);
  for (int iteration = 0; iteration < most_steps; ++iteration) {
    if (!keep) factor();
    Eigen::VectorXd change = step(at_->residual);
    double moves = size(change);
    if (keep) {
      // The first step from another motion shows nothing yet.
      contraction_ = std::isfinite(size_before) ? moves / size_before : contraction_;
      if (std::isfinite(size_before) && size_before > 1e-7) bend_ = contraction_ / size(view(now_) - factored_at_);
      if (std::isfinite(size_before) && moves > enough && !pays(contraction_, moves)) {
        refresh();
        change = step(at_->residual);
        moves = size(change);
      }
    }
    if (linear_ends && !keep && near(moves)) {
      take_last(change, states);
      return;
    }
    bool last = moves <= enough;
    if (until == Until::same_force && last && moves > 0.0) {
      // Or until rounding keeps the step from becoming smaller.
      const auto [moved, all] = keep ? effect_by_steps(force_before) : std::pair(effect(change), effect(view(now_)));
      for (std::size_t f = 0; f < moved.size(); ++f)
        last = last && (moved[f] <= not_felt * all[f] || moved[f] > 0.5 * before[f]);
      before = moved;
    }
    force_before = at_->journal.force;
    const bool derivatives_now = linear_ends && keep && near(5.0 * contraction_ * moves);
    const bool keep_next = may_keep && !derivatives_now && (last || keep || pays(std::min(bend_ * moves, 0.4), moves));
    for (double damping = 1.0;;) {
      if (!(damping >= 1e-6)) throw core::NotConverged("the film by itself did not relax");
      trial_ = now_;
      for (Eigen::Index k = 0; k < change.size(); ++k) trial_[static_cast<std::size_t>(k)] -= damping * change[k];
      const bool sure = last || film_.whole_steps();
      bool further = true;
      try {
        film_.evaluate(motion_, trial_, rates_, keep_next ? Need::force : Need::tangents, there_);
        further = !sure && distance(there_) > (1.0 - 1e-4 * damping) * distance(*at_);
      } catch (const core::DomainError&) {
      }
      if (!further) {
        std::swap(now_, trial_);
        std::swap(keep_next ? here_ : linear_, there_);
        at_ = keep_next ? &here_ : &linear_;
        size_before = damping < 1.0 ? unknown : moves;
        break;
      }
      if (keep) {  // the factors are not good enough
        refresh();
        change = step(at_->residual);
        moves = size(change);
        last = false;
      } else {
        damping *= 0.5;
      }
    }
    keep = keep_next;
    if (!last) continue;
    states = now_;
    return;
  }
  throw core::NotConverged("the film by itself did not relax");
}

const StateResponse& Steady::tangents() {
  if (at_ != &linear_) linearise(now_);
  return linear_;
}

// (dg/ds)^-1 b or its transpose: by the factors of derivatives near by where that is known to cost less, and in either
// case until rounding is all that is left of what the factors lack.
Eigen::MatrixXd Steady::refined(const Eigen::MatrixXd& b, bool transposed) {
  constexpr double exact = 1e-12, forces = 2.0, too_slow = 0.2;
  const auto solved = [&](const Eigen::MatrixXd& r) -> Eigen::MatrixXd {
    if (band_) return transposed ? band_->solve_transposed(r) : band_->solve(r);
    if (transposed) return lu_->solve_transposed(r);
    return lu_->solve(r);
  };
  const bool near =
      !factored_.empty() && contraction_ < 0.1 && forces * std::log(exact) / std::log(contraction_) <= price_;
  if (!near) factor();
  for (;;) {
    const bool own = factored_ == linear_.d_states;
    Eigen::MatrixXd x = solved(b);
    if (own && (!band_ || band_->loss() <= exact)) return x;
    const auto& matrix = matrix_.filled(linear_.d_states);
    for (double before = unknown;;) {
      const Eigen::MatrixXd image = transposed ? Eigen::MatrixXd(matrix.transpose() * x) : Eigen::MatrixXd(matrix * x);
      const Eigen::MatrixXd more = solved(b - image);
      x += more;
      // Of the columns the one that lacks most.
      const double now = more.colwise().norm().cwiseQuotient(x.colwise().norm().cwiseMax(1e-300)).maxCoeff();
      if (now <= exact || (own && !(now < too_slow * before))) return x;
      if (!(now < too_slow * before)) break;
      before = now;
    }
    factor();
  }
}

Eigen::MatrixXd Steady::solve_transposed(const Eigen::MatrixXd& b) {
  return refined(b, true);
}

Eigen::MatrixXd Steady::slopes() {
  const auto ports = static_cast<Eigen::Index>(film_.ports().size());
  Eigen::MatrixXd rows(scale_.size(), 2 * ports + 1);
  rows.leftCols(2 * ports) = linear_.inputs.transpose();
  rows.col(2 * ports) = view(linear_.d_speed);
  return -refined(rows, false);
}

void Steady::follow(const JournalMotion& from, const JournalMotion& to, std::vector<double>& states) {
  constexpr double most = 0.5;
  if (factored_.empty() || linear_.inputs.size() == 0 || linear_.d_speed.empty()) return;
  Eigen::VectorXd rows = (to.speed - from.speed) * view(linear_.d_speed);
  const auto ports = film_.ports();
  for (std::size_t p = 0; p < ports.size(); ++p) {
    const auto w = static_cast<std::size_t>(ports[p]);
    const auto row = static_cast<Eigen::Index>(p), of_rates = static_cast<Eigen::Index>(ports.size());
    rows += (to.position[w] - from.position[w]) * linear_.inputs.row(row).transpose() +
            (to.velocity[w] - from.velocity[w]) * linear_.inputs.row(of_rates + row).transpose();
  }
  const Eigen::VectorXd change = band_ ? band_->solve(rows) : Eigen::VectorXd(lu_->solve(Eigen::MatrixXd(rows)));
  if (!(size(change) <= most)) return;
  for (Eigen::Index k = 0; k < change.size(); ++k) states[static_cast<std::size_t>(k)] -= change(k);
}

long relax(Film& film, const JournalMotion& motion, std::vector<double>& states) {
  if (film.states() == 0) return 0;
  const std::vector<double> rest(states.size(), 0.0);
  Steady steady(film);
  steady.solve(motion, rest, Steady::Until::small_step, Need::force, states);
  return steady.factorisations();
}

}  // namespace whirl::film
