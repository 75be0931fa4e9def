// Between the distributed unknowns of a periodic solution and its Cycle; phase reference; adapted meshes.

#include <cmath>
#include <numbers>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"

namespace whirl::solve {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Cycle CycleProblem::gather(Vec u) const {
  const Index m = scheme_.degree, total = static_cast<Index>(mesh_.size()) - 1;
  const VectorXd border = border_of(u);
  Cycle cycle{mesh_, MatrixXd(n_, total * m), 0, border(borders_ - 1) * options_.parameter_scale};
  std::vector<int> counts(static_cast<std::size_t>(size_)), offsets(static_cast<std::size_t>(size_));
  for (int p = 0; p < size_; ++p) {
    const Index begin = total * p / size_, end = total * (p + 1) / size_;
    offsets[static_cast<std::size_t>(p)] = static_cast<int>(begin * m * n_);
    counts[static_cast<std::size_t>(p)] = static_cast<int>((end - begin) * m * n_);
  }
  const core::ReadArray ua(u);
  MPI_Allgatherv(ua.data(), static_cast<int>(count_ * m * n_), MPI_DOUBLE, cycle.x.data(), counts.data(),
                 offsets.data(), MPI_DOUBLE, comm_);
  cycle.x = state_scale().asDiagonal() * cycle.x;
  if (options_.autonomous)
    cycle.period = border(0) * period_scale_;
  else
    cycle.period =
        2 * std::numbers::pi * options_.turns / (system_.parameter_is_speed() ? cycle.parameter : system_.speed());
  return cycle;
}

core::Vector CycleProblem::scatter(const Cycle& cycle) const {
  core::require(!options_.autonomous || period_scale_ > 0, "an autonomous cycle wants its phase reference first");
  const Cycle here = cycle.on(scheme_, mesh_);
  const Index m = scheme_.degree;
  core::Vector u = make_unknown();
  core::WriteArray ua(u.get());
  Map<MatrixXd>(ua.data(), n_, count_ * m) =
      state_scale().cwiseInverse().asDiagonal() * here.x.middleCols(first_ * m, count_ * m);
  if (rank_ == size_ - 1) {
    if (options_.autonomous) ua[ua.size() - 2] = cycle.period / period_scale_;
    ua[ua.size() - 1] = cycle.parameter / options_.parameter_scale;
  }
  return u;
}

VectorXd CycleProblem::reference_rate(const Cycle& reference, Index g, Index l) {
  const Index m = scheme_.degree;
  const VectorXd w = lagrange_slope(scheme_, scheme_.node(l)) / interval_length(g - first_);
  VectorXd rate = w(0) * reference.x.col(g == 0 ? reference.x.cols() - 1 : g * m - 1);
  for (Index q = 1; q <= m; ++q) rate += w(q) * reference.x.col(g * m + q - 1);
  return rate;
}

void CycleProblem::set_phase_reference(const Cycle& reference) {
  core::require(options_.autonomous, "only an autonomous cycle has a phase condition");
  if (period_scale_ == 0) period_scale_ = reference.period;
  const Cycle here = reference.on(scheme_, mesh_);
  const Index m = scheme_.degree;
  phase_row_.resize(n_, count_ * m);
  double values[2] = {0, 0};  // squared norm of the rate, and integral of <x, x'>
  core::agree(comm_, [&] {    // a film may refuse a cycle that comes from another mesh
    for (Index i = 0; i < count_; ++i) {
      const Index g = first_ + i;
      const double h = interval_length(g - first_);
      for (Index l = 1; l <= m; ++l) {
        VectorXd rate = reference_rate(here, g, l);
        rate = rate.cwiseQuotient(state_scale());
        const VectorXd value = here.x.col(g * m + l - 1).cwiseQuotient(state_scale());
        const double weight = h * scheme_.node_weight(l - 1);
        phase_row_.col(i * m + l - 1) = weight * rate;
        values[0] += weight * rate.squaredNorm();
        values[1] += weight * rate.dot(value);
      }
    }
  });
  MPI_Allreduce(MPI_IN_PLACE, values, 2, MPI_DOUBLE, MPI_SUM, comm_);
  const double norm = std::sqrt(values[0]);
  core::require(norm > 0, "the phase reference does not move");
  phase_row_ /= norm;
  phase_offset_ = values[1] / norm;
}

bool CycleProblem::adapt(core::Vector& u, core::Vector& tangent) {
  // Modes in time want intervals of like lengths: whole shafts keep their mesh, and bars tell what it does.
  if (options_.mesh_tolerance <= 0 || way_ == Way::sparse) return false;
  const Cycle cycle = gather(u.get()), direction = gather(tangent.get());
  double longest = 0;
  for (Index i = 0; i < cycle.intervals(); ++i) longest = std::max(longest, interval_length(i - first_));
  const int base = options_.base_intervals > 0 ? options_.base_intervals : static_cast<int>(std::lround(1 / longest));
  std::vector<double> mesh =
      adapted_mesh(scheme_, cycle, state_scale(), options_.mesh_tolerance, base, options_.max_intervals);
  if (mesh == mesh_ || static_cast<int>(mesh.size()) - 1 < size_) return false;
  layout(std::move(mesh));
  u = scatter(cycle);
  tangent = scatter(direction);
  if (options_.autonomous) set_phase_reference(cycle);
  return true;
}

}  // namespace whirl::solve
