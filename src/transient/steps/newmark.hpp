#pragma once
// Newmark's method with beta = 1/4, gamma = 1/2: the mean acceleration of a step.

#include "transient/steps/equations.hpp"
#include "transient/steps/stepper.hpp"

namespace whirl::transient {

/// With q' = v among the equations, q_1 = q_0 + h (v_0 + v_1)/2, v_1 = v_0 + h (a_0 + a_1)/2 is the trapezoidal rule
/// for all states, own ones of films too:
///
///     F(t_1, u_1, r_1) = 0,   r_1 = 2/h (u_1 - u_0) - r_0
///
/// by Newton's method (the Jacobian of (2.57) with the term of the velocities that it lacks, which dF/d(du/dt) brings
/// in with 2/h), or by one step of it from the films linearised at (u_0, r_0).
///
/// After forget() r_0 is that of F(t_0, u_0, r_0) = 0. Where dF/d(du/dt) is singular it does not follow from that, but
/// from
///
///     F(t_0 + e, v, (v - u_0)/e) = 0,   F(t_0 + 2 e, w, r_0) = 0,   r_0 = (w - v)/e,   e << h
///
/// two of Euler's implicit steps so short that the first one moves nothing but what disobeys the equations without
/// rates. If they fail the first step is Euler's. Source: Skarolek (2011), (2.44)-(2.58).
class NewmarkSteps : public Stepper {
public:
  /// `tolerance` of Newton's method, on the scaled states; `regular` false if dF/d(du/dt) is known to be singular.
  /// `equations` outlive this.
  NewmarkSteps(Equations& equations, bool linearised, bool regular, double tolerance);

  [[nodiscard]] Taken step(double time, double wanted, Vec u) override;
  [[nodiscard]] Pace pace() const override { return Pace::to_samples; }
  void forget() override;
  void pass_break() override { has_rate_ = false; }

protected:
  using Vector = Eigen::VectorXd;
  /// u_1 and r_1 in end_ and end_rate_ from u_0 and r_0; false if the iteration did not converge.
  [[nodiscard]] virtual bool solve(double time, double length, const Vector& u, const Vector& rate);
  /// r_1 = (u_1 - u_0)/own - kept r_0.
  [[nodiscard]] double own(double length) const { return length / (euler_ ? 1 : 2); }
  void set_rate(double length, const Vector& u, const Vector& rate);

  Equations& equations_;
  double tolerance_;
  Vector end_, end_rate_, f_;

private:
  [[nodiscard]] double kept() const { return euler_ ? 0 : 1; }
  void begin(double time, double wanted);
  [[nodiscard]] bool newton(double time, double length, const Vector& u, const Vector& rate);

  bool linearised_;
  Vector start_, rate_;
  std::unique_ptr<solve::Stage> stage_;
  bool regular_, has_rate_ = false, euler_ = false;
};

/// The same by u <- u - P^-1 F with P = [L1 2/h + L0, films' forces; 0, dg/ds' 2/h + dg/ds]: the films' forces are
/// those of the last iterate, own states of films follow the journals. Converges while the stiffness and damping of the
/// films are small beside 4 M/h^2, (2.64). Single rank, thin equations. Source: ibid., (2.60)-(2.63).
class NewmarkFixedPointSteps final : public NewmarkSteps {
public:
  NewmarkFixedPointSteps(Equations& equations, bool regular, double tolerance);
  void forget() override;
  void pass_break() override;

private:
  [[nodiscard]] bool solve(double time, double length, const Vector& u, const Vector& rate) override;
  std::unique_ptr<solve::Stage> lagging_;
  solve::StepOf made_{};
  bool has_matrix_ = false;
};

}  // namespace whirl::transient
