#pragma once
// Small cycles born at a Hopf point, by harmonic balance.

#include <Eigen/Core>
#include <array>
#include <complex>
#include <memory>
#include <vector>

#include "whirl/problem/system.hpp"
#include "whirl/solve/newton/extended_problem.hpp"
#include "whirl/solve/newton/newton.hpp"

namespace whirl::solve {

class FrequencyResolvent;

/// Critical vector of a Hopf point in scaled states [n]: (dF/dx + i omega dF/d(dx/dt)) q = 0, of any length.
[[nodiscard]] Eigen::VectorXcd critical_vector(problem::System& system, Vec x, double omega);

/// A cycle x(t) = a_0 + Re sum_{k=1..H} a_k exp(i k omega t) of F(0, x, dx/dt; p) = 0:
///
///     r_0 = mean F = 0,   r_k = 2 mean F exp(-i k omega t) = 0,   Im q^* a_1 = 0,   u = (a_0, a_1, ..., omega, p),
///
/// means over 4 H + 4 equidistant times. It differs from the rest x_H by small terms only, so that the linearised
/// equations there, one sparse matrix A_k = dF/dx + i k omega dF/d(dx/dt) a harmonic, precondition Newton's:
///
///     [ A_0                     | c_0 ]      columns c: d/d(omega, p), eliminated by what they leave in the
///     [     A_1 (singular)      | c_1 ]      direction b that A_1 cannot reach, [A_1 b; q^* 0]
///     [           A_2 ... A_H   | c_k ]
///
/// Its cost goes with sparse factors and H, so that it serves shafts of thousands of states, of which a collocation
/// would join dense maps. The system is whole on this rank (communicator of size 1).
/// Source: Kuznetsov (2004), 3.5; Seydel (2010), 6.6 for harmonic balance.
class HarmonicCycle : public ExtendedProblem {
public:
  /// At the Hopf point x (SI) with `omega` [rad/s] at the system's parameter; q [n] scaled, the motion that an
  /// amplitude of one stands for. `system` outlives this.
  HarmonicCycle(problem::System& system, Vec x, double omega, Eigen::VectorXcd q, int harmonics,
                double parameter_scale);
  ~HarmonicCycle() override;

  [[nodiscard]] MPI_Comm comm() const override { return system_.comm(); }
  [[nodiscard]] core::Vector make_unknown() const override;
  [[nodiscard]] Vec weights() const override { return weights_.get(); }
  [[nodiscard]] double parameter_scale() const override { return parameter_scale_; }
  void residual(Vec u, Vec r) override;
  /// `row` is that of the amplitude.
  void linearise(Vec u, Vec row) override;
  void multiply(Vec v, Vec y) override;
  /// A preconditioner: exact for vanishing amplitudes.
  void solve(Vec rhs, Vec x) override;
  [[nodiscard]] double linear_tolerance() const override { return 1e-4; }

  /// row . u = Re q^* a_1/|q|^2, the amplitude.
  void amplitude_row(Vec row) const;
  /// Solves for the cycle of this amplitude and returns its SI parameter and omega [rad/s]. Begins with the last cycle
  /// found, scaled as cycles near their birth are, or with the critical motion. Throws core::NotConverged.
  [[nodiscard]] std::array<double, 2> at_amplitude(double amplitude, const NewtonOptions& options);

private:
  struct Sample {
    core::Matrix by_state, by_rate;
  };
  [[nodiscard]] double phase(const Eigen::VectorXd& u) const;
  void motion_at(const Eigen::VectorXd& u, Eigen::Index sample, Vec x, Vec rate) const;
  void project(Eigen::Index sample, Vec f, Eigen::Ref<Eigen::VectorXd> r) const;
  void set_parameter(double scaled);
  [[nodiscard]] Eigen::VectorXd balance(const Eigen::VectorXd& rhs, std::complex<double>& beyond);
  [[nodiscard]] Eigen::Index n() const { return q_.size(); }
  [[nodiscard]] Eigen::Index unknowns() const { return (2 * harmonics_ + 1) * n() + 2; }
  [[nodiscard]] Eigen::Index samples() const { return 4 * harmonics_ + 4; }

  problem::System& system_;
  double omega_;
  Eigen::VectorXcd q_;
  int harmonics_;
  double parameter_scale_, square_;
  Eigen::VectorXd state_scale_, residual_scale_;
  core::Vector weights_, x_, rate_, f_;
  std::vector<std::unique_ptr<FrequencyResolvent>> blocks_;
  std::vector<Sample> tangents_;
  Eigen::MatrixXd columns_;  // dR/d(omega, parameter)
  Eigen::VectorXd row_;
  double omega_now_ = 0;  // [rad/s]
  // Changes of all unknowns that answer a change of omega, and of the parameter, and what they leave beyond A_1.
  Eigen::MatrixXd answers_;
  std::array<std::complex<double>, 2> beyond_;
  Eigen::VectorXd last_, birth_;
  double last_amplitude_ = 0;
};

}  // namespace whirl::solve
