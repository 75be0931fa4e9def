#pragma once
// One Runge-Kutta step on F(angle, x, dx/dt) = 0 with its exact derivatives, dense.

#include "whirl/problem/scaled_point.hpp"
#include "whirl/solve/shooting/tableau.hpp"

namespace whirl::solve {

/// x_1 = phi(x_0; H, p), in scaled states.
class RungeKutta {
public:
  RungeKutta(problem::ScaledPoint& point, Tableau tableau) : point_(point), tableau_(std::move(tableau)) {}
  [[nodiscard]] const Tableau& tableau() const { return tableau_; }

  /// Carries x [n] over one step of `length` H [s] in which the shaft turns by `d_angle`. If `tangents` is not null, it
  /// becomes [d phi/dx_0 | d phi/dH at fixed angles | d phi/dp] [n x (n + 2)].
  ///
  /// These are the derivatives of the discrete map itself, not of the flow: G_i = I + dt dg/du and m b_T = g + dt
  /// dg/d(dt) in the notation of van de Vrande (2001), Sec. 3.1, with the errata of the stage chain. Throws
  /// core::DomainError if a stage leaves the validity of a film or its equation is not solved.
  void step(double angle, double d_angle, double length, Eigen::VectorXd& x, Eigen::MatrixXd* tangents);

private:
  void solve_stage(Eigen::Index j, double angle, double length, const Eigen::VectorXd& x, Eigen::MatrixXd& slopes);
  void solve_coupled(double angle, double d_angle, double length, const Eigen::VectorXd& x, Eigen::MatrixXd& slopes);
  [[nodiscard]] Eigen::MatrixXd tangents_of(double angle, double d_angle, double length, const Eigen::VectorXd& x,
                                            const Eigen::MatrixXd& slopes);
  problem::ScaledPoint& point_;
  Tableau tableau_;
};

}  // namespace whirl::solve
