#include "whirl/solve/cycle/spread_collocation.hpp"

#include <algorithm>
#include <cmath>

#include "solve/cycle/spread_interval.hpp"
#include "solve/newton/local_part.hpp"
#include "solve/newton/port_maker.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/index.hpp"
#include "whirl/problem/spread_point.hpp"

namespace whirl::solve {

using core::at;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Relative residuals of intervals: of products that only precondition, and of those that multipliers are made of.
constexpr double rough_tolerance = 1e-5, full_tolerance = 1e-11;

// Films settle by whole steps, each of which may find another set of full nodes, to `settled` of their scale.
constexpr double settling_tolerance = 1e-6, settled = 1e-10;
constexpr int settling_steps = 40, settling_laps = 60;

}  // namespace

struct SpreadCollocation::Tools {
  Tools(problem::System& system, const Scheme& scheme)
      : point(system), maker(PortMaker::make(system)), step(system.comm(), system.local_size(), scheme) {
    core::require(maker != nullptr, "a machine with parts");
    each_point = system.settles();
  }
  problem::SpreadPoint point;
  std::unique_ptr<PortMaker> maker;
  SpreadStep step;
  core::Matrix matrix;
  bool each_point = false;  // derivatives jump within an interval
};

SpreadCollocation::SpreadCollocation(problem::System& system, const SpreadCollocationOptions& options,
                                     std::vector<double> mesh)
    : SpreadCollocation(system, options, std::move(mesh), TimeGroups(system.comm())) {}

SpreadCollocation::SpreadCollocation(problem::System& system, const SpreadCollocationOptions& options,
                                     std::vector<double> mesh, const TimeGroups& groups)
    : SpreadCycle(system, options, make_scheme(options.degree, Points::radau), std::move(mesh), true, groups),
      options_(options),
      tools_(std::make_unique<Tools>(system, scheme())) {
  for (core::Vector* v : {&value_, &rate_, &f_}) *v = core::duplicate(work());
}

SpreadCollocation::~SpreadCollocation() = default;

std::vector<problem::Field> SpreadCollocation::fields() const {
  return {{"orbit", 0, static_cast<PetscInt>(intervals() * scheme().degree * local())}};
}

void SpreadCollocation::refresh() {}

void SpreadCollocation::forget_mesh() {
  intervals_.clear();
}

void SpreadCollocation::interpolate(const MatrixXd& x, Index i, Index j, double period) {
  const Index m = scheme().degree;
  put(x.col(i * m + 1 + j), value_.get());
  const VectorXd rate = x.middleCols(i * m, m + 1) * scheme().slope.row(j).transpose();
  put(rate / (length(i) * period), rate_.get());
}

void SpreadCollocation::residual_of(const MatrixXd& x, Index i, double period, double* r) {
  for (Index j = 0; j < scheme().degree; ++j) {
    interpolate(x, i, j, period);
    tools_->point.residual(angle(begin(i) + length(i) * scheme().c(j)), value_.get(), rate_.get(), f_.get());
    Map<VectorXd>(r + j * local(), local()) = get(f_.get());
  }
}

void SpreadCollocation::residuals(const MatrixXd& x, double period, MatrixXd& r) {
  r.resize(scheme().degree * local(), intervals());
  for (Index i = 0; i < intervals(); ++i) residual_of(x, i, period, r.col(i).data());
}

