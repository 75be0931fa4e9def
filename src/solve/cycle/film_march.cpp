#include "solve/cycle/film_march.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"

namespace whirl::solve {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Of a clearance: with oil of 1.5 GPa a hundredth of a Pascal.
constexpr double enough = 1e-11;
constexpr int most_steps = 60;
constexpr int most_laps = 60;

}  // namespace

FilmMarch::FilmMarch(const Scheme& scheme, problem::BlockStructure& structure, problem::ScaledPoint& point)
    : scheme_(scheme), structure_(structure), point_(point), at_(static_cast<std::size_t>(scheme.degree)) {
  for (const problem::OwnStates& film : structure.own()) {
    blocks_.push_back(film.settles ? make_own_block(scheme, film) : nullptr);
    core::require(!film.settles || blocks_.back()->shape().separators == 0, "a film that settles is a band");
  }
  for (const problem::PointState& at : at_) points_.push_back(&at);
  rows_.resize(point.own_states(), scheme.degree);
  row_.resize(point.size());
}

FilmMarch::~FilmMarch() = default;

// From the rows and tangents at the points.
void FilmMarch::step(double length, Eigen::Ref<MatrixXd> nodes, double& largest) {
  const Index n = structure_.size(), m = scheme_.degree;
  largest = 0;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (!blocks_[i]) continue;
    const problem::OwnStates& film = structure_.own()[i];
    blocks_[i]->factorise(points_, i, point_, n + film.first, length, false);
    film_.resize(m * film.count);
    Map<MatrixXd> change(film_.data(), m, film.count);
    change = rows_.middleRows(film.first, film.count).transpose();
    blocks_[i]->eliminate(1, film_.data(), force_);
    nodes.middleRows(n + film.first, film.count) -= change.transpose();
    // Before any maximum, which may pass over what is not a number.
    if (!film_.allFinite()) throw core::NotConverged("a film by itself is singular");
    if (film_.size() > 0) largest = std::max(largest, film_.lpNorm<Eigen::Infinity>());
  }
}

double FilmMarch::interval(double length, const VectorXd& start, double* own) {
  const Index m = scheme_.degree;
  Map<MatrixXd> nodes(own, point_.size(), m);
  const VectorXd end = nodes.col(m - 1);
  for (int k = 0; k < most_steps; ++k) {
    for (Index j = 0; j < m; ++j) {
      value_ = scheme_.value(j, 0) * start;
      slope_ = scheme_.slope(j, 0) * start;
      value_.noalias() += nodes * scheme_.value.row(j).tail(m).transpose();
      slope_.noalias() += nodes * scheme_.slope.row(j).tail(m).transpose();
      slope_ /= length;
      // Films do not see the angle.
      point_.residual(0, value_, slope_, row_, at_[static_cast<std::size_t>(j)]);
      rows_.col(j) = row_.tail(rows_.rows());
    }
    double largest = 0;
    step(length, nodes, largest);
    if (largest <= enough) return (nodes.col(m - 1) - end).lpNorm<Eigen::Infinity>();
  }
  throw core::NotConverged("the full nodes of a film did not settle within an interval");
}

bool CycleProblem::settles() const {
  if (way_ != Way::own_states || !collocates()) return false;
  const auto& films = structure_->own();
  return std::any_of(films.begin(), films.end(), [](const problem::OwnStates& film) { return film.settles; });
}

// Lap after lap, until what enters each interval stays. Films forget: what a cavity holds is carried into a groove or
// out of the pad within a few turns. Ranks march at once, each from what the one before it ended with last time.
bool CycleProblem::settle(Vec u) {
  if (!settles()) return false;
  if (!march_) march_ = std::make_unique<FilmMarch>(scheme_, *structure_, point_);
  const VectorXd border = border_of(u);
  const Index m = scheme_.degree;
  MatrixXd nodes;
  {
    const core::ReadArray ua(u);
    nodes = Map<const MatrixXd>(ua.data(), local_, count_ * m);
  }
  try {
    core::agree(comm(), [&] { (void)begin_point(border); });
    VectorXd entered;
    double moved = 0;
    for (int lap = 0; lap < most_laps * groups_.count(); ++lap) {
      const VectorXd before = previous_end(nodes.data());
      moved = lap == 0 ? 1 : (before - entered).lpNorm<Eigen::Infinity>();
      entered = before;
      MPI_Allreduce(MPI_IN_PLACE, &moved, 1, MPI_DOUBLE, MPI_MAX, comm());
      if (moved <= enough) break;
      core::agree(comm(), [&] {
        for (Index i = 0; i < count_; ++i) {
          const VectorXd start = i == 0 ? before : VectorXd(nodes.col(i * m - 1));
          const double change = march_->interval(length(i) * period_of(border), start, nodes.col(i * m).data());
          if (lap > 0 && change <= enough) break;  // all behind it stays
        }
      });
    }
    if (!(moved <= enough)) return false;
  } catch (const core::DomainError&) {
    return false;
  } catch (const core::NotConverged&) {
    return false;
  }
  const core::WriteArray ua(u);
  Map<MatrixXd>(ua.data(), local_, count_ * m) = nodes;
  return true;
}

}  // namespace whirl::solve
