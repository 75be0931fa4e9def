#include "transient/steps/thin_inverse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "whirl/core/error.hpp"

namespace whirl::transient {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr std::size_t most_kept = 6;
// Factors are tried for others within this ratio; the rate of their refinement is then about as much.
constexpr double near_step = 0.1, near_parameter = 0.05;
constexpr double slow = 0.3;  // a refinement that converges slower pays for new factors
constexpr int most_refinements = 12;
// A dense inverse wins up to here: one product without a dependence of one row on the next. It is used with refinement
// or in Newton's method only.
constexpr Index dense_until = 160;

// Whether `inverse` of `m` is one beyond rounding. The largest entry of diag(|M| |M^-1|), a condition number that no
// scale of rows or columns changes, tells how much rounding grows: without bound where columns depend on each other,
// which elimination turns into a zero or into what rounding leaves of one.
bool is_regular(const MatrixXd& m, const MatrixXd& inverse) {
  if (!inverse.allFinite()) return false;
  constexpr double most = 1e-2 / std::numeric_limits<double>::epsilon();
  return m.cwiseAbs().cwiseProduct(inverse.transpose().cwiseAbs()).rowwise().sum().maxCoeff() < most;
}

bool near(double a, double b, double ratio) {
  return std::abs(a - b) <= ratio * std::abs(b);
}

}  // namespace

bool ThinInverse::exact(const ThinOperator& a) const {
  return point_.own_states() == 0 && a.parameter == now_->parameter && near(a.alpha / a.sigma, now_->tau, 1e-13);
}

ThinInverse::Factors* ThinInverse::nearest(double tau, double parameter) {
  Factors* best = nullptr;
  for (const auto& f : kept_)
    if (near(tau, f->tau, near_step) && near(parameter, f->parameter, near_parameter) &&
        (!best || std::abs(f->tau - tau) < std::abs(best->tau - tau)))
      best = f.get();
  return best;
}

void ThinInverse::factorise_film(const ThinOperator& a, std::size_t which, Film& film) const {
  const problem::OwnStates& own = structure_.own()[which];
  const core::PartResponse& t = a.at.films.own[which];
  const Index first = structure_.size() + own.first;
  const double tau = a.alpha / a.sigma;
  const auto columns = point_.state_scale().segment(first, own.count);
  const VectorXd rows = point_.residual_scale().segment(first, own.count).cwiseInverse();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(t.d_states.size() + t.d_rates.size());
  const auto add = [&](const std::vector<problem::EntryPlace>& places, const std::vector<double>& values,
                       double factor) {
    for (std::size_t e = 0; e < places.size(); ++e)
      entries.emplace_back(places[e].row, places[e].column,
                           factor * values[e] * rows(places[e].row) * columns(places[e].column));
  };
  add(own.states, t.d_states, tau);
  add(own.rates, t.d_rates, 1);
  Sparse s(own.count, own.count);
  s.setFromTriplets(entries.begin(), entries.end());
  if (!film.lu.compute(s)) throw core::NotConverged("the matrix of a film's states is singular");
  film.by_input = film.lu.solve(MatrixXd(rows.asDiagonal() * t.inputs.transpose()));
  film.forces = tau * t.forces * columns.asDiagonal();
  if (t.force_rates.rows() > 0) film.forces += t.force_rates * columns.asDiagonal();
}

ThinInverse::Factors& ThinInverse::factorise(const ThinOperator& a) {
  // Nothing is ready if this throws.
  now_ = nullptr;
  prepared_ = nullptr;
  const double tau = a.alpha / a.sigma;
  std::unique_ptr<Factors> made;
  // In place of those for the same step, or of those that were not used for longest.
  for (auto& f : kept_)
    if (near(tau, f->tau, 1e-6)) made = std::move(f);
  std::erase(kept_, nullptr);
  if (!made && kept_.size() == most_kept) {
    const auto oldest =
        std::min_element(kept_.begin(), kept_.end(), [](const auto& p, const auto& q) { return p->used < q->used; });
    made = std::move(*oldest);
    kept_.erase(oldest);
  }
  if (!made) made = std::make_unique<Factors>();
  made->tau = tau;
  made->parameter = a.parameter;
  const auto& blocks = point_.thin_blocks();
  const Sparse m = blocks.l1 + tau * blocks.l0;
  const MatrixXd b = blocks.b;
  if (m.rows() <= dense_until) {
    const MatrixXd whole(m);
    made->inverse = core::DenseLu<double>(whole).inverse();
    if (!is_regular(whole, made->inverse)) throw core::NotConverged("the matrix of the rotor is singular");
    made->lead.noalias() = made->inverse * b;
  } else {
    if (!made->sparse) made->sparse = std::make_unique<core::PivotedLu<double>>();
    if (!made->sparse->compute(m)) throw core::NotConverged("the matrix of the rotor is singular");
    made->lead = made->sparse->solve(b);
  }
  made->seen = blocks.c * made->lead;
  made->films.resize(structure_.own().size());
  for (std::size_t i = 0; i < made->films.size(); ++i) {
    if (!made->films[i]) made->films[i] = std::make_unique<Film>();
    factorise_film(a, i, *made->films[i]);
  }
  ++factorisations_;
  kept_.push_back(std::move(made));
  return *kept_.back();
}

