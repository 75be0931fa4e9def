#include "whirl/solve/cycle/orbit_problem.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "solve/newton/local_part.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/count.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/index.hpp"

namespace whirl::solve {

using core::at;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

OrbitProblem::OrbitProblem(problem::System& system, const TimeGroups& groups, const OrbitOptions& options,
                           Scheme scheme, std::vector<double> mesh)
    : system_(system),
      groups_(groups),
      orbit_(options),
      scheme_(std::move(scheme)),
      local_(system.local_size()),
      borders_(options.autonomous ? 2 : 1),
      last_(core::rank_of(groups.all()) == core::size_of(groups.all()) - 1) {
  const core::Vector scale = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE),
                     unused = core::duplicate(scale.get());
  system.scales(scale.get(), unused.get());
  scale_ = get(scale.get());
  set_mesh(std::move(mesh));
}

void OrbitProblem::set_mesh(std::vector<double> mesh) {
  mesh_ = std::move(mesh);
  const auto all = static_cast<Index>(mesh_.size()) - 1;
  core::agree(comm(), [&] {
    (void)core::count_of(std::int64_t{all} * scheme_.degree * system_.size() + borders_,
                         "unknowns of a cycle (intervals x points x states)");
    if (all < groups_.count())
      throw core::InputError("fewer intervals than ranks, or groups of ranks, that share them");
  });
  first_ = groups_.first(all, groups_.index());
  count_ = groups_.first(all, groups_.index() + 1) - first_;
  weights_ = OrbitProblem::make_unknown();
  const Index m = scheme_.degree;
  const core::WriteArray w(weights_.get());
  for (Index i = 0; i < count_; ++i)
    for (Index l = 0; l < m; ++l)
      Map<VectorXd>(w.data() + (i * m + l) * local_, local_)
          .setConstant(orbit_.state_weight * length(i) * scheme_.node_weight(l) / static_cast<double>(system_.size()));
  if (last_) w[w.size() - 1] = 1;
}

core::Vector OrbitProblem::make_unknown() const {
  const Index own = count_ * scheme_.degree * local_ + (last_ ? borders_ : 0);
  return core::make_vector(comm(), static_cast<PetscInt>(own), PETSC_DETERMINE);
}

double OrbitProblem::angle(double s) const {
  return orbit_.autonomous ? 0.0 : 2 * std::numbers::pi * orbit_.turns * s;
}

VectorXd OrbitProblem::border_of(Vec u) const {
  VectorXd border(borders_);
  if (last_) {
    const core::ReadArray a(u);
    border = Map<const VectorXd>(a.data() + a.size() - borders_, borders_);
  }
  MPI_Bcast(border.data(), static_cast<int>(borders_), MPI_DOUBLE, core::size_of(comm()) - 1, comm());
  return border;
}

double OrbitProblem::period_of(const VectorXd& border) const {
  return orbit_.autonomous ? border(0) * period_scale_ : 2 * std::numbers::pi * orbit_.turns / system_.speed();
}

MatrixXd OrbitProblem::with_start(const MatrixXd& own) const {
  MatrixXd x(local_, 1 + own.cols());
  x << groups_.from_before(own.rightCols(1)), own;
  return x;
}

MatrixXd OrbitProblem::nodes(Vec u) const {
  const core::ReadArray ua(u);
  return with_start(Map<const MatrixXd>(ua.data(), local_, count_ * scheme_.degree));
}

void OrbitProblem::sum_over_time(MatrixXd& values) const {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm());
}

void OrbitProblem::put_phase(const Eigen::Ref<const MatrixXd>& own, const core::WriteArray& r) const {
  if (!orbit_.autonomous) return;
  MatrixXd phase(1, 1);
  phase(0, 0) = (own.array() * phase_row_.array()).sum();
  sum_over_time(phase);
  if (last_) r[r.size() - 2] = phase(0, 0) - phase_offset_;
}

void OrbitProblem::take_rows(Vec row) {
  const core::ReadArray wa(row);
  const Index size = scheme_.degree * local_;
  rows_.assign(at(count_), MatrixXd(borders_, size));
  for (Index i = 0; i < count_; ++i) {
    if (orbit_.autonomous) rows_[at(i)].row(0) = Map<const VectorXd>(phase_row_.data() + i * size, size).transpose();
    rows_[at(i)].row(borders_ - 1) = Map<const VectorXd>(wa.data() + i * size, size).transpose();
  }
  corner_ = MatrixXd::Zero(borders_, borders_);
  corner_.row(borders_ - 1) = border_of(row).transpose();
}

