#include "solve/structured_rate.hpp"

#include <algorithm>
#include <cmath>

namespace whirl::solve {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Marks in front of the columns of E: those of inputs that a film does not see are passed over.
constexpr double seen = 1, not_seen = 0;

}  // namespace

std::unique_ptr<StructuredRate> StructuredRate::make(problem::System& system) {
  if (core::size_of(system.comm()) > 1 || !system.structure()) return nullptr;
  std::unique_ptr<StructuredRate> out(new StructuredRate(system));
  if (!out->find_places()) return nullptr;
  out->refresh();
  return out->mass_.allFinite() ? std::move(out) : nullptr;
}

StructuredRate::StructuredRate(problem::System& system)
    : point_(system, system.structure()), own_(system.structure()->own()), n_(system.structure()->size()) {
  f_.resize(size());
  inverse_.resize(size() - n_);
}

// False if the dense blocks or scattered entries would make products dearer than those of a sparse matrix.
bool StructuredRate::find_places() {
  const Index k = size() - n_;
  if (n_ * n_ > 8 * size()) return false;
  values_ = n_ * n_;
  Index told = 0;
  for (const problem::OwnStates& own : own_) {
    Film film;
    film.at = own;
    told += own.count;
    if (own.first != told - own.count || static_cast<Index>(own.rates.size()) != own.count) return false;
    for (const problem::Place& p : own.rates)
      if (p.row != p.column) return false;
    std::vector<Index> shift_of;
    for (const problem::Place& p : own.states) {
      Index shift = p.column - p.row;
      if (2 * shift > own.count) shift -= own.count;
      if (2 * shift <= -own.count) shift += own.count;
      const auto known = std::find(film.shifts.begin(), film.shifts.end(), shift);
      film.entries.push_back((known - film.shifts.begin()) * own.count + p.row);
      if (known == film.shifts.end()) film.shifts.push_back(shift);
      film.reach = std::max(film.reach, std::abs(shift));
    }
    if (static_cast<Index>(film.shifts.size()) * own.count > 2 * static_cast<Index>(own.states.size())) return false;
    film.forces = values_;
    film.inputs = film.forces + own.forces * own.count;
    film.diagonals = film.inputs + own.inputs * (own.count + 1);
    values_ = film.diagonals + static_cast<Index>(film.shifts.size()) * own.count;
    padded_.resize(std::max(padded_.size(), own.count + 2 * film.reach));
    films_.push_back(std::move(film));
  }
  return told == k;
}

void StructuredRate::refresh() {
  point_.refresh();
  mass_ = point_.l1().partialPivLu().inverse();
  lead_ = mass_ * point_.b();
}

void StructuredRate::evaluate(double angle, const VectorXd& z, VectorXd& rate, RateMatrix& a, VectorXd& d_parameter) {
  const VectorXd &states = point_.state_scale(), &rows = point_.residual_scale();
  rate.setZero(size());
  point_.residual(angle, z, rate, f_, at_);
  for (const Film& film : films_)
    for (std::size_t e = 0; e < film.at.rates.size(); ++e) {
      const Index row = film.at.first + film.at.rates[e].row;
      inverse_(row) = 1 / (at_.films.own[static_cast<std::size_t>(&film - films_.data())].rates[e] * states(n_ + row));
    }
  rate.head(n_).noalias() = -(mass_ * f_.head(n_));
  rate.tail(size() - n_) = -inverse_.cwiseProduct(f_.tail(size() - n_)).cwiseProduct(rows.tail(size() - n_));

  a.resize(static_cast<std::size_t>(values_));
  Map<MatrixXd> core(a.data(), n_, n_);
  core.noalias() = -(mass_ * point_.l0());
  core.noalias() += lead_ * (at_.films.d_inputs * point_.c());
  for (std::size_t i = 0; i < films_.size(); ++i) {
    const Film& film = films_[i];
    const problem::OwnTangents& t = at_.films.own[i];
    const Index count = film.at.count;
    const auto scale = states.segment(n_ + film.at.first, count);
    const auto inverse = inverse_.segment(film.at.first, count);
    for (Index e = 0; e < film.at.forces; ++e)
      Map<VectorXd>(a.data() + film.forces + e * count, count) = t.forces.row(e).transpose().cwiseProduct(scale);
    for (Index e = 0; e < film.at.inputs; ++e) {
      double* to = a.data() + film.inputs + e * (count + 1);
      Map<VectorXd> column(to + 1, count);
      column = -t.inputs.row(e).transpose().cwiseProduct(inverse);
      *to = column.isZero(0) ? not_seen : seen;
    }
    double* diagonals = a.data() + film.diagonals;
    std::fill(diagonals, diagonals + static_cast<Index>(film.shifts.size()) * count, 0.0);
    for (std::size_t e = 0; e < film.entries.size(); ++e)
      diagonals[film.entries[e]] -= t.states[e] * inverse(film.at.states[e].row) * scale(film.at.states[e].column);
  }
  // At the rates found: masses may depend on the parameter.
  at_.rate = rate.cwiseProduct(states);
  d_parameter.resize(size());
  point_.parameter_derivative(angle, at_, d_parameter);
  d_parameter.head(n_) = -(mass_ * d_parameter.head(n_)).eval();
  d_parameter.tail(size() - n_).array() *= -inverse_.array() * rows.tail(size() - n_).array();
}

void StructuredRate::times(const RateMatrix& a, const double* v, double* y) const {
  const Map<const VectorXd> x(v, n_);
  Map<VectorXd> core(y, n_);
  core.noalias() = Map<const MatrixXd>(a.data(), n_, n_) * x;
  eta_.noalias() = point_.c() * x;
  for (const Film& film : films_) {
    const Index count = film.at.count, reach = film.reach;
    const double* s = v + n_ + film.at.first;
    for (Index e = 0; e < film.at.forces; ++e)
      core += Map<const VectorXd>(a.data() + film.forces + e * count, count).dot(Map<const VectorXd>(s, count)) *
              lead_.col(film.at.first_force + e);
    double* ring = padded_.data() + reach;
    std::copy(s, s + count, ring);
    std::copy(s + count - reach, s + count, ring - reach);
    std::copy(s, s + reach, ring + count);
    double* out = y + n_ + film.at.first;
    std::fill(out, out + count, 0.0);
    for (Index e = 0; e < film.at.inputs; ++e) {
      const double* from = a.data() + film.inputs + e * (count + 1);
      if (*from == not_seen) continue;
      const double by = eta_(film.at.first_input + e);
      for (Index k = 0; k < count; ++k) out[k] += by * from[k + 1];
    }
    for (std::size_t d = 0; d < film.shifts.size(); ++d) {
      const double *diagonal = a.data() + film.diagonals + static_cast<Index>(d) * count, *shifted = ring + film.shifts[d];
      for (Index k = 0; k < count; ++k) out[k] += diagonal[k] * shifted[k];
    }
  }
}

}  // namespace whirl::solve
