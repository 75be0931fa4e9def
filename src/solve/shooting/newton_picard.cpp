#include "whirl/solve/shooting/newton_picard.hpp"

#include <cmath>
#include <numbers>

#include "solve/shooting/local_part.hpp"
#include "solve/shooting/sparse_step.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/index.hpp"

namespace whirl::solve {

using core::at;
using core::check;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int stale_after = 12;

}  // namespace

NewtonPicardProblem::NewtonPicardProblem(problem::System& system, const NewtonPicardOptions& options, Tableau tableau,
                                         int steps, std::vector<double> mesh)
    : system_(system),
      options_(options),
      steps_(steps),
      scheme_(make_scheme(1, Points::radau)),
      mesh_(std::move(mesh)),
      stepper_(std::make_unique<SparseRungeKutta>(system, std::move(tableau), options.constant_rates,
                                                  options.autonomous || system.parameter_is_speed())),
      local_(system.local_size()),
      borders_(options.autonomous ? 2 : 1),
      last_(core::rank_of(system.comm()) == core::size_of(system.comm()) - 1),
      scale_(get(stepper_->state_scale())) {
  core::require(steps > 0, "shooting needs at least one step per interval");
  work_ = core::make_vector(comm(), system.local_size(), PETSC_DETERMINE);
  whole_scale_ = whole(scale_);
  weights_ = make_unknown();
  const core::WriteArray w(weights_.get());
  for (Index i = 0; i < intervals(); ++i)
    Map<VectorXd>(w.data() + i * local_, local_)
        .setConstant(options_.state_weight * length(i) / static_cast<double>(system.size()));
  if (last_) w[w.size() - 1] = 1;
}

NewtonPicardProblem::~NewtonPicardProblem() = default;

bool NewtonPicardProblem::structured() const {
  return stepper_->product_is_free();
}

double NewtonPicardProblem::length(Index i) const {
  return mesh_[at(i) + 1] - mesh_[at(i)];
}

double NewtonPicardProblem::angle(double s) const {
  return options_.autonomous ? 0.0 : 2 * std::numbers::pi * options_.turns * s;
}

core::Vector NewtonPicardProblem::make_unknown() const {
  return core::make_vector(comm(), static_cast<PetscInt>(intervals() * local_ + (last_ ? borders_ : 0)),
                           PETSC_DETERMINE);
}

VectorXd NewtonPicardProblem::border_of(Vec u) const {
  VectorXd border(borders_);
  if (last_) border = get(u).tail(borders_);
  MPI_Bcast(border.data(), static_cast<int>(borders_), MPI_DOUBLE, core::size_of(comm()) - 1, comm());
  return border;
}

// Sets the parameter and returns the period.
double NewtonPicardProblem::begin_point(const VectorXd& border) {
  core::agree(comm(), [&] { system_.set_parameter(border(borders_ - 1) * options_.parameter_scale); });
  stepper_->refresh();
  const double period =
      options_.autonomous ? border(0) * period_scale_ : 2 * std::numbers::pi * options_.turns / system_.speed();
  core::agree(comm(), [&] {
    if (!(period > 0)) throw core::DomainError("the period is not positive");
  });
  return period;
}

void NewtonPicardProblem::sum(MatrixXd& values) const {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm());
}

// Carries x over interval i; with `links`, keeps the products of its steps and fills -d phi/d(border).
void NewtonPicardProblem::march(Index i, double period, Vec x, Links* links) {
  const double begin = mesh_[at(i)], h = length(i) / steps_;
  if (!links) {
    for (int k = 0; k < steps_; ++k) stepper_->step(angle(begin + k * h), angle(h), h * period, x, nullptr);
    return;
  }
  MatrixXd& columns = links->columns[at(i)];
  columns.setZero(local_, borders_);
  auto& steps = links->steps[at(i)];
  steps.resize(static_cast<std::size_t>(steps_));
  const bool by_speed = !options_.autonomous && system_.parameter_is_speed();
  for (int k = 0; k < steps_; ++k) {
    StepProduct& step = steps[at(k)];
    stepper_->step(angle(begin + k * h), angle(h), h * period, x, &step);
    if (k > 0) step.apply(columns);
    columns.col(borders_ - 1) -= options_.parameter_scale * step.d_parameter();
    if (by_speed)
      columns.col(borders_ - 1) += options_.parameter_scale * h * period / system_.speed() * step.d_length();
    if (options_.autonomous) columns.col(0) -= h * period_scale_ * step.d_length();
  }
}

// The ends of all intervals from the states of u, with what linearise() wants of them if `links` is not null.
void NewtonPicardProblem::march_all(Vec u, double period, MatrixXd& ends, Links* links) {
  const core::ReadArray ua(u);
  const Map<const MatrixXd> x(ua.data(), local_, intervals());
  if (links) {
    links->u.resize(0);
    links->steps.resize(at(intervals()));
    links->columns.resize(at(intervals()));
  }
  ends.resize(local_, intervals());
  for (Index i = 0; i < intervals(); ++i) {
    put(x.col(i == 0 ? intervals() - 1 : i - 1), work_.get());
    march(i, period, work_.get(), links);
    ends.col(i) = get(work_.get());
  }
  if (links) links->u = get(u);
}

void NewtonPicardProblem::residual(Vec u, Vec r) {
  const double period = begin_point(border_of(u));
  MatrixXd ends;
  march_all(u, period, ends, stepper_->product_is_free() ? &next_ : nullptr);
  const core::ReadArray ua(u);
  const core::WriteArray ra(r);
  const Map<const MatrixXd> x(ua.data(), local_, intervals());
  Map<MatrixXd>(ra.data(), local_, intervals()) = x - ends;
  if (!options_.autonomous) return;
  MatrixXd phase(1, 1);
  phase(0, 0) = (x.array() * phase_row_.array()).sum();
  sum(phase);
  if (last_) ra[ra.size() - 2] = phase(0, 0) - phase_offset_;
}

