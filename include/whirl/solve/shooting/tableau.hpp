#pragma once
// Runge-Kutta schemes by their coefficients.

#include <Eigen/Core>

namespace whirl::solve {

/// One step of length H: X_j = x_0 + H sum_l a(j,l) K_l with F(angle + c_j d_angle, X_j, K_j) = 0, then
/// x_1 = x_0 + H sum_l b_l K_l.
struct Tableau {
  Eigen::MatrixXd a;     ///< [stages x stages]
  Eigen::VectorXd b, c;  ///< [stages]
  int order = 0;

  [[nodiscard]] Eigen::Index stages() const { return b.size(); }
  /// No stage depends on a later one, so that stages are solved one after the other.
  [[nodiscard]] bool sequential() const;
  /// No stage depends on itself either: only dF/d(dx/dt) is inverted.
  [[nodiscard]] bool is_explicit() const;
};

/// Improved Euler (Heun), the third-order scheme (k1 + k2 + 4 k3)/6 and the classical fourth-order one. Source: van de
/// Vrande (2001), Sec. 3.1.
[[nodiscard]] Tableau heun();
[[nodiscard]] Tableau third_order();
[[nodiscard]] Tableau classical();
/// Radau IIA, order 2 stages - 1: the same numbers as collocation at Radau points. Throws core::InputError outside 1 to
/// 10 stages. Source: Hairer and Wanner (1996), IV.5.
[[nodiscard]] Tableau radau_iia(int stages);
/// Singly diagonally implicit, stiffly accurate and L-stable: order 2 (Alexander 1977, 2 stages) or 4 (Hairer and
/// Wanner 1996, IV (6.16), 5 stages). Throws core::InputError for other orders.
[[nodiscard]] Tableau sdirk(int order);

}  // namespace whirl::solve
