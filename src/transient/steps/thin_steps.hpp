#pragma once
// Steps of a diagonally implicit scheme for a machine that tells its structure, without PETSc in the loop.

#include <optional>
#include <vector>

#include "transient/steps/equations.hpp"
#include "transient/steps/stepper.hpp"
#include "transient/steps/thin_inverse.hpp"
#include "whirl/solve/shooting/tableau.hpp"

namespace whirl::transient {

/// F(t + c_i h, Y_i, K_i) = 0, Y_i = u_0 + h sum_{j<=i} a_ij K_j by a simplified Newton's method (Hairer and Wanner
/// 1996, IV.8): its matrix is ThinInverse's, without refinement, at the first iterate of a stage where tangents come
/// with the forces, and at an earlier step where films have states of their own. Slopes are predicted by the polynomial
/// through the last ones. Single rank.
class ThinSteps final : public Stepper {
public:
  /// `equations` are thin and outlive this.
  ThinSteps(Equations& equations, const solve::Tableau& tableau, double tolerance);

  [[nodiscard]] Taken step(double time, double wanted, Vec u) override;
  void interpolate(double time, Vec u) override;
  void forget() override;
  void pass_break() override { length_before_ = 0; }
  [[nodiscard]] Vec stage(int i) override { return stages_[static_cast<std::size_t>(i)].get(); }

  struct Work {
    long tangents = 0, factorisations = 0;
  };
  [[nodiscard]] Work work() const { return {tangents_, inverse_.factorisations()}; }

private:
  [[nodiscard]] std::optional<double> attempt(double time, double length);
  [[nodiscard]] bool solve_stage(Eigen::Index i, double time, double length);
  void predict(Eigen::Index i, double length);
  [[nodiscard]] double norm(const Eigen::VectorXd& v) const;

  Equations& equations_;
  const solve::Tableau& tableau_;
  double tolerance_;
  Eigen::VectorXd estimate_;    // weights of the error of a step
  Eigen::MatrixXd continuous_;  // powers of the part of a step to the weights between its ends
  ThinInverse inverse_;
  ThinOperator operator_;
  bool has_tangents_ = false;
  bool careful_ = false;  // until the next step that is taken
  double rate_ = 1;       // by which the last iteration converged

  struct Node {
    double at;  // in steps from the beginning of this one
    const double* slope;
  };
  std::vector<Node> nodes_;  // work space of predict(), nearest first

  Eigen::VectorXd start_, weights_, known_, value_, slope_, f_, change_, end_;
  Eigen::MatrixXd slopes_, before_;  // K_i of this step and of the last one [n x stages]
  double time_ = 0, length_ = 0, length_before_ = 0;
  std::vector<core::Vector> stages_;
  long tangents_ = 0;
};

}  // namespace whirl::transient
