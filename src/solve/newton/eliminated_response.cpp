#include "solve/newton/eliminated_response.hpp"

#include <algorithm>

#include "whirl/core/error.hpp"
#include "whirl/core/index.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/solve/newton/frequency_solver.hpp"

namespace whirl::solve {

using core::at;
using core::check;
using Eigen::Index;

void EliminatedResponse::read(Mat jx, Mat jd, const double* row, const double* column) {
  check(MatGetSize(jx, &n_, nullptr));
  const std::vector<PetscInt> old_begin = std::move(begin_), old_columns = std::move(columns_);
  begin_.assign(1, 0);
  columns_.clear();
  x_.clear();
  d_.clear();
  std::vector<Link> links(at(n_));
  std::vector<bool> fixed(at(n_), false);  // states that others are expressed by must stay
  for (PetscInt i = 0; i < n_; ++i) {
    PetscInt k = 0, kd = 0, nonzero_x = 0, nonzero_d = 0;
    const PetscInt *columns = nullptr, *columns_d = nullptr;
    const PetscScalar *x = nullptr, *d = nullptr;
    check(MatGetRow(jx, i, &k, &columns, &x));
    check(MatGetRow(jd, i, &kd, &columns_d, &d));
    core::require(k == kd, "dF/dx and dF/d(dx/dt) have one pattern");
    Link link;
    link.row = i;
    PetscInt v = -1;
    for (PetscInt e = 0; e < k; ++e) {
      const PetscInt c = columns[e];
      const double s = column[c] / row[i];
      columns_.push_back(c);
      x_.push_back(s * x[e]);
      d_.push_back(s * d[e]);
      if (x[e] != 0) v = c, link.a = s * x[e], ++nonzero_x;
      if (d[e] != 0) link.to = c, link.d = s * d[e], ++nonzero_d;
    }
    check(MatRestoreRow(jx, i, &k, &columns, &x));
    check(MatRestoreRow(jd, i, &kd, &columns_d, &d));
    begin_.push_back(static_cast<PetscInt>(columns_.size()));
    if (nonzero_x == 1 && nonzero_d == 1 && v != link.to && links[at(v)].row < 0 && !fixed[at(v)] &&
        links[at(link.to)].row < 0) {
      links[at(v)] = link;
      fixed[at(link.to)] = true;
    }
  }
  const auto same = [](const Link& p, const Link& q) { return p.row == q.row && p.to == q.to; };
  if (begin_ != old_begin || columns_ != old_columns ||
      !std::equal(links.begin(), links.end(), links_.begin(), links_.end(), same))
    analysed_ = false;
  links_ = std::move(links);
}

void EliminatedResponse::analyse() {
  kept_.assign(at(n_), -1);
  row_of_.assign(at(n_), 0);
  PetscInt size = 0, rows = 0;
  for (PetscInt c = 0; c < n_; ++c) {
    const Link& link = links_[at(c)];
    if (link.row < 0)
      kept_[at(c)] = size++;
    else
      row_of_[at(link.row)] = -1;
  }
  for (PetscInt i = 0; i < n_; ++i)
    if (row_of_[at(i)] == 0) row_of_[at(i)] = rows++;
  const auto column_of = [&](std::size_t e) {
    const Link& link = links_[at(columns_[e])];
    return kept_[at(link.row < 0 ? columns_[e] : link.to)];
  };
  const auto each = [&](auto&& action) {
    for (PetscInt i = 0; i < n_; ++i) {
      if (row_of_[at(i)] < 0) continue;
      for (std::size_t e = at(begin_[at(i)]); e < at(begin_[at(i) + 1]); ++e)
        if (x_[e] != 0 || d_[e] != 0) action(row_of_[at(i)], e);
    }
  };
  std::vector<Eigen::Triplet<Complex>> entries;
  each([&](PetscInt row, std::size_t e) { entries.emplace_back(row, column_of(e), 1.0); });
  matrix_.resize(size, size);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  matrix_.makeCompressed();
  place_.assign(columns_.size(), -1);
  each([&](PetscInt row, std::size_t e) {
    const auto c = column_of(e);
    const auto* first = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[c];
    const auto* last = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[c + 1];
    place_[e] = static_cast<PetscInt>(std::lower_bound(first, last, row) - matrix_.innerIndexPtr());
  });
  lu_.analyse(matrix_);
  analysed_ = true;
}

void EliminatedResponse::linearise(Mat jx, Mat jd, const double* row, const double* column) {
  read(jx, jd, row, column);
  row_.assign(row, row + n_);
  column_.assign(column, column + n_);
}

void EliminatedResponse::factorise(double omega) {
  omega_ = omega;
  // An entry that was zero when the pattern was made and is not now asks for a new one.
  for (std::size_t e = 0; e < columns_.size() && analysed_; ++e)
    if (place_[e] < 0 && (x_[e] != 0 || d_[e] != 0)) {
      const auto i = std::upper_bound(begin_.begin(), begin_.end(), static_cast<PetscInt>(e)) - begin_.begin() - 1;
      analysed_ = row_of_[static_cast<std::size_t>(i)] < 0;
    }
  if (!analysed_) analyse();

  const Complex rate(0, omega);
  Complex* const values = matrix_.valuePtr();
  std::fill(values, values + matrix_.nonZeros(), Complex(0));
  for (PetscInt i = 0; i < n_; ++i) {
    if (row_of_[at(i)] < 0) continue;
    for (std::size_t e = at(begin_[at(i)]); e < at(begin_[at(i) + 1]); ++e) {
      if (place_[e] < 0) continue;
      Complex value(x_[e], omega * d_[e]);
      const Link& link = links_[at(columns_[e])];
      if (link.row >= 0) value *= -rate * link.d / link.a;
      values[place_[e]] += value;
    }
  }
  if (!lu_.factorise(matrix_)) throw core::NotConverged(singular_at_frequency);
}

void EliminatedResponse::solve(const std::vector<double>& right, std::vector<double>& amplitude) const {
  const auto b = [&](PetscInt i) { return Complex(right[at(2 * i)], right[at(2 * i + 1)]) / row_[at(i)]; };
  Eigen::VectorXcd rhs(matrix_.rows());
  for (PetscInt i = 0; i < n_; ++i) {
    if (row_of_[at(i)] < 0) continue;
    Complex load = b(i);
    for (std::size_t e = at(begin_[at(i)]); e < at(begin_[at(i) + 1]); ++e) {
      const Link& link = links_[at(columns_[e])];
      if (place_[e] >= 0 && link.row >= 0) load -= Complex(x_[e], omega_ * d_[e]) * b(link.row) / link.a;
    }
    rhs(row_of_[at(i)]) = load;
  }
  const Eigen::VectorXcd z = lu_.solve(rhs);
  const Complex rate(0, omega_);
  amplitude.resize(at(2 * n_));
  for (PetscInt c = 0; c < n_; ++c) {
    const Link& link = links_[at(c)];
    const Complex value =
        link.row < 0 ? z(kept_[at(c)]) : (b(link.row) - rate * link.d * z(kept_[at(link.to)])) / link.a;
    amplitude[at(2 * c)] = value.real() * column_[at(c)];
    amplitude[at(2 * c + 1)] = value.imag() * column_[at(c)];
  }
}

}  // namespace whirl::solve
