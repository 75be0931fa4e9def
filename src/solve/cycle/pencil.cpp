#include "solve/cycle/pencil.hpp"

#include <Eigen/OrderingMethods>
#include <algorithm>

#include "whirl/core/error.hpp"

namespace whirl::solve {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// y -= a x, complex, for each lane; a is shared by all columns.
void subtract(const double* __restrict a, const double* __restrict x, double* __restrict y, Index lanes,
              Index columns) {
  const Index count = lanes * columns;
  if (lanes == 1) {
    const double re = a[0], im = a[1];
    for (Index k = 0; k < count; ++k) {
      y[k] -= re * x[k] - im * x[count + k];
      y[count + k] -= re * x[count + k] + im * x[k];
    }
    return;
  }
  for (Index c = 0; c < count; c += lanes)
    for (Index k = 0; k < lanes; ++k) {
      const double re = a[k], im = a[lanes + k], xr = x[c + k], xi = x[count + c + k];
      y[c + k] -= re * xr - im * xi;
      y[count + c + k] -= re * xi + im * xr;
    }
}

// y := a y.
void scale(const double* __restrict a, double* __restrict y, Index lanes, Index columns) {
  const Index count = lanes * columns;
  for (Index c = 0; c < count; c += lanes)
    for (Index k = 0; k < lanes; ++k) {
      const double re = a[k], im = a[lanes + k], yr = y[c + k], yi = y[count + c + k];
      y[c + k] = re * yr - im * yi;
      y[count + c + k] = re * yi + im * yr;
    }
}

// y -= factor x, real.
void subtract(double factor, const double* __restrict x, double* __restrict y, Index count) {
  for (Index k = 0; k < count; ++k) y[k] -= factor * x[k];
}

std::vector<int> pattern_of(const Pencil::Matrix& a, std::vector<int> pattern) {
  pattern.insert(pattern.end(), a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize() + 1);
  pattern.insert(pattern.end(), a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros());
  return pattern;
}

}  // namespace

bool Pencil::same_pattern(const Matrix& l1, const Matrix& l0) const {
  std::size_t from = 0;
  const auto same = [&](const int* values, Index count) {
    const auto size = static_cast<std::size_t>(count);
    if (from + size > pattern_.size() || !std::equal(values, values + size, pattern_.data() + from)) return false;
    from += size;
    return true;
  };
  for (const Matrix* a : {&l1, &l0})
    if (!same(a->outerIndexPtr(), a->outerSize() + 1) || !same(a->innerIndexPtr(), a->nonZeros())) return false;
  return from == pattern_.size();
}

void Pencil::compute(const Matrix& l1, const Matrix& l0, const std::vector<problem::KinematicRow>& kinematic,
                     const Eigen::ArrayXcd& lambda) {
  core::require(l1.isCompressed() && l0.isCompressed(), "a pencil wants compressed matrices");
  n_ = l1.rows();
  lanes_ = lambda.size();
  lambda_.resize(2 * lanes_);
  lambda_ << lambda.real(), lambda.imag();
  square_.resize(2 * lanes_);
  square_ << lambda.square().real(), lambda.square().imag();
  if (!same_pattern(l1, l0)) analyse(l1, l0, kinematic);
  fill(l1, l0);
  factorise();
  if (!lu_.allFinite()) throw core::NotConverged("the linear part has a vanishing pivot at a time mode");
}

void Pencil::take_pairs(const std::vector<problem::KinematicRow>& kinematic) {
  std::vector<bool> row_taken(static_cast<std::size_t>(n_), false), state_taken = row_taken;
  rates_.clear();
  for (const auto& [row, state, rate] : kinematic) {
    rates_.push_back({row, state, rate, -1, 0, 0});
    row_taken[static_cast<std::size_t>(row)] = state_taken[static_cast<std::size_t>(rate)] = true;
  }
  row_.clear();
  state_.clear();
  for (Index i = 0; i < n_; ++i) {
    if (!row_taken[static_cast<std::size_t>(i)]) row_.push_back(i);
    if (!state_taken[static_cast<std::size_t>(i)]) state_.push_back(i);
  }
  kept_ = n_ - eliminated();
}

