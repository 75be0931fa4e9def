#pragma once
// F and J over time, in scaled states and residuals, as PETSc wants them.

#include <memory>
#include <utility>
#include <vector>

#include "transient/thin_inverse.hpp"
#include "whirl/core/gate.hpp"
#include "whirl/problem/drive.hpp"
#include "whirl/problem/system.hpp"
#include "whirl/solve/cycle/scaled_point.hpp"
#include "whirl/transient/integrator.hpp"

namespace whirl::transient {

/// F(angle(t), x, dx/dt)/residual_scale as a function of u = x/state_scale and du/dt.
///
/// A machine that tells its structure is never assembled on one rank: see ThinInverse. All members are collective.
class Equations {
public:
  Equations(problem::System& system, const problem::Drive& drive, Algebra algebra = Algebra::automatic);

  [[nodiscard]] problem::System& system() const { return system_; }
  [[nodiscard]] bool dense() const { return point_ && !thin(); }
  /// Matrices are products only, of which configure() knows the inverse.
  [[nodiscard]] bool thin() const { return thin_; }
  [[nodiscard]] core::Vector make_state() const { return core::duplicate(state_scale_.get()); }
  [[nodiscard]] core::Matrix make_matrix();
  /// A solver of KSP for matrices of make_matrix(): ThinInverse, or LU with row exchanges.
  void configure(KSP ksp);
  /// What callbacks throw leaves PETSc through it.
  [[nodiscard]] core::Gate& gate() { return gate_; }

  void scale(Vec x, Vec u) const;
  void unscale(Vec u, Vec x) const;
  /// Throws core::DomainError (agreed) outside the validity of a film.
  void residual(double t, Vec u, Vec udot, Vec f);
  /// F - B f(t) from now on; null: none. They outlive their use here.
  void act(const Forces* forces) { forces_ = forces; }
  /// j = alpha dF/du + sigma dF/d(du/dt)
  void jacobian(double t, Vec u, Vec udot, double alpha, double sigma, Mat j);

private:
  void turn(double t);
  /// Without external forces.
  void free_residual(double t, Vec u, Vec udot, Vec f);
  [[nodiscard]] ThinOperator& operator_of(Mat m);
  void thin_residual(double t, Vec u, Vec udot);

  problem::System& system_;
  problem::Drive drive_;
  const Forces* forces_ = nullptr;
  core::Gate gate_;
  bool thin_ = false;
  core::Vector state_scale_, residual_scale_, inverse_, x_, xdot_;
  std::unique_ptr<solve::ScaledPoint> point_;
  Eigen::VectorXd u_, udot_, f_;
  Eigen::MatrixXd jx_, jxdot_;
  // Of thin ones: the point of the last residual and its tangents, and what matrices stand for.
  double time_ = 0;
  solve::PointState at_;
  bool tangents_ = false;
  std::vector<std::pair<Mat, std::shared_ptr<ThinOperator>>> operators_;
};

}  // namespace whirl::transient
