#include "whirl/solve/cycle_problem.hpp"

#include <cmath>
#include <numbers>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::solve {
namespace {

using core::check;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double two_pi = 2 * std::numbers::pi;

double length(const std::vector<double>& mesh, Index i) {
  return mesh[static_cast<std::size_t>(i) + 1] - mesh[static_cast<std::size_t>(i)];
}

}  // namespace

CycleProblem::CycleProblem(MPI_Comm time, problem::System& local, const CycleOptions& options, std::vector<double> mesh)
    : comm_(time),
      rank_(core::rank_of(time)),
      size_(core::size_of(time)),
      system_(local),
      structure_(options.use_structure ? local.structure() : nullptr),
      point_(local, structure_),
      options_(options),
      scheme_(make_scheme(options.degree, options.points)),
      n_(local.size()),
      borders_(options.autonomous ? 2 : 1) {
  layout(std::move(mesh));
}

CycleProblem::~CycleProblem() = default;

void CycleProblem::layout(std::vector<double> mesh) {
  mesh_ = std::move(mesh);
  const Index total = static_cast<Index>(mesh_.size()) - 1;
  if (total < size_) throw core::InputError("fewer collocation intervals than ranks");
  first_ = total * rank_ / size_;
  count_ = total * (rank_ + 1) / size_ - first_;
  intervals_.clear();
  weights_ = make_unknown();
  core::WriteArray w(weights_.get());
  const Index m = scheme_.degree;
  for (Index i = 0; i < count_; ++i)
    for (Index l = 0; l < m; ++l)
      for (Index k = 0; k < n_; ++k)
        w[static_cast<PetscInt>((i * m + l) * n_ + k)] =
            options_.state_weight * length(mesh_, first_ + i) * scheme_.node_weight(l) / static_cast<double>(n_);
  if (rank_ == size_ - 1) w[w.size() - 1] = 1;
}

core::Vector CycleProblem::make_unknown() const {
  const Index local = count_ * scheme_.degree * n_ + (rank_ == size_ - 1 ? borders_ : 0);
  return core::make_vector(comm_, static_cast<PetscInt>(local), PETSC_DETERMINE);
}

VectorXd CycleProblem::border_of(Vec u) const {
  VectorXd border(borders_);
  if (rank_ == size_ - 1) {
    const core::ReadArray a(u);
    for (Index k = 0; k < borders_; ++k) border(k) = a[static_cast<PetscInt>(a.size() - borders_ + k)];
  }
  MPI_Bcast(border.data(), static_cast<int>(borders_), MPI_DOUBLE, size_ - 1, comm_);
  return border;
}

void CycleProblem::set_parameter(const VectorXd& border) {
  system_.set_parameter(border(borders_ - 1) * options_.parameter_scale);
}

double CycleProblem::period_of(const VectorXd& border) const {
  if (options_.autonomous) return border(0) * period_scale_;
  return two_pi * options_.turns / system_.speed();
}

VectorXd CycleProblem::previous_end(const double* local) const {
  VectorXd send = Map<const VectorXd>(local + (count_ * scheme_.degree - 1) * n_, n_), receive(n_);
  const int next = (rank_ + 1) % size_, previous = (rank_ + size_ - 1) % size_;
  MPI_Sendrecv(send.data(), static_cast<int>(n_), MPI_DOUBLE, next, 0, receive.data(), static_cast<int>(n_), MPI_DOUBLE,
               previous, 0, comm_, MPI_STATUS_IGNORE);
  return receive;
}

void CycleProblem::residual(Vec u, Vec r) {
  const VectorXd border = border_of(u);
  const core::ReadArray ua(u);
  const VectorXd before = previous_end(ua.data());
  core::WriteArray ra(r);
  const Index m = scheme_.degree;
  core::agree(comm_, [&] {
    set_parameter(border);
    const double period = period_of(border);
    if (!(period > 0)) throw core::DomainError("the period is not positive");
    point_.refresh();
    for (Index i = 0; i < count_; ++i) {
      const double* own = ua.data() + i * m * n_;
      const double* start = i == 0 ? before.data() : own - n_;
      interval_residual(i, own, Map<const VectorXd>(start, n_), period, ra.data() + i * m * n_);
    }
  });
  if (options_.autonomous) {
    double phase = 0;
    if (count_ > 0) phase = (Map<const MatrixXd>(ua.data(), n_, count_ * m).array() * phase_row_.array()).sum();
    MPI_Allreduce(MPI_IN_PLACE, &phase, 1, MPI_DOUBLE, MPI_SUM, comm_);
    if (rank_ == size_ - 1) ra[ra.size() - 2] = phase - phase_offset_;
  }
}