// Minimum degree on the symmetric pattern, then the fill: what a row sees to its right, its next one sees as well.
void Pencil::find_slots(const Matrix& pattern) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(Matrix(pattern + Matrix(pattern.transpose())), order);
  const std::vector<Index> rows = row_, states = state_;
  std::vector<Index> place(static_cast<std::size_t>(kept_));
  for (Index i = 0; i < kept_; ++i) {
    const auto from = static_cast<std::size_t>(order.indices()(i));
    row_[static_cast<std::size_t>(i)] = rows[from];
    state_[static_cast<std::size_t>(i)] = states[from];
    place[from] = i;
  }
  std::vector<std::vector<Index>> upper(static_cast<std::size_t>(kept_)), lower(upper);
  for (Index j = 0; j < kept_; ++j)
    for (Matrix::InnerIterator it(pattern, j); it; ++it) {
      const Index a = place[static_cast<std::size_t>(it.row())], b = place[static_cast<std::size_t>(j)];
      if (a != b) upper[static_cast<std::size_t>(std::min(a, b))].push_back(std::max(a, b));
    }
  begin_.assign(1, 0);
  for (Index i = 0; i < kept_; ++i) {
    auto& right = upper[static_cast<std::size_t>(i)];
    std::sort(right.begin(), right.end());
    right.erase(std::unique(right.begin(), right.end()), right.end());
    for (const Index k : right) lower[static_cast<std::size_t>(k)].push_back(i);
    if (right.size() > 1) {
      auto& next = upper[static_cast<std::size_t>(right.front())];
      next.insert(next.end(), right.begin() + 1, right.end());
    }
  }
  diagonal_.clear();
  column_.clear();
  for (Index i = 0; i < kept_; ++i) {
    const auto &left = lower[static_cast<std::size_t>(i)], &right = upper[static_cast<std::size_t>(i)];
    column_.insert(column_.end(), left.begin(), left.end());
    diagonal_.push_back(static_cast<Index>(column_.size()));
    column_.push_back(i);
    column_.insert(column_.end(), right.begin(), right.end());
    begin_.push_back(static_cast<Index>(column_.size()));
  }
}

void Pencil::analyse(const Matrix& l1, const Matrix& l0, const std::vector<problem::KinematicRow>& kinematic) {
  pattern_ = pattern_of(l0, pattern_of(l1, {}));
  take_pairs(kinematic);
  // Where rows and states stand among the kept ones, or which rate a state is: before and after ordering.
  std::vector<Index> row_place(static_cast<std::size_t>(n_), -1), state_place(row_place), rate_of(row_place);
  for (std::size_t e = 0; e < rates_.size(); ++e)
    rate_of[static_cast<std::size_t>(rates_[e].b)] = static_cast<Index>(e);
  const auto number = [&] {
    for (Index p = 0; p < kept_; ++p) {
      row_place[static_cast<std::size_t>(row_[static_cast<std::size_t>(p)])] = p;
      state_place[static_cast<std::size_t>(state_[static_cast<std::size_t>(p)])] = p;
    }
  };
  const auto column_of = [&](Index state) {
    const Index e = rate_of[static_cast<std::size_t>(state)];
    return state_place[static_cast<std::size_t>(e < 0 ? state : rates_[static_cast<std::size_t>(e)].a)];
  };
  number();
  std::vector<Eigen::Triplet<double>> entries;
  for (Index p = 0; p < kept_; ++p) entries.emplace_back(p, p, 1);
  for (const Matrix* m : {&l0, &l1})
    for (Index j = 0; j < n_; ++j)
      for (Matrix::InnerIterator it(*m, j); it; ++it)
        if (const Index p = row_place[static_cast<std::size_t>(it.row())]; p >= 0)
          entries.emplace_back(p, column_of(j), 1);
  Matrix pattern(kept_, kept_);
  pattern.setFromTriplets(entries.begin(), entries.end());
  find_slots(pattern);
  number();
  for (Rate& r : rates_) r.place_a = state_place[static_cast<std::size_t>(r.a)];
  targets_.clear();
  for (const Matrix* m : {&l0, &l1})
    for (Index j = 0; j < n_; ++j)
      for (Matrix::InnerIterator it(*m, j); it; ++it) {
        Target t;
        const Index p = row_place[static_cast<std::size_t>(it.row())];
        if (p >= 0) {
          const auto from = column_.begin() + begin_[static_cast<std::size_t>(p)],
                     to = column_.begin() + begin_[static_cast<std::size_t>(p) + 1];
          t.slot = std::lower_bound(from, to, column_of(j)) - column_.begin();
          t.rate = rate_of[static_cast<std::size_t>(j)];
          t.degree = (m == &l1 ? 1 : 0) + (t.rate >= 0 ? 1 : 0);
        }
        targets_.push_back(t);
      }
}

