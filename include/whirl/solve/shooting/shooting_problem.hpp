#pragma once
// Periodic solutions by one-step maps: single and multiple shooting, and the finite differences of explicit schemes.

#include <memory>

#include "whirl/solve/cycle/cycle_problem.hpp"
#include "whirl/solve/shooting/runge_kutta.hpp"

namespace whirl::solve {

/// Equations x_(i+1) = phi_i(x_i; T, p), i over the intervals of the mesh with x_N = x_0, where phi_i are `steps` equal
/// Runge-Kutta steps.
///
/// One interval: single shooting. Several: multiple shooting, distributed over the ranks like collocation. An explicit
/// scheme with one step per interval: the finite-difference method of van de Vrande (2001), Sec. 3.1, whose system
/// (3.4) is condensed by the same products of G_i. Unknowns, border, phase condition, monodromy and parallel
/// condensation are those of CycleProblem with the states at the ends of the intervals (degree 1) as unknowns; the
/// residual is in scaled states. With Radau IIA steps the states at the mesh points and the monodromy are those of
/// collocation. G_i are dense; where Newton-Picard takes its steps by the structure of the system, their columns are
/// found by its products.
class ShootingProblem : public CycleProblem {
public:
  /// Degree, points and mesh tolerance of `options` are not used. `mesh` has at least one interval per rank. With
  /// `constant_rates`, dF/d(dx/dt) depends on nothing but the parameter.
  ShootingProblem(MPI_Comm time, problem::System& local, const CycleOptions& options, Tableau tableau, int steps,
                  std::vector<double> mesh, bool constant_rates = false);

  [[nodiscard]] const Tableau& tableau() const { return stepper_.tableau(); }
  /// Steps per interval.
  [[nodiscard]] int steps() const { return steps_; }

  [[nodiscard]] Cycle orbit(Vec u) override;
  [[nodiscard]] const Scheme& orbit_scheme() const override { return quintic(); }

protected:
  [[nodiscard]] bool collocates() const override { return false; }
  void interval_residual(Eigen::Index i, const double* own, const Eigen::VectorXd& start, double period,
                         double* out) override;
  [[nodiscard]] std::unique_ptr<Interval> linearise_interval(Eigen::Index i, const double* own,
                                                             const Eigen::VectorXd& start, double period,
                                                             Eigen::MatrixXd& columns) override;
  void interval_transposed(Eigen::Index i, const double* own, const Eigen::VectorXd& start, double period,
                           const Eigen::MatrixXd& y, Eigen::MatrixXd& to_own, Eigen::MatrixXd& to_start,
                           Eigen::MatrixXd& to_border) override;
  [[nodiscard]] Eigen::MatrixXd interval_tangent(Eigen::Index i, const double* own, const Eigen::VectorXd& start,
                                                 double period, const Eigen::MatrixXd& d_own,
                                                 const Eigen::MatrixXd& d_start) override;
  /// From the equation itself, because the neighbours of a shooting point can be far.
  [[nodiscard]] Eigen::VectorXd reference_rate(const Cycle& reference, Eigen::Index g, Eigen::Index l) override;

private:
  /// Carries x over interval i; `states`, if not null, gets those after each step [n x steps].
  void march(Eigen::Index i, double period, Eigen::VectorXd& x, Eigen::MatrixXd* tangents,
             Eigen::MatrixXd* states = nullptr);
  RungeKutta stepper_;
  double known_at_;  // the parameter that its stages know
  StepDerivative derivative_;
  int steps_;
};

}  // namespace whirl::solve
