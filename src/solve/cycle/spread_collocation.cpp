#include "whirl/solve/cycle/spread_collocation.hpp"

#include <algorithm>
#include <cmath>

#include "solve/cycle/spread_interval.hpp"
#include "solve/newton/local_part.hpp"
#include "solve/newton/port_maker.hpp"
#include "solve/newton/spread_point.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/index.hpp"

namespace whirl::solve {

using core::at;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Relative residuals of intervals: of products that only precondition, and of those that multipliers are made of.
constexpr double rough_tolerance = 1e-5, full_tolerance = 1e-11;

}  // namespace

struct SpreadCollocation::Tools {
  Tools(problem::System& system, const Scheme& scheme)
      : point(system), maker(PortMaker::make(system)), step(system.comm(), system.local_size(), scheme) {
    core::require(maker != nullptr, "a machine whose parts elimination keeps apart");
  }
  SpreadPoint point;
  std::unique_ptr<PortMaker> maker;
  SpreadStep step;
  core::Matrix matrix;
};

SpreadCollocation::SpreadCollocation(problem::System& system, const SpreadCollocationOptions& options,
                                     std::vector<double> mesh)
    : SpreadCycle(system, options, make_scheme(options.degree, Points::radau), std::move(mesh), true),
      options_(options),
      tools_(std::make_unique<Tools>(system, scheme())) {
  for (core::Vector* v : {&value_, &rate_, &f_}) *v = core::duplicate(work());
}

SpreadCollocation::~SpreadCollocation() = default;

bool SpreadCollocation::serves(const problem::System& system) {
  return PortElimination::serves(system.fields());
}

std::vector<problem::Field> SpreadCollocation::fields() const {
  return {{"orbit", 0, static_cast<PetscInt>(intervals() * scheme().degree * local())}};
}

void SpreadCollocation::refresh() {}

void SpreadCollocation::interpolate(const Map<const MatrixXd>& x, Index i, Index j, double period) {
  const Index m = scheme().degree;
  VectorXd rate = x.middleCols(i * m, m) * scheme().slope.row(j).tail(m).transpose();
  rate += scheme().slope(j, 0) * x.col(before(i));
  put(x.col(i * m + j), value_.get());
  put(rate / (length(i) * period), rate_.get());
}

void SpreadCollocation::residuals(Vec u, double period, MatrixXd& r) {
  const core::ReadArray ua(u);
  const auto x = nodes(ua);
  const Index m = scheme().degree;
  r.resize(m * local(), intervals());
  for (Index i = 0; i < intervals(); ++i)
    for (Index j = 0; j < m; ++j) {
      interpolate(x, i, j, period);
      tools_->point.residual(angle(mesh()[at(i)] + length(i) * scheme().c(j)), value_.get(), rate_.get(), f_.get());
      r.col(i).segment(j * local(), local()) = get(f_.get());
    }
}

// Neighbours of one length share an elimination, in runs that leave as many as may be held.
bool SpreadCollocation::shares(Index i, Index first) const {
  if (options_.eliminations <= 0) return false;
  const Index run = (intervals() + options_.eliminations - 1) / options_.eliminations;
  return i - first < run && std::abs(length(i) - length(first)) < 1e-9 * length(i);
}

void SpreadCollocation::linearise_intervals(Vec u, double period) {
  const core::ReadArray ua(u);
  const auto x = nodes(ua);
  const Index m = scheme().degree;
  const bool by_speed = !options().autonomous && system().parameter_is_speed();
  SpreadPoint& point = tools_->point;
  PortMaker& maker = *tools_->maker;
  intervals_.clear();
  intervals_.resize(at(intervals()));
  columns_.assign(at(intervals()), MatrixXd(m * local(), borders()));
  std::shared_ptr<PortElimination> similar;
  std::shared_ptr<const PortMatrix> rate;
  Index first = 0;  // whose elimination it is
  VectorXd by_rate(local());
  for (Index i = 0; i < intervals(); ++i) {
    const double h = length(i) * period, own = h / tools_->step.shift();
    if (i > 0 && !shares(i, first)) {
      similar.reset();
      first = i;
    }
    std::vector<std::shared_ptr<const PortMatrix>> blocks(at(m)), rates(at(m));
    for (Index j = 0; j < m; ++j) {
      const double here = angle(mesh()[at(i)] + length(i) * scheme().c(j));
      interpolate(x, i, j, period);
      if (!rate || !options().constant_rates) {
        point.jacobian(here, value_.get(), rate_.get(), 0, 1, tools_->matrix);
        rate = maker.blocks(tools_->matrix.get());
      }
      rates[at(j)] = rate;
      point.jacobian(here, value_.get(), rate_.get(), own, 1, tools_->matrix);
      blocks[at(j)] = maker.blocks(tools_->matrix.get());
      if (!similar) similar = maker.eliminate(tools_->matrix.get(), *blocks[at(j)], here, point.x(), point.xdot(), own);
      point.parameter_derivative(here, value_.get(), rate_.get(), f_.get());
      {
        const core::ReadArray k(rate_.get());
        rate->multiply(k.data(), by_rate.data());
      }
      auto own_columns = columns_[at(i)].middleRows(j * local(), local());
      VectorXd by_parameter = get(f_.get());
      // On a forced cycle T = 2 pi k/Omega, so that the rate x'/T grows with the speed at fixed x(s).
      if (by_speed) by_parameter += by_rate / system().speed();
      own_columns.rightCols(1) = options().parameter_scale * by_parameter;
      if (options().autonomous) own_columns.col(0) = -by_rate / period * period_scale();
    }
    intervals_[at(i)] = std::make_unique<SpreadInterval>(tools_->step, h, std::move(blocks), std::move(rates), similar);
  }
}

VectorXd SpreadCollocation::product(Index i, const VectorXd& start, const VectorXd& x) const {
  VectorXd y(x.size());
  intervals_[at(i)]->multiply(start.data(), x.data(), y.data());
  return y;
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
  return w(0) * x.col(before(i)) + x.middleCols(i * m, m) * w.tail(m);
}

bool SpreadCollocation::adapt(core::Vector& u, core::Vector& tangent) {
  if (options_.mesh_tolerance <= 0) return false;
  const Cycle cycle = gather(u.get()), direction = gather(tangent.get());
  double longest = 0;
  for (Index i = 0; i < intervals(); ++i) longest = std::max(longest, length(i));
  const int base = options_.base_intervals > 0 ? options_.base_intervals : static_cast<int>(std::lround(1 / longest));
  std::vector<double> better =
      adapted_mesh(scheme(), cycle, state_scale(), options_.mesh_tolerance, base, options_.max_intervals);
  if (better == mesh()) return false;
  intervals_.clear();
  set_mesh(std::move(better));
  u = scatter(cycle);
  tangent = scatter(direction);
  if (options().autonomous) set_phase_reference(cycle);
  return true;
}

}  // namespace whirl::solve
