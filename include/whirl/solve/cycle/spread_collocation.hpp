#pragma once
// Periodic solutions by orthogonal collocation of systems that are spread over ranks.

#include <memory>
#include <vector>

#include "whirl/solve/cycle/spread_cycle.hpp"

namespace whirl::solve {

class PortElimination;
class PortMatrix;
class SpreadInterval;

struct SpreadCollocationOptions : NewtonPicardOptions {
  int degree = 2;
  double mesh_tolerance = 0;  ///< error per interval for adapt(); 0 keeps the mesh
  int base_intervals = 0;     ///< adapt() never makes a mesh coarser than this uniform one; 0: its longest interval
  int max_intervals = 400;
};

/// The equations of CycleProblem at Radau points, F(2 pi k s, x(s), x'(s)/T; p) = 0 with x(0) = x(1), for a machine
/// made of parts on the ranks of its own communicator. Each rank holds its rows of the states at all points and of the
/// blocks of dF/dx and dF/d(dx/dt) there: memory grows with states times points, and with one elimination for each
/// interval, or for each point of systems that settle (problem::System::settles()). How an interval is solved: see
/// SpreadInterval.
class SpreadCollocation final : public SpreadCycle {
public:
  /// `system` outlives this and has parts; core::Bug of others.
  SpreadCollocation(problem::System& system, const SpreadCollocationOptions& options, std::vector<double> mesh);
  /// The same in groups of ranks that share the intervals; `system` is that of this group.
  SpreadCollocation(problem::System& system, const SpreadCollocationOptions& options, std::vector<double> mesh,
                    const TimeGroups& groups);
  ~SpreadCollocation() override;

  [[nodiscard]] bool settles() const override { return true; }
  /// The films, with the hub and all that they see of it held, from interval to interval and lap after lap until what
  /// enters each interval stays.
  bool settle(Vec u) override;
  bool adapt(core::Vector& u, core::Vector& tangent) override;
  /// "orbit": the states at all points of time.
  [[nodiscard]] std::vector<problem::Field> fields() const override;

private:
  void refresh() override;
  void forget_mesh() override;
  void residuals(const Eigen::MatrixXd& x, double period, Eigen::MatrixXd& r) override;
  void linearise_intervals(const Eigen::MatrixXd& x, double period) override;
  [[nodiscard]] const Eigen::MatrixXd& columns(Eigen::Index i) const override {
    return columns_[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] Eigen::MatrixXd advance(Eigen::Index i, const Eigen::MatrixXd& start, const Eigen::MatrixXd* rhs,
                                        bool rest) const override;
  [[nodiscard]] Eigen::VectorXd product(Eigen::Index i, const Eigen::VectorXd& start,
                                        const Eigen::VectorXd& x) const override;
  [[nodiscard]] std::vector<Eigen::MatrixXd> tangents_at(const Eigen::MatrixXd& x, double period,
                                                         const std::vector<Eigen::MatrixXd>& b) override;
  [[nodiscard]] Eigen::VectorXd reference_rate(const Eigen::MatrixXd& x, double period, Eigen::Index i,
                                               Eigen::Index l) override;
  /// State and rate at point j of interval i into value_ and rate_; `x` as nodes().
  void interpolate(const Eigen::MatrixXd& x, Eigen::Index i, Eigen::Index j, double period);
  /// F of interval i [m local].
  void residual_of(const Eigen::MatrixXd& x, Eigen::Index i, double period, double* r);
  /// The linearised interval; `rate` is dF/d(dx/dt) if that is constant, once it is known. What is eliminated of it
  /// stands in `similar` already, or is put there, if there are no `columns` of the parts alone.
  [[nodiscard]] std::unique_ptr<SpreadInterval> interval_at(const Eigen::MatrixXd& x, Eigen::Index i, double period,
                                                            std::shared_ptr<const PortMatrix>& rate,
                                                            std::vector<std::shared_ptr<PortElimination>>& similar,
                                                            Eigen::MatrixXd* columns);
  /// How far the end of interval i has moved.
  double settle_interval(Eigen::MatrixXd& x, Eigen::Index i, double period);
  SpreadCollocationOptions options_;
  struct Tools;
  std::unique_ptr<Tools> tools_;
  core::Vector value_, rate_, f_;
  // dF/d(dx/dt) of the last linearisation if it depends on nothing but the parameter, and the parameter.
  std::shared_ptr<const PortMatrix> constant_;
  double constant_at_ = 0;
  std::vector<std::unique_ptr<SpreadInterval>> intervals_;
  std::vector<Eigen::MatrixXd> columns_;
};

}  // namespace whirl::solve
