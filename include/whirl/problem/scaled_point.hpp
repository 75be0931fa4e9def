#pragma once
// F and its derivatives at one point, scaled, for a system that lives on one rank.

#include <Eigen/Core>

#include "whirl/problem/structure.hpp"
#include "whirl/problem/system.hpp"
#include "whirl/problem/thin_blocks.hpp"

namespace whirl::problem {

/// What is kept of one point between the residual and its linearisation, by systems that tell their structure.
struct PointState {
  Eigen::VectorXd value, rate;  ///< (x, s) and its rates in SI [n]
  Films films;                  ///< with tangents, in SI
};

/// F/residual_scale as a function of x/state_scale and (dx/dt)/state_scale; by the system's structure where it has one,
/// which spares its sparse matrices. Nothing here communicates.
class ScaledPoint {
public:
  /// `system` lives on a communicator of size 1 and outlives this; `structure` may be null. With `sparse` the blocks of
  /// the structure stay sparse; small machines are quicker with dense ones.
  ScaledPoint(System& system, BlockStructure* structure, bool sparse = false);

  [[nodiscard]] Eigen::Index size() const { return state_scale_.size(); }
  /// Own states of films as the structure tells them; they stand behind all others.
  [[nodiscard]] Eigen::Index own_states() const { return structure_ ? size() - structure_->size() : 0; }
  [[nodiscard]] const Eigen::VectorXd& state_scale() const { return state_scale_; }
  [[nodiscard]] const Eigen::VectorXd& residual_scale() const { return residual_scale_; }
  /// Scaled blocks of the structure at the last refresh().
  [[nodiscard]] const DenseBlocks& blocks() const { return dense_; }     ///< not with `sparse`
  [[nodiscard]] const ThinBlocks& thin_blocks() const { return thin_; }  ///< with `sparse` only

  /// To be called after each change of the system's parameter.
  void refresh();
  /// Where nothing but the speed has changed: of the structure only L0 follows it.
  void refresh_speed();
  /// out = F(angle, x, xdot) [n]. Throws core::DomainError.
  void residual(double angle, const Eigen::VectorXd& x, const Eigen::VectorXd& xdot, Eigen::Ref<Eigen::VectorXd> out);
  /// The same with the films' tangents, which stay in `keep`; with structure only.
  void residual(double angle, const Eigen::VectorXd& x, const Eigen::VectorXd& xdot, Eigen::Ref<Eigen::VectorXd> out,
                PointState& keep);
  /// dF/dp [n] per SI unit of the parameter at such a point.
  void parameter_derivative(double angle, const PointState& at, Eigen::Ref<Eigen::VectorXd> out);
  /// out = dF/d(dx/dt) v [n] there, v in scaled states.
  void times_rates(const PointState& at, const Eigen::VectorXd& v, Eigen::Ref<Eigen::VectorXd> out) const;
  /// out = dF/dx a + dF/d(dx/dt) b [n] there.
  void times(const PointState& at, const Eigen::VectorXd& a, const Eigen::VectorXd& b,
             Eigen::Ref<Eigen::VectorXd> out) const;
  /// by_state = (dF/dx)^T y and by_rate = (dF/d(dx/dt))^T y [n] there.
  void times_transposed(const PointState& at, const Eigen::Ref<const Eigen::VectorXd>& y, Eigen::VectorXd& by_state,
                        Eigen::VectorXd& by_rate) const;
  /// dF/dx and dF/d(dx/dt) [n x n] and, if not null, dF/dp [n] per SI unit of the parameter.
  void linearise(double angle, const Eigen::VectorXd& x, const Eigen::VectorXd& xdot, Eigen::MatrixXd& jx,
                 Eigen::MatrixXd& jxdot, Eigen::VectorXd* d_parameter);
  /// The two matrices at a point that was kept.
  void matrices(const PointState& at, Eigen::MatrixXd& jx, Eigen::MatrixXd& jxdot) const;
  /// The xdot of F(angle, x, xdot) = 0, F being linear in it with a regular dF/d(dx/dt).
  [[nodiscard]] Eigen::VectorXd rate(double angle, const Eigen::VectorXd& x);

private:
  void put(const Eigen::VectorXd& x, const Eigen::VectorXd& xdot);
  void structured(double angle, const Eigen::VectorXd& x, const Eigen::VectorXd& xdot, bool tangents,
                  Eigen::Ref<Eigen::VectorXd> out, PointState& at);
  // Work on the blocks as they are kept.
  template <class Work>
  auto with_blocks(Work&& work) const {
    return sparse_ ? work(thin_) : work(dense_);
  }

  System& system_;
  BlockStructure* structure_;
  bool sparse_;
  Eigen::VectorXd state_scale_, residual_scale_;
  Eigen::VectorXd load_, inputs_, d_parameter_;  // work space
  PointState point_;
  DenseBlocks dense_;
  ThinBlocks thin_;
  core::Vector x_, xdot_, f_;
  core::Matrix matrix_;
};

}  // namespace whirl::problem
