#pragma once
// What all problems share whose unknowns are the states of a cycle at the nodes of intervals.

#include <Eigen/Core>
#include <vector>

#include "whirl/problem/system.hpp"
#include "whirl/solve/cycle/periodic_problem.hpp"
#include "whirl/solve/cycle/time_groups.hpp"

namespace whirl::solve {

struct OrbitOptions {
  int turns = 1;
  bool autonomous = false;
  double parameter_scale = 1, state_weight = 1;  ///< as of CycleOptions
};

/// Unknowns: this rank's rows of the scaled states X_1..X_m at the nodes of its group's intervals, and behind them on
/// the last rank the border, [period,] parameter. The start of an interval is its left neighbour's X_m, and x(0) =
/// x(1). The linearised equations are
///
///     A0_i x_i + A_i X_i + columns_i d = y_i of interval i,     sum rows_i X_i + corner d = y_c.
///
/// Groups of ranks share the intervals; each group holds a whole system on a communicator of its own.
class OrbitProblem : public PeriodicProblem {
public:
  [[nodiscard]] MPI_Comm comm() const override { return groups_.all(); }
  [[nodiscard]] core::Vector make_unknown() const override;
  [[nodiscard]] Vec weights() const override { return weights_.get(); }
  [[nodiscard]] double parameter_scale() const override { return orbit_.parameter_scale; }
  void multiply(Vec v, Vec y) override;

  [[nodiscard]] const Scheme& scheme() const override { return scheme_; }
  [[nodiscard]] const std::vector<double>& mesh() const override { return mesh_; }
  [[nodiscard]] const Eigen::VectorXd& state_scale() const override { return scale_; }
  [[nodiscard]] Cycle gather(Vec u) const override;
  [[nodiscard]] core::Vector scatter(const Cycle& cycle) const override;
  /// sum weight <x - ref, ref'> = 0 over all nodes from now on.
  void set_phase_reference(const Cycle& reference) override;
  [[nodiscard]] double period_scale() const override { return period_scale_; }
  [[nodiscard]] MPI_Comm rows() const override { return system_.comm(); }

protected:
  OrbitProblem(problem::System& system, const TimeGroups& groups, const OrbitOptions& options, Scheme scheme,
               std::vector<double> mesh);

  /// dR_i/d(period, parameter) [m local x nb].
  [[nodiscard]] virtual const Eigen::MatrixXd& columns(Eigen::Index i) const = 0;
  /// A0_i start + A_i x [m local].
  [[nodiscard]] virtual Eigen::VectorXd product(Eigen::Index i, const Eigen::VectorXd& start,
                                                const Eigen::VectorXd& x) const = 0;
  /// x'(s) of a reference on this mesh at the nodes of this group's intervals, scaled [local x count m].
  [[nodiscard]] virtual Eigen::MatrixXd reference_rates(const Cycle& reference) = 0;
  /// The mesh has changed: a linearisation is to be made again.
  virtual void forget_mesh() {}

  [[nodiscard]] problem::System& system() const { return system_; }
  [[nodiscard]] const TimeGroups& groups() const { return groups_; }
  /// N, of this group; interval i begins at s = begin(i).
  [[nodiscard]] Eigen::Index intervals() const { return count_; }
  [[nodiscard]] double begin(Eigen::Index i) const { return mesh_[static_cast<std::size_t>(first_ + i)]; }
  [[nodiscard]] double length(Eigen::Index i) const { return begin(i + 1) - begin(i); }
  /// Of the shaft; 0 on an autonomous cycle.
  [[nodiscard]] double angle(double s) const;
  [[nodiscard]] Eigen::Index local() const { return local_; }
  [[nodiscard]] Eigen::Index borders() const { return borders_; }
  /// Of a vector like the unknown, on every rank. Collective.
  [[nodiscard]] Eigen::VectorXd border_of(Vec u) const;
  /// At the system's present parameter.
  [[nodiscard]] double period_of(const Eigen::VectorXd& border) const;
  /// The nodes of u [local x 1 + N m]: the state that enters the first interval, and those of all intervals; that at
  /// the start of interval i is column i m. Collective.
  [[nodiscard]] Eigen::MatrixXd nodes(Vec u) const;
  [[nodiscard]] Eigen::MatrixXd with_start(const Eigen::MatrixXd& own) const;
  /// The residual of the phase condition, if there is one, goes into its place in r. Collective.
  void put_phase(const Eigen::Ref<const Eigen::MatrixXd>& own, const core::WriteArray& r) const;
  /// Takes rows_ and corner_ from the last row of the equations. Collective.
  void take_rows(Vec row);
  /// adapt() by adapted_mesh().
  [[nodiscard]] bool adapt_to(double tolerance, int base, int max_intervals, core::Vector& u, core::Vector& tangent);
  /// Sums over all ranks.
  void sum_over_time(Eigen::MatrixXd& values) const;

  problem::System& system_;
  TimeGroups groups_;
  OrbitOptions orbit_;
  Scheme scheme_;
  std::vector<double> mesh_;
  Eigen::Index first_ = 0, count_ = 0;  // intervals of this group
  Eigen::Index local_, borders_;        // this rank's states; 1 or 2
  bool last_;                           // this rank holds the border
  double period_scale_ = 0;
  std::vector<Eigen::MatrixXd> rows_;  // [nb x m local]
  Eigen::MatrixXd corner_;             // [nb x nb]

private:
  void set_mesh(std::vector<double> mesh);
  Eigen::VectorXd scale_;
  core::Vector weights_;
  Eigen::MatrixXd phase_row_;  // [local x N m]
  double phase_offset_ = 0;
};

}  // namespace whirl::solve
