#pragma once
// The blocks that a train on one rank shows to structured solvers.

#include <Eigen/Core>

#include "whirl/film/contract/film.hpp"
#include "whirl/problem/structure.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

/// Inputs are (x, y, vx, vy) of each journal relative to its pedestal (elevation not subtracted), forces (Fx, Fy) of
/// each film on its journal; with the slopes of the shaft behind x, y, their rates behind vx, vy and the moments behind
/// Fx, Fy where a film tilts.
class RotorSystem::MachineBlocks : public problem::BlockStructure {
public:
  explicit MachineBlocks(RotorSystem& system);
  /// To be called after each build of the system: all blocks are made anew, references to them stay valid.
  void rebuild();

  [[nodiscard]] Eigen::Index size() const override { return l1_.rows(); }
  [[nodiscard]] Eigen::Index n_forces() const override { return b_.cols(); }
  [[nodiscard]] Eigen::Index n_inputs() const override { return c_.rows(); }
  [[nodiscard]] const std::vector<problem::OwnStates>& own() const override { return own_; }
  [[nodiscard]] const problem::SparseBlock& l1() override;
  [[nodiscard]] const problem::SparseBlock& l0() override;
  [[nodiscard]] const problem::SparseBlock& b() const override { return b_; }
  [[nodiscard]] const problem::SparseBlock& c() const override { return c_; }
  void load(double angle, Eigen::VectorXd& load) override;
  void films(const Eigen::VectorXd& inputs, const double* own, const double* rates, bool tangents,
             problem::Films& films) override;
  void parameter_derivative(double angle, const Eigen::VectorXd& x, const Eigen::VectorXd& xdot,
                            const problem::Films& films, Eigen::VectorXd& out) override;

private:
  void find_own_states();

  RotorSystem& system_;
  problem::SparseBlock l1_, l0_at_rest_, l0_by_speed_, gyroscopic_, l0_, b_, c_;
  double l0_speed_ = -1;
  std::vector<problem::SparseBlock> by_speed_;  // dL0/dOmega, dL1/dOmega of joints; empty if zero
  std::vector<problem::OwnStates> own_;
  struct Ports {
    Eigen::Index first, count;
  };
  film::StateResponse without_states_;  // work space
  std::vector<Ports> ports_;            // of each bearing among the forces; positions stand at twice that, then rates
};

}  // namespace whirl::system