void Pencil::fill(const Matrix& l1, const Matrix& l0) {
  for (Rate& r : rates_) {
    r.alpha = l1.coeff(r.row, r.a);
    r.beta = l0.coeff(r.row, r.b);
  }
  coefficients_.assign(3 * column_.size(), 0.0);
  couplings_.clear();
  auto target = targets_.begin();
  std::vector<Index> place(static_cast<std::size_t>(n_), -1);
  for (Index p = 0; p < kept_; ++p) place[static_cast<std::size_t>(row_[static_cast<std::size_t>(p)])] = p;
  for (const Matrix* m : {&l0, &l1})
    for (Index e = 0; e < m->nonZeros(); ++e, ++target) {
      if (target->slot < 0) continue;
      double value = m->valuePtr()[e];
      if (target->rate >= 0) {
        const Rate& r = rates_[static_cast<std::size_t>(target->rate)];
        couplings_.push_back(
            {place[static_cast<std::size_t>(m->innerIndexPtr()[e])], target->rate, target->degree - 1, value});
        value *= -r.alpha / r.beta;
      }
      coefficients_[static_cast<std::size_t>(3 * target->slot + target->degree)] += value;
    }
}

void Pencil::factorise() {
  const Index lanes = lanes_;
  lu_.resize(2 * lanes * static_cast<Index>(column_.size()));
  std::vector<Index> where(static_cast<std::size_t>(kept_), -1);
  for (Index i = 0; i < kept_; ++i) {
    const Index from = begin_[static_cast<std::size_t>(i)], to = begin_[static_cast<std::size_t>(i) + 1],
                diagonal = diagonal_[static_cast<std::size_t>(i)];
    for (Index s = from; s < to; ++s) {
      where[static_cast<std::size_t>(column_[static_cast<std::size_t>(s)])] = s;
      const double* t = coefficients_.data() + 3 * s;
      double* out = at(s);
      for (Index k = 0; k < 2 * lanes; ++k) out[k] = t[1] * lambda_[k] + t[2] * square_[k];
      for (Index k = 0; k < lanes; ++k) out[k] += t[0];
    }
    for (Index s = from; s < diagonal; ++s) {
      const auto j = static_cast<std::size_t>(column_[static_cast<std::size_t>(s)]);
      scale(at(diagonal_[j]), at(s), lanes, 1);
      for (Index u = diagonal_[j] + 1; u < begin_[j + 1]; ++u)
        subtract(at(s), at(u), at(where[static_cast<std::size_t>(column_[static_cast<std::size_t>(u)])]), lanes, 1);
    }
    double* pivot = at(diagonal);
    for (Index k = 0; k < lanes; ++k) {
      const double re = pivot[k], im = pivot[lanes + k], square = re * re + im * im;
      pivot[k] = re / square;
      pivot[lanes + k] = -im / square;
    }
  }
}

const double* Pencil::times_lambda(const double* v, Eigen::ArrayXd& product) const {
  const Index lanes = lanes_, count = product.size() / 2;
  for (Index c = 0; c < count; c += lanes)
    for (Index k = 0; k < lanes; ++k) {
      const double re = lambda_[k], im = lambda_[lanes + k], vr = v[c + k], vi = v[count + c + k];
      product[c + k] = re * vr - im * vi;
      product[count + c + k] = re * vi + im * vr;
    }
  return product.data();
}