void ThinInverse::prepare(const ThinOperator& a, Factors& f) {
  now_ = &f;
  f.used = ++clock_;
  by_input_ = a.at.films.d_inputs;
  for (std::size_t i = 0; i < f.films.size(); ++i) {
    const problem::OwnStates& own = structure_.own()[i];
    by_input_.block(own.first_force, own.first_input, own.forces, own.inputs) -=
        f.films[i]->forces * f.films[i]->by_input;
  }
  small_matrix_.noalias() = -f.tau * by_input_ * f.seen;
  small_matrix_.diagonal().array() += 1;
  small_.compute(small_matrix_);
  prepared_ = &a;
  version_ = a.version;
}

// A/sigma = [ M - tau B D C   -B F ]     M = L1 + tau L0, S = dg/ds' + tau dg/ds, F = df/ds' + tau df/ds, D = df/dw
//           [ tau dg/dw C        S   ]
void ThinInverse::apply(const ThinOperator& a, const VectorXd& y, VectorXd& x) {
  const Factors& f = *now_;
  const auto& blocks = point_.thin_blocks();
  const Index n = structure_.size();
  x.resize(y.size());
  rhs_ = y.head(n);
  if (!f.films.empty()) {
    forces_.setZero(structure_.n_forces());
    for (std::size_t i = 0; i < f.films.size(); ++i) {
      const problem::OwnStates& own = structure_.own()[i];
      f.films[i]->lu.solve(y.data() + n + own.first, x.data() + n + own.first);
      forces_.segment(own.first_force, own.forces) += f.films[i]->forces * x.segment(n + own.first, own.count);
    }
    rhs_ += blocks.b * forces_;
  }
  if (f.sparse)
    x.head(n) = f.sparse->solve(rhs_);
  else
    x.head(n).noalias() = f.inverse * rhs_;
  inputs_.noalias() = blocks.c * x.head(n);
  forces_.noalias() = by_input_ * inputs_;
  by_force_ = small_.solve(forces_);
  x.head(n).noalias() += f.tau * (f.lead * by_force_);
  if (!f.films.empty()) {
    inputs_.noalias() += f.tau * (f.seen * by_force_);
    for (std::size_t i = 0; i < f.films.size(); ++i) {
      const problem::OwnStates& own = structure_.own()[i];
      x.segment(n + own.first, own.count).noalias() -=
          f.tau * (f.films[i]->by_input * inputs_.segment(own.first_input, own.inputs));
    }
  }
  x /= a.sigma;
}

void ThinInverse::place(const ThinOperator& a) {
  Factors* f = nearest(a.alpha / a.sigma, a.parameter);
  prepare(a, f ? *f : factorise(a));
}

bool ThinInverse::fits(double tau, double parameter) const {
  return now_ && near(tau, now_->tau, near_step) && near(parameter, now_->parameter, near_parameter);
}

double ThinInverse::mismatch(double tau, double parameter) const {
  const double by_parameter = parameter == now_->parameter ? 0 : std::abs(parameter / now_->parameter - 1);
  return std::abs(tau / now_->tau - 1) + by_parameter;
}

void ThinInverse::forget() {
  kept_.clear();
  now_ = nullptr;
  prepared_ = nullptr;
}

void ThinInverse::solve(const ThinOperator& a, const VectorXd& y, VectorXd& x, double tolerance) {
  bool fresh = false;
  if (prepared_ != &a || version_ != a.version) {
    Factors* f = nearest(a.alpha / a.sigma, a.parameter);
    fresh = !f;
    prepare(a, f ? *f : factorise(a));
  }
  for (;;) {
    apply(a, y, x);
    if (exact(a)) {
      // What is left is the matrix of the journals' forces.
      if (!x.allFinite() && y.allFinite()) throw core::NotConverged("the matrix of a step in time is singular");
      break;
    }
    double norm = y.norm();
    const double wanted = tolerance * norm;
    bool good = false;
    for (int k = 0; k < most_refinements; ++k) {
      left_.resize(y.size());
      point_.times(a.at, a.alpha * x, a.sigma * x, left_);
      left_ = y - left_;
      const double before = norm;
      norm = left_.norm();
      good = norm <= wanted;
      if (good || !(norm <= slow * before)) break;
      apply(a, left_, more_);
      x += more_;
    }
    if (good) break;
    if (fresh) {
      if (!std::isfinite(norm)) throw core::NotConverged("the matrix of a step in time is singular");
      break;  // Newton's method tells what is left
    }
    fresh = true;
    prepare(a, factorise(a));
  }
}

}  // namespace whirl::transient
