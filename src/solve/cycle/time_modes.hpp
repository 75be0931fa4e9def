#pragma once
// Collocation of linear equations with constant coefficients, diagonalised in time.

#include <Eigen/Core>
#include <vector>

#include "whirl/solve/cycle/scheme.hpp"

namespace whirl::solve {

/// With V and D [P x P] from the P nodal values (of a cycle, or of one interval behind its start) to values and slopes
/// at the collocation points and V^-1 D = Z Lambda Z^-1,
///
///     V x L0 + D x L1 = (V Z x I) (I x L0 + Lambda x L1) (Z^-1 x I):
///
/// the equations fall apart into one of the size of the states for each eigenvalue ("fast diagonalisation", Lynch, Rice
/// and Thomas 1964, in time). Of a conjugate pair only the one above the real axis is kept, so that real data y [n x P]
/// are carried by real matrices: as rows (real parts [lanes], imaginary parts [lanes]),
///
///     yhat = into^T y^T,   (L0 + lambda_k L1) xhat_k = yhat_k,   x^T = out xhat,   (x V^T)^T = seen xhat
///
/// On `shares` ranks each holds a share of the lanes, columns `share * 2 lanes` on; the last lanes may be copies
/// without weight, so that all shares have the same length.
struct TimeModes {
  Eigen::Index lanes = 0;           ///< of one share
  Eigen::ArrayXcd lambda;           ///< [shares lanes]
  Eigen::MatrixXd into, out, seen;  ///< [P x 2 shares lanes]
};

/// Throws core::NotConverged where V is singular, as for Gauss points of odd degree on an even number of intervals.
[[nodiscard]] TimeModes time_modes(const Eigen::MatrixXd& value, const Eigen::MatrixXd& slope, int shares,
                                   Eigen::Index multiple);
/// Of a whole cycle on `mesh`; lambda in 1/period.
[[nodiscard]] TimeModes cycle_modes(const Scheme& scheme, const std::vector<double>& mesh, int shares);
/// Of one interval of `length` (s) behind its start; lambda in 1/s.
[[nodiscard]] TimeModes interval_modes(const Scheme& scheme, double length);

}  // namespace whirl::solve