void NewtonPicardProblem::apply(Index i, MatrixXd& v) const {
  for (const StepProduct& step : links_.steps[at(i)]) step.apply(v);
}

// M v, and what the motions add to the rows [nb x columns].
MatrixXd NewtonPicardProblem::monodromy_times(const MatrixXd& v, MatrixXd& added) const {
  MatrixXd state = v;
  added = MatrixXd::Zero(borders_, v.cols());
  for (Index i = 0; i < intervals(); ++i) {
    apply(i, state);
    added.noalias() += rows_[at(i)].transpose().lazyProduct(state);
  }
  sum(added);
  products_ += v.cols();
  return state;
}

MatrixXd NewtonPicardProblem::complement(const MatrixXd& v) const {
  MatrixXd inner = basis_.transpose() * v;
  sum(inner);
  return v - basis_ * inner;
}

// q of (I - Q M) q = Q right with M q and what that adds. Iteration stops where another one would change less than
// Newton's linear solves ask for; the last change is then missing in M q.
MatrixXd NewtonPicardProblem::picard(const MatrixXd& right, MatrixXd& image, MatrixXd& added) const {
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

void NewtonPicardProblem::linearise(Vec u, Vec row) {
  const double period = begin_point(border_of(u));
  // The residual at u may have left its links behind; they are exchanged, because those of this linearisation are
  // wanted until the next one.
  if (stepper_->product_is_free() && next_.u.size() > 0 && next_.u == get(u)) {
    std::swap(links_, next_);
    next_.u.resize(0);
  } else {
    MatrixXd ends;
    march_all(u, period, ends, &links_);
  }
  const core::ReadArray wa(row);
  const Index count = intervals();
  const Map<const MatrixXd> w(wa.data(), local_, count);
  rows_.resize(at(count));
  for (Index i = 0; i < count; ++i) {
    rows_[at(i)].resize(local_, borders_);
    if (options_.autonomous) rows_[at(i)].col(0) = phase_row_.col(i);
    rows_[at(i)].rightCols(1) = w.col(i);
  }
  corner_ = MatrixXd::Zero(borders_, borders_);
  corner_.row(borders_ - 1) = border_of(row).transpose();

  ends_ = MatrixXd::Zero(local_, borders_);
  ends_added_ = MatrixXd::Zero(borders_, borders_);
  for (Index i = 0; i < count; ++i) {
    const auto k = at(i);
    if (i > 0) apply(i, ends_);
    ends_ -= links_.columns[k];
    ends_added_.noalias() += rows_[k].transpose().lazyProduct(ends_);
  }
  sum(ends_added_);

  const bool stale = solves_ > stale_after || image_.rows() != local_;
  if (stale)
    (void)find_subspace();
  else
    basis_ = image_;
  if (!stale) orthonormalise(basis_, 0);
  find_image();
  prepare();
}

// Everything that solve() needs of the subspace and its image.
void NewtonPicardProblem::prepare() {
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

void NewtonPicardProblem::multiply(Vec v, Vec y) {
  const VectorXd border = border_of(v);
  const core::ReadArray va(v);
  const core::WriteArray ya(y);
  const Index count = intervals();
  const Map<const MatrixXd> x(va.data(), local_, count);
  MatrixXd added = MatrixXd::Zero(borders_, 1), state;
  for (Index i = 0; i < count; ++i) {
    const auto k = at(i);
    state = x.col(i == 0 ? count - 1 : i - 1);
    apply(i, state);
    Map<VectorXd>(ya.data() + i * local_, local_) = x.col(i) - state + links_.columns[k].lazyProduct(border);
    added.noalias() += rows_[k].transpose().lazyProduct(x.col(i));
  }
  ++products_;
  sum(added);
  added += corner_ * border;
  if (last_) Map<VectorXd>(ya.data() + ya.size() - borders_, borders_) = added;
}

void NewtonPicardProblem::solve(Vec rhs, Vec out) {
  const VectorXd r_border = border_of(rhs);
  const core::ReadArray ra(rhs);
  const core::WriteArray xa(out);
  const Index count = intervals(), p = basis_.cols();
  const Map<const MatrixXd> r(ra.data(), local_, count);
  // The motion that the right-hand side alone drives: none for a tangent.
  MatrixXd added = MatrixXd::Zero(borders_, 1), driven(1, 1);
  MatrixXd state = MatrixXd::Zero(local_, 1), q = state, image_q = state, q_added = added;
  driven(0) = r.squaredNorm();
  sum(driven);
  if (driven(0) > 0) {
    for (Index i = 0; i < count; ++i) {
      if (i > 0) apply(i, state);
      state += r.col(i);
      added.noalias() += rows_[at(i)].transpose().lazyProduct(state);
    }
    sum(added);
    products_ += count > 1;
    q = picard(state, image_q, q_added);
  }
  MatrixXd top = basis_.transpose() * (state + image_q);
  sum(top);
  VectorXd small(p + borders_);
  small << top, r_border - added - q_added;
  small = small_.solve(small).eval();
  const VectorXd border = small.tail(borders_);
  state = basis_ * small.head(p) + q + q_ends_ * border;
  for (Index i = 0; i < count; ++i) {
    apply(i, state);
    state += r.col(i) - links_.columns[at(i)].lazyProduct(border);
    Map<VectorXd>(xa.data() + i * local_, local_) = state;
  }
  ++products_;
  ++solves_;
  if (last_) Map<VectorXd>(xa.data() + xa.size() - borders_, borders_) = border;
}

}  // namespace whirl::solve