double CycleProblem::interval_length(Index i) const {
  return length(mesh_, first_ + i);
}

double CycleProblem::angle_at(Index i, double t) const {
  const auto k = static_cast<std::size_t>(first_ + i);
  return options_.autonomous ? 0.0 : two_pi * options_.turns * (mesh_[k] + length(mesh_, first_ + i) * t);
}

// State and rate at point j of interval i.
void CycleProblem::interpolate(Index i, Index j, const double* own, const VectorXd& start, double period,
                               VectorXd& value, VectorXd& slope) const {
  value = scheme_.value(j, 0) * start;
  slope = scheme_.slope(j, 0) * start;
  for (Index l = 1; l <= scheme_.degree; ++l) {
    const Map<const VectorXd> node(own + (l - 1) * n_, n_);
    value += scheme_.value(j, l) * node;
    slope += scheme_.slope(j, l) * node;
  }
  slope /= length(mesh_, first_ + i) * period;
}

void CycleProblem::interval_residual(Index i, const double* own, const VectorXd& start, double period, double* out) {
  VectorXd value(n_), slope(n_);
  for (Index j = 0; j < scheme_.degree; ++j) {
    interpolate(i, j, own, start, period, value, slope);
    point_.residual(angle_at(i, scheme_.c(j)), value, slope, Map<VectorXd>(out + j * n_, n_));
  }
}

std::unique_ptr<Interval> CycleProblem::linearise_interval(Index i, const double* own, const VectorXd& start,
                                                           double period, MatrixXd& columns) {
  const Index m = scheme_.degree;
  const double h = length(mesh_, first_ + i);
  columns.resize(m * n_, borders_);
  std::vector<MatrixXd> tangents(static_cast<std::size_t>(m)), jx, jxdot;
  if (!structure_) {
    jx.resize(static_cast<std::size_t>(m));
    jxdot.resize(static_cast<std::size_t>(m));
  }
  VectorXd value(n_), slope(n_), load(n_), d_load(n_), forces, d_forces, rate(n_);
  for (Index j = 0; j < m; ++j) {
    const auto jj = static_cast<std::size_t>(j);
    interpolate(i, j, own, start, period, value, slope);
    const double angle = angle_at(i, scheme_.c(j));
    VectorXd d_parameter;
    if (structure_) {
      structure_->load(angle, load, &d_load);
      structure_->forces(point_.c() * value, forces, &tangents[jj], &d_forces);
      d_parameter = dl0_ * value - d_load.cwiseQuotient(point_.residual_scale()) - point_.b() * d_forces;
      rate.noalias() = point_.l1() * slope;
    } else {
      point_.linearise(angle, value, slope, jx[jj], jxdot[jj], &d_parameter);
      rate.noalias() = jxdot[jj] * slope;
    }
    // On a forced cycle T = 2 pi k/Omega, so that the rate x'/T grows with the speed at fixed x(s).
    if (!options_.autonomous && system_.parameter_is_speed()) d_parameter += rate / system_.speed();
    columns.block(j * n_, borders_ - 1, n_, 1) = d_parameter * options_.parameter_scale;
    if (options_.autonomous) columns.block(j * n_, 0, n_, 1) = -rate / period * period_scale_;
  }
  if (!structure_) return make_dense_interval(scheme_, h * period, std::move(jx), std::move(jxdot));
  const double rounded = std::round(h * 1e12) / 1e12;
  auto& part = parts_[rounded];
  if (!part) part = std::make_shared<LinearPart>(scheme_, h * period, point_.l1(), l0_, point_.b(), point_.c());
  return make_low_rank_interval(part, std::move(tangents));
}

