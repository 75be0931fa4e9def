#pragma once
// Response of a system on one rank after its kinematic equations are eliminated.

#include <petscmat.h>

#include <complex>
#include <vector>

#include "whirl/core/pivoted_lu.hpp"

namespace whirl::solve {

/// Solves (Jx + i omega Jd) z = b where rows of the kind a x_v + d x_q' = 0 (q' = v) are eliminated exactly:
///
///     z_v = (b_i - i omega d z_q)/a
///
/// A system of second order in state form so keeps its coordinates only; one without such rows is solved as it is.
/// Columns are ordered (COLAMD) and the factorisation is analysed anew only when the nonzeros or the rows to eliminate
/// change.
class EliminatedResponse {
public:
  /// Takes Jx and Jd on one rank with one pattern; `row` and `column` [n] scale rows and columns.
  void linearise(Mat jx, Mat jd, const double* row, const double* column);
  /// Throws core::NotConverged if the matrix is singular.
  void factorise(double omega);
  /// `right` and `amplitude` [2 n] as in FrequencyResponse, at the frequency factorised last.
  void solve(const std::vector<double>& right, std::vector<double>& amplitude) const;

private:
  using Complex = std::complex<double>;
  struct Link {
    PetscInt row = -1;  // equation that gives the eliminated state; -1: the state stays
    PetscInt to = -1;   // the state whose rate it is
    double a = 0, d = 0;
  };
  // The dense rows of both matrices, one behind the other, and the kinematic rows among them.
  void read(Mat jx, Mat jd, const double* row, const double* column);
  void analyse();

  PetscInt n_ = 0;
  double omega_ = 0;
  std::vector<double> row_, column_;
  std::vector<PetscInt> begin_, columns_;  // compressed rows of both matrices
  std::vector<double> x_, d_;              // scaled values
  std::vector<Link> links_;                // per state
  std::vector<PetscInt> kept_, row_of_;    // place of a state that stays / row of an equation that stays, or -1
  std::vector<PetscInt> place_;            // of an entry among the values of the reduced matrix, -1 for a zero
  bool analysed_ = false;
  Eigen::SparseMatrix<Complex> matrix_;
  core::PivotedLu<Complex> lu_;
};

}  // namespace whirl::solve