void OrbitProblem::multiply(Vec v, Vec y) {
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
      Map<VectorXd> out(ya.data() + i * size, size);
      out = product(i, start, own);
      out.noalias() += columns(i) * border;
      added.noalias() += rows_[at(i)] * own;
      start = own.tail(local_);
    }
  });
  sum_over_time(added);
  added += corner_ * border;
  if (last_) Map<VectorXd>(ya.data() + ya.size() - borders_, borders_) = added;
}

Cycle OrbitProblem::gather(Vec u) const {
  const VectorXd border = border_of(u);
  const core::ReadArray ua(u);
  Cycle cycle{mesh_, {}, 0, border(borders_ - 1) * orbit_.parameter_scale};
  const Map<const MatrixXd> own(ua.data(), local_, count_ * scheme_.degree);
  cycle.x = scale_.asDiagonal() * groups_.joined(own, static_cast<Index>(mesh_.size()) - 1);
  if (orbit_.autonomous)
    cycle.period = border(0) * period_scale_;
  else
    cycle.period =
        2 * std::numbers::pi * orbit_.turns / (system_.parameter_is_speed() ? cycle.parameter : system_.speed());
  return cycle;
}

core::Vector OrbitProblem::scatter(const Cycle& cycle) const {
  core::require(!orbit_.autonomous || period_scale_ > 0, "an autonomous cycle wants its phase reference first");
  core::require(cycle.x.rows() == local_, "of a cycle each rank has its rows");
  const Cycle here = cycle.on(scheme_, mesh_);
  core::Vector u = make_unknown();
  const core::WriteArray ua(u.get());
  const Index m = scheme_.degree;
  Map<MatrixXd>(ua.data(), local_, count_ * m) =
      scale_.cwiseInverse().asDiagonal() * here.x.middleCols(first_ * m, count_ * m);
  if (last_) {
    if (orbit_.autonomous) ua[ua.size() - 2] = cycle.period / period_scale_;
    ua[ua.size() - 1] = cycle.parameter / orbit_.parameter_scale;
  }
  return u;
}

void OrbitProblem::set_phase_reference(const Cycle& reference) {
  core::require(orbit_.autonomous, "only an autonomous cycle has a phase condition");
  if (period_scale_ == 0) period_scale_ = reference.period;
  const Cycle here = reference.on(scheme_, mesh_);
  const Index m = scheme_.degree;
  phase_row_ = reference_rates(here);
  MatrixXd values = MatrixXd::Zero(2, 1);  // squared norm of the rate, and integral of <x, x'>
  for (Index k = 0; k < count_ * m; ++k) {
    const double weight = length(k / m) * scheme_.node_weight(k % m);
    auto rate = phase_row_.col(k);
    values(0) += weight * rate.squaredNorm();
    values(1) += weight * rate.dot(here.x.col(first_ * m + k).cwiseQuotient(scale_));
    rate *= weight;
  }
  sum_over_time(values);
  const double norm = std::sqrt(values(0));
  core::require(norm > 0, "the phase reference does not move");
  phase_row_ /= norm;
  phase_offset_ = values(1) / norm;
}

bool OrbitProblem::adapt_to(double tolerance, int base, int max_intervals, core::Vector& u, core::Vector& tangent) {
  if (tolerance <= 0) return false;
  const Cycle cycle = gather(u.get()), direction = gather(tangent.get());
  double longest = 0;
  for (std::size_t i = 0; i + 1 < mesh_.size(); ++i) longest = std::max(longest, mesh_[i + 1] - mesh_[i]);
  if (base <= 0) base = static_cast<int>(std::lround(1 / longest));
  std::vector<double> better = adapted_mesh(scheme_, cycle, scale_, tolerance, base, max_intervals, system_.comm());
  if (better == mesh_ || static_cast<int>(better.size()) - 1 < groups_.count()) return false;
  set_mesh(std::move(better));
  forget_mesh();
  u = scatter(cycle);
  tangent = scatter(direction);
  if (orbit_.autonomous) set_phase_reference(cycle);
  return true;
}

}  // namespace whirl::solve