void CycleProblem::linearise(Vec u, Vec row) {
  const VectorXd border = border_of(u);
  const core::ReadArray ua(u), wa(row);
  const VectorXd before = previous_end(ua.data());
  const Index m = scheme_.degree;
  const auto count = static_cast<std::size_t>(count_);
  intervals_.clear();
  intervals_.resize(count);
  parts_.clear();
  columns_.resize(count);
  core::agree(comm_, [&] {
    set_parameter(border);
    const double period = period_of(border);
    if (!(period > 0)) throw core::DomainError("the period is not positive");
    point_.refresh();
    if (structure_) {
      l0_ = point_.scaled(structure_->l0());
      dl0_ = point_.scaled(structure_->dl0());
    }
    for (Index i = 0; i < count_; ++i) {
      const double* own = ua.data() + i * m * n_;
      const VectorXd start = i == 0 ? before : VectorXd(Map<const VectorXd>(own - n_, n_));
      intervals_[static_cast<std::size_t>(i)] =
          linearise_interval(i, own, start, period, columns_[static_cast<std::size_t>(i)]);
    }
  });

  rows_.assign(count, MatrixXd::Zero(borders_, m * n_));
  for (Index i = 0; i < count_; ++i) {
    auto& rows = rows_[static_cast<std::size_t>(i)];
    rows.row(borders_ - 1) = Map<const VectorXd>(wa.data() + i * m * n_, m * n_).transpose();
    if (options_.autonomous) rows.row(0) = Map<const VectorXd>(phase_row_.data() + i * m * n_, m * n_).transpose();
  }
  corner_ = MatrixXd::Zero(borders_, borders_);
  corner_.row(borders_ - 1) = border_of(row).transpose();
  compose(rows_);
  if (options_.assembled) assemble(rows_);
}

// Runs the condensed recurrence over this rank's intervals, gathers the ranks' maps and factorises the small system
//     [ I - Phi   -Theta     ] [ x_0 ]   [ t       ]      x_(end) = Phi x_0 + Theta d + t after one turn
//     [ K         D + corner ] [ d   ] = [ r_c - s ]      added rows = K x_0 + D d + s
void CycleProblem::compose(const std::vector<MatrixXd>& rows) {
  const Index all = n_ + borders_;
  MatrixXd map = MatrixXd::Zero(all, all), state = MatrixXd::Identity(n_, all);
  eliminated_.resize(intervals_.size());
  for (std::size_t i = 0; i < intervals_.size(); ++i) {
    const Interval& interval = *intervals_[i];
    MatrixXd adjoint = rows[i].transpose();
    interval.solve_transposed(adjoint);
    map.bottomRows(borders_).noalias() -= interval.start_transposed(adjoint).transpose() * state;
    map.bottomRightCorner(borders_, borders_).noalias() -= adjoint.transpose() * columns_[i];
    eliminated_[i] = columns_[i];
    interval.solve(eliminated_[i]);
    if (i == 0)
      state.leftCols(n_) = interval.transition();  // of the identity
    else
      state = (interval.transition() * state).eval();
    state.rightCols(borders_) -= eliminated_[i].bottomRows(n_);
  }
  map.topRows(n_) = state;

  rank_maps_.assign(static_cast<std::size_t>(size_), MatrixXd(all, all));
  std::vector<double> gathered(static_cast<std::size_t>(all * all * size_));
  MPI_Allgather(map.data(), static_cast<int>(all * all), MPI_DOUBLE, gathered.data(), static_cast<int>(all * all),
                MPI_DOUBLE, comm_);
  MatrixXd entering = MatrixXd::Identity(n_, all), added = MatrixXd::Zero(borders_, all);
  to_rank_.clear();
  for (int p = 0; p < size_; ++p) {
    auto& q = rank_maps_[static_cast<std::size_t>(p)];
    q = Map<const MatrixXd>(gathered.data() + static_cast<Index>(p) * all * all, all, all);
    to_rank_.push_back(entering);
    if (p == 0) {  // entering is the identity
      added = q.bottomRows(borders_);
      entering = q.topRows(n_);
      continue;
    }
    added += q.bottomLeftCorner(borders_, n_) * entering;
    added.rightCols(borders_) += q.bottomRightCorner(borders_, borders_);
    MatrixXd next = q.topLeftCorner(n_, n_) * entering;
    next.rightCols(borders_) += q.topRightCorner(n_, borders_);
    entering = std::move(next);
  }
  monodromy_ = entering.leftCols(n_);
  MatrixXd small(all, all);
  small.topRows(n_) = MatrixXd::Identity(n_, all) - entering;
  small.bottomRows(borders_) = added;
  small.bottomRightCorner(borders_, borders_) += corner_;
  small_.compute(small);
}

