#include "whirl/solve/shooting/shooting_problem.hpp"

#include "solve/newton/local_part.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {
namespace {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// x_end - G x_start: the linearised one-step map.
class MapInterval : public Interval {
public:
  explicit MapInterval(MatrixXd g) : g_(std::move(g)) {}
  void solve(MatrixXd&) const override {}
  void solve_transposed(MatrixXd&) const override {}
  MatrixXd start(const MatrixXd& x) const override { return -(g_ * x); }
  MatrixXd start_transposed(const MatrixXd& y) const override { return -(g_.transpose() * y); }
  VectorXd multiply(const VectorXd& x_start, const VectorXd& x) const override { return x - g_ * x_start; }
  void carry(const MatrixXd& rows, MatrixXd& state, MatrixXd& added) const override {
    state = (g_ * state).eval();
    added.noalias() += rows * state;
  }
  MatrixXd block(int, int l) const override {
    return l == 0 ? MatrixXd(-g_) : MatrixXd::Identity(g_.rows(), g_.rows());
  }

private:
  MatrixXd g_;
};

CycleOptions of_degree_one(CycleOptions options) {
  options.degree = 1;
  options.points = Points::radau;
  options.mesh_tolerance = 0;
  // Intervals are transitions of their own kind, which time modes know nothing of.
  if (options.joining == CycleOptions::Joining::cheapest) options.joining = CycleOptions::Joining::one_by_one;
  return options;
}

}  // namespace

ShootingProblem::ShootingProblem(MPI_Comm time, problem::System& local, const CycleOptions& options, Tableau tableau,
                                 int steps, std::vector<double> mesh, bool constant_rates)
    : CycleProblem(time, local, of_degree_one(options), std::move(mesh)),
      stepper_(choose_stages(local, tableau, constant_rates, &point()), tableau),
      known_at_(local.parameter()),
      steps_(steps) {
  core::require(steps > 0, "shooting needs at least one step per interval");
}

// Tangents [d/dx_start | d/dH | d/dp] over all steps of the interval, H the length of one of them.
void ShootingProblem::march(Index i, double period, VectorXd& x, MatrixXd* tangents, MatrixXd* states) {
  const double length = interval_length(i) * period / steps_;
  if (tangents) *tangents = MatrixXd::Identity(x.size(), x.size() + 2);
  if (system().parameter() != known_at_) stepper_.stages().refresh();
  known_at_ = system().parameter();
  for (int k = 0; k < steps_; ++k) {
    const double begin = angle_at(i, static_cast<double>(k) / steps_),
                 end = angle_at(i, static_cast<double>(k + 1) / steps_);
    stepper_.step(begin, end - begin, length, x, tangents ? &derivative_ : nullptr);
    if (states) states->col(k) = x;
    if (!tangents) continue;
    derivative_.carry(*tangents);
    tangents->col(x.size()) += derivative_.d_length();
    tangents->col(x.size() + 1) += derivative_.d_parameter();
  }
}

void ShootingProblem::interval_residual(Index i, const double* own, const VectorXd& start, double period, double* out) {
  VectorXd x = start;
  march(i, period, x, nullptr);
  Map<VectorXd>(out, x.size()) = Map<const VectorXd>(own, x.size()) - x;
}

std::unique_ptr<Interval> ShootingProblem::linearise_interval(Index i, const double*, const VectorXd& start,
                                                              double period, MatrixXd& columns) {
  const Index n = start.size();
  VectorXd x = start;
  MatrixXd tangents;
  march(i, period, x, &tangents);
  const double share = interval_length(i) / steps_;
  VectorXd d_parameter = tangents.col(n + 1);
  // On a forced cycle T = 2 pi k/Omega.
  if (!options().autonomous && system().parameter_is_speed())
    d_parameter -= share * period / system().speed() * tangents.col(n);
  columns.resize(n, options().autonomous ? 2 : 1);
  columns.rightCols(1) = -d_parameter * options().parameter_scale;
  if (options().autonomous) columns.col(0) = -share * period_scale() * tangents.col(n);
  return std::make_unique<MapInterval>(tangents.leftCols(n));
}

void ShootingProblem::interval_transposed(Index i, const double* own, const VectorXd& start, double period,
                                          const MatrixXd& y, MatrixXd& to_own, MatrixXd& to_start,
                                          MatrixXd& to_border) {
  MatrixXd columns;
  const auto map = linearise_interval(i, own, start, period, columns);
  to_own += y;
  to_start += map->start_transposed(y);
  to_border += columns.transpose() * y;
}

MatrixXd ShootingProblem::interval_tangent(Index i, const double* own, const VectorXd& start, double period,
                                           const MatrixXd& d_own, const MatrixXd& d_start) {
  MatrixXd columns, out(d_own.rows(), d_own.cols());
  const auto map = linearise_interval(i, own, start, period, columns);
  for (Index k = 0; k < out.cols(); ++k) out.col(k) = map->multiply(d_start.col(k), d_own.col(k));
  return out;
}

Cycle ShootingProblem::orbit(Vec u) {
  const Cycle ends = gather(u);
  Cycle points{refined(ends.mesh, steps_), {}, ends.period, ends.parameter};
  const Index n = ends.x.rows();
  points.x = MatrixXd::Zero(n, points.intervals());
  const Index total = ends.intervals(), size = core::size_of(comm()), rank = core::rank_of(comm());
  const Index first = total * rank / size, count = total * (rank + 1) / size - first;
  core::agree(comm(), [&] {
    system().set_parameter(ends.parameter);
    point().refresh();
    MatrixXd states(n, steps_);
    for (Index i = 0; i < count; ++i) {
      const Index g = first + i;
      VectorXd x = ends.x.col(g == 0 ? total - 1 : g - 1).cwiseQuotient(state_scale());
      march(i, ends.period, x, nullptr, &states);
      points.x.middleCols(g * steps_, steps_) = state_scale().asDiagonal() * states;
    }
  });
  MPI_Allreduce(MPI_IN_PLACE, points.x.data(), static_cast<int>(points.x.size()), MPI_DOUBLE, MPI_SUM, comm());
  return through(points);
}

VectorXd ShootingProblem::reference_rate(const Cycle& reference, Index g, Index) {
  system().set_parameter(reference.parameter);
  point().refresh();
  const VectorXd x = reference.x.col(g).cwiseQuotient(state_scale());
  return reference.period * point().rate(0, x).cwiseProduct(state_scale());
}

}  // namespace whirl::solve
