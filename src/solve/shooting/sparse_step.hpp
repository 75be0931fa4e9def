#pragma once
// Runge-Kutta steps of a system distributed in space, and the products of their derivatives with vectors.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "solve/shooting/port_stages.hpp"
#include "solve/shooting/stage_solver.hpp"
#include "solve/shooting/structured_stage.hpp"
#include "whirl/problem/spread_point.hpp"
#include "whirl/problem/system.hpp"
#include "whirl/solve/shooting/tableau.hpp"

namespace whirl::solve {

/// The derivative of one step at the point where it was taken: products only, no matrix of size n x n is formed.
/// Vectors are this rank's scaled rows; products are collective.
class StepProduct {
public:
  /// v := G v for each column of v [local x k], G = d phi/dx_0.
  void apply(Eigen::MatrixXd& v) const;
  /// d phi/dH at fixed angles and d phi/dp [local].
  [[nodiscard]] const Eigen::VectorXd& d_length() const { return d_length_; }
  [[nodiscard]] const Eigen::VectorXd& d_parameter() const { return d_parameter_; }

private:
  friend class SparseRungeKutta;
  using Columns = std::vector<Eigen::VectorXd>;
  /// H sum b k of the k_j with dF/dx (v + w_j + H sum_(l<j) a k_l) + (...) k_j + g_j = 0 at all stages; `lift` and
  /// `load` (w and g) may be empty.
  [[nodiscard]] Eigen::MatrixXd change(const Eigen::MatrixXd& v, const Columns& lift, const Columns& load) const;
  void apply_structured(Eigen::MatrixXd& v) const;
  const Tableau* tableau_ = nullptr;
  double length_ = 0;
  std::vector<StageProduct> stages_;
  const StructuredRate* rate_ = nullptr;   // and in place of stages_, of a system that tells its structure:
  std::vector<RateMatrix> rates_;          // [stages]
  std::vector<StructuredStage> implicit_;  // [stages] of an implicit scheme
  Eigen::VectorXd d_length_, d_parameter_;
};

/// The same step as RungeKutta for schemes with sequential stages, in scaled states; each stage costs sparse solves on
/// system.comm(): by elimination of the parts of a system that has some, else by LU, or one pass over dF/dx where
/// dF/d(dx/dt) of an explicit stage is inverted entry by entry; none at all on one rank where StructuredRate serves.
class SparseRungeKutta {
public:
  /// With `constant_rates`, dF/d(dx/dt) depends on nothing but the parameter. Without `by_length`, products need not
  /// know d phi/dH.
  SparseRungeKutta(problem::System& system, Tableau tableau, bool constant_rates, bool by_length);

  /// To be called after each change of the system's parameter.
  void refresh() {
    rates_.reset();
    rate_blocks_.reset();
    if (structured_) structured_->refresh();
  }
  /// A step makes its product on the way, so that both are best taken together.
  [[nodiscard]] bool product_is_free() const { return structured_ != nullptr; }
  /// Carries x over one step; fills `product` if not null. Collective; throws core::DomainError on all ranks.
  void step(double angle, double d_angle, double length, Vec x, StepProduct* product);
  /// xdot of F(angle, x, xdot) = 0.
  void rate(double angle, Vec x, Vec xdot);
  [[nodiscard]] Vec state_scale() const { return point_.state_scale(); }
  [[nodiscard]] const Tableau& tableau() const { return tableau_; }

private:
  [[nodiscard]] StageProduct product_at(double angle, Vec x, Vec k, double own,
                                        std::shared_ptr<const StageSolver> solver);
  /// dF/d(dx/dt) + own dF/dx, ready to solve with.
  [[nodiscard]] std::shared_ptr<const StageSolver> solver_at(double angle, Vec x, Vec k, double own);
  /// The solver of the last iteration.
  [[nodiscard]] std::shared_ptr<const StageSolver> solve_stage(double angle, double own, Vec base, Vec k);
  void structured_step(double angle, double d_angle, double length, Eigen::Map<Eigen::VectorXd> x,
                       StepProduct& product);
  void structured_stage(double angle, double own, RateMatrix& matrix, StructuredStage& solver);
  [[noreturn]] void fail() const;
  problem::System& system_;
  Tableau tableau_;
  bool constant_rates_, by_length_wanted_;
  problem::SpreadPoint point_;
  core::Vector value_, base_, f_, d_, lift_;
  std::vector<core::Vector> slopes_;
  core::Matrix scratch_;
  std::shared_ptr<const StageSolver> rates_;       // of explicit stages with constant rates
  std::unique_ptr<PortStages> parts_;              // of a system that has parts
  std::shared_ptr<const PortMatrix> rate_blocks_;  // dF/d(dx/dt) if it is constant
  std::unique_ptr<StructuredRate> structured_;
  StepProduct unused_;                                       // of structured steps whose product nobody asks for
  Eigen::MatrixXd stage_slopes_, by_length_, by_parameter_;  // work space of structured steps
  Eigen::VectorXd base_now_, value_now_, slope_now_, d_parameter_now_;
};

}  // namespace whirl::solve