void CycleProblem::multiply(Vec v, Vec y) {
  const VectorXd border = border_of(v);
  const core::ReadArray va(v);
  const VectorXd before = previous_end(va.data());
  const Index m = scheme_.degree;
  core::WriteArray ya(y);
  VectorXd added = VectorXd::Zero(borders_);
  for (Index i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double* own = va.data() + i * m * n_;
    const VectorXd x = Map<const VectorXd>(own, m * n_),
                   start = i == 0 ? before : VectorXd(Map<const VectorXd>(own - n_, n_));
    Map<VectorXd>(ya.data() + i * m * n_, m * n_) = intervals_[k]->multiply(start, x) + columns_[k] * border;
    added += rows_[k] * x;
  }
  MPI_Allreduce(MPI_IN_PLACE, added.data(), static_cast<int>(borders_), MPI_DOUBLE, MPI_SUM, comm_);
  added += corner_ * border;
  if (rank_ == size_ - 1)
    for (Index k = 0; k < borders_; ++k) ya[static_cast<PetscInt>(ya.size() - borders_ + k)] = added(k);
}

void CycleProblem::solve(Vec rhs, Vec x) {
  if (options_.assembled) {
    check(KSPSolve(assembled_solver_.get(), rhs, x));
    return;
  }
  const Index m = scheme_.degree, all = n_ + borders_;
  const VectorXd r_border = border_of(rhs);
  const core::ReadArray ra(rhs);
  core::WriteArray xa(x);

  // Forward: response of this rank's run to the right-hand side alone.
  VectorXd own = VectorXd::Zero(all), t = VectorXd::Zero(n_);
  MatrixXd z;
  for (Index i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    z = Map<const VectorXd>(ra.data() + i * m * n_, m * n_) - intervals_[k]->start(t);
    intervals_[k]->solve(z);
    own.tail(borders_) += rows_[k] * z.col(0);
    t = z.col(0).tail(n_);
  }
  own.head(n_) = t;
  VectorXd gathered(all * size_);
  MPI_Allgather(own.data(), static_cast<int>(all), MPI_DOUBLE, gathered.data(), static_cast<int>(all), MPI_DOUBLE,
                comm_);
  VectorXd through = VectorXd::Zero(n_), entering = VectorXd::Zero(n_), added = VectorXd::Zero(borders_);
  for (int p = 0; p < size_; ++p) {
    const auto& q = rank_maps_[static_cast<std::size_t>(p)];
    const auto part = gathered.segment(static_cast<Index>(p) * all, all);
    if (p == rank_) entering = through;
    added += part.tail(borders_) + q.bottomLeftCorner(borders_, n_) * through;
    through = (part.head(n_) + q.topLeftCorner(n_, n_) * through).eval();
  }
  VectorXd small(all);
  small << through, r_border - added;
  small = small_.solve(small).eval();
  VectorXd state = to_rank_[static_cast<std::size_t>(rank_)] * small + entering;
  const VectorXd border = small.tail(borders_);

  // Back: with the state entering this rank and the border known, each interval follows from its left neighbour.
  for (Index i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    z = Map<const VectorXd>(ra.data() + i * m * n_, m * n_) - intervals_[k]->start(state) - columns_[k] * border;
    intervals_[k]->solve(z);
    Map<VectorXd>(xa.data() + i * m * n_, m * n_) = z.col(0);
    state = z.col(0).tail(n_);
  }
  if (rank_ == size_ - 1)
    for (Index k = 0; k < borders_; ++k) xa[static_cast<PetscInt>(xa.size() - borders_ + k)] = border(k);
}

MatrixXd CycleProblem::propagate(const VectorXd& v) const {
  const Index m = scheme_.degree, total = static_cast<Index>(mesh_.size()) - 1;
  MatrixXd whole = MatrixXd::Zero(n_, total * m);
  VectorXd state = to_rank_[static_cast<std::size_t>(rank_)].leftCols(n_) * v;
  for (Index i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    MatrixXd z = -intervals_[k]->start(state);
    intervals_[k]->solve(z);
    whole.middleCols((first_ + i) * m, m) = Map<const MatrixXd>(z.data(), n_, m);
    state = z.col(0).tail(n_);
  }
  MPI_Allreduce(MPI_IN_PLACE, whole.data(), static_cast<int>(whole.size()), MPI_DOUBLE, MPI_SUM, comm_);
  return whole;
}

std::vector<std::complex<double>> CycleProblem::multipliers() {
  return spectral::eigenvalues(monodromy_);
}

// v of (M - mu I) v = 0 by inverse iteration, carried over the period.
MatrixXd CycleProblem::critical_motion(double mu) {
  const Eigen::PartialPivLU<MatrixXd> lu(monodromy_ - mu * (1 + 1e-10) * MatrixXd::Identity(n_, n_));
  VectorXd v(n_);
  for (Index k = 0; k < n_; ++k) v(k) = std::sin(1.0 + static_cast<double>(k));
  for (int k = 0; k < 4; ++k) v = lu.solve(v).normalized();
  return state_scale().asDiagonal() * propagate(v);
}

