#pragma once
// F over time, in scaled states and residuals, and stages that solve it.

#include <memory>
#include <string>

#include "whirl/problem/drive.hpp"
#include "whirl/problem/scaled_point.hpp"
#include "whirl/solve/shooting/runge_kutta.hpp"
#include "whirl/transient/steps/integrator.hpp"

namespace whirl::transient {

/// F(angle(t), x, dx/dt)/residual_scale - B f(t) as a function of u = x/state_scale and du/dt, this rank's rows; its
/// matrices dF/d(du/dt) + own dF/du are those of solve::Stage. All members are collective.
class Equations {
public:
  Equations(problem::System& system, const problem::Drive& drive, Algebra algebra = Algebra::automatic);
  Equations(const Equations&) = delete;
  Equations& operator=(const Equations&) = delete;

  [[nodiscard]] problem::System& system() const { return system_; }
  [[nodiscard]] const problem::Drive& drive() const { return drive_; }
  /// Stages are those of solve::thin_stages().
  [[nodiscard]] bool thin() const { return thin_; }
  [[nodiscard]] const solve::Stages& stages() const { return *stages_; }
  /// Of Stage::solve(), where it is to be exact. Newton's method puts the rest right; on several ranks it is to go on
  /// as on one.
  [[nodiscard]] double tolerance() const { return thin_ ? 1e-6 : 1e-10; }
  /// What is kept from one matrix to the next belongs to the stage.
  [[nodiscard]] std::unique_ptr<solve::Stage> make_stage() const { return stages_->make(); }
  [[nodiscard]] core::Vector make_state() const { return core::duplicate(state_scale_.get()); }
  /// Sets the speed of the shaft at `t`, where it changes.
  void turn(double t);
  void scale(Vec x, Vec u) const;
  void unscale(Vec u, Vec x) const;
  /// The root of the mean over all states of what sums up to `squares` on this rank.
  [[nodiscard]] double root_mean(double squares) const;
  /// External forces f from now on; null: none. They outlive their use here.
  void act(const Forces* forces) { forces_ = forces; }

  /// f = F(t, u, udot) - B f(t); with `ready` factorise() follows. Throws core::DomainError (agreed) outside the
  /// validity of a film.
  void residual(solve::Stage& stage, double t, const Eigen::VectorXd& u, const Eigen::VectorXd& udot,
                Eigen::VectorXd& f, bool ready = false);
  /// Stage::factorise() at the point of the last residual, and Stage::keep() at any.
  void factorise(solve::Stage& stage, double own, const Eigen::VectorXd& u, const Eigen::VectorXd& udot,
                 bool lagging = false);
  void keep(solve::Stage& stage, double t, double own, const Eigen::VectorXd& u, const Eigen::VectorXd& udot);

  /// The du/dt of F(t, u, du/dt) = 0, F being linear in it but for cut-offs, with a regular dF/d(du/dt).
  void rate(double t, const Eigen::VectorXd& u, Eigen::VectorXd& udot);
  /// What rate() keeps from one call to the next.
  void forget() { rates_ = make_stage(); }
  /// Which equations hold no rates, so that dF/d(du/dt) is singular at `u`: the states they belong to; empty if there
  /// are none.
  [[nodiscard]] std::string why_singular(double t, Vec u);
  /// Evaluations of F, and linearisations, so far.
  [[nodiscard]] long residuals() const { return residuals_; }
  [[nodiscard]] long jacobians() const { return jacobians_; }

private:
  problem::System& system_;
  problem::Drive drive_;
  const Forces* forces_ = nullptr;
  bool thin_ = false;
  double turned_ = 0;  // the speed that stages are at
  PetscInt begin_ = 0;
  core::Vector state_scale_;
  Eigen::VectorXd inverse_;                      // of the residuals' scale
  std::unique_ptr<problem::ScaledPoint> point_;  // of dense stages
  std::unique_ptr<solve::Stages> stages_;
  solve::StageGroup group_;
  std::unique_ptr<solve::Stage> rates_;
  Eigen::VectorXd f_;
  long residuals_ = 0, jacobians_ = 0;
};

}  // namespace whirl::transient
