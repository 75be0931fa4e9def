#pragma once
// F and its derivatives at one point of a cycle, scaled and dense, for a system that lives on one rank.

#include <Eigen/Core>

#include "whirl/problem/system.hpp"

namespace whirl::solve {

/// F/residual_scale as a function of x/state_scale and (dx/dt)/state_scale; by the system's structure where it has one,
/// which spares its sparse matrices. Nothing here communicates.
class ScaledPoint {
public:
  /// `system` lives on a communicator of size 1 and outlives this; `structure` may be null.
  ScaledPoint(problem::System& system, problem::Structure* structure);

  [[nodiscard]] Eigen::Index size() const { return state_scale_.size(); }
  [[nodiscard]] const Eigen::VectorXd& state_scale() const { return state_scale_; }
  [[nodiscard]] const Eigen::VectorXd& residual_scale() const { return residual_scale_; }
  /// Scaled L1, B and C of the structure.
  [[nodiscard]] const Eigen::MatrixXd& l1() const { return l1_; }
  [[nodiscard]] const Eigen::MatrixXd& b() const { return b_; }
  [[nodiscard]] const Eigen::MatrixXd& c() const { return c_; }
  /// A block of dF/dx or dF/d(dx/dt), scaled.
  [[nodiscard]] Eigen::MatrixXd scaled(const Eigen::MatrixXd& block) const;

  /// To be called after each change of the system's parameter.
  void refresh();
  /// out = F(angle, x, xdot) [n]. Throws core::DomainError.
  void residual(double angle, const Eigen::VectorXd& x, const Eigen::VectorXd& xdot, Eigen::Ref<Eigen::VectorXd> out);
  /// dF/dx and dF/d(dx/dt) [n x n] and, if not null, dF/dp [n] per SI unit of the parameter.
  void linearise(double angle, const Eigen::VectorXd& x, const Eigen::VectorXd& xdot, Eigen::MatrixXd& jx,
                 Eigen::MatrixXd& jxdot, Eigen::VectorXd* d_parameter);
  /// The xdot of F(angle, x, xdot) = 0, F being linear in it with a regular dF/d(dx/dt).
  [[nodiscard]] Eigen::VectorXd rate(double angle, const Eigen::VectorXd& x);

private:
  void put(const Eigen::VectorXd& x, const Eigen::VectorXd& xdot);
  problem::System& system_;
  problem::Structure* structure_;
  Eigen::VectorXd state_scale_, residual_scale_;
  Eigen::VectorXd load_, forces_;  // work space
  Eigen::MatrixXd l1_, b_, c_, l0_, dl0_;
  core::Vector x_, xdot_, f_;
  core::Matrix matrix_;
};

}  // namespace whirl::solve