// The same matrix entry by entry, for MUMPS: the check on everything above.
void CycleProblem::assemble(const std::vector<MatrixXd>& rows) {
  const Index m = scheme_.degree, total = static_cast<Index>(mesh_.size()) - 1;
  const Index local = count_ * m * n_ + (rank_ == size_ - 1 ? borders_ : 0), unknowns = total * m * n_;
  check(MatCreate(comm_, assembled_.put()));
  check(MatSetSizes(assembled_.get(), static_cast<PetscInt>(local), static_cast<PetscInt>(local), PETSC_DETERMINE,
                    PETSC_DETERMINE));
  check(MatSetType(assembled_.get(), MATAIJ));
  std::vector<PetscInt> diagonal(static_cast<std::size_t>(local),
                                 static_cast<PetscInt>(std::min(local, (m + 1) * n_ + borders_)));
  std::vector<PetscInt> off(static_cast<std::size_t>(local), static_cast<PetscInt>(n_ + borders_));
  if (rank_ == size_ - 1)
    for (Index k = 0; k < borders_; ++k) {
      diagonal[static_cast<std::size_t>(local - borders_ + k)] = static_cast<PetscInt>(local);
      off[static_cast<std::size_t>(local - borders_ + k)] = static_cast<PetscInt>(unknowns + borders_ - local);
    }
  check(MatSeqAIJSetPreallocation(assembled_.get(), 0, diagonal.data()));
  check(MatMPIAIJSetPreallocation(assembled_.get(), 0, diagonal.data(), 0, off.data()));
  const auto add = [&](Index row, Index column, const MatrixXd& block) {
    for (Index a = 0; a < block.rows(); ++a)
      for (Index b = 0; b < block.cols(); ++b)
        if (block(a, b) != 0)
          check(MatSetValue(assembled_.get(), static_cast<PetscInt>(row + a), static_cast<PetscInt>(column + b),
                            block(a, b), ADD_VALUES));
  };
  for (Index i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Index base = (first_ + i) * m * n_, before = first_ + i == 0 ? unknowns - n_ : base - n_;
    for (int j = 0; j < m; ++j) {
      add(base + j * n_, before, intervals_[k]->block(j, 0));
      for (int l = 1; l <= m; ++l) add(base + j * n_, base + (l - 1) * n_, intervals_[k]->block(j, l));
    }
    add(base, unknowns, columns_[k]);
    add(unknowns, base, rows[k]);
  }
  if (rank_ == size_ - 1) {
    add(unknowns, unknowns, corner_);
    for (Index k = 0; k < borders_; ++k)
      check(MatSetValue(assembled_.get(), static_cast<PetscInt>(unknowns + k), static_cast<PetscInt>(unknowns + k), 0.0,
                        ADD_VALUES));
  }
  check(MatAssemblyBegin(assembled_.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(assembled_.get(), MAT_FINAL_ASSEMBLY));
  check(KSPCreate(comm_, assembled_solver_.put()));
  check(KSPSetOptionsPrefix(assembled_solver_.get(), "assembled_"));
  check(KSPSetOperators(assembled_solver_.get(), assembled_.get(), assembled_.get()));
  check(KSPSetType(assembled_solver_.get(), KSPPREONLY));
  PC pc = nullptr;
  check(KSPGetPC(assembled_solver_.get(), &pc));
  check(PCSetType(pc, PCLU));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  check(KSPSetFromOptions(assembled_solver_.get()));
}

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
    cycle.period = two_pi * options_.turns / (system_.parameter_is_speed() ? cycle.parameter : system_.speed());
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
  const VectorXd w = lagrange_slope(scheme_, scheme_.node(l)) / length(mesh_, g);
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
  for (Index i = 0; i < count_; ++i) {
    const Index g = first_ + i;
    const double h = length(mesh_, g);
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
  MPI_Allreduce(MPI_IN_PLACE, values, 2, MPI_DOUBLE, MPI_SUM, comm_);
  const double norm = std::sqrt(values[0]);
  core::require(norm > 0, "the phase reference does not move");
  phase_row_ /= norm;
  phase_offset_ = values[1] / norm;
}

bool CycleProblem::adapt(core::Vector& u, core::Vector& tangent) {
  if (options_.mesh_tolerance <= 0) return false;
  const Cycle cycle = gather(u.get()), direction = gather(tangent.get());
  double longest = 0;
  for (Index i = 0; i < cycle.intervals(); ++i) longest = std::max(longest, length(mesh_, i));
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
