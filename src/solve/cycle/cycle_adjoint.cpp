// Adjoint equations and second derivatives of a periodic solution: what its bifurcation conditions are made of.

#include <algorithm>
#include <cmath>
#include <limits>

#include "whirl/core/agree.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"

namespace whirl::solve {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double difference_step(double largest) {
  return std::cbrt(std::numeric_limits<double>::epsilon()) / std::max(largest, std::numeric_limits<double>::min());
}

double CycleProblem::largest(const Path& path, MPI_Comm comm) {
  double value = 0;
  for (const auto* part : {&path.start, &path.border})
    if (part->size() > 0) value = std::max(value, part->cwiseAbs().maxCoeff());
  if (path.nodes.size() > 0) value = std::max(value, path.nodes.cwiseAbs().maxCoeff());
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, comm);
  return value;
}

Path CycleProblem::path_of(Vec v) const {
  const core::ReadArray a(v);
  return {previous_end(a.data()), Map<const MatrixXd>(a.data(), local_, count_ * scheme_.degree), border_of(v)};
}

void CycleProblem::interval_transposed(Index i, const double* own, const VectorXd& start, double period,
                                       const MatrixXd& y, MatrixXd& to_own, MatrixXd& to_start, MatrixXd& to_border) {
  const double length = interval_length(i) * period;
  VectorXd value(local_), slope(local_), d_parameter(local_), rate(local_), by_value, by_slope;
  MatrixXd jx, jxdot;
  problem::PointState at;
  for (Index j = 0; j < scheme_.degree; ++j) {
    interpolate(i, j, own, start, period, value, slope);
    const double angle = angle_at(i, scheme_.c(j));
    if (structure_) {
      point_.residual(angle, value, slope, rate, at);
      point_.parameter_derivative(angle, at, d_parameter);
      point_.times_rates(at, slope, rate);
    } else {
      point_.linearise(angle, value, slope, jx, jxdot, &d_parameter);
      rate.noalias() = jxdot * slope;
    }
    to_border += border_columns(d_parameter, rate, period).transpose() * y.middleRows(j * local_, local_);
    for (Index k = 0; k < y.cols(); ++k) {
      const auto part = y.col(k).segment(j * local_, local_);
      if (structure_) {
        point_.times_transposed(at, part, by_value, by_slope);
      } else {
        by_value.noalias() = jx.transpose() * part;
        by_slope.noalias() = jxdot.transpose() * part;
      }
      by_slope /= length;
      to_start.col(k) += scheme_.value(j, 0) * by_value + scheme_.slope(j, 0) * by_slope;
      for (Index l = 1; l <= scheme_.degree; ++l)
        to_own.col(k).segment((l - 1) * local_, local_) +=
            scheme_.value(j, l) * by_value + scheme_.slope(j, l) * by_slope;
    }
  }
}

MatrixXd CycleProblem::interval_tangent(Index i, const double* own, const VectorXd& start, double period,
                                        const MatrixXd& d_own, const MatrixXd& d_start) {
  VectorXd value(local_), slope(local_), d_value(local_), d_slope(local_), unused(local_);
  MatrixXd jx, jxdot, out(scheme_.degree * local_, d_own.cols());
  problem::PointState at;
  for (Index j = 0; j < scheme_.degree; ++j) {
    interpolate(i, j, own, start, period, value, slope);
    const double angle = angle_at(i, scheme_.c(j));
    if (structure_)
      point_.residual(angle, value, slope, unused, at);
    else
      point_.linearise(angle, value, slope, jx, jxdot, nullptr);
    for (Index k = 0; k < out.cols(); ++k) {
      interpolate(i, j, d_own.col(k).data(), d_start.col(k), period, d_value, d_slope);
      if (structure_)
        point_.times(at, d_value, d_slope, out.col(k).segment(j * local_, local_));
      else
        out.col(k).segment(j * local_, local_) = jx * d_value + jxdot * d_slope;
    }
  }
  return out;
}

// Calls work(interval, own, start, period) at u + step * along.
void CycleProblem::displaced(Vec u, double step, const Path& along,
                             const std::function<void(Index, const double*, const VectorXd&, double)>& work) {
  const Path at = path_of(u);
  const VectorXd border =
      at.border + (along.border.size() > 0 ? VectorXd(step * along.border) : VectorXd::Zero(borders_));
  const MatrixXd nodes = at.nodes + step * along.nodes;
  const VectorXd before = at.start + step * along.start;
  core::agree(comm(), [&] {
    const double period = begin_point(border);
    for (Index i = 0; i < count_; ++i) {
      const double* own = nodes.data() + i * scheme_.degree * local_;
      work(i, own, i == 0 ? before : VectorXd(Map<const VectorXd>(own - local_, local_)), period);
    }
  });
}

