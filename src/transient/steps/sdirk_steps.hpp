#pragma once
// Steps of a diagonally implicit scheme with error control.

#include <optional>
#include <vector>

#include "transient/steps/equations.hpp"
#include "transient/steps/stepper.hpp"
#include "whirl/solve/shooting/tableau.hpp"

namespace whirl::transient {

/// F(t + c_i h, Y_i, K_i) = 0, Y_i = u_0 + h sum_{j<=i} a_ij K_j by a simplified Newton's method (Hairer and Wanner
/// 1996, IV.8): its matrix is that of the first iterate of a stage where tangents come with the forces, of an earlier
/// step where they do not. Slopes are predicted by the polynomial through the last ones.
class SdirkSteps final : public Stepper {
public:
  /// Newton's method ends where its next change would be the part `newton` of the tolerance of a step. `equations`
  /// outlive this.
  SdirkSteps(Equations& equations, const solve::Tableau& tableau, double tolerance, double newton = 1e-2);

  [[nodiscard]] Taken step(double time, double wanted, Vec u) override;
  void interpolate(double time, Vec u) override;
  void forget() override;
  void pass_break() override { length_before_ = 0; }
  /// The state where the last step began, and its slopes K_i [n x stages].
  [[nodiscard]] const Eigen::VectorXd& start() const { return start_; }
  [[nodiscard]] const Eigen::MatrixXd& slopes() const { return before_; }

private:
  [[nodiscard]] std::optional<double> attempt(double time, double length);
  [[nodiscard]] bool solve_stage(Eigen::Index i, double time, double length);
  void predict(Eigen::Index i, double length);
  [[nodiscard]] double norm(const Eigen::VectorXd& v) const {
    return equations_.root_mean(v.cwiseProduct(weights_).squaredNorm());
  }

  Equations& equations_;
  const solve::Tableau& tableau_;
  double tolerance_, newton_;
  Eigen::VectorXd estimate_;    // weights of the error of a step
  Eigen::MatrixXd continuous_;  // powers of the part of a step to the weights between its ends
  std::unique_ptr<solve::Stage> stage_;
  solve::StepOf made_{};  // of its tangents
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
};

}  // namespace whirl::transient
