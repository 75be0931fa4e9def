#pragma once
// Columns of nodes one behind the other, each coupled to the next one node by node: LU of blocks.

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace whirl::film {

/// Entries of the rows of a strip of columns, [nodes of a column x columns]: in the column before and the one after, at
/// the nodes below and above in the same column, and at the node itself. Entries that do not exist are zero.
template <class Scalar>
struct Strip {
  using Entries = Eigen::Array<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  Entries before, after, below, above, itself;
};

/// Solves A x = r of a strip, and with the transpose, column by column:
///
///     S_k = T_k - L_k V_(k-1) U_(k-1),   V_k = S_k^-1
///     z_k = V_k (r_k - L_k z_(k-1)),     x_k = z_k - V_k U_k x_(k+1)
///
/// T is tridiagonal, L and U are diagonal. Columns of S_k that hold their diagonal alone stay so in V_k: those of empty
/// nodes, on which no pressure depends. No column waits for a pivot from another one, so A has to be a matrix whose
/// columns (or rows) are diagonally dominant, in some scaling. A singular one gives answers that are not finite.
/// Cost for n nodes in a column, n_d of them dense: 2 n_d^2 n operations to factorise it, 4 n n_d to solve, n n_d
/// numbers to hold.
template <class Scalar>
class ColumnChain {
public:
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

  void factor(const Strip<Scalar>& strip);
  [[nodiscard]] Eigen::Index columns() const { return static_cast<Eigen::Index>(inverses_.size()); }
  /// The last columns' block of A^-1, which is V of the last one.
  [[nodiscard]] Matrix last() const;
  /// r [nodes of all columns x right-hand sides] becomes z.
  void forward(bool transposed, Eigen::Ref<Matrix> r) const;
  /// z becomes x. `beyond` [nodes x right-hand sides] is U x of what follows behind the last column; null: nothing
  /// does.
  void backward(bool transposed, Eigen::Ref<Matrix> z, const Matrix* beyond = nullptr) const;

private:
  struct Inverse {           // V of one column
    std::vector<int> dense;  // columns of V with more than a diagonal,
    Matrix values;           // [nodes x dense] their values,
    Vector diagonal;         // and the other ones; zero at those
  };
  void factor(const Strip<Scalar>& strip, Eigen::Index k);
  /// V b, or with the transpose.
  static Matrix times(bool transposed, const Inverse& v, const Matrix& b);

  std::vector<Inverse> inverses_;
  typename Strip<Scalar>::Entries before_, after_;
};

extern template class ColumnChain<double>;
extern template class ColumnChain<std::complex<double>>;

}  // namespace whirl::film
