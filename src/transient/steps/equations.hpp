#pragma once
// F and J over time, in scaled states and residuals, as PETSc wants them.

#include <memory>
#include <utility>
#include <vector>

#include "transient/steps/thin_inverse.hpp"
#include "whirl/core/gate.hpp"
#include "whirl/problem/drive.hpp"
#include "whirl/problem/scaled_point.hpp"
#include "whirl/problem/system.hpp"
#include "whirl/transient/steps/integrator.hpp"

namespace whirl::transient {

/// F(angle(t), x, dx/dt)/residual_scale as a function of u = x/state_scale and du/dt.
///
/// A machine that tells its structure is never assembled on one rank: see ThinInverse. All members are collective.
class Equations {
public:
  Equations(problem::System& system, const problem::Drive& drive, Algebra algebra = Algebra::automatic);
  Equations(const Equations&) = delete;
  Equations& operator=(const Equations&) = delete;

  [[nodiscard]] problem::System& system() const { return system_; }
  /// Matrices are products only, of which configure() knows the inverse.
  [[nodiscard]] bool thin() const { return thin_; }
  [[nodiscard]] core::Vector make_state() const { return core::duplicate(state_scale_.get()); }
  [[nodiscard]] core::Matrix make_matrix();
  /// A solver of KSP for matrices of make_matrix(): ThinInverse, or LU with row exchanges.
  void configure(KSP ksp);
  /// What solvers of configure() and make_solver() keep from one matrix to the next: they depend on the next one only.
  void forget();
  [[nodiscard]] core::LinearSolver make_solver(const std::string& prefix);
  /// x = matrix^-1 b; false if that failed.
  [[nodiscard]] bool solve(KSP ksp, Mat matrix, Vec b, Vec x);
  [[nodiscard]] problem::ScaledPoint& point() { return *point_; }
  [[nodiscard]] const problem::Drive& drive() const { return drive_; }
  /// Sets the speed of the shaft at `t`, where it changes.
  void turn(double t);
  /// What callbacks throw leaves PETSc through it.
  [[nodiscard]] core::Gate& gate() { return gate_; }

  void scale(Vec x, Vec u) const;
  void unscale(Vec u, Vec x) const;
  /// Throws core::DomainError (agreed) outside the validity of a film.
  void residual(double t, Vec u, Vec udot, Vec f);
  /// F - B f(t) from now on; null: none. They outlive their use here.
  void act(const Forces* forces) { forces_ = forces; }
  /// Of thin ones the same without PETSc; with `keep` the films' tangents stay in it.
  void residual(double t, const Eigen::VectorXd& u, const Eigen::VectorXd& udot, Eigen::VectorXd& f,
                problem::PointState* keep = nullptr);
  /// j = alpha dF/du + sigma dF/d(du/dt)
  void jacobian(double t, Vec u, Vec udot, double alpha, double sigma, Mat j);

  /// The du/dt of F(t, u, du/dt) = 0, F being linear in it but for cut-offs, with a regular dF/d(du/dt).
  void rate(double t, Vec u, Vec udot);
  /// Which equations hold no rates, so that dF/d(du/dt) is singular at `u`: the states they belong to; empty if there
  /// are none.
  [[nodiscard]] std::string why_singular(double t, Vec u);
  /// Evaluations by residual() and jacobian() so far.
  [[nodiscard]] long residuals() const { return residuals_; }
  [[nodiscard]] long jacobians() const { return jacobians_; }

private:
  /// Of assembled ones, without external forces.
  void free_residual(double t, Vec u, Vec udot, Vec f);
  [[nodiscard]] ThinOperator& operator_of(Mat m);
  void thin_residual(double t, Vec u, Vec udot);

  problem::System& system_;
  problem::Drive drive_;
  const Forces* forces_ = nullptr;
  core::Gate gate_;
  bool thin_ = false;
  double turned_ = 0;  // the speed that `point_` is at
  core::Vector state_scale_, residual_scale_, inverse_, x_, xdot_;
  core::Matrix sparse_;                          // of small systems, whose matrices are dense copies of it
  std::unique_ptr<problem::ScaledPoint> point_;  // of thin ones
  Eigen::VectorXd u_, udot_, f_;
  // Of thin ones: the point of the last residual and its tangents, and what matrices stand for.
  double time_ = 0;
  problem::PointState at_;
  bool tangents_ = false;
  long residuals_ = 0, jacobians_ = 0;
  std::vector<std::pair<Mat, std::shared_ptr<ThinOperator>>> operators_;
  std::vector<std::weak_ptr<ThinInverse>> inverses_;  // of configure()
  core::Matrix rates_;                                // of rate()
  core::LinearSolver rate_solver_;
  core::Vector f_rate_, change_;
};

}  // namespace whirl::transient
