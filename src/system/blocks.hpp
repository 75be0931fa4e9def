#pragma once
// The dense blocks that a train on one rank shows to structured solvers.

#include <Eigen/Core>

#include "whirl/problem/structure.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

/// Inputs are (x, y, vx, vy) of each journal relative to its pedestal (elevation not subtracted), forces (Fx, Fy) of
/// each film on its journal.
class RotorSystem::Blocks : public problem::Structure {
public:
  explicit Blocks(RotorSystem& system);

  [[nodiscard]] Eigen::Index size() const override { return l1_.rows(); }
  [[nodiscard]] Eigen::Index n_forces() const override { return b_.cols(); }
  [[nodiscard]] Eigen::Index n_inputs() const override { return c_.rows(); }
  [[nodiscard]] const Eigen::MatrixXd& l1() const override { return l1_; }
  [[nodiscard]] const Eigen::MatrixXd& l0() override;
  [[nodiscard]] const Eigen::MatrixXd& dl0() override;
  [[nodiscard]] const Eigen::MatrixXd& b() const override { return b_; }
  [[nodiscard]] const Eigen::MatrixXd& c() const override { return c_; }
  void load(double angle, Eigen::VectorXd& load, Eigen::VectorXd* d_load) override;
  void forces(const Eigen::VectorXd& inputs, Eigen::VectorXd& f, Eigen::MatrixXd* d_inputs,
              Eigen::VectorXd* d_parameter) override;

private:
  RotorSystem& system_;
  Eigen::MatrixXd l1_, l0_at_rest_, gyroscopic_, l0_, b_, c_;
  double l0_speed_ = -1;
};

}  // namespace whirl::system
