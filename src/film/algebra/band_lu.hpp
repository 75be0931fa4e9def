#pragma once
// LU of a sparse matrix whose entries lie near its diagonal.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "whirl/core/pivoted_band.hpp"

namespace whirl::film {

/// D A U = L R of matrices of one pattern, U the units of the unknowns, D such that the largest entry of each row is
/// one: films have several units. Rows are not exchanged; in a film that costs some digits where it stands still. How
/// many is tried on a solution that is known: where fewer than seven are left rows are exchanged (core::PivotedBand).
/// Cost for n states of bandwidth w on either side: 2 n w^2 operations to factorise, 4 n w to solve, 2 n w numbers to
/// hold; twice as much with exchanges.
class BandLu {
public:
  using Sparse = Eigen::SparseMatrix<double>;
  /// `units` [n] are what the unknowns are measured in, so that entries of a row can be compared; one if empty.
  explicit BandLu(const Sparse& pattern, Eigen::VectorXd units = {});
  /// Largest distance of an entry from the diagonal.
  [[nodiscard]] static int bandwidth(const Sparse& pattern);
  /// Whether this costs less than a sparse LU of a mesh in two directions, by counts.
  [[nodiscard]] static bool pays(const Sparse& pattern);
  /// Of a matrix with that pattern; false if it is singular.
  [[nodiscard]] bool factor(const Sparse& a);
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// Of each column of b [n x any]; two at a time cost little more than one.
  [[nodiscard]] Eigen::MatrixXd solve_all(const Eigen::MatrixXd& b) const;
  /// Of each column of b [n x any]; two at a time cost little more than one.
  [[nodiscard]] Eigen::MatrixXd solve_transposed(const Eigen::MatrixXd& b) const;
  /// The largest relative error of the solution that was tried.
  [[nodiscard]] double loss() const { return loss_; }
  /// Whether the last factors needed exchanges of rows.
  [[nodiscard]] bool exchanged() const { return exchanged_; }

private:
  [[nodiscard]] bool scale_rows(const Sparse& a);
  void factor_as_it_stands(const Sparse& a);
  template <int Vectors, class LayOut>
  void eliminate(const LayOut& lay_out);
  [[nodiscard]] bool factor_with_exchanges(const Sparse& a);
  template <int Sides>
  void direct(const double* b, double* to) const;
  template <int Sides>
  void transposed(const double* b, double* to) const;
  [[nodiscard]] double* column(int k) { return band_.data() + first(k); }
  [[nodiscard]] const double* column(int k) const { return band_.data() + first(k); }
  [[nodiscard]] std::ptrdiff_t first(int k) const { return static_cast<std::ptrdiff_t>(k) * stride_ + 8 + width_ - k; }

  // width_ in whole vectors of eight rows, and how far columns lie apart.
  int size_, width_, height_, stride_;
  // Of column k the rows k - width to k + width, as they stand: row r at column(k)[r]. Between columns there are zeros,
  // eight or more, so that whole vectors may be taken above and below each; some columns more behind the last.
  std::vector<double> band_;
  std::vector<double> panel_;  // L of four columns at once
  bool exchanged_ = false;
  double loss_ = 0;
  core::PivotedBand pivoted_;
  Eigen::VectorXd units_, scale_;  // D
};

}  // namespace whirl::film