std::unique_ptr<SpreadInterval> SpreadCollocation::interval_at(const MatrixXd& x, Index i, double period,
                                                               std::shared_ptr<const PortMatrix>& rate,
                                                               std::vector<std::shared_ptr<PortElimination>>& similar,
                                                               MatrixXd* columns) {
  const Index m = scheme().degree;
  const bool by_speed = !options().autonomous && system().parameter_is_speed();
  problem::SpreadPoint& point = tools_->point;
  PortMaker& maker = *tools_->maker;
  const double h = length(i) * period;
  const bool eliminate = similar.empty(), each = eliminate ? tools_->each_point : similar.size() > 1;
  std::vector<std::shared_ptr<const PortMatrix>> blocks(at(m)), rates(at(m));
  VectorXd by_rate(local());
  for (Index j = 0; j < m; ++j) {
    const double here = angle(begin(i) + length(i) * scheme().c(j)), own = h * tools_->step.own(j, each);
    interpolate(x, i, j, period);
    if (!rate || !options().constant_rates) {
      point.jacobian(here, value_.get(), rate_.get(), 0, 1, tools_->matrix);
      rate = maker.blocks(tools_->matrix.get());
    }
    rates[at(j)] = rate;
    point.jacobian(here, value_.get(), rate_.get(), own, 1, tools_->matrix);
    blocks[at(j)] = maker.blocks(tools_->matrix.get());
    if (eliminate && (each || j == 0))
      similar.push_back(maker.eliminate(*blocks[at(j)], here, point.x(), point.xdot(), own, columns == nullptr));
    if (!columns) continue;
    point.parameter_derivative(here, value_.get(), rate_.get(), f_.get());
    {
      const core::ReadArray k(rate_.get());
      rate->multiply(k.data(), by_rate.data());
    }
    auto own_columns = columns->middleRows(j * local(), local());
    VectorXd by_parameter = get(f_.get());
    // On a forced cycle T = 2 pi k/Omega, so that the rate x'/T grows with the speed at fixed x(s).
    if (by_speed) by_parameter += by_rate / system().speed();
    own_columns.rightCols(1) = options().parameter_scale * by_parameter;
    if (options().autonomous) own_columns.col(0) = -by_rate / period * period_scale();
  }
  return std::make_unique<SpreadInterval>(tools_->step, h, std::move(blocks), std::move(rates), similar);
}

void SpreadCollocation::linearise_intervals(const MatrixXd& x, double period) {
  intervals_.clear();
  columns_.assign(at(intervals()), MatrixXd(scheme().degree * local(), borders()));
  constant_.reset();
  std::vector<std::unique_ptr<SpreadInterval>> made;
  std::shared_ptr<const PortMatrix> rate;
  for (Index i = 0; i < intervals(); ++i) {
    std::vector<std::shared_ptr<PortElimination>> own;
    made.push_back(interval_at(x, i, period, rate, own, &columns_[at(i)]));
  }
  intervals_ = std::move(made);
  constant_ = options().constant_rates ? rate : nullptr;
  constant_at_ = system().parameter();
}

double SpreadCollocation::settle_interval(MatrixXd& x, Index i, double period) {
  const Index m = scheme().degree;
  const VectorXd end = x.col((i + 1) * m);
  // Smooth films: factors of the last linearisation precondition here as well; without any, those of the first step do.
  std::vector<std::shared_ptr<PortElimination>> similar;
  if (!tools_->each_point && !intervals_.empty()) similar = intervals_[at(i)]->similar();
  MatrixXd step(m * local(), 1);
  const auto largest_of = [&](const auto& v) {
    double size = v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0;
    MPI_Allreduce(MPI_IN_PLACE, &size, 1, MPI_DOUBLE, MPI_MAX, system().comm());
    return size;
  };
  for (int k = 0; k < settling_steps; ++k) {
    if (tools_->each_point) similar.clear();
    residual_of(x, i, period, step.data());
    const auto interval = interval_at(x, i, period, constant_, similar, nullptr);
    SpreadStep::hold(*tools_->maker->layout(), step.data(), m);  // known once there is a matrix
    interval->solve(step, settling_tolerance, true);
    x.middleCols(i * m + 1, m) -= Map<const MatrixXd>(step.data(), local(), m);
    if (largest_of(step) <= settled) return largest_of(x.col((i + 1) * m) - end);
  }
  throw core::NotConverged("the films did not settle within an interval");
}

