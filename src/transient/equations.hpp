#pragma once
// F and J over time, in scaled states and residuals, as PETSc wants them.

#include <memory>

#include "whirl/problem/drive.hpp"
#include "whirl/problem/system.hpp"
#include "whirl/solve/cycle/scaled_point.hpp"

namespace whirl::transient {

/// F(angle(t), x, dx/dt)/residual_scale as a function of u = x/state_scale and du/dt.
///
/// A small system on one rank is dense: LAPACK pivots where PETSc's sparse LU does not, and the structure of a rotor
/// spares its sparse matrices. All members are collective.
class Equations {
public:
  Equations(problem::System& system, const problem::Drive& drive);

  [[nodiscard]] problem::System& system() const { return system_; }
  [[nodiscard]] bool dense() const { return static_cast<bool>(point_); }
  [[nodiscard]] core::Vector make_state() const { return core::duplicate(state_scale_.get()); }
  [[nodiscard]] core::Matrix make_matrix() const;
  /// A solver of KSP for matrices of make_matrix(): LU with row exchanges.
  void configure(KSP ksp) const;

  void scale(Vec x, Vec u) const;
  void unscale(Vec u, Vec x) const;
  /// Throws core::DomainError (agreed) outside the validity of a film.
  void residual(double t, Vec u, Vec udot, Vec f);
  /// j = alpha dF/du + sigma dF/d(du/dt)
  void jacobian(double t, Vec u, Vec udot, double alpha, double sigma, Mat j);

private:
  void turn(double t);
  problem::System& system_;
  problem::Drive drive_;
  core::Vector state_scale_, residual_scale_, inverse_, x_, xdot_;
  std::unique_ptr<solve::ScaledPoint> point_;
  Eigen::VectorXd u_, udot_, f_;
  Eigen::MatrixXd jx_, jxdot_;
};

}  // namespace whirl::transient
