#pragma once
// LU of a sparse matrix whose entries lie near its diagonal.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <span>
#include <vector>

#include "whirl/core/pivoted_lu.hpp"

namespace whirl::core {

/// D A U = L R of matrices of one pattern, U the units of the unknowns, D such that the largest entry of each row is
/// one: films have several units. Rows are not exchanged; in a film that costs some digits where it stands still. How
/// many is tried on a solution that is known: where it is off by more than `most` PivotedLu takes the matrix. Cost for
/// n states of bandwidth w on either side: 2 n w^2 operations to factorise, 4 n w to solve, 2 n w numbers to hold.
class BandLu {
public:
  using Sparse = Eigen::SparseMatrix<double>;
  /// `units` [n] are what the unknowns are measured in, so that entries of a row can be compared; one if empty.
  explicit BandLu(const Sparse& pattern, Eigen::VectorXd units = {}, double most = 1e-7);
  /// Of n = `size` states with `width` diagonals on either side, whose entries are set in place.
  BandLu(int size, int width, Eigen::VectorXd units = {}, double most = 1e-7);
  /// Largest distance of an entry from the diagonal.
  [[nodiscard]] static int bandwidth(const Sparse& pattern);
  /// Whether this costs less than a sparse LU of a mesh in two directions, by counts of states and their bandwidth.
  [[nodiscard]] static bool pays(double states, double width);
  [[nodiscard]] static bool pays(const Sparse& pattern) {
    return pays(static_cast<double>(pattern.rows()), bandwidth(pattern));
  }
  /// Of a matrix with that pattern; false if it is singular, and solutions are then not finite.
  [[nodiscard]] bool factor(const Sparse& a);
  /// A = 0, an entry of A, and the factors of what then stands there, unscaled and untried: for matrices whose rows or
  /// columns are diagonally dominant.
  void clear();
  [[nodiscard]] double& entry(int row, int k) { return column(k)[row]; }
  void factor() { eliminate({}); }
  /// The same of A + diag(extra) [n], A = `base`, which starts again where only `extra` changed: the first call takes
  /// all columns and remembers what it finds in those from `mark` on, a multiple of at_once; later ones, with first
  /// = mark, only do these. An infinite extra holds its unknown at zero.
  void factor(const BandLu& base, std::span<const double> extra, int first, int mark) {
    eliminate({nullptr, &base, extra, first, mark});
  }
  /// Columns that are eliminated together.
  static constexpr int at_once = 4;
  /// A^-1 y and A^-T y of a vector or of all columns; two or four at a time cost little more than one.
  template <class Y>
  [[nodiscard]] typename Y::PlainObject solve(const Eigen::MatrixBase<Y>& y) const {
    return answer(false, y.derived().eval());
  }
  template <class Y>
  [[nodiscard]] typename Y::PlainObject solve_transposed(const Eigen::MatrixBase<Y>& y) const {
    return answer(true, y.derived().eval());
  }
  /// x = A^-1 y or A^-T y of n x columns numbers each; x may be y.
  void solve(bool transposed, const double* y, double* x, Eigen::Index columns) const;
  /// The largest relative error of the solution that was tried.
  [[nodiscard]] double loss() const { return loss_; }
  /// Whether the last factors needed exchanges of rows.
  [[nodiscard]] bool exchanged() const { return exchanged_; }

private:
  [[nodiscard]] bool scale_rows(const Sparse& a);
  struct Source {  // what to eliminate; none: what stands here
    const Sparse* a = nullptr;
    const BandLu* base = nullptr;
    std::span<const double> extra = {};
    int first = 0, mark = -1;
  };
  void lay_out(int first, int end, const Source& of);
  void eliminate(const Source& of);
  template <int Vectors>
  void eliminate(const Source& of);
  template <int Sides>
  void substitute(const double* b, double* to) const;
  template <int Sides>
  void substitute_transposed(const double* b, double* to) const;
  template <class Plain>
  [[nodiscard]] Plain answer(bool transposed, const Plain& y) const {
    Plain x(y.rows(), y.cols());
    solve(transposed, y.data(), x.data(), y.cols());
    return x;
  }
  [[nodiscard]] double* column(int k) { return band_.data() + first(k); }
  [[nodiscard]] const double* column(int k) const { return band_.data() + first(k); }
  [[nodiscard]] std::ptrdiff_t first(int k) const { return static_cast<std::ptrdiff_t>(k) * stride_ + 8 + width_ - k; }

  // width_ in whole vectors of eight rows, and how far columns lie apart.
  int size_, width_, height_, stride_;
  // Of column k the rows k - width to k + width, as they stand: row r at column(k)[r]. Between columns there are zeros,
  // eight or more, so that whole vectors may be taken above and below each; some columns more behind the last.
  std::vector<double> band_;
  std::vector<double> panel_;   // L of four columns at once
  std::vector<double> marked_;  // columns mark .. mark + width when those before were eliminated
  bool regular_ = true, exchanged_ = false;
  double most_, loss_ = 0;
  PivotedLu<double> pivoted_;
  Eigen::VectorXd units_, scale_;  // D
};

}  // namespace whirl::core
