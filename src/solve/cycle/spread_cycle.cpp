#include "whirl/solve/cycle/spread_cycle.hpp"

#include <cmath>
#include <numbers>

#include "solve/newton/local_part.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/count.hpp"
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
    : system_(system),
      groups_(groups),
      options_(options),
      radius_(options.radius),
      scheme_(std::move(scheme)),
      local_(system.local_size()),
      borders_(options.autonomous ? 2 : 1),
      last_(core::rank_of(groups.all()) == core::size_of(groups.all()) - 1),
      inexact_(inexact) {
  work_ = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  const core::Vector scale = core::duplicate(work_.get()), unused = core::duplicate(work_.get());
  system.scales(scale.get(), unused.get());
  scale_ = get(scale.get());
  set_mesh(std::move(mesh));
}

void SpreadCycle::set_mesh(std::vector<double> mesh) {
  mesh_ = std::move(mesh);
  const auto all = static_cast<Index>(mesh_.size()) - 1;
  core::agree(comm(), [&] {
    (void)core::count_of(std::int64_t{all} * scheme_.degree * system_.size() + borders_,
                         "unknowns of a cycle (intervals x points x states)");
    if (all < groups_.count()) throw core::InputError("fewer intervals than groups of ranks that share them");
  });
  first_ = groups_.first(all, groups_.index());
  count_ = groups_.first(all, groups_.index() + 1) - first_;
  weights_ = make_unknown();
  const Index m = scheme_.degree;
  const core::WriteArray w(weights_.get());
  for (Index i = 0; i < intervals(); ++i)
    for (Index l = 0; l < m; ++l)
      Map<VectorXd>(w.data() + (i * m + l) * local_, local_)
          .setConstant(options_.state_weight * length(i) * scheme_.node_weight(l) /
                       static_cast<double>(system_.size()));
  if (last_) w[w.size() - 1] = 1;
}

double SpreadCycle::begin(Index i) const {
  return mesh_[at(first_ + i)];
}

double SpreadCycle::length(Index i) const {
  return mesh_[at(first_ + i) + 1] - mesh_[at(first_ + i)];
}

double SpreadCycle::angle(double s) const {
  return options_.autonomous ? 0.0 : 2 * std::numbers::pi * options_.turns * s;
}

core::Vector SpreadCycle::make_unknown() const {
  return core::make_vector(
      comm(), static_cast<PetscInt>(intervals() * scheme_.degree * local_ + (last_ ? borders_ : 0)), PETSC_DETERMINE);
}

VectorXd SpreadCycle::border_of(Vec u) const {
  VectorXd border(borders_);
  if (last_) border = get(u).tail(borders_);
  MPI_Bcast(border.data(), static_cast<int>(borders_), MPI_DOUBLE, core::size_of(comm()) - 1, comm());
  return border;
}

// Sets the parameter and returns the period.
double SpreadCycle::begin_point(const VectorXd& border) {
  core::agree(comm(), [&] { system_.set_parameter(border(borders_ - 1) * options_.parameter_scale); });
  refresh();
  const double period =
      options_.autonomous ? border(0) * period_scale_ : 2 * std::numbers::pi * options_.turns / system_.speed();
  core::agree(comm(), [&] {
    if (!(period > 0)) throw core::DomainError("the period is not positive");
  });
  return period;
}

void SpreadCycle::sum(MatrixXd& values) const {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, system_.comm());
}

void SpreadCycle::sum_over_time(MatrixXd& values) const {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm());
}

MatrixXd SpreadCycle::nodes(Vec u) const {
  const core::ReadArray ua(u);
  MatrixXd x(local_, 1 + count_ * scheme_.degree);
  x.rightCols(x.cols() - 1) = Map<const MatrixXd>(ua.data(), local_, x.cols() - 1);
  x.col(0) = groups_.from_before(x.rightCols(1));
  return x;
}

