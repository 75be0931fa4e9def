#pragma once
// LU of band matrices with exchanges of rows.

#include <Eigen/Core>
#include <vector>

namespace whirl::core {

/// L U of A [n x n], `reach` diagonals on either side of the main one; 4 n reach numbers. Own loops: of narrow bands,
/// on which LAPACK (dgbtrf) spends its time in calls for each column, they make whole decks up to 1.37 times faster
/// (docs/speed.md).
class PivotedBand {
public:
  /// A = 0.
  void resize(Eigen::Index n, Eigen::Index reach);
  /// Entry of A before it is factorised, |column - row| <= reach.
  [[nodiscard]] double& at(Eigen::Index row, Eigen::Index column) { return rows_(column - row + reach_, row); }
  /// False if A is singular; solutions are then not finite.
  bool factorise();
  /// x := A^-1 x [n], x := A^-T x.
  void solve(double* x) const;
  void solve_transposed(double* x) const;

private:
  Eigen::Index reach_ = 0;
  Eigen::MatrixXd rows_;   // column j of row i at (j - i + reach, i); exchanges fill `reach` more places
  Eigen::MatrixXd lower_;  // multipliers [reach x n]
  std::vector<Eigen::Index> pivot_;
};

}  // namespace whirl::core