std::vector<core::Vector> CycleProblem::gradients(Vec u, const Path& v, const std::vector<MatrixXd>& weights) {
  const Index m = scheme_.degree, block = m * local_, many = static_cast<Index>(weights.size());
  const double h = difference_step(largest(v, comm()));
  MatrixXd own_sum = MatrixXd::Zero(count_ * block, many), before_sum = MatrixXd::Zero(local_, many),
           border_sum = MatrixXd::Zero(borders_, many), y(block, many);
  for (const double sign : {1.0, -1.0})
    displaced(u, sign * h, v, [&](Index i, const double* own, const VectorXd& start, double period) {
      MatrixXd to_own = MatrixXd::Zero(block, many), to_start = MatrixXd::Zero(local_, many),
               to_border = MatrixXd::Zero(borders_, many);
      for (Index k = 0; k < many; ++k) y.col(k) = weights[static_cast<std::size_t>(k)].col(i);
      interval_transposed(i, own, start, period, y, to_own, to_start, to_border);
      const double factor = sign / (2 * h);
      own_sum.middleRows(i * block, block) += factor * to_own;
      if (i == 0)
        before_sum += factor * to_start;
      else
        own_sum.middleRows(i * block - local_, local_) += factor * to_start;
      border_sum += factor * to_border;
    });
  (void)begin_point(border_of(u));
  const int next = (groups_.index() + 1) % groups_.count(),
            previous = (groups_.index() + groups_.count() - 1) % groups_.count();
  std::vector<core::Vector> out;
  for (Index k = 0; k < many; ++k) {
    VectorXd received(local_);
    MPI_Sendrecv(before_sum.col(k).data(), static_cast<int>(local_), MPI_DOUBLE, previous, 0, received.data(),
                 static_cast<int>(local_), MPI_DOUBLE, next, 0, comm(), MPI_STATUS_IGNORE);
    own_sum.col(k).tail(local_) += received;
    MPI_Allreduce(MPI_IN_PLACE, border_sum.col(k).data(), static_cast<int>(borders_), MPI_DOUBLE, MPI_SUM, comm());
    core::Vector g = make_unknown();
    const core::WriteArray a(g.get());
    Map<VectorXd>(a.data(), own_sum.rows()) = own_sum.col(k);
    if (last_) Map<VectorXd>(a.data() + own_sum.rows(), borders_) = border_sum.col(k);
    out.push_back(std::move(g));
  }
  return out;
}

void CycleProblem::curvature(Vec u, Vec v, Vec w, Vec out) {
  const core::ReadArray a(w);
  const Index block = scheme_.degree * local_;
  std::vector<MatrixXd> weights{Map<const MatrixXd>(a.data(), block, count_)};
  core::check(VecCopy(gradients(u, path_of(v), weights).front().get(), out));
}

std::vector<MatrixXd> CycleProblem::tangents(Vec u, double step, const Path& a, const std::vector<const Path*>& b) {
  const Index block = scheme_.degree * local_, many = static_cast<Index>(b.size());
  std::vector<MatrixXd> y(b.size(), MatrixXd(block, count_));
  MatrixXd d_own(block, many), d_start(local_, many);
  displaced(u, step, a, [&](Index i, const double* own, const VectorXd& start, double period) {
    for (Index k = 0; k < many; ++k) {
      const Path& path = *b[static_cast<std::size_t>(k)];
      const double* nodes = path.nodes.data() + i * block;
      d_own.col(k) = Map<const VectorXd>(nodes, block);
      d_start.col(k) = i == 0 ? path.start : VectorXd(Map<const VectorXd>(nodes - local_, local_));
    }
    const MatrixXd out = interval_tangent(i, own, start, period, d_own, d_start);
    for (Index k = 0; k < many; ++k) y[static_cast<std::size_t>(k)].col(i) = out.col(k);
  });
  (void)begin_point(border_of(u));
  return y;
}

// The motion from `start` under `rhs`, if that is not null.
Path CycleProblem::driven(const VectorXd& start, const double* rhs, VectorXd& end) const {
  Path path{{}, MatrixXd(local_, count_ * scheme_.degree), {}};
  MatrixXd state = start;
  VectorXd added = VectorXd::Zero(borders_);
  groups_.in_turn(state, [&] {
    path.start = state;
    state = run_.drive(rhs, path.start, nullptr, path.nodes.data(), added);
  });
  end = state;
  return path;
}

Path CycleProblem::forward(const VectorXd& v) const {
  VectorXd end;
  return driven(v, nullptr, end);
}

Path CycleProblem::forced(const MatrixXd& y, VectorXd& end) const {
  const MatrixXd rhs = -y;
  return driven(VectorXd::Zero(local_), rhs.data(), end);
}

MatrixXd CycleProblem::backward(const VectorXd& w) const {
  MatrixXd lambda = w, weights(scheme_.degree * local_, count_);
  VectorXd seen = VectorXd::Zero(borders_);
  groups_.in_turn(
      lambda, [&] { lambda = run_.drive_back(nullptr, lambda, VectorXd::Zero(borders_), weights.data(), seen); }, true);
  return weights;
}

void CycleProblem::solve_transposed(Vec rhs, Vec x) {
  VectorXd border = border_of(rhs);
  const core::ReadArray ra(rhs);
  const core::WriteArray xa(x);
  composition_->solve_transposed(ra.data(), border, xa.data());
  if (last_) Map<VectorXd>(xa.data() + xa.size() - borders_, borders_) = border;
}

}  // namespace whirl::solve