void SpreadCycle::residual(Vec u, Vec r) {
  const double period = begin_point(border_of(u));
  const MatrixXd x = nodes(u);
  MatrixXd equations;
  groups_.together([&] { residuals(x, period, equations); });
  const core::WriteArray ra(r);
  Map<MatrixXd>(ra.data(), equations.rows(), equations.cols()) = equations;
  if (!options_.autonomous) return;
  MatrixXd phase(1, 1);
  phase(0, 0) = (x.rightCols(phase_row_.cols()).array() * phase_row_.array()).sum();
  sum_over_time(phase);
  if (last_) ra[ra.size() - 2] = phase(0, 0) - phase_offset_;
}

void SpreadCycle::carry(Index i, MatrixXd& state, const MatrixXd* rhs, bool rest, MatrixXd& added) const {
  MatrixXd x = advance(i, state, rhs, rest);
  added.noalias() += rows_[at(i)].transpose().lazyProduct(x);
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

Path SpreadCycle::forward(const VectorXd& v) const {
  const Index m = scheme_.degree;
  Path path{v, MatrixXd(local_, count_ * m), {}};
  MatrixXd state = v;
  groups_.in_turn(state, [&] {
    path.start = state;
    for (Index i = 0; i < count_; ++i) {
      const MatrixXd x = advance(i, state, nullptr, false);
      state = x.bottomRows(local_);
      path.nodes.middleCols(i * m, m) = x.reshaped(local_, m);
    }
  });
  products_ += 1;
  return path;
}

Path SpreadCycle::forced(const MatrixXd& y, VectorXd& end) const {
  const Index m = scheme_.degree;
  Path path{VectorXd::Zero(local_), MatrixXd(local_, count_ * m), {}};
  MatrixXd state = path.start;
  groups_.in_turn(state, [&] {
    path.start = state;
    for (Index i = 0; i < count_; ++i) {
      const MatrixXd load = -y.col(i), x = advance(i, state, &load, first_ + i == 0);
      state = x.bottomRows(local_);
      path.nodes.middleCols(i * m, m) = x.reshaped(local_, m);
    }
  });
  end = state;
  products_ += 1;
  return path;
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
  const core::ReadArray wa(row);
  const Index count = count_, m = scheme_.degree;
  const Map<const MatrixXd> w(wa.data(), m * local_, count), phase(phase_row_.data(), m * local_, count);
  rows_.resize(at(count));
  for (Index i = 0; i < count; ++i) {
    rows_[at(i)].resize(m * local_, borders_);
    if (options_.autonomous) rows_[at(i)].col(0) = phase.col(i);
    rows_[at(i)].rightCols(1) = w.col(i);
  }
  corner_ = MatrixXd::Zero(borders_, borders_);
  corner_.row(borders_ - 1) = border_of(row).transpose();

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
  if (stale)
    (void)find_subspace();
  else
    basis_ = image_;
  if (!stale) orthonormalise(basis_, 0);
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
  const VectorXd border = border_of(v);
  const core::ReadArray va(v);
  const core::WriteArray ya(y);
  const Index size = scheme_.degree * local_;
  const VectorXd entering = groups_.from_before(Map<const VectorXd>(va.data() + count_ * size - local_, local_));
  MatrixXd added = MatrixXd::Zero(borders_, 1);
  groups_.together([&] {
    VectorXd own, start = entering;
    for (Index i = 0; i < count_; ++i) {
      own = Map<const VectorXd>(va.data() + i * size, size);
      Map<VectorXd>(ya.data() + i * size, size) = product(i, start, own) + columns(i).lazyProduct(border);
      added.noalias() += rows_[at(i)].transpose().lazyProduct(own);
      start = own.tail(local_);
    }
  });
  ++products_;
  sum_over_time(added);
  added += corner_ * border;
  if (last_) Map<VectorXd>(ya.data() + ya.size() - borders_, borders_) = added;
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
