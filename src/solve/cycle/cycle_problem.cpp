#include "whirl/solve/cycle/cycle_problem.hpp"

#include <algorithm>
#include <cmath>

#include "solve/cycle/cycle_matrix.hpp"
#include "solve/cycle/film_march.hpp"
#include "solve/cycle/linear_part.hpp"
#include "solve/cycle/own_block.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/plan.hpp"
#include "whirl/solve/cycle/composition.hpp"
#include "whirl/solve/cycle/cost.hpp"

namespace whirl::solve {
namespace {

using core::check;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using Joining = CycleOptions::Joining;

cost::CycleCounts counts(const CycleOptions& options, problem::BlockStructure& structure, std::size_t intervals) {
  cost::CycleCounts c{.states = structure.size(),
                      .borders = options.autonomous ? 2 : 1,
                      .intervals = static_cast<Index>(intervals),
                      .degree = options.degree,
                      .forces = structure.n_forces(),
                      .entries = structure.l1().nonZeros() + structure.l0().nonZeros()};
  for (const problem::OwnStates& film : structure.own()) {
    c.states += film.count;
    if (options.joining == Joining::one_by_one) continue;  // dense maps, whatever is behind them
    c.own += film.count;
    c.band = std::max(c.band, OwnShape(film).width());
  }
  return c;
}

}  // namespace

CycleProblem::Way CycleProblem::way_of(const CycleOptions& options, problem::BlockStructure* structure,
                                       std::size_t intervals) {
  if (!structure) return Way::dense;
  if (!structure->own().empty()) return Way::own_states;
  const auto modes_are_cheaper = [&] {
    return cost::cheapest(counts(options, *structure, intervals), false, true) == core::plan::CycleWay::modes;
  };
  if (options.points == Points::radau &&
      (options.joining == Joining::modes || (options.joining == Joining::cheapest && modes_are_cheaper())))
    return Way::sparse;
  return 2 * structure->n_forces() < structure->size() ? Way::low_rank : Way::dense;
}

CycleProblem::CycleProblem(MPI_Comm time, problem::System& local, const CycleOptions& options, std::vector<double> mesh)
    : OrbitProblem(local, TimeGroups(time, time),
                   {options.turns, options.autonomous, options.parameter_scale, options.state_weight},
                   make_scheme(options.degree, options.points), mesh),
      structure_(options.use_structure ? local.structure() : nullptr),
      options_(options),
      way_(way_of(options, structure_, mesh.size() - 1)),
      point_(local, structure_, way_ == Way::sparse),
      run_{.comm = time,
           .groups = groups_,
           .n = local_,
           .borders = borders_,
           .intervals = {},
           .columns = {},
           .rows = rows_,
           .corner = corner_,
           .thin = {},
           .multipliers = options.multipliers} {
  const auto sweeps_are_cheaper = [&] {
    return cost::cheapest(counts(options, *structure_, mesh.size() - 1), true, false) == core::plan::CycleWay::sweeps;
  };
  const bool sweeps = options.joining == Joining::sweeps ||
                      ((options.joining == Joining::cheapest || options.joining == Joining::one_by_one) &&
                       way_ == Way::own_states && sweeps_are_cheaper());
  core::require(options.joining != Joining::modes || way_ == Way::sparse,
                "time modes want Radau points and a machine that is linear but for thin forces");
  core::plan::note(way_ == Way::sparse ? core::plan::CycleWay::modes
                   : sweeps            ? core::plan::CycleWay::sweeps
                                       : core::plan::CycleWay::dense);
  composition_ = way_ == Way::sparse ? make_mode_composition()
                 : sweeps            ? make_sweep_composition()
                                     : make_dense_composition();
  forget_mesh();
}

CycleProblem::~CycleProblem() = default;

void CycleProblem::forget_mesh() {
  matrix_.reset();
  linearised_ = false;
  kept_.resize(static_cast<std::size_t>(structure_ ? count_ * scheme_.degree : 0));
  kept_valid_ = false;
  run_.intervals.clear();
}

double CycleProblem::begin_point(const VectorXd& border) {
  system_.set_parameter(border(borders_ - 1) * options_.parameter_scale);
  const double period = period_of(border);
  if (!(period > 0)) throw core::DomainError("the period is not positive");
  point_.refresh();
  return period;
}

VectorXd CycleProblem::previous_end(const double* own) const {
  return groups_.from_before(Map<const VectorXd>(own + (count_ * scheme_.degree - 1) * local_, local_));
}

void CycleProblem::residual(Vec u, Vec r) {
  const VectorXd border = border_of(u);
  const core::ReadArray ua(u);
  const VectorXd before = previous_end(ua.data());
  core::WriteArray ra(r);
  const Index m = scheme_.degree;
  kept_valid_ = false;
  core::agree(comm(), [&] {
    const double period = begin_point(border);
    for (Index i = 0; i < count_; ++i) {
      const double* own = ua.data() + i * m * local_;
      const double* start = i == 0 ? before.data() : own - local_;
      interval_residual(i, own, Map<const VectorXd>(start, local_), period, ra.data() + i * m * local_);
    }
  });
  keep(ua, before, border);
  put_phase(Map<const MatrixXd>(ua.data(), local_, count_ * m), ra);
}

// State and rate at point j of interval i.
void CycleProblem::interpolate(Index i, Index j, const double* own, const VectorXd& start, double period,
                               VectorXd& value, VectorXd& slope) const {
  value = scheme_.value(j, 0) * start;
  slope = scheme_.slope(j, 0) * start;
  for (Index l = 1; l <= scheme_.degree; ++l) {
    const Map<const VectorXd> node(own + (l - 1) * local_, local_);
    value += scheme_.value(j, l) * node;
    slope += scheme_.slope(j, l) * node;
  }
  slope /= length(i) * period;
}

void CycleProblem::interval_residual(Index i, const double* own, const VectorXd& start, double period, double* out) {
  const Index m = scheme_.degree;
  for (Index j = 0; j < m; ++j) {
    interpolate(i, j, own, start, period, value_, slope_);
    Map<VectorXd> row(out + j * local_, local_);
    if (structure_)
      point_.residual(angle_at(i, scheme_.c(j)), value_, slope_, row, kept_[static_cast<std::size_t>(i * m + j)]);
    else
      point_.residual(angle_at(i, scheme_.c(j)), value_, slope_, row);
  }
}

MatrixXd CycleProblem::border_columns(const VectorXd& d_parameter, const VectorXd& rate, double period) const {
  MatrixXd columns(local_, borders_);
  columns.rightCols(1) = d_parameter;
  // On a forced cycle T = 2 pi k/Omega, so that the rate x'/T grows with the speed at fixed x(s).
  if (!options_.autonomous && system_.parameter_is_speed()) columns.rightCols(1) += rate / system_.speed();
  columns.rightCols(1) *= options_.parameter_scale;
  if (options_.autonomous) columns.col(0) = -rate / period * period_scale_;
  return columns;
}

std::unique_ptr<Interval> CycleProblem::linearise_interval(Index i, const double* own, const VectorXd& start,
                                                           double period, MatrixXd& columns) {
  const Index m = scheme_.degree;
  const double h = length(i);
  columns.resize(m * local_, borders_);
  std::vector<MatrixXd> jx(static_cast<std::size_t>(m)), jxdot(jx);
  std::vector<const problem::PointState*> points;
  VectorXd d_parameter(local_), rate(local_);
  for (Index j = 0; j < m; ++j) {
    const auto jj = static_cast<std::size_t>(j);
    const double angle = angle_at(i, scheme_.c(j));
    interpolate(i, j, own, start, period, value_, slope_);
    if (structure_) {
      problem::PointState& at = kept_[static_cast<std::size_t>(i * m + j)];
      if (!kept_valid_) point_.residual(angle, value_, slope_, rate, at);
      point_.parameter_derivative(angle, at, d_parameter);
      point_.times_rates(at, slope_, rate);
      points.push_back(&at);
      if (way_ == Way::dense) point_.matrices(at, jx[jj], jxdot[jj]);
    } else {
      point_.linearise(angle, value_, slope_, jx[jj], jxdot[jj], &d_parameter);
      rate.noalias() = jxdot[jj] * slope_;
    }
    columns.middleRows(j * local_, local_) = border_columns(d_parameter, rate, period);
  }
  if (way_ == Way::dense) return make_dense_interval(scheme_, h * period, std::move(jx), std::move(jxdot));
  const double rounded = std::round(h * 1e12) / 1e12;
  std::vector<MatrixXd> tangents;
  if (way_ != Way::own_states)
    for (const problem::PointState* at : points) tangents.push_back(at->films.d_inputs);
  if (way_ == Way::sparse) {
    auto& part = sparse_parts_[rounded];
    if (!part) part = make_sparse_part(scheme_, h * period, thin_);
    return make_sparse_interval(part, std::move(tangents));
  }
  auto& part = parts_[rounded];
  if (!part) part = std::make_shared<LinearPart>(scheme_, h * period, point_.blocks());
  if (way_ == Way::own_states) return make_own_interval(part, structure_->own(), point_, points);
  return make_low_rank_interval(part, std::move(tangents));
}

void CycleProblem::linearise(Vec u, Vec row) {
  const VectorXd border = border_of(u);
  const core::ReadArray ua(u);
  const VectorXd before = previous_end(ua.data());
  const Index m = scheme_.degree, size = m * local_;
  const auto count = static_cast<std::size_t>(count_);
  const bool known = kept_valid_ && same_as_kept(ua, before, border);
  kept_valid_ = known;
  linearised_ = false;
  run_.intervals.clear();
  run_.intervals.resize(count);
  parts_.clear();
  sparse_parts_.clear();
  run_.thin.reset();
  run_.columns.resize(count);
  core::agree(comm(), [&] {
    const double period = begin_point(border);
    if (way_ == Way::sparse) thin_ = point_.thin_blocks();
    for (Index i = 0; i < count_; ++i) {
      const double* own = ua.data() + i * size;
      const VectorXd start = i == 0 ? before : VectorXd(Map<const VectorXd>(own - local_, local_));
      run_.intervals[static_cast<std::size_t>(i)] =
          linearise_interval(i, own, start, period, run_.columns[static_cast<std::size_t>(i)]);
    }
    if (way_ != Way::sparse) return;
    run_.thin = ThinRun{&thin_, &scheme_, &mesh_, period, {}};
    for (const problem::PointState& at : kept_) run_.thin->tangents.push_back(&at.films.d_inputs);
  });
  // The same solution is often linearised again with another row.
  if (!known) keep(ua, before, border);

  take_rows(row);
  composition_->compose(run_);
  linearised_ = true;
  if (matrix_) matrix_->fill(run_);
}

Mat CycleProblem::matrix() {
  if (!matrix_ && !linearised_) return nullptr;
  if (!matrix_) matrix_ = std::make_unique<CycleMatrix>(run_, first_, static_cast<Index>(mesh_.size()) - 1);
  return matrix_->get();
}

VectorXd CycleProblem::reference_rate(const Cycle& reference, Index g, Index l) {
  const Index m = scheme_.degree;
  const VectorXd w = lagrange_slope(scheme_, scheme_.node(l)) / length(g - first_);
  VectorXd rate = w(0) * reference.x.col(g == 0 ? reference.x.cols() - 1 : g * m - 1);
  for (Index q = 1; q <= m; ++q) rate += w(q) * reference.x.col(g * m + q - 1);
  return rate;
}

MatrixXd CycleProblem::reference_rates(const Cycle& reference) {
  const Index m = scheme_.degree;
  MatrixXd rates(local_, count_ * m);
  core::agree(comm(), [&] {  // a film may refuse a cycle that comes from another mesh
    for (Index k = 0; k < count_ * m; ++k)
      rates.col(k) = reference_rate(reference, first_ + k / m, k % m + 1).cwiseQuotient(state_scale());
  });
  return rates;
}

bool CycleProblem::adapt(core::Vector& u, core::Vector& tangent) {
  // Modes in time want intervals of like lengths: whole shafts keep their mesh, and bars tell what it does.
  if (way_ == Way::sparse) return false;
  return adapt_to(options_.mesh_tolerance, options_.base_intervals, options_.max_intervals, u, tangent);
}

std::vector<problem::Field> CycleProblem::fields() const {
  return {{"orbit", 0, static_cast<PetscInt>(count_ * scheme_.degree * local_)}};
}

void CycleProblem::keep(const core::ReadArray& u, const VectorXd& before, const VectorXd& border) {
  kept_u_ = Map<const VectorXd>(u.data(), u.size());
  kept_before_ = before;
  kept_border_ = border;
  kept_valid_ = structure_ != nullptr;
}

bool CycleProblem::same_as_kept(const core::ReadArray& u, const VectorXd& before, const VectorXd& border) const {
  return kept_u_.size() == u.size() && before == kept_before_ && border == kept_border_ &&
         kept_u_ == Map<const VectorXd>(u.data(), u.size());
}

void CycleProblem::solve(Vec rhs, Vec x) {
  VectorXd border = border_of(rhs);
  const core::ReadArray ra(rhs);
  core::WriteArray xa(x);
  composition_->solve(ra.data(), border, xa.data());
  if (last_) Map<VectorXd>(xa.data() + xa.size() - borders_, borders_) = border;
}

std::vector<std::complex<double>> CycleProblem::multipliers() {
  return composition_->multipliers();
}

MatrixXd CycleProblem::monodromy() const {
  return composition_->monodromy();
}

MatrixXd CycleProblem::critical_motion(double mu) {
  return state_scale().asDiagonal() * propagate(composition_->critical_start(mu));
}

MatrixXd CycleProblem::propagate(const VectorXd& v) const {
  return groups_.joined(forward(v).nodes, static_cast<Index>(mesh_.size()) - 1);
}

}  // namespace whirl::solve
