#include "film/algebra/strip_inverse.hpp"

#include <algorithm>

#include "film/algebra/column_chain.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {

using Eigen::Index;

namespace {

template <class Scalar>
void sum_over_ranks(MPI_Comm comm, Scalar* values, Index count) {
  const auto doubles = static_cast<Index>(sizeof(Scalar) / sizeof(double));
  MPI_Allreduce(MPI_IN_PLACE, values, static_cast<int>(count * doubles), MPI_DOUBLE, MPI_SUM, comm);
}

}  // namespace

/// The part of a strip that stands on this rank: the column at its cut, if it does not begin the strip, and a chain.
///
/// Rows of the chain's first column see the cut before it by `to_first`, whose row sees them by `from_first`; likewise
/// the last column and the next rank's cut.
template <class Scalar>
class StripInverse::Piece {
public:
  using Matrix = typename ColumnChain<Scalar>::Matrix;
  using Vector = typename ColumnChain<Scalar>::Vector;

  Piece(MPI_Comm comm, int line, const Cut& cut) : comm_(comm), line_(line), cut_(cut) {}
  /// `entries` [5 rows of the film here]. Collective if the strip is cut, as solve().
  void factor(const Entries<Scalar>& entries);
  // Of `sides` right-hand sides, `rows` apart.
  void solve(bool transposed, const Scalar* r, Scalar* x, Index rows, Index sides) const;

private:
  [[nodiscard]] Index inner() const { return std::max(cut_.columns - (cut_.mine >= 0 ? 1 : 0), 0); }
  [[nodiscard]] bool from_behind() const { return cut_.mine >= 0 && cut_.next < 0; }
  void join(const Strip<Scalar>& here);

  MPI_Comm comm_;
  int line_;
  Cut cut_;
  ColumnChain<Scalar> chain_;  // from the last column to the first if only the first one is next to a cut
  Vector to_first_, from_first_, to_last_, from_last_;
  core::DenseLu<Scalar> joint_;  // of the columns at all cuts of the strip
};

template <class Scalar>
void StripInverse::Piece<Scalar>::factor(const Entries<Scalar>& entries) {
  using Block = typename Strip<Scalar>::Entries;
  const Index rows = entries.size() / places, n = inner(), first = cut_.columns - n;
  const auto take = [&](Place place, Index column, Index columns) -> Block {
    const Scalar* from = entries.data() + place * rows + cut_.row + column * line_;
    return Eigen::Map<const Block>(from, line_, columns);
  };
  const auto strip = [&](Index column, Index columns) {
    return Strip<Scalar>{take(before, column, columns), take(after, column, columns), take(below, column, columns),
                         take(above, column, columns), take(itself, column, columns)};
  };
  if (n > 0) {
    Strip<Scalar> s = strip(first, n);
    to_first_ = s.before.col(0);
    to_last_ = s.after.col(n - 1);
    if (from_behind()) {
      std::swap(s.before, s.after);
      for (Block* a : {&s.before, &s.after, &s.below, &s.above, &s.itself}) *a = a->rowwise().reverse().eval();
    }
    chain_.factor(s);
  }
  if (cut_.cuts > 0) join(strip(0, cut_.mine >= 0 ? 1 : 0));
}

// A_cc - A_ci A_ii^-1 A_ic of the columns c at cuts: what the columns i between two of them do stands in four blocks.
template <class Scalar>
void StripInverse::Piece<Scalar>::join(const Strip<Scalar>& here) {
  const Index m = line_, n = inner();
  const bool mine = cut_.mine >= 0, next = cut_.next >= 0;
  Matrix to_left = Matrix::Zero(m, cut_.cuts);
  if (mine) to_left.col(cut_.mine) = here.before.col(0);
  sum_over_ranks(comm_, to_left.data(), to_left.size());
  if (mine) from_first_ = here.after.col(0);
  if (next) from_last_ = to_left.col(cut_.next);

  Matrix joint = Matrix::Zero(m * cut_.cuts, m * cut_.cuts);
  const auto block = [&](int i, int k) { return joint.block(i * m, k * m, m, m); };
  if (mine) {
    auto own = block(cut_.mine, cut_.mine);
    own.diagonal() = here.itself.col(0);
    own.diagonal(-1) = here.below.col(0).tail(m - 1);
    own.diagonal(1) = here.above.col(0).head(m - 1);
  }
  if (n == 0) {
    if (mine && next) {  // two cuts side by side
      block(cut_.mine, cut_.next).diagonal() = from_first_;
      block(cut_.next, cut_.mine).diagonal() = from_last_;
    }
  } else if (mine && next) {
    Matrix x = Matrix::Zero(m * n, 2 * m);
    x.topLeftCorner(m, m) = to_first_.asDiagonal();
    x.bottomRightCorner(m, m) = to_last_.asDiagonal();
    chain_.forward(false, x);
    chain_.backward(false, x);
    block(cut_.mine, cut_.mine) -= from_first_.asDiagonal() * x.topLeftCorner(m, m);
    block(cut_.mine, cut_.next) -= from_first_.asDiagonal() * x.topRightCorner(m, m);
    block(cut_.next, cut_.mine) -= from_last_.asDiagonal() * x.bottomLeftCorner(m, m);
    block(cut_.next, cut_.next) -= from_last_.asDiagonal() * x.bottomRightCorner(m, m);
  } else if (mine) {
    block(cut_.mine, cut_.mine) -= from_first_.asDiagonal() * chain_.last() * to_first_.asDiagonal();
  } else if (next) {
    block(cut_.next, cut_.next) -= from_last_.asDiagonal() * chain_.last() * to_last_.asDiagonal();
  }
  sum_over_ranks(comm_, joint.data(), joint.size());
  joint_.compute(joint);
}