bool SpreadCollocation::settle(Vec u) {
  MatrixXd x = nodes(u);
  try {
    const double period = begin_point(border_of(u));
    if (constant_at_ != system().parameter()) constant_.reset();
    // What leaves the group before, with how far it has moved in this lap below it on each rank.
    MatrixXd entering(local() + 1, 1);
    entering.topRows(local()) = x.col(0);
    entering(local(), 0) = 1;
    double& moved = entering(local(), 0);
    for (int lap = 0; lap < settling_laps && moved > settled; ++lap)
      groups().in_turn(entering, [&] {
        x.col(0) = entering.topRows(local());
        for (Index i = 0; i < intervals() && (lap == 0 || moved > settled); ++i)
          moved = settle_interval(x, i, period);  // if it stays, all behind it stays
        entering.topRows(local()) = x.rightCols(1);
      });
    if (!(moved <= settled)) return false;
  } catch (const core::DomainError&) {
    return false;
  } catch (const core::NotConverged&) {
    return false;
  }
  const core::WriteArray ua(u);
  Map<MatrixXd>(ua.data(), local(), x.cols() - 1) = x.rightCols(x.cols() - 1);
  return true;
}

VectorXd SpreadCollocation::product(Index i, const VectorXd& start, const VectorXd& x) const {
  VectorXd y(x.size());
  intervals_[at(i)]->multiply(start.data(), x.data(), y.data());
  return y;
}

std::vector<MatrixXd> SpreadCollocation::tangents_at(const MatrixXd& x, double period, const std::vector<MatrixXd>& b) {
  const Index m = scheme().degree;
  std::vector<MatrixXd> out(b.size(), MatrixXd(m * local(), intervals()));
  const core::Vector value = core::duplicate(work()), rate = core::duplicate(work());
  for (Index i = 0; i < intervals(); ++i)
    for (Index j = 0; j < m; ++j) {
      const double here = angle(begin(i) + length(i) * scheme().c(j));
      interpolate(x, i, j, period);
      core::check(VecCopy(value_.get(), value.get()));
      core::check(VecCopy(rate_.get(), rate.get()));
      for (const bool by_rate : {false, true}) {
        tools_->point.jacobian(here, value.get(), rate.get(), by_rate ? 0 : 1, by_rate ? 1 : 0, tools_->matrix);
        for (std::size_t k = 0; k < b.size(); ++k) {
          interpolate(b[k], i, j, period);
          core::check(MatMult(tools_->matrix.get(), by_rate ? rate_.get() : value_.get(), f_.get()));
          auto part = out[k].col(i).segment(j * local(), local());
          part = by_rate ? VectorXd(part + get(f_.get())) : get(f_.get());
        }
      }
    }
  return out;
}

MatrixXd SpreadCollocation::advance(Index i, const MatrixXd& start, const MatrixXd* rhs, bool rest) const {
  const SpreadInterval& interval = *intervals_[at(i)];
  const Index m = scheme().degree;
  MatrixXd x = MatrixXd::Zero(m * local(), start.cols());
  if (!rest) {
    const VectorXd zero = VectorXd::Zero(m * local());
    VectorXd y(m * local());
    for (Index k = 0; k < start.cols(); ++k) {
      interval.multiply(start.col(k).data(), zero.data(), y.data());
      x.col(k) = -y;
    }
  }
  if (rhs) x += *rhs;
  interval.solve(x, rough() ? rough_tolerance : full_tolerance);
  return x;
}

VectorXd SpreadCollocation::reference_rate(const MatrixXd& x, double /*period*/, Index i, Index l) {
  const Index m = scheme().degree;
  const VectorXd w = lagrange_slope(scheme(), scheme().node(l)) / length(i);
  return x.middleCols(i * m, m + 1) * w;
}

bool SpreadCollocation::adapt(core::Vector& u, core::Vector& tangent) {
  return adapt_to(options_.mesh_tolerance, options_.base_intervals, options_.max_intervals, u, tangent);
}

}  // namespace whirl::solve
