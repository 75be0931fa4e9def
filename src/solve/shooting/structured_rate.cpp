#include "solve/shooting/structured_rate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "whirl/core/dense_lu.hpp"
#include "whirl/core/plan.hpp"

namespace whirl::solve {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr Index max_inputs = 4;  // of one film: position and velocity of its journal
constexpr Index width = 8;       // of vector registers, in numbers
using Pack = Eigen::Array<double, width, 1>;

Index filled(Index count) {
  return (count + width - 1) / width * width;
}

// Arrays of a RateMatrix stand at whole registers; states shifted around their ring do not.
Map<const Pack, Eigen::AlignedMax> pack(const double* from) {
  return Map<const Pack, Eigen::AlignedMax>(from);
}
Map<const Pack> shifted(const double* from) {
  return Map<const Pack>(from);
}

}  // namespace

std::unique_ptr<StructuredRate> StructuredRate::make(problem::System& system) {
  if (core::size_of(system.comm()) > 1 || !system.structure()) return nullptr;
  // Dense blocks may make products dearer than those of a sparse matrix, in which a state of a film has five entries.
  problem::BlockStructure& s = *system.structure();
  const Index entries = s.l1().nonZeros() + s.l0().nonZeros() + 5 * (system.size() - s.size());
  if (core::plan::rates(s.size(), entries) == core::plan::StepWay::sparse) return nullptr;
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

// False if rates are not one in a row, or if entries are too scattered for diagonals.
bool StructuredRate::find_places() {
  const Index k = size() - n_;
  values_ = filled(n_ * n_);
  Index told = 0;
  for (const problem::OwnStates& own : own_) {
    RateFilm film;
    film.at = own;
    film.stride = filled(own.count);
    told += own.count;
    if (own.inputs > max_inputs || own.first != told - own.count || static_cast<Index>(own.rates.size()) != own.count)
      return false;
    for (const problem::EntryPlace& p : own.rates)
      if (p.row != p.column) return false;
    std::vector<Index> shift_of;
    for (const problem::EntryPlace& p : own.states) {
      Index shift = p.column - p.row;
      if (2 * shift > own.count) shift -= own.count;
      if (2 * shift <= -own.count) shift += own.count;
      const auto known = std::find(film.shifts.begin(), film.shifts.end(), shift);
      film.entries.push_back((known - film.shifts.begin()) * film.stride + p.row);
      if (known == film.shifts.end()) film.shifts.push_back(shift);
      film.reach = std::max(film.reach, std::abs(shift));
    }
    if (static_cast<Index>(film.shifts.size()) * own.count > 2 * static_cast<Index>(own.states.size())) return false;
    film.forces = values_;
    film.inputs = film.forces + own.forces * film.stride;
    film.diagonals = film.inputs + own.inputs * film.stride;
    film.seen = film.diagonals + static_cast<Index>(film.shifts.size()) * film.stride;
    values_ = film.seen + filled(own.inputs);
    films_.push_back(std::move(film));
  }
  Index longest = 0;
  for (const RateFilm& film : films_) {
    longest = std::max(longest, film.stride);
    reach_ = std::max(reach_, filled(film.reach));
  }
  ring_.setZero(longest + 2 * reach_);
  return told == k;
}

bool StructuredRate::narrow() const {
  return std::all_of(films_.begin(), films_.end(),
                     [](const RateFilm& f) { return f.reach <= 4 && f.at.count > 4 * f.reach; });
}

void StructuredRate::refresh() {
  point_.refresh();
  mass_ = core::DenseLu<double>(point_.blocks().l1).inverse();
  lead_ = mass_ * point_.blocks().b;
  linear_ = -mass_ * point_.blocks().l0;
}

// What depends on R, which is the same at all points but for changes of the parameter.
void StructuredRate::follow_rates() {
  bool same = !rates_.empty();
  std::size_t from = 0;
  for (const core::PartResponse& t : at_.films.own) {
    same = same && std::equal(t.d_rates.begin(), t.d_rates.end(), rates_.begin() + static_cast<std::ptrdiff_t>(from));
    from += t.d_rates.size();
  }
  if (same) return;
  const auto states = point_.state_scale().tail(size() - n_);
  rates_.clear();
  factors_.clear();
  for (std::size_t i = 0; i < films_.size(); ++i) {
    const problem::OwnStates& own = films_[i].at;
    const std::vector<double>& rates = at_.films.own[i].d_rates;
    rates_.insert(rates_.end(), rates.begin(), rates.end());
    for (std::size_t e = 0; e < rates.size(); ++e) {
      const Index row = own.first + own.rates[e].row;
      inverse_(row) = -1 / (rates[e] * states(row));
    }
    for (const problem::EntryPlace& p : own.states)
      factors_.push_back(inverse_(own.first + p.row) * states(own.first + p.column));
  }
}

const VectorXd& StructuredRate::evaluate(double angle, const Eigen::Ref<const VectorXd>& z, RateMatrix& a,
                                         VectorXd& d_parameter) {
  const VectorXd &states = point_.state_scale(), &rows = point_.residual_scale();
  z_ = z;
  rate_.setZero(size());
  point_.residual(angle, z_, rate_, f_, at_);
  follow_rates();
  rate_.head(n_).noalias() = -mass_.lazyProduct(f_.head(n_));
  rate_.tail(size() - n_) = inverse_.cwiseProduct(f_.tail(size() - n_)).cwiseProduct(rows.tail(size() - n_));

  if (a.size() != values_) a.setZero(values_);
  inputs_.noalias() = at_.films.d_inputs.lazyProduct(point_.blocks().c);
  Map<MatrixXd>(a.data(), n_, n_) = linear_;
  Map<MatrixXd>(a.data(), n_, n_).noalias() += lead_.lazyProduct(inputs_);
  const double* factor = factors_.data();
  for (std::size_t i = 0; i < films_.size(); ++i) {
    const RateFilm& film = films_[i];
    const core::PartResponse& t = at_.films.own[i];
    const Index count = film.at.count;
    const auto scale = states.segment(n_ + film.at.first, count);
    const auto inverse = inverse_.segment(film.at.first, count);
    for (Index e = 0; e < film.at.forces; ++e) {
      double* to = a.data() + film.forces + e * film.stride;
      for (Index k = 0; k < count; ++k) to[k] = t.forces(e, k) * scale(k);
    }
    for (Index e = 0; e < film.at.inputs; ++e) {
      double *to = a.data() + film.inputs + e * film.stride, &seen = a(film.seen + e);
      seen = 0;
      for (Index k = 0; k < count; ++k) {
        to[k] = t.inputs(e, k) * inverse(k);
        if (to[k] != 0) seen = 1;
      }
    }
    double* diagonals = a.data() + film.diagonals;
    std::fill(diagonals, a.data() + film.seen, 0.0);
    for (std::size_t e = 0; e < film.entries.size(); ++e) diagonals[film.entries[e]] += *factor++ * t.d_states[e];
  }
  // At the rates found: masses may depend on the parameter.
  at_.rate = rate_.cwiseProduct(states);
  d_parameter.resize(size());
  point_.parameter_derivative(angle, at_, d_parameter);
  d_parameter.head(n_) = -mass_.lazyProduct(d_parameter.head(n_)).eval();
  d_parameter.tail(size() - n_).array() *= inverse_.array() * rows.tail(size() - n_).array();
  return rate_;
}

void StructuredRate::times(const RateMatrix& a, const double* v, double* y) const {
  const Map<const VectorXd> x(v, n_);
  Map<VectorXd> core(y, n_);
  core.noalias() = Map<const MatrixXd>(a.data(), n_, n_).lazyProduct(x);
  for (const RateFilm& film : films_) {
    const Index count = film.at.count, stride = film.stride;
    const double* s = v + n_ + film.at.first;
    double *ring = ring_.data() + reach_, *out = y + n_ + film.at.first;
    std::copy(s, s + count, ring);
    for (Index k = 1; k <= film.reach; ++k) ring[-k] = s[count - k];
    for (Index k = 0; k < film.reach; ++k) ring[count + k] = s[k];
    // Padded entries of the matrix are zero, but a longer film may have left an infinity here.
    if (count + film.reach < stride) std::fill(ring + count + film.reach, ring + stride, 0.0);
    for (Index e = 0; e < film.at.forces; ++e) {
      const double* row = a.data() + film.forces + e * stride;
      Pack sum = Pack::Zero();
      for (Index k = 0; k < stride; k += width) sum += pack(row + k) * pack(ring + k);
      core += sum.sum() * lead_.col(film.at.first_force + e);
    }
    std::array<double, max_inputs> by{};
    std::array<const double*, max_inputs> columns{};
    std::size_t seen = 0;
    for (Index e = 0; e < film.at.inputs; ++e) {
      if (a(film.seen + e) == 0) continue;
      columns[seen] = a.data() + film.inputs + e * stride;
      by[seen++] = point_.blocks().c.row(film.at.first_input + e).lazyProduct(x)(0);
    }
    for (Index k = 0; k < stride; k += width) {
      Pack sum = Pack::Zero();
      for (std::size_t e = 0; e < seen; ++e) sum += by[e] * pack(columns[e] + k);
      const double* diagonal = a.data() + film.diagonals + k;
      for (const Index shift : film.shifts) {
        sum += pack(diagonal) * shifted(ring + shift + k);
        diagonal += stride;
      }
      if (k + width <= count)
        Map<Pack>(out + k) = sum;
      else
        std::copy(sum.data(), sum.data() + (count - k), out + k);
    }
  }
}

}  // namespace whirl::solve
