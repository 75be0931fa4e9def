#include "film/algebra/ring_preconditioner.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <tuple>
#include <type_traits>
#include <utility>

#include "film/algebra/line_solver.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/plan.hpp"

namespace whirl::film {
namespace {

static_assert(std::is_same_v<Real, float>, "exchange() and gather() send MPI_FLOAT");

}  // namespace

// The rows of one level on this rank.
class RingPreconditioner::Level {
public:
  Level(MPI_Comm comm, int lines, int line, Lines here, bool finest);
  // Rows of all lines here: own line, line before, line after.
  struct Rows {
    Block own, before, after;
  };
  void set(const Rows& rows);
  void cycle(const std::vector<Real>& r, std::vector<Real>& x);  // [line][lines here]

private:
  struct Colour {
    Block own, before, after;
    LineSolver solver;
    Columns rhs, x;
  };
  void split(const Columns& from, Columns& even, Columns& odd) const;
  void exchange(std::initializer_list<Columns*> columns) const;
  void gather(const Rows& mine, Rows& all) const;
  void coarsen(Rows& coarse);
  void solve_f(bool zero, bool last = false);
  void coarse_residual(Columns& out) const;

  MPI_Comm comm_;
  int rank_, size_, lines_, line_;
  Lines here_;
  bool finest_, odd_;      // odd: the last line and the first are both even and neighbours
  int c_begin_, f_begin_;  // first even and odd line here, in their own count
  int f_shift_, c_shift_;  // column of the odd line after even line 0 here; of the even line before odd line 0 here
  Colour c_, f_;
  Block wrap_before_, wrap_after_;  // coupling of the first even line to the last one and back
  LineSolver single_;
  Columns single_x_, residual_;
  std::vector<Real> coarse_r_, coarse_x_, part_;
  mutable std::vector<Real> send_, receive_;
  std::vector<int> counts_, offsets_;  // of gathered lines
  std::unique_ptr<Level> coarse_;
  bool gathered_ = false;  // the coarse level holds all lines on every rank
};

RingPreconditioner::Level::Level(MPI_Comm comm, int lines, int line, Lines here, bool finest)
    : comm_(comm), rank_(0), size_(1), lines_(lines), line_(line), here_(here), finest_(finest), odd_(lines % 2 != 0) {
  MPI_Comm_rank(comm, &rank_);
  MPI_Comm_size(comm, &size_);
  c_begin_ = (here.begin + 1) / 2;
  f_begin_ = here.begin / 2;
  const int c_end = (here.end + 1) / 2, f_end = here.end / 2;
  f_shift_ = c_begin_ - f_begin_;
  c_shift_ = f_begin_ - c_begin_;
  const auto colour = [line](int n) {
    return Colour{Block(line, n), Block(line, n), Block(line, n), {}, Columns(line, n), Columns(line, n)};
  };
  c_ = colour(c_end - c_begin_);
  f_ = colour(f_end - f_begin_);
  if (lines == 1) {
    single_x_ = Columns(line, 1);
    return;
  }
  residual_ = Columns(line, c_.x.count);
  wrap_before_ = wrap_after_ = Block(line, 1);
  const int coarse_lines = (lines + 1) / 2;
  gathered_ = core::plan::level(coarse_lines, line, size_) == core::plan::LevelWay::repeated;
  Lines coarse_here{c_begin_, c_end};
  if (gathered_) {
    coarse_here = {0, coarse_lines};
    counts_.resize(at(size_));
    offsets_.assign(at(size_), 0);
    const int mine = c_.x.count * line;
    MPI_Allgather(&mine, 1, MPI_INT, counts_.data(), 1, MPI_INT, comm_);
    for (int r = 1; r < size_; ++r) offsets_[at(r)] = offsets_[at(r - 1)] + counts_[at(r - 1)];
  }
  coarse_ = std::make_unique<Level>(gathered_ ? MPI_COMM_SELF : comm_, coarse_lines, line, coarse_here, false);
  coarse_r_.resize(at(coarse_here.count() * line));
  coarse_x_.resize(coarse_r_.size());
  part_.resize(at(c_.x.count * line));
}

// Fills the columns beside the first and the last one from the neighbours in the ring.
void RingPreconditioner::Level::exchange(std::initializer_list<Columns*> columns) const {
  if (size_ == 1) {
    for (Columns* c : columns)
      for (int z = 0; z < c->length; ++z) {
        Real* row = c->row(z);
        row[-1] = row[c->count - 1];
        row[c->count] = row[0];
      }
    return;
  }
  // First columns, then last ones. Two ranks are each other's neighbours on both sides: one message instead of two.
  const std::size_t n = columns.size() * at(line_);
  send_.resize(2 * n);
  receive_.resize(2 * n);
  std::size_t k = 0;
  for (Columns* c : columns)
    for (int z = 0; z < line_; ++z, ++k) {
      send_[k] = c->row(z)[0];
      send_[n + k] = c->row(z)[c->count - 1];
    }
  const int before = (rank_ + size_ - 1) % size_, after = (rank_ + 1) % size_, m = static_cast<int>(n);
  if (size_ == 2) {
    MPI_Sendrecv(send_.data(), 2 * m, MPI_FLOAT, after, 1, receive_.data(), 2 * m, MPI_FLOAT, after, 1, comm_,
                 MPI_STATUS_IGNORE);
  } else {
    std::array<MPI_Request, 4> all{};
    MPI_Irecv(receive_.data(), m, MPI_FLOAT, after, 1, comm_, &all[0]);
    MPI_Irecv(receive_.data() + n, m, MPI_FLOAT, before, 2, comm_, &all[1]);
    MPI_Isend(send_.data(), m, MPI_FLOAT, before, 1, comm_, &all[2]);
    MPI_Isend(send_.data() + n, m, MPI_FLOAT, after, 2, comm_, &all[3]);
    MPI_Waitall(4, all.data(), MPI_STATUSES_IGNORE);
  }
  k = 0;
  for (Columns* c : columns)
    for (int z = 0; z < line_; ++z, ++k) {
      c->row(z)[-1] = receive_[n + k];
      c->row(z)[c->count] = receive_[k];
    }
}

void RingPreconditioner::Level::split(const Columns& from, Columns& even, Columns& odd) const {
  const int e = here_.begin % 2, o = 1 - e;  // column of the first even and odd line
  for (int z = 0; z < line_; ++z) {
    const Real* row = from.row(z);
    Real *c = even.row(z), *f = odd.row(z);
    for (int i = 0; i < even.count; ++i) c[i] = row[e + 2 * i];
    for (int i = 0; i < odd.count; ++i) f[i] = row[o + 2 * i];
  }
}

void RingPreconditioner::Level::set(const Rows& given) {
  Rows rows = given;
  if (lines_ == 1) {
    // Both neighbours are the line itself.
    for (auto [to, b, a] : {std::array{&rows.own.below, &rows.before.below, &rows.after.below},
                            std::array{&rows.own.centre, &rows.before.centre, &rows.after.centre},
                            std::array{&rows.own.above, &rows.before.above, &rows.after.above}})
      for (std::size_t k = 0; k < to->data.size(); ++k) to->data[k] += b->data[k] + a->data[k];
    single_.factor(rows.own);
    return;
  }
  const auto take = [&](Block& from, Block& even, Block& odd) {
    split(from.below, even.below, odd.below);
    split(from.centre, even.centre, odd.centre);
    split(from.above, even.above, odd.above);
  };
  take(rows.own, c_.own, f_.own);
  take(rows.before, c_.before, f_.before);
  take(rows.after, c_.after, f_.after);
  if (odd_) {
    const auto move = [&](Block& from, int column, Block& to) {
      const auto source = from.parts(), target = to.parts();
      for (std::size_t p = 0; p < 3; ++p)
        for (int z = 0; z < line_; ++z) {
          target[p]->row(z)[0] = source[p]->row(z)[column];
          source[p]->row(z)[column] = Real{0};
        }
    };
    if (here_.begin == 0) move(c_.before, 0, wrap_before_);
    if (here_.end == lines_) move(c_.after, c_.x.count - 1, wrap_after_);
  }
  c_.solver.factor(c_.own);
  f_.solver.factor(f_.own);

  const int nc = c_.x.count;
  Rows coarse{Block(line_, nc), Block(line_, nc), Block(line_, nc)};
  coarsen(coarse);
  if (!gathered_) return coarse_->set(coarse);
  Rows all{Block(line_, coarse_->here_.count()), Block(line_, coarse_->here_.count()),
           Block(line_, coarse_->here_.count())};
  gather(coarse, all);
  coarse_->set(all);
}

void RingPreconditioner::Level::gather(const Rows& mine, Rows& all) const {
  Rows from = mine;
  const std::array<Block*, 3> source = {&from.own, &from.before, &from.after},
                              target = {&all.own, &all.before, &all.after};
  std::vector<Real> part(part_.size()), whole(coarse_r_.size());
  const int n = c_.x.count, m = coarse_->here_.count();
  for (std::size_t b = 0; b < 3; ++b)
    for (std::size_t p = 0; p < 3; ++p) {
      for (int z = 0; z < line_; ++z)
        for (int i = 0; i < n; ++i) part[at(i * line_ + z)] = source[b]->parts()[p]->row(z)[i];
      MPI_Allgatherv(part.data(), static_cast<int>(part.size()), MPI_FLOAT, whole.data(), counts_.data(),
                     offsets_.data(), MPI_FLOAT, comm_);
      for (int z = 0; z < line_; ++z)
        for (int i = 0; i < m; ++i) target[b]->parts()[p]->row(z)[i] = whole[at(i * line_ + z)];
    }
}

// A_c = A_CC + A_CF P + R (A_FC + A_FF P).
void RingPreconditioner::Level::coarsen(Rows& coarse) {
  const int nf = f_.x.count, nc = c_.x.count;
  const auto row_sum = [&](const Block& b, Columns& out) {
    for (int z = 0; z < line_; ++z)
      for (int i = 0; i < b.centre.count; ++i)
        out.row(z)[i] = -(b.centre.row(z)[i] + (z > 0 ? b.below.row(z)[i] : Real{0}) +
                          (z + 1 < line_ ? b.above.row(z)[i] : Real{0}));
  };
  const auto column_sum = [&](const Block& b, Columns& out) {
    for (int z = 0; z < line_; ++z)
      for (int i = 0; i < b.centre.count; ++i)
        out.row(z)[i] = -(b.centre.row(z)[i] + (z > 0 ? b.above.row(z - 1)[i] : Real{0}) +
                          (z + 1 < line_ ? b.below.row(z + 1)[i] : Real{0}));
  };
  // P of odd lines from the even line before and after.
  Columns p_before(line_, nf), p_after(line_, nf);
  row_sum(f_.before, p_before);
  row_sum(f_.after, p_after);
  f_.solver.solve(p_before);
  f_.solver.solve(p_after);
  // R from odd lines to the even line before, whose neighbour after they are, and to the one after.
  Columns c_after(line_, nc), c_before(line_, nc), r_before(line_, nf), r_after(line_, nf);
  column_sum(c_.after, c_after);
  column_sum(c_.before, c_before);
  exchange({&c_after, &c_before});
  for (int z = 0; z < line_; ++z)
    for (int i = 0; i < nf; ++i) {
      r_before.row(z)[i] = c_after.row(z)[i + c_shift_];
      r_after.row(z)[i] = c_before.row(z)[i + c_shift_ + 1];
    }
  f_.solver.solve_transposed(r_before);
  f_.solver.solve_transposed(r_after);
  // Q = A_FC + A_FF P for either side.
  Block q_before(line_, nf), q_after(line_, nf);
  for (const auto& [q, a, p] :
       {std::tuple(&q_before, &f_.before, &p_before), std::tuple(&q_after, &f_.after, &p_after)})
    for (int z = 0; z < line_; ++z)
      for (int i = 0; i < nf; ++i) {
        q->centre.row(z)[i] = a->centre.row(z)[i] + f_.own.centre.row(z)[i] * p->row(z)[i];
        if (z > 0) q->below.row(z)[i] = a->below.row(z)[i] + f_.own.below.row(z)[i] * p->row(z - 1)[i];
        if (z + 1 < line_) q->above.row(z)[i] = a->above.row(z)[i] + f_.own.above.row(z)[i] * p->row(z + 1)[i];
      }
  exchange({&p_before, &p_after, &r_before, &r_after, &q_before.below, &q_before.centre, &q_before.above,
            &q_after.below, &q_after.centre, &q_after.above});
  // The odd line after even line k is column k + f_shift_, the one before it the column to its left.
  const auto add = [&](Block& to, const Block& a, int shift, const Columns& p, const Columns& r, const Block& q) {
    for (int z = 0; z < line_; ++z)
      for (int i = 0; i < nc; ++i) {
        const int f = i + f_shift_ + shift;
        const Real weight = r.row(z)[f];
        to.centre.row(z)[i] += a.centre.row(z)[i] * p.row(z)[f] + weight * q.centre.row(z)[f];
        if (z > 0) to.below.row(z)[i] += a.below.row(z)[i] * p.row(z - 1)[f] + weight * q.below.row(z)[f];
        if (z + 1 < line_) to.above.row(z)[i] += a.above.row(z)[i] * p.row(z + 1)[f] + weight * q.above.row(z)[f];
      }
  };
  coarse.own = c_.own;
  add(coarse.own, c_.after, 0, p_before, r_before, q_before);
  add(coarse.after, c_.after, 0, p_after, r_before, q_after);
  add(coarse.own, c_.before, -1, p_after, r_after, q_after);
  add(coarse.before, c_.before, -1, p_before, r_after, q_before);
  if (!odd_) return;
  const auto put = [&](Block& from, int column, Block& to) {
    const auto source = from.parts(), target = to.parts();
    for (std::size_t p = 0; p < 3; ++p)
      for (int z = 0; z < line_; ++z) target[p]->row(z)[column] += source[p]->row(z)[0];
  };
  if (here_.begin == 0) put(wrap_before_, 0, coarse.before);
  if (here_.end == lines_) put(wrap_after_, nc - 1, coarse.after);
}

// x_F = A_FF^-1 (r_F - A_FC x_C); the last one of a cycle is wanted by no other line.
void RingPreconditioner::Level::solve_f(bool zero, bool last) {
  f_.x.data = f_.rhs.data;
  if (!zero) {
    exchange({&c_.x});
    subtract(f_.before, finest_, c_.x, c_shift_, f_.x);
    subtract(f_.after, finest_, c_.x, c_shift_ + 1, f_.x);
  }
  f_.solver.solve(f_.x);
  if (!last) exchange({&f_.x});
}

// r_C - A_CF x_F.
void RingPreconditioner::Level::coarse_residual(Columns& out) const {
  out.data = c_.rhs.data;
  subtract(c_.after, finest_, f_.x, f_shift_, out);
  subtract(c_.before, finest_, f_.x, f_shift_ - 1, out);
}

void RingPreconditioner::Level::cycle(const std::vector<Real>& r, std::vector<Real>& x) {
  const int n = here_.count(), nc = c_.x.count;
  if (lines_ == 1) {
    for (int z = 0; z < line_; ++z) single_x_.row(z)[0] = r[at(z)];
    single_.solve(single_x_);
    for (int z = 0; z < line_; ++z) x[at(z)] = single_x_.row(z)[0];
    return;
  }
  const int e = here_.begin % 2, o = 1 - e;
  for (int z = 0; z < line_; ++z) {
    const Real* from = r.data() + at(z * n);
    for (int i = 0; i < nc; ++i) c_.rhs.row(z)[i] = from[e + 2 * i];
    for (int i = 0; i < f_.x.count; ++i) f_.rhs.row(z)[i] = from[o + 2 * i];
  }
  solve_f(true);
  coarse_residual(residual_);
  if (!gathered_) {
    for (int z = 0; z < line_; ++z) std::copy_n(residual_.row(z), nc, coarse_r_.data() + at(z * nc));
    coarse_->cycle(coarse_r_, coarse_x_);
    for (int z = 0; z < line_; ++z) std::copy_n(coarse_x_.data() + at(z * nc), nc, c_.x.row(z));
  } else {
    const int m = coarse_->here_.count();
    std::vector<Real>& whole = coarse_x_;
    for (int z = 0; z < line_; ++z)
      for (int i = 0; i < nc; ++i) part_[at(i * line_ + z)] = residual_.row(z)[i];
    MPI_Allgatherv(part_.data(), static_cast<int>(part_.size()), MPI_FLOAT, whole.data(), counts_.data(),
                   offsets_.data(), MPI_FLOAT, comm_);
    for (int z = 0; z < line_; ++z)
      for (int i = 0; i < m; ++i) coarse_r_[at(z * m + i)] = whole[at(i * line_ + z)];
    coarse_->cycle(coarse_r_, coarse_x_);
    for (int z = 0; z < line_; ++z) std::copy_n(coarse_x_.data() + at(z * m + c_begin_), nc, c_.x.row(z));
  }
  solve_f(false);
  if (odd_) exchange({&c_.x});
  coarse_residual(residual_);
  if (odd_) {
    const auto wrap = [&](Block& block, int column, int neighbour) {
      for (int z = 0; z < line_; ++z)
        for (int s = -1; s <= 1; ++s) {
          if (z + s < 0 || z + s >= line_) continue;
          residual_.row(z)[column] -= block.parts()[at(s + 1)]->row(z)[0] * c_.x.row(z + s)[neighbour];
        }
    };
    if (here_.begin == 0) wrap(wrap_before_, 0, -1);
    if (here_.end == lines_) wrap(wrap_after_, nc - 1, nc);
  }
  std::swap(c_.x.data, residual_.data);
  c_.solver.solve(c_.x);
  solve_f(false, true);
  for (int z = 0; z < line_; ++z) {
    Real* to = x.data() + at(z * n);
    for (int i = 0; i < nc; ++i) to[e + 2 * i] = c_.x.row(z)[i];
    for (int i = 0; i < f_.x.count; ++i) to[o + 2 * i] = f_.x.row(z)[i];
  }
}

RingPreconditioner::RingPreconditioner(MPI_Comm comm, int lines, int line, Lines here)
    : top_(std::make_unique<Level>(comm, lines, line, here, true)), line_(line), here_(here) {
  core::require(here.count() >= 2, "a rank without lines of a ring");
  r_.resize(at(here.count() * line));
  x_.resize(r_.size());
}

RingPreconditioner::~RingPreconditioner() = default;

void RingPreconditioner::set(const StateDerivatives& at_states, double alpha, double sigma) {
  const int n = here_.count();
  const std::size_t rows = at(n * line_);
  Level::Rows out{Block(line_, n), Block(line_, n), Block(line_, n)};
  const auto put = [&](Stencil::Place place, Columns& to) {
    for (const auto& [values, factor] : {std::pair{at_states.states, alpha}, std::pair{at_states.rates, sigma}}) {
      if ((static_cast<std::size_t>(place) + 1) * rows > values.size()) continue;
      const double* from = Stencil::at(place, rows, values.data());
      for (int i = 0; i < n; ++i)
        for (int z = 0; z < line_; ++z) to.row(z)[i] += static_cast<Real>(factor * from[at(i * line_ + z)]);
    }
  };
  put(Stencil::centre, out.own.centre);
  put(Stencil::below, out.own.below);
  put(Stencil::above, out.own.above);
  put(Stencil::before, out.before.centre);
  put(Stencil::second_before, out.before.centre);
  put(Stencil::after, out.after.centre);
  top_->set(out);
}

void RingPreconditioner::apply(std::span<const double> r, std::span<double> x) {
  const int n = here_.count();
  const std::size_t rows = r_.size();
  for (std::size_t first = 0; first < r.size(); first += rows) {
    for (int i = 0; i < n; ++i)
      for (int z = 0; z < line_; ++z) r_[at(z * n + i)] = static_cast<Real>(r[first + at(i * line_ + z)]);
    top_->cycle(r_, x_);
    for (int i = 0; i < n; ++i)
      for (int z = 0; z < line_; ++z) x[first + at(i * line_ + z)] = x_[at(z * n + i)];
  }
}

}  // namespace whirl::film
