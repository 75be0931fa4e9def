#include "whirl/solve/shooting/newton_picard.hpp"

#include "whirl/core/index.hpp"

namespace whirl::solve {

using core::at;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

NewtonPicardProblem::NewtonPicardProblem(problem::System& system, const NewtonPicardOptions& options, Tableau tableau,
                                         int steps, std::vector<double> mesh)
    : SpreadCycle(system, options, make_scheme(1, Points::radau), std::move(mesh), false, TimeGroups(system.comm())),
      steps_(steps),
      stepper_(choose_stages(system, tableau, options.constant_rates, nullptr), tableau,
               options.autonomous || system.parameter_is_speed()) {
  core::require(tableau.sequential(), "steps distributed in space need a scheme with sequential stages");
  core::require(steps > 0, "shooting needs at least one step per interval");
}

// Carries x over interval i; with `links`, keeps the products of its steps and fills -d phi/d(border).
void NewtonPicardProblem::march(Index i, double period, VectorXd& x, Links* links) {
  const double begin = mesh()[at(i)], h = length(i) / steps_;
  if (!links) {
    for (int k = 0; k < steps_; ++k) stepper_.step(angle(begin + k * h), angle(h), h * period, x, nullptr);
    return;
  }
  MatrixXd& columns = links->columns[at(i)];
  columns.setZero(local(), borders());
  auto& steps = links->steps[at(i)];
  steps.resize(static_cast<std::size_t>(steps_));
  const bool by_speed = !options().autonomous && system().parameter_is_speed();
  for (int k = 0; k < steps_; ++k) {
    StepDerivative& step = steps[at(k)];
    stepper_.step(angle(begin + k * h), angle(h), h * period, x, &step);
    if (k > 0) step.carry(columns);
    columns.col(borders() - 1) -= options().parameter_scale * step.d_parameter();
    if (by_speed)
      columns.col(borders() - 1) += options().parameter_scale * h * period / system().speed() * step.d_length();
    if (options().autonomous) columns.col(0) -= h * period_scale() * step.d_length();
  }
}

// The ends of all intervals from the states of u, with what linearise() wants of them if `links` is not null.
void NewtonPicardProblem::march_all(const MatrixXd& x, double period, MatrixXd& ends, Links* links) {
  if (links) {
    links->x.resize(0, 0);
    links->steps.resize(at(intervals()));
    links->columns.resize(at(intervals()));
  }
  ends.resize(local(), intervals());
  for (Index i = 0; i < intervals(); ++i) {
    VectorXd end = x.col(i);
    march(i, period, end, links);
    ends.col(i) = end;
  }
  if (links) {
    links->x = x;
    links->period = period;
    links->parameter = system().parameter();
  }
}

void NewtonPicardProblem::residuals(const MatrixXd& x, double period, MatrixXd& r) {
  march_all(x, period, r, structured() ? &next_ : nullptr);
  r = x.rightCols(intervals()) - r;
}

void NewtonPicardProblem::linearise_intervals(const MatrixXd& x, double period) {
  // The residual at x may have left its links behind; they are exchanged, because those of this linearisation are
  // wanted until the next one.
  int known = structured() && next_.x.cols() == x.cols() && next_.period == period &&
              next_.parameter == system().parameter() && next_.x == x;
  MPI_Allreduce(MPI_IN_PLACE, &known, 1, MPI_INT, MPI_LAND, comm());
  if (known != 0) {
    std::swap(links_, next_);
    next_.x.resize(0, 0);
  } else {
    MatrixXd ends;
    march_all(x, period, ends, &links_);
  }
}

const MatrixXd& NewtonPicardProblem::columns(Index i) const {
  return links_.columns[at(i)];
}

std::vector<MatrixXd> NewtonPicardProblem::tangents_at(const MatrixXd& x, double period,
                                                       const std::vector<MatrixXd>& b) {
  MatrixXd ends, moved(local(), static_cast<Index>(b.size()));
  march_all(x, period, ends, &next_);
  std::vector<MatrixXd> out(b.size(), MatrixXd(local(), intervals()));
  for (Index i = 0; i < intervals(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) moved.col(static_cast<Index>(k)) = b[k].col(i);
    for (const StepDerivative& step : next_.steps[at(i)]) step.carry(moved);
    for (std::size_t k = 0; k < b.size(); ++k) out[k].col(i) = b[k].col(i + 1) - moved.col(static_cast<Index>(k));
  }
  return out;
}

MatrixXd NewtonPicardProblem::advance(Index i, const MatrixXd& start, const MatrixXd* rhs, bool rest) const {
  if (rest) return rhs ? *rhs : start;
  MatrixXd x = start;
  for (const StepDerivative& step : links_.steps[at(i)]) step.carry(x);
  if (rhs) x += *rhs;
  return x;
}

VectorXd NewtonPicardProblem::product(Index i, const VectorXd& start, const VectorXd& x) const {
  return x - advance(i, start, nullptr, false).col(0);
}

VectorXd NewtonPicardProblem::reference_rate(const MatrixXd& x, double /*period*/, Index i, Index /*l*/) {
  return stepper_.rate(0, x.col(i + 1));
}

Cycle NewtonPicardProblem::orbit(Vec u) {
  const double period = begin_point(border_of(u));
  const Cycle ends = gather(u);
  Cycle points{refined(mesh(), steps_), MatrixXd(local(), intervals() * steps_), ends.period, ends.parameter};
  const MatrixXd x = nodes(u);
  for (Index i = 0; i < intervals(); ++i) {
    VectorXd state = x.col(i);
    const double begin = mesh()[at(i)], h = length(i) / steps_;
    for (int k = 0; k < steps_; ++k) {
      stepper_.step(angle(begin + k * h), angle(h), h * period, state, nullptr);
      points.x.col(i * steps_ + k) = state_scale().cwiseProduct(state);
    }
  }
  return through(points);
}

}  // namespace whirl::solve
