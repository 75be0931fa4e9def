#include "whirl/solve/cycle/spread_cycle.hpp"

#include <cmath>

#include "solve/cycle/dominant_subspace.hpp"
#include "solve/newton/local_part.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/index.hpp"

namespace whirl::solve {

using core::at;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int stale_after = 12;

// Products within its life take few digits.
class Roughly {
public:
  Roughly(bool& rough, bool inexact) : rough_(rough), before_(rough) { rough_ = inexact; }
  Roughly(const Roughly&) = delete;
  Roughly& operator=(const Roughly&) = delete;
  ~Roughly() { rough_ = before_; }

private:
  bool& rough_;
  bool before_;
};

}  // namespace

SpreadCycle::SpreadCycle(problem::System& system, const NewtonPicardOptions& options, Scheme scheme,
                         std::vector<double> mesh, bool inexact, const TimeGroups& groups)
    : OrbitProblem(system, groups, {options.turns, options.autonomous, options.parameter_scale, options.state_weight},
                   std::move(scheme), std::move(mesh)),
      options_(options),
      radius_(options.radius),
      inexact_(inexact),
      work_(core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE)) {}

// Sets the parameter and returns the period.
double SpreadCycle::begin_point(const VectorXd& border) {
  core::agree(comm(), [&] { system_.set_parameter(border(borders_ - 1) * options_.parameter_scale); });
  refresh();
  const double period = period_of(border);
  core::agree(comm(), [&] {
    if (!(period > 0)) throw core::DomainError("the period is not positive");
  });
  return period;
}

void SpreadCycle::sum(MatrixXd& values) const {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, system_.comm());
}

void SpreadCycle::residual(Vec u, Vec r) {
  const double period = begin_point(border_of(u));
  const MatrixXd x = nodes(u);
  MatrixXd equations;
  groups_.together([&] { residuals(x, period, equations); });
  const core::WriteArray ra(r);
  Map<MatrixXd>(ra.data(), equations.rows(), equations.cols()) = equations;
  put_phase(x.rightCols(x.cols() - 1), ra);
}

MatrixXd SpreadCycle::reference_rates(const Cycle& reference) {
  system_.set_parameter(reference.parameter);
  refresh();
  const MatrixXd x = nodes(scatter(reference).get());
  const Index m = scheme_.degree;
  MatrixXd rates(local_, count_ * m);
  groups_.together([&] {
    for (Index k = 0; k < count_ * m; ++k) rates.col(k) = reference_rate(x, reference.period, k / m, k % m + 1);
  });
  return rates;
}

void SpreadCycle::carry(Index i, MatrixXd& state, const MatrixXd* rhs, bool rest, MatrixXd& added) const {
  MatrixXd x = advance(i, state, rhs, rest);
  added.noalias() += rows_[at(i)].lazyProduct(x);
  if (x.rows() == local_)
    state = std::move(x);
  else
    state = x.bottomRows(local_);
}

// M v, and what the motions add to the rows [nb x columns].
MatrixXd SpreadCycle::monodromy_times(const MatrixXd& v, MatrixXd& added) const {
  MatrixXd state = v;
  added = MatrixXd::Zero(borders_, v.cols());
  groups_.in_turn(state, [&] {
    for (Index i = 0; i < count_; ++i) carry(i, state, nullptr, false, added);
  });
  sum_over_time(added);
  products_ += v.cols();
  return state;
}

MatrixXd SpreadCycle::times(const MatrixXd& v) {
  MatrixXd added;
  return monodromy_times(v, added);
}

// The motion from `start` under -y, if that is not null.
Path SpreadCycle::driven(const VectorXd& start, const MatrixXd* y, VectorXd& end) const {
  const Index m = scheme_.degree;
  Path path{{}, MatrixXd(local_, count_ * m), {}};
  MatrixXd state = start;
  groups_.in_turn(state, [&] {
    path.start = state;
    for (Index i = 0; i < count_; ++i) {
      MatrixXd load;
      if (y) load = -y->col(i);
      const MatrixXd x = advance(i, state, y ? &load : nullptr, y && first_ + i == 0);
      state = x.bottomRows(local_);
      path.nodes.middleCols(i * m, m) = x.reshaped(local_, m);
    }
  });
  end = state;
  products_ += 1;
  return path;
}

Path SpreadCycle::forward(const VectorXd& v) const {
  VectorXd end;
  return driven(v, nullptr, end);
}

Path SpreadCycle::forced(const MatrixXd& y, VectorXd& end) const {
  return driven(VectorXd::Zero(local_), &y, end);
}

std::vector<MatrixXd> SpreadCycle::tangents(Vec u, double step, const Path& a, const std::vector<const Path*>& b) {
  const double period = begin_point(border_of(u));
  const auto at_nodes = [&](const Path& path) {
    MatrixXd x(local_, 1 + path.nodes.cols());
    x << path.start, path.nodes;
    return x;
  };
  const MatrixXd x = nodes(u) + step * at_nodes(a);
  std::vector<MatrixXd> along, out;
  for (const Path* path : b) along.push_back(at_nodes(*path));
  groups_.together([&] { out = tangents_at(x, period, along); });
  return out;
}

