#include "solve/newton/frequency_hub.hpp"

#include <algorithm>
#include <limits>

#include "whirl/core/index.hpp"

namespace whirl::solve {

using core::at;
using Complex = std::complex<double>;
using Eigen::Index;

void FrequencyHub::linearise(const std::vector<problem::KinematicRow>& kinematic) {
  found_.assign(at(a.cols()), {});
  for (const auto& [row, state, rate] : kinematic)
    found_[at(rate)] = {row, state, a.coeff(row, rate), b.coeff(row, state)};
}

void FrequencyHub::analyse() {
  const std::size_t n = links_.size();
  kept_.assign(n, -1);
  row_of_.assign(n, 0);
  int size = 0, rows = 0;
  for (std::size_t c = 0; c < n; ++c)
    if (links_[c].row < 0)
      kept_[c] = size++;
    else
      row_of_[at(links_[c].row)] = -1;
  for (int& row : row_of_)
    if (row == 0) row = rows++;
  const auto column_of = [&](int c) { return kept_[at(links_[at(c)].row < 0 ? c : links_[at(c)].to)]; };
  // Those of a and b that are not zero, then those of blocks.
  const auto each = [&](auto&& sparse, auto&& dense) {
    for (int c = 0; c < a.outerSize(); ++c)
      for (int e = a.outerIndexPtr()[c]; e < a.outerIndexPtr()[c + 1]; ++e) {
        const int row = row_of_[at(a.innerIndexPtr()[e])];
        if (row >= 0 && (a.valuePtr()[e] != 0 || b.valuePtr()[e] != 0)) sparse(row, column_of(c), at(e));
      }
    for (const Block& block : blocks_)
      for (const int c : block.columns)
        for (const int r : block.rows) dense(row_of_[at(r)], column_of(c));
  };
  std::vector<Eigen::Triplet<Complex>> entries;
  const auto list = [&](int row, int column, std::size_t = 0) { entries.emplace_back(row, column, 1.0); };
  each(list, list);
  matrix_.resize(size, size);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  matrix_.makeCompressed();
  const auto place = [&](int row, int column) {
    const auto* first = matrix_.innerIndexPtr();
    return static_cast<int>(
        std::lower_bound(first + matrix_.outerIndexPtr()[column], first + matrix_.outerIndexPtr()[column + 1], row) -
        first);
  };
  place_.assign(at(a.nonZeros()), -1);
  block_place_.clear();
  each([&](int row, int column, std::size_t e) { place_[e] = place(row, column); },
       [&](int row, int column) { block_place_.push_back(place(row, column)); });
  lu_.analyse(matrix_);
  analysed_ = true;
}

FrequencyHub::Border FrequencyHub::split(std::vector<Block>& blocks, Index n) {
  Border out{Vector::Zero(n), Vector::Zero(n), {}, {}, 0, 0, 0};
  for (Block& block : blocks) {
    std::vector<Index> rows, columns;  // that stay
    for (std::size_t r = 0; r < block.rows.size(); ++r)
      if (block.rows[r] < n) rows.push_back(static_cast<Index>(r));
    for (std::size_t c = 0; c < block.columns.size(); ++c)
      if (block.columns[c] < n) columns.push_back(static_cast<Index>(c));
    for (std::size_t r = 0; r < block.rows.size(); ++r)
      for (std::size_t c = 0; c < block.columns.size(); ++c) {
        const Complex entry = block.values(static_cast<Index>(r), static_cast<Index>(c));
        if (block.rows[r] == n && block.columns[c] == n)
          out.d += entry;
        else if (block.columns[c] == n)
          out.b(block.rows[r]) += entry;
        else if (block.rows[r] == n)
          out.c(block.columns[c]) += std::conj(entry);
      }
    Block inner;
    for (const Index r : rows) inner.rows.push_back(block.rows[at(r)]);
    for (const Index c : columns) inner.columns.push_back(block.columns[at(c)]);
    inner.values = block.values(rows, columns);
    block = std::move(inner);
  }
  std::erase_if(blocks, [](const Block& block) { return block.rows.empty() || block.columns.empty(); });
  return out;
}

bool FrequencyHub::factorise(Complex lambda, std::vector<Block> blocks, int border) {
  border_.reset();
  if (border == 0) return eliminate(lambda, std::move(blocks), found_);
  std::vector<Block> inner = blocks;
  Border around = split(inner, a.cols());
  if (eliminate(lambda, std::move(inner), found_)) {
    around.v = solve_inner(around.b);
    around.w = solve_inner_adjoint(around.c);
    around.right = around.d - around.c.dot(around.v);
    around.left = around.d - around.w.dot(around.b);
    // Two steps repair a rest that is singular to rounding, not one whose last pivot is nothing at all.
    constexpr double limit = 1e3 / std::numeric_limits<double>::epsilon();
    const double largest = matrix_.coeffs().abs().maxCoeff();
    const bool exact = largest * around.v.norm() < limit * around.b.norm() &&
                       largest * around.w.norm() < limit * around.c.norm();  // false for no numbers
    if (exact && around.right != 0.0 && around.left != 0.0) {
      border_ = std::move(around);
      return true;
    }
  }
  return eliminate(lambda, std::move(blocks), std::vector<Link>(at(a.cols() + border)));
}

bool FrequencyHub::eliminate(Complex lambda, std::vector<Block> blocks, std::vector<Link> links) {
  const auto same = [](const auto& p, const auto& q, auto&& alike) {
    return std::equal(p.begin(), p.end(), q.begin(), q.end(), alike);
  };
  analysed_ =
      analysed_ && same(links, links_, [](const Link& p, const Link& q) { return p.row == q.row && p.to == q.to; }) &&
      same(blocks, blocks_, [](const Block& p, const Block& q) { return p.rows == q.rows && p.columns == q.columns; });
  lambda_ = lambda;
  links_ = std::move(links);
  blocks_ = std::move(blocks);
  // An entry that was zero when the pattern was made and is not now asks for a new one.
  for (int e = 0; e < a.nonZeros() && analysed_; ++e)
    analysed_ =
        place_[at(e)] >= 0 || row_of_[at(a.innerIndexPtr()[e])] < 0 || (a.valuePtr()[e] == 0 && b.valuePtr()[e] == 0);
  if (!analysed_) analyse();
  Complex* const values = matrix_.valuePtr();
  std::fill(values, values + matrix_.nonZeros(), Complex(0));
  const auto factor = [&](int c) { return links_[at(c)].row < 0 ? Complex(1) : follows(links_[at(c)]); };
  for (int c = 0; c < a.outerSize(); ++c) {
    const Complex by = factor(c);
    for (int e = a.outerIndexPtr()[c]; e < a.outerIndexPtr()[c + 1]; ++e)
      if (place_[at(e)] >= 0) values[place_[at(e)]] += (a.valuePtr()[e] + lambda * b.valuePtr()[e]) * by;
  }
  const int* to = block_place_.data();
  for (const Block& block : blocks_)
    for (std::size_t c = 0; c < block.columns.size(); ++c)
      for (std::size_t r = 0; r < block.rows.size(); ++r)
        values[*to++] += block.values(static_cast<Index>(r), static_cast<Index>(c)) * factor(block.columns[c]);
  return lu_.factorise(matrix_);
}

template <class Use>
void FrequencyHub::in_column(int c, Use&& use) const {
  for (int e = a.outerIndexPtr()[c]; e < a.outerIndexPtr()[c + 1]; ++e)
    use(a.innerIndexPtr()[e], a.valuePtr()[e] + lambda_ * b.valuePtr()[e]);
  for (const Block& block : blocks_)
    if (const auto found = std::find(block.columns.begin(), block.columns.end(), c); found != block.columns.end())
      for (std::size_t r = 0; r < block.rows.size(); ++r)
        use(block.rows[r], block.values(static_cast<Index>(r), found - block.columns.begin()));
}

// With the states x = P z + Q r and the rows S that stay: A^-1 = P (S A P)^-1 S (1 - A Q) + Q.
FrequencyHub::Vector FrequencyHub::solve_inner(const Vector& r) const {
  const auto n = static_cast<int>(links_.size());
  Vector load = r, x(n), kept(matrix_.rows());
  for (int c = 0; c < n; ++c)
    if (const Link& link = links_[at(c)]; link.row >= 0 && r(link.row) != 0.0) {
      const Complex moved = r(link.row) / link.a;
      in_column(c, [&](int row, Complex entry) { load(row) -= entry * moved; });
    }
  for (int i = 0; i < n; ++i)
    if (row_of_[at(i)] >= 0) kept(row_of_[at(i)]) = load(i);
  kept = lu_.solve(kept);
  for (int c = 0; c < n; ++c) {
    const Link& link = links_[at(c)];
    x(c) = link.row < 0 ? kept(kept_[at(c)]) : r(link.row) / link.a + follows(link) * kept(kept_[at(link.to)]);
  }
  return x;
}

FrequencyHub::Vector FrequencyHub::solve_inner_adjoint(const Vector& r) const {
  const auto n = static_cast<int>(links_.size());
  Vector y = Vector::Zero(n), kept = Vector::Zero(matrix_.rows());
  for (int c = 0; c < n; ++c)
    if (const Link& link = links_[at(c)]; link.row < 0)
      kept(kept_[at(c)]) += std::conj(r(c));
    else
      kept(kept_[at(link.to)]) += follows(link) * std::conj(r(c));
  kept = lu_.solve_transposed(kept).conjugate();
  for (int i = 0; i < n; ++i)
    if (row_of_[at(i)] >= 0) y(i) = kept(row_of_[at(i)]);
  for (int c = 0; c < n; ++c)
    if (const Link& link = links_[at(c)]; link.row >= 0) {
      Complex left = r(c);
      in_column(c, [&](int row, Complex entry) { left -= row_of_[at(row)] < 0 ? 0.0 : std::conj(entry) * y(row); });
      y(link.row) = left / link.a;
    }
  return y;
}

// Two steps: the first takes the border's unknown from the left null vector, the second what is left from the right
// one.
template <class Rest>
FrequencyHub::Vector FrequencyHub::Border::solve(const Vector& r, Rest&& rest) const {
  const Index n = b.size();
  const Complex first = (r(n) - w.dot(r.head(n))) / left;
  const Vector z = rest(r.head(n) - b * first);
  const Complex second = (r(n) - d * first - c.dot(z)) / right;
  Vector out(n + 1);
  out << z - v * second, first + second;
  return out;
}

FrequencyHub::Vector FrequencyHub::solve(const Vector& r) const {
  if (!border_) return solve_inner(r);
  return border_->solve(r, [this](const Vector& y) { return solve_inner(y); });
}

FrequencyHub::Vector FrequencyHub::solve_adjoint(const Vector& r) const {
  if (!border_) return solve_inner_adjoint(r);
  return border_->adjoint().solve(r, [this](const Vector& y) { return solve_inner_adjoint(y); });
}

}  // namespace whirl::solve