template <class Scalar>
void StripInverse::Piece<Scalar>::solve(bool transposed, const Scalar* r, Scalar* x, Index rows, Index sides) const {
  const Index m = line_, n = inner(), first = cut_.columns - n;
  const bool mine = cut_.mine >= 0, next = cut_.next >= 0, behind = from_behind();
  const Vector &to_first = transposed ? from_first_ : to_first_, &from_first = transposed ? to_first_ : from_first_;
  const Vector &to_last = transposed ? from_last_ : to_last_, &from_last = transposed ? to_last_ : from_last_;
  using Columns = Eigen::Map<Matrix>;
  // Right-hand side k: all columns of the strip, and those between cuts in their order of elimination.
  const auto given = [&](Index k) { return Eigen::Map<const Matrix>(r + k * rows, m, cut_.columns); };
  Matrix z(m * n, sides);
  const auto inner_of = [&](Index k) { return Columns(z.col(k).data(), m, n); };
  const auto in_order = [&](const Eigen::Ref<const Matrix>& columns) -> Matrix {
    if (behind) return columns.rowwise().reverse();
    return columns;
  };
  for (Index k = 0; k < sides; ++k) inner_of(k) = in_order(given(k).rightCols(n));
  if (n > 0) chain_.forward(transposed, z);
  Matrix at_cuts, beyond;
  if (cut_.cuts > 0) {
    at_cuts.setZero(m * cut_.cuts, sides);
    const auto at = [&](int cut) { return at_cuts.middleRows(cut * m, m); };
    if (n > 0 && mine && next) chain_.backward(transposed, z);
    for (Index k = 0; mine && k < sides; ++k) at(cut_.mine).col(k) += given(k).col(0);
    if (n > 0 && mine) at(cut_.mine) -= from_first.asDiagonal() * (behind ? z.bottomRows(m) : z.topRows(m));
    if (n > 0 && next) at(cut_.next) -= from_last.asDiagonal() * z.bottomRows(m);
    sum_over_ranks(comm_, at_cuts.data(), at_cuts.size());
    at_cuts = transposed ? joint_.solve_transposed(at_cuts) : joint_.solve(at_cuts);
    if (n > 0 && mine && next) {
      for (Index k = 0; k < sides; ++k) inner_of(k) = given(k).rightCols(n);
      z.topRows(m) -= to_first.asDiagonal() * at(cut_.mine);
      chain_.forward(transposed, z);
    }
    if (n > 0 && next) beyond = to_last.asDiagonal() * at(cut_.next);
    if (n > 0 && behind) beyond = to_first.asDiagonal() * at(cut_.mine);
    for (Index k = 0; mine && k < sides; ++k) Eigen::Map<Vector>(x + k * rows, m) = at(cut_.mine).col(k);
  }
  if (n == 0) return;
  chain_.backward(transposed, z, beyond.size() > 0 ? &beyond : nullptr);
  for (Index k = 0; k < sides; ++k) Columns(x + k * rows + first * m, m, n) = in_order(inner_of(k));
}

template <class Scalar>
struct StripInverse::Factors {
  MPI_Comm comm;
  int row;                  // the first one here
  Entries<Scalar> entries;  // that they belong to
  std::vector<Piece<Scalar>> pieces;
};

struct StripInverse::Latest {
  std::weak_ptr<Factors<double>> factors;
};

std::shared_ptr<StripInverse::Latest> StripInverse::nothing_yet() {
  return std::make_shared<Latest>();
}

