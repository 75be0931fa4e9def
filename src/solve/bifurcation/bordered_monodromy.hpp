#pragma once
// Systems of polynomials of the monodromy matrix, bordered where they are singular.

#include <Eigen/Core>
#include <vector>

#include "whirl/solve/cycle/cycle_problem.hpp"

namespace whirl::solve {

/// [A b; c^T 0][v; g] = [0; I] and its transpose with w for A = a_0 I + a_1 M + a_2 M^2 + ... that loses rank by the
/// number k of columns of b and c [n x k]: v, w [n x k], g [k x k], the same on every rank.
///
/// By LU where M is at hand. Else by GMRES on products with M, preconditioned by the answer for M ~ (M V) V^T with the
/// subspace V of the dominant multipliers: A ~ a_0 I + U V^T, U = M V (a_1 I + a_2 V^T M V + ...), and z = V^T v,
///
///     [ a_0 I + V^T U   V^T b ] [ z ]   [ V^T r         ]
///     [ c^T U           c^T b ] [ g ] = [ c^T r - a_0 s ]      v = (r - U z - b g)/a_0
///
/// Collective on the problem's communicator. Where each rank has whole states the iteration is rank 0's: it alone
/// decides, the others take part in the products. Where ranks share states each group of them iterates.
class BorderedMonodromy {
public:
  /// Borders that are generic and the same everywhere. `problem` outlives this and is linearised.
  BorderedMonodromy(CycleProblem& problem, Eigen::Index k);
  /// Finds v and g at the problem's present linearisation. Throws core::NotConverged.
  void solve(const std::vector<double>& polynomial);
  /// w, to be asked for at the linearisation at which solve() was called last.
  [[nodiscard]] const Eigen::MatrixXd& left();
  /// The null vectors found last as borders.
  void update();

  Eigen::MatrixXd v, g;

private:
  [[nodiscard]] Eigen::MatrixXd null_vectors(bool transposed) const;

  CycleProblem& problem_;
  Eigen::MatrixXd b_, c_, w_;
  std::vector<double> polynomial_;
  Eigen::MatrixXd basis_, image_;  // V, U
};

/// A^-1 r [n_local x columns] for A = a_0 I + a_1 M + ..., regular, at the problem's present linearisation: the above
/// without a border. Throws core::NotConverged. Collective.
[[nodiscard]] Eigen::MatrixXd solve_polynomial(PeriodicProblem& problem, const std::vector<double>& polynomial,
                                               const Eigen::MatrixXd& rhs);

/// g [k x columns] with r = `basis` g + a rest in the range of A, which loses rank by k, for its null vectors `basis`
/// [n_local x k]: the above with b = c = basis, and right-hand side (r, 0). The left null vectors take no part.
/// Throws core::NotConverged. Collective.
[[nodiscard]] Eigen::MatrixXd share_of_null_space(PeriodicProblem& problem, const std::vector<double>& polynomial,
                                                  const Eigen::MatrixXd& basis, const Eigen::MatrixXd& rhs);

}  // namespace whirl::solve
