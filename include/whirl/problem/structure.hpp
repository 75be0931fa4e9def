#pragma once
// What a system may tell beyond F and J: it is linear except for a thin coupling.

#include <Eigen/Core>

namespace whirl::problem {

/// F(angle, x, xdot; p) = L1 xdot + L0(p) x - g - u(angle; p) - B f(C x; p), with r = columns of B and w = rows of C
/// much smaller than n.
///
/// L1, L0 [n x n] are constant along a cycle, g [n] is the constant load, u [n] the forcing, f [r] the nonlinear forces
/// (journal forces of the films) that depend on the thin inputs C x [w] (positions and velocities of the journals in
/// their bearings) only. All on one rank, SI.
class Structure {
public:
  virtual ~Structure() = default;

  /// n, r, w.
  [[nodiscard]] virtual Eigen::Index size() const = 0;
  [[nodiscard]] virtual Eigen::Index n_forces() const = 0;
  [[nodiscard]] virtual Eigen::Index n_inputs() const = 0;

  [[nodiscard]] virtual const Eigen::MatrixXd& l1() const = 0;
  /// L0 at the present parameter, and dL0/dp.
  [[nodiscard]] virtual const Eigen::MatrixXd& l0() = 0;
  [[nodiscard]] virtual const Eigen::MatrixXd& dl0() = 0;
  [[nodiscard]] virtual const Eigen::MatrixXd& b() const = 0;
  [[nodiscard]] virtual const Eigen::MatrixXd& c() const = 0;

  /// g + u(angle) and its derivative in p (d_load may be null).
  virtual void load(double angle, Eigen::VectorXd& load, Eigen::VectorXd* d_load) = 0;
  /// f(w; p) and, if not null, df/dw [r x w] and df/dp [r]. Throws core::DomainError outside the validity of a film.
  virtual void forces(const Eigen::VectorXd& inputs, Eigen::VectorXd& f, Eigen::MatrixXd* d_inputs,
                      Eigen::VectorXd* d_parameter) = 0;
};

}  // namespace whirl::problem