StripInverse::StripInverse(MPI_Comm comm, const Share& share, int line, const std::vector<Extent>& strips,
                           std::shared_ptr<Latest> latest)
    : comm_(comm), line_(line), rows_(share.rows()), latest_(std::move(latest)) {
  int ranks = 1, rank = 0;
  MPI_Comm_size(comm, &ranks);
  MPI_Comm_rank(comm, &rank);
  std::vector<int> begins(static_cast<std::size_t>(ranks));
  MPI_Allgather(&share.begin, 1, MPI_INT, begins.data(), 1, MPI_INT, comm);
  for (const Extent& s : strips) {
    const int end = s.first + s.columns * line, from = std::clamp(share.begin, s.first, end);
    Cut& cut =
        cuts_.emplace_back(Cut{from - share.begin, (std::clamp(share.end, s.first, end) - from) / line, 0, -1, -1});
    for (int r = 0; r < ranks; ++r) {
      const int begin = begins[static_cast<std::size_t>(r)];
      if (begin <= s.first || begin >= end) continue;
      if (r == rank) cut.mine = cut.cuts;
      if (r == rank + 1) cut.next = cut.cuts;
      ++cut.cuts;
    }
    shared_ = shared_ || cut.cuts > 0;
  }
  const auto place = [&](int row, int state) {
    const int away = state - share.begin - row;
    Place p = itself;
    if (away == -line)
      p = before;
    else if (away == line)
      p = after;
    else if (away == -1)
      p = below;
    else if (away == 1)
      p = above;
    else
      core::require(away == 0, "rows that see their neighbours in a strip");
    return p * rows_ + row;
  };
  for_entries(share, share.d_states, {}, [&](int row, int s, double) { state_places_.push_back(place(row, s)); });
  for_entries(share, share.d_rates, {}, [&](int row, int s, double) { rate_places_.push_back(place(row, s)); });
}

StripInverse::~StripInverse() = default;

template <class Scalar>
StripInverse::Entries<Scalar> StripInverse::entries(const StateDerivatives& at, double alpha, Scalar sigma) const {
  Entries<Scalar> out = Entries<Scalar>::Zero(Index{places} * rows_);
  for (std::size_t k = 0; k < state_places_.size(); ++k) out[state_places_[k]] += alpha * at.states[k];
  if (sigma != Scalar(0))
    for (std::size_t k = 0; k < rate_places_.size(); ++k) out[rate_places_[k]] += sigma * at.rates[k];
  return out;
}

template <class Scalar>
void StripInverse::find(Entries<Scalar> entries, std::shared_ptr<Factors<Scalar>>& at_hand,
                        std::shared_ptr<Factors<Scalar>> known) {
  const int row = cuts_.front().row;
  const auto serve = [&](const std::shared_ptr<Factors<Scalar>>& f) {
    int yes = f && f->comm == comm_ && f->row == row && f->entries.size() == entries.size() &&
              ((f->entries - entries).abs() <= 1e-12 * entries.abs()).all();
    if (shared_) MPI_Allreduce(MPI_IN_PLACE, &yes, 1, MPI_INT, MPI_LAND, comm_);
    return yes != 0;
  };
  if (serve(at_hand)) return;
  if (known && known != at_hand && serve(known)) {
    at_hand = std::move(known);
    return;
  }
  known.reset();
  if (!at_hand || at_hand.use_count() > 1) {
    at_hand = std::make_shared<Factors<Scalar>>(Factors<Scalar>{comm_, row, {}, {}});
    for (const Cut& cut : cuts_) at_hand->pieces.emplace_back(comm_, line_, cut);
  }
  at_hand->entries = std::move(entries);
  for (Piece<Scalar>& piece : at_hand->pieces) piece.factor(at_hand->entries);
  ++factorisations_;
}

void StripInverse::set(const StateDerivatives& at, double alpha, double sigma) {
  find(entries(at, alpha, sigma), factors_, latest_->factors.lock());
  latest_->factors = factors_;
}

void StripInverse::set_at(const StateDerivatives& at, Complex lambda) {
  find(entries(at, 1.0, lambda), factors_at_, {});
}

template <class Scalar>
void StripInverse::solve(const Factors<Scalar>& factors, bool transposed, std::span<const Scalar> r,
                         std::span<Scalar> x) const {
  const Index sides = rows_ > 0 ? static_cast<Index>(r.size()) / rows_ : 0;
  for (std::size_t k = 0; k < cuts_.size(); ++k)
    factors.pieces[k].solve(transposed, r.data() + cuts_[k].row, x.data() + cuts_[k].row, rows_, sides);
}

void StripInverse::apply(std::span<const double> r, std::span<double> x) {
  solve(*factors_, false, r, x);
}

void StripInverse::apply_transposed(std::span<const double> r, std::span<double> x) {
  solve(*factors_, true, r, x);
}

void StripInverse::apply_at(std::span<const Complex> r, std::span<Complex> x) {
  solve(*factors_at_, false, r, x);
}

}  // namespace whirl::film
