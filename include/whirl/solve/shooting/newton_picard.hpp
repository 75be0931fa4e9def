#pragma once
// Newton-Picard Gauss-Seidel for cycles of systems distributed in space, by steps of a Runge-Kutta scheme.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "whirl/solve/cycle/spread_cycle.hpp"
#include "whirl/solve/shooting/runge_kutta.hpp"

namespace whirl::solve {

/// Equations x_(i+1) = phi_i(x_i; T, p) of ShootingProblem, with M known only by its products: the cost grows with the
/// nonzeros of dF/dx instead of n^2.
///
/// One interval: shooting-based. An explicit scheme with one step per interval: finite-difference-based. Degree 1:
/// cycles are given by their states at the ends of the intervals.
class NewtonPicardProblem : public SpreadCycle {
public:
  /// `tableau` has sequential stages; `steps` per interval of `mesh`. The communicator is that of `system`.
  NewtonPicardProblem(problem::System& system, const NewtonPicardOptions& options, Tableau tableau, int steps,
                      std::vector<double> mesh);

  [[nodiscard]] Cycle orbit(Vec u) override;
  [[nodiscard]] const Scheme& orbit_scheme() const override { return quintic(); }
  /// Whether steps are taken by the structure of the system.
  [[nodiscard]] bool structured() const { return stepper_.stages().derivative_is_free(); }

private:
  void refresh() override { stepper_.stages().refresh(); }
  void residuals(const Eigen::MatrixXd& x, double period, Eigen::MatrixXd& r) override;
  void linearise_intervals(const Eigen::MatrixXd& x, double period) override;
  [[nodiscard]] const Eigen::MatrixXd& columns(Eigen::Index i) const override;
  [[nodiscard]] Eigen::MatrixXd advance(Eigen::Index i, const Eigen::MatrixXd& start, const Eigen::MatrixXd* rhs,
                                        bool rest) const override;
  [[nodiscard]] Eigen::VectorXd product(Eigen::Index i, const Eigen::VectorXd& start,
                                        const Eigen::VectorXd& x) const override;
  [[nodiscard]] std::vector<Eigen::MatrixXd> tangents_at(const Eigen::MatrixXd& x, double period,
                                                         const std::vector<Eigen::MatrixXd>& b) override;
  [[nodiscard]] Eigen::VectorXd reference_rate(const Eigen::MatrixXd& x, double period, Eigen::Index i,
                                               Eigen::Index l) override;
  struct Links {
    Eigen::MatrixXd x;                               // where: this rank's rows of the nodes,
    double period = 0, parameter = 0;                // and these
    std::vector<std::vector<StepDerivative>> steps;  // per interval
    std::vector<Eigen::MatrixXd> columns;            // dR/d(border) per interval [local x nb]
  };
  void march(Eigen::Index i, double period, Eigen::VectorXd& x, Links* links);
  void march_all(const Eigen::MatrixXd& x, double period, Eigen::MatrixXd& ends, Links* links);

  int steps_;
  RungeKutta stepper_;
  Links links_, next_;  // of the linearisation, and of the last residual if they are free
};

}  // namespace whirl::solve
