#pragma once
// Orthogonal collocation on one interval.

#include <Eigen/Core>

namespace whirl::solve {

enum class Points { radau, gauss };

/// Collocation of degree m on [0, 1]: the polynomial through its values at the nodes 0 = t_0 < ... < t_m = 1 solves the
/// equation at m points c_j.
///
/// x(c_j) = sum_l value(j, l) x_l and x'(c_j) = sum_l slope(j, l) x_l, l = 0..m. Radau IIA points (c_m = 1, nodes =
/// points, order 2m - 1) damp stiff modes; Gauss points (equidistant nodes, order 2m) leave multipliers of the highest
/// rotor modes spuriously large. Source: de Boor and Swartz 1973; Hairer and Wanner 1996, IV.5.
struct Scheme {
  int degree = 0;
  Points points = Points::radau;
  Eigen::VectorXd c;             ///< collocation points [m]
  Eigen::VectorXd weight;        ///< quadrature weights at c [m], sum 1
  Eigen::VectorXd node;          ///< nodes t_0..t_m [m + 1]
  Eigen::VectorXd node_weight;   ///< weights of the norm at t_1..t_m [m], sum 1
  Eigen::MatrixXd value, slope;  ///< [m x (m + 1)]

  /// Order of the error at the mesh points.
  [[nodiscard]] int order() const { return points == Points::radau ? 2 * degree - 1 : 2 * degree; }
};

/// The scheme of `degree` 1 to 10. Throws core::InputError outside.
[[nodiscard]] Scheme make_scheme(int degree, Points points);

/// Weights [m + 1] that evaluate the interval's polynomial / its derivative at `t` in [0, 1] from the values at the
/// nodes.
[[nodiscard]] Eigen::VectorXd lagrange(const Scheme& scheme, double t);
[[nodiscard]] Eigen::VectorXd lagrange_slope(const Scheme& scheme, double t);

/// L of A = L U with ones on the diagonal of U, without exchanges of rows (Crout), of the coefficients A [m x m] of a
/// scheme: stages by L alone, one after the other, precondition those by A (van der Houwen and de Swart 1997).
[[nodiscard]] Eigen::MatrixXd lower_factor(const Eigen::MatrixXd& a);

}  // namespace whirl::solve
