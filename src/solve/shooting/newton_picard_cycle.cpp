// The cycle of a Newton-Picard problem: to and from its distributed unknown, and its phase reference.

#include <cmath>
#include <numbers>

#include "solve/shooting/local_part.hpp"
#include "solve/shooting/sparse_step.hpp"
#include "whirl/solve/shooting/newton_picard.hpp"

namespace whirl::solve {

using core::check;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd NewtonPicardProblem::whole(const MatrixXd& columns) const {
  MatrixXd out(system_.size(), columns.cols());
  core::Scatter scatter;
  core::Vector all;
  check(VecScatterCreateToAll(work_.get(), scatter.put(), all.put()));
  for (Index i = 0; i < columns.cols(); ++i) {
    put(columns.col(i), work_.get());
    check(VecScatterBegin(scatter.get(), work_.get(), all.get(), INSERT_VALUES, SCATTER_FORWARD));
    check(VecScatterEnd(scatter.get(), work_.get(), all.get(), INSERT_VALUES, SCATTER_FORWARD));
    out.col(i) = get(all.get());
  }
  return out;
}

Cycle NewtonPicardProblem::gather(Vec u) const {
  const VectorXd border = border_of(u);
  const core::ReadArray ua(u);
  Cycle cycle{mesh_, {}, 0, border(borders_ - 1) * options_.parameter_scale};
  cycle.x = whole(scale_.asDiagonal() * Map<const MatrixXd>(ua.data(), local_, intervals()));
  if (options_.autonomous)
    cycle.period = border(0) * period_scale_;
  else
    cycle.period =
        2 * std::numbers::pi * options_.turns / (system_.parameter_is_speed() ? cycle.parameter : system_.speed());
  return cycle;
}

Cycle NewtonPicardProblem::orbit(Vec u) {
  const double period = begin_point(border_of(u));
  const Cycle ends = gather(u);
  Cycle points{refined(mesh_, steps_), MatrixXd(system_.size(), intervals() * steps_), ends.period, ends.parameter};
  const core::ReadArray ua(u);
  const Map<const MatrixXd> x(ua.data(), local_, intervals());
  core::Vector state = core::duplicate(work_.get());
  MatrixXd states(local_, steps_);
  for (Index i = 0; i < intervals(); ++i) {
    put(x.col(i == 0 ? intervals() - 1 : i - 1), state.get());
    const double begin = mesh_[static_cast<std::size_t>(i)], h = length(i) / steps_;
    for (int k = 0; k < steps_; ++k) {
      stepper_->step(angle(begin + k * h), angle(h), h * period, state.get(), nullptr);
      states.col(k) = scale_.cwiseProduct(get(state.get()));
    }
    points.x.middleCols(i * steps_, steps_) = whole(states);
  }
  return through(points);
}

core::Vector NewtonPicardProblem::scatter(const Cycle& cycle) const {
  core::require(!options_.autonomous || period_scale_ > 0, "an autonomous cycle wants its phase reference first");
  const Cycle here = cycle.on(scheme_, mesh_);
  core::Vector u = make_unknown();
  PetscInt begin = 0;
  check(VecGetOwnershipRange(work_.get(), &begin, nullptr));
  const core::WriteArray ua(u.get());
  Map<MatrixXd>(ua.data(), local_, intervals()) = scale_.cwiseInverse().asDiagonal() * here.x.middleRows(begin, local_);
  if (last_) {
    if (options_.autonomous) ua[ua.size() - 2] = cycle.period / period_scale_;
    ua[ua.size() - 1] = cycle.parameter / options_.parameter_scale;
  }
  return u;
}

void NewtonPicardProblem::set_phase_reference(const Cycle& reference) {
  core::require(options_.autonomous, "only an autonomous cycle has a phase condition");
  if (period_scale_ == 0) period_scale_ = reference.period;
  system_.set_parameter(reference.parameter);
  stepper_->refresh();
  const core::Vector u = scatter(reference);
  const core::ReadArray ua(u.get());
  const Map<const MatrixXd> x(ua.data(), local_, intervals());
  core::Vector state = core::duplicate(work_.get()), slope = core::duplicate(work_.get());
  phase_row_.resize(local_, intervals());
  MatrixXd values = MatrixXd::Zero(2, 1);
  for (Index i = 0; i < intervals(); ++i) {
    put(x.col(i), state.get());
    stepper_->rate(0, state.get(), slope.get());
    const VectorXd rate = get(slope.get());
    phase_row_.col(i) = length(i) * rate;
    values(0) += length(i) * rate.squaredNorm();
    values(1) += length(i) * rate.dot(x.col(i));
  }
  sum(values);
  const double norm = std::sqrt(values(0));
  core::require(norm > 0, "the phase reference does not move");
  phase_row_ /= norm;
  phase_offset_ = values(1) / norm;
}

}  // namespace whirl::solve