MatrixXd SpreadCycle::complement(const MatrixXd& v) const {
  MatrixXd inner = basis_.transpose() * v;
  sum(inner);
  return v - basis_ * inner;
}

// q of (I - Q M) q = Q right with M q and what that adds. Iteration stops where another one would change less than
// Newton's linear solves ask for; the last change is then missing in M q.
MatrixXd SpreadCycle::picard(const MatrixXd& right, MatrixXd& image, MatrixXd& added) const {
  constexpr double enough = 1e-7;
  const MatrixXd fixed = complement(right);
  MatrixXd q = fixed, sizes(2, 1);
  for (int k = 0;; ++k) {
    image = monodromy_times(q, added);
    if (k == options_.picard) return q;
    const MatrixXd next = complement(image) + fixed;
    sizes << (next - q).squaredNorm(), fixed.squaredNorm();
    sum(sizes);
    q = next;
    if (sizes(0) <= enough * enough * sizes(1)) return q;
  }
}

void SpreadCycle::linearise(Vec u, Vec row) {
  const double period = begin_point(border_of(u));
  exact_ = false;
  {
    const MatrixXd x = nodes(u);
    groups_.together([&] { linearise_intervals(x, period); });
  }
  const Index count = count_;
  take_rows(row);

  const Roughly here(rough_, inexact_);
  ends_ = MatrixXd::Zero(local_, borders_);
  ends_added_ = MatrixXd::Zero(borders_, borders_);
  groups_.in_turn(ends_, [&] {
    MatrixXd load;
    for (Index i = 0; i < count; ++i) {
      load = -columns(i);
      carry(i, ends_, &load, first_ + i == 0, ends_added_);
    }
  });
  sum_over_time(ends_added_);

  const bool stale = solves_ > stale_after || !image_known_;
  if (stale) {
    (void)find_subspace();
  } else {
    basis_.resize(local_, 0);
    add_orthonormal(system_.comm(), basis_, image_);
  }
  find_image();
  prepare();
}

// Everything that solve() needs of the subspace and its image.
void SpreadCycle::prepare() {
  const Roughly here(rough_, inexact_);
  const Index p = basis_.cols();
  MatrixXd q_added;
  q_ends_ = picard(ends_, image_q_ends_, q_added);
  MatrixXd top(p, p + borders_);
  top << basis_.transpose() * image_, basis_.transpose() * (ends_ + image_q_ends_);
  sum(top);
  MatrixXd small(p + borders_, p + borders_);
  small.topRows(p) = MatrixXd::Identity(p, p + borders_) - top;
  small.bottomLeftCorner(borders_, p) = basis_added_;
  small.bottomRightCorner(borders_, borders_) = q_added + ends_added_ + corner_;
  small_.compute(small);
  solves_ = 0;
}

void SpreadCycle::multiply(Vec v, Vec y) {
  OrbitProblem::multiply(v, y);
  ++products_;
}

void SpreadCycle::solve(Vec rhs, Vec out) {
  const Roughly here(rough_, inexact_);
  const VectorXd r_border = border_of(rhs);
  const core::ReadArray ra(rhs);
  const core::WriteArray xa(out);
  const Index count = count_, p = basis_.cols(), size = scheme_.degree * local_;
  const Map<const MatrixXd> r(ra.data(), size, count);
  // The motion that the right-hand side alone drives: none for a tangent.
  MatrixXd added = MatrixXd::Zero(borders_, 1), driven(1, 1), load;
  MatrixXd state = MatrixXd::Zero(local_, 1), q = state, image_q = state, q_added = added;
  driven(0) = r.squaredNorm();
  sum_over_time(driven);
  if (driven(0) > 0) {
    groups_.in_turn(state, [&] {
      for (Index i = 0; i < count; ++i) {
        load = r.col(i);
        carry(i, state, &load, first_ + i == 0, added);
      }
    });
    sum_over_time(added);
    products_ += mesh_.size() > 2;
    q = picard(state, image_q, q_added);
  }
  MatrixXd top = basis_.transpose() * (state + image_q);
  sum(top);
  VectorXd small(p + borders_);
  small << top, r_border - added - q_added;
  small = small_.solve(small);
  const VectorXd border = small.tail(borders_);
  state = basis_ * small.head(p) + q + q_ends_ * border;
  groups_.in_turn(state, [&] {
    for (Index i = 0; i < count; ++i) {
      load = r.col(i) - columns(i).lazyProduct(border);
      const MatrixXd x = advance(i, state, &load, false);
      state = x.bottomRows(local_);
      Map<VectorXd>(xa.data() + i * size, size) = x.col(0);
    }
  });
  ++products_;
  ++solves_;
  if (last_) Map<VectorXd>(xa.data() + xa.size() - borders_, borders_) = border;
}

}  // namespace whirl::solve