void Pencil::solve(MatrixXd& x, Index columns) const {
  const Index lanes = lanes_, count = lanes * columns;
  Eigen::ArrayXd turned(2 * count);
  const auto by_lambda = [&](const double* v) { return times_lambda(v, turned); };
  MatrixXd z(2 * count, kept_);
  for (Index p = 0; p < kept_; ++p) z.col(p) = x.col(row_[static_cast<std::size_t>(p)]);
  // Eliminated states at rest: x_b = y_i/beta.
  std::vector<bool> moves(rates_.size());
  for (std::size_t e = 0; e < rates_.size(); ++e) moves[e] = (x.col(rates_[e].row).array() != 0).any();
  for (const Coupling& c : couplings_) {
    if (!moves[static_cast<std::size_t>(c.rate)]) continue;
    const Rate& r = rates_[static_cast<std::size_t>(c.rate)];
    const double* y = x.col(r.row).data();
    subtract(c.value / r.beta, c.degree == 0 ? y : by_lambda(y), z.col(c.place).data(), 2 * count);
  }
  for (Index i = 0; i < kept_; ++i)
    for (Index s = begin_[static_cast<std::size_t>(i)]; s < diagonal_[static_cast<std::size_t>(i)]; ++s)
      subtract(at(s), z.col(column_[static_cast<std::size_t>(s)]).data(), z.col(i).data(), lanes, columns);
  for (Index i = kept_; i-- > 0;) {
    const Index diagonal = diagonal_[static_cast<std::size_t>(i)];
    for (Index s = diagonal + 1; s < begin_[static_cast<std::size_t>(i) + 1]; ++s)
      subtract(at(s), z.col(column_[static_cast<std::size_t>(s)]).data(), z.col(i).data(), lanes, columns);
    scale(at(diagonal), z.col(i).data(), lanes, columns);
  }
  MatrixXd y_rates;  // rows and states may stand in each other's places
  if (std::find(moves.begin(), moves.end(), true) != moves.end()) {
    y_rates.resize(2 * count, eliminated());
    for (Index e = 0; e < eliminated(); ++e) y_rates.col(e) = x.col(rates_[static_cast<std::size_t>(e)].row);
  }
  for (std::size_t e = 0; e < rates_.size(); ++e) {
    const Rate& r = rates_[e];
    auto out = x.col(r.b);
    if (moves[e])
      out = y_rates.col(static_cast<Index>(e)) / r.beta;
    else
      out.setZero();
    subtract(r.alpha / r.beta, by_lambda(z.col(r.place_a).data()), out.data(), 2 * count);
  }
  for (Index p = 0; p < kept_; ++p) x.col(state_[static_cast<std::size_t>(p)]) = z.col(p);
}

// With A = L0 + lambda L1 and rows r (kept), i (rates), columns a (kept), b (eliminated):
//     A_rb^T x_r + beta x_i = y_b,   A_ra^T x_r + alpha lambda x_i = y_a   =>   T^T x_r = y_a - (alpha lambda/beta) y_b
// The conjugate transpose is the transpose between two conjugations.
void Pencil::solve_adjoint(MatrixXd& x, Index columns) const {
  const Index lanes = lanes_, count = lanes * columns;
  Eigen::ArrayXd turned(2 * count);
  const auto by_lambda = [&](const double* v) { return times_lambda(v, turned); };
  x.bottomRows(count) *= -1;
  MatrixXd z(2 * count, kept_);
  for (Index p = 0; p < kept_; ++p) z.col(p) = x.col(state_[static_cast<std::size_t>(p)]);
  for (const Rate& r : rates_)
    subtract(r.alpha / r.beta, by_lambda(x.col(r.b).data()), z.col(r.place_a).data(), 2 * count);
  for (Index i = 0; i < kept_; ++i) {
    const Index diagonal = diagonal_[static_cast<std::size_t>(i)];
    scale(at(diagonal), z.col(i).data(), lanes, columns);
    for (Index s = diagonal + 1; s < begin_[static_cast<std::size_t>(i) + 1]; ++s)
      subtract(at(s), z.col(i).data(), z.col(column_[static_cast<std::size_t>(s)]).data(), lanes, columns);
  }
  for (Index i = kept_; i-- > 0;)
    for (Index s = begin_[static_cast<std::size_t>(i)]; s < diagonal_[static_cast<std::size_t>(i)]; ++s)
      subtract(at(s), z.col(i).data(), z.col(column_[static_cast<std::size_t>(s)]).data(), lanes, columns);
  // x_i = (y_b - A_rb^T x_r)/beta
  MatrixXd x_i(2 * count, eliminated());
  for (Index e = 0; e < eliminated(); ++e) x_i.col(e) = x.col(rates_[static_cast<std::size_t>(e)].b);
  for (const Coupling& c : couplings_) {
    const double* v = z.col(c.place).data();
    subtract(c.value, c.degree == 0 ? v : by_lambda(v), x_i.col(c.rate).data(), 2 * count);
  }
  for (Index e = 0; e < eliminated(); ++e) {
    const Rate& r = rates_[static_cast<std::size_t>(e)];
    x.col(r.row) = x_i.col(e) / r.beta;
  }
  for (Index p = 0; p < kept_; ++p) x.col(row_[static_cast<std::size_t>(p)]) = z.col(p);
  x.bottomRows(count) *= -1;
}

}  // namespace whirl::solve
