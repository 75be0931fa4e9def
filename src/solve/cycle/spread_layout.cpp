// A cycle spread over ranks: to and from its distributed unknown, and its phase reference.

#include <cmath>
#include <numbers>

#include "whirl/solve/cycle/spread_cycle.hpp"

namespace whirl::solve {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Cycle SpreadCycle::gather(Vec u) const {
  const VectorXd border = border_of(u);
  const core::ReadArray ua(u);
  Cycle cycle{mesh_, {}, 0, border(borders_ - 1) * options_.parameter_scale};
  const Map<const MatrixXd> own(ua.data(), local_, count_ * scheme_.degree);
  cycle.x = scale_.asDiagonal() * groups_.joined(own, static_cast<Index>(mesh_.size()) - 1);
  if (options_.autonomous)
    cycle.period = border(0) * period_scale_;
  else
    cycle.period =
        2 * std::numbers::pi * options_.turns / (system_.parameter_is_speed() ? cycle.parameter : system_.speed());
  return cycle;
}

core::Vector SpreadCycle::scatter(const Cycle& cycle) const {
  core::require(!options_.autonomous || period_scale_ > 0, "an autonomous cycle wants its phase reference first");
  core::require(cycle.x.rows() == local_, "of a cycle each rank has its rows");
  const Cycle here = cycle.on(scheme_, mesh_);
  core::Vector u = make_unknown();
  const core::WriteArray ua(u.get());
  const Index m = scheme_.degree;
  Map<MatrixXd>(ua.data(), local_, count_ * m) =
      scale_.cwiseInverse().asDiagonal() * here.x.middleCols(first_ * m, count_ * m);
  if (last_) {
    if (options_.autonomous) ua[ua.size() - 2] = cycle.period / period_scale_;
    ua[ua.size() - 1] = cycle.parameter / options_.parameter_scale;
  }
  return u;
}

void SpreadCycle::set_phase_reference(const Cycle& reference) {
  core::require(options_.autonomous, "only an autonomous cycle has a phase condition");
  if (period_scale_ == 0) period_scale_ = reference.period;
  system_.set_parameter(reference.parameter);
  refresh();
  const core::Vector u = scatter(reference);
  const MatrixXd x = nodes(u.get());
  const Index m = scheme_.degree;
  phase_row_.resize(local_, count_ * m);
  MatrixXd values = MatrixXd::Zero(2, 1);
  groups_.together([&] {
    for (Index i = 0; i < count_; ++i)
      for (Index l = 1; l <= m; ++l) {
        const Index k = i * m + l;
        const double weight = length(i) * scheme_.node_weight(l - 1);
        const VectorXd rate = reference_rate(x, reference.period, i, l);
        phase_row_.col(k - 1) = weight * rate;
        values(0) += weight * rate.squaredNorm();
        values(1) += weight * rate.dot(x.col(k));
      }
  });
  sum_over_time(values);
  const double norm = std::sqrt(values(0));
  core::require(norm > 0, "the phase reference does not move");
  phase_row_ /= norm;
  phase_offset_ = values(1) / norm;
}

}  // namespace whirl::solve
