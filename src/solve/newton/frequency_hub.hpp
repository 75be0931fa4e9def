#pragma once
// The hub of a machine at a complex frequency, after its kinematic equations are eliminated.

#include <Eigen/SparseCore>
#include <complex>
#include <optional>
#include <vector>

#include "whirl/core/pivoted_lu.hpp"
#include "whirl/problem/kinematic.hpp"

namespace whirl::solve {

/// LU of A = a + lambda b + dense blocks, whole on this rank, where rows of the kind a x_v + b x_q' = 0 (q' = v) are
/// eliminated exactly:
///
///     z_v = (r_i - lambda b z_q)/a
///
/// A system of second order in state form so keeps its coordinates only; one without such rows is solved as it is.
/// Columns are ordered and the factorisation is analysed anew only when the nonzeros, the rows to eliminate or
/// the places of blocks change.
class FrequencyHub {
public:
  using Complex = std::complex<double>;
  using Sparse = Eigen::SparseMatrix<double>;
  using Vector = Eigen::VectorXcd;
  /// Adds to A at these rows and columns.
  struct Block {
    std::vector<int> rows, columns;
    Eigen::MatrixXcd values;
  };

  /// a and b with one pattern, whose values may change before linearise().
  Sparse a, b;
  /// `kinematic` are rows of both, and of no block.
  void linearise(const std::vector<problem::KinematicRow>& kinematic);
  /// With `border` (0 or 1) more rows and columns behind those of a, whose entries stand in blocks. False if A is
  /// singular. The border is solved around the factors of the rest (mixed block elimination: Govaerts and Pryce 1993;
  /// Govaerts 2000, sec. 3.6), as a full row and column would fill them. The rest may be singular to rounding. Where it
  /// is singular beyond that, the border is factorised with it, and no rows are eliminated.
  [[nodiscard]] bool factorise(Complex lambda, std::vector<Block> blocks, int border);
  /// A^-1 r and A^-* r (conjugate transpose).
  [[nodiscard]] Vector solve(const Vector& r) const;
  [[nodiscard]] Vector solve_adjoint(const Vector& r) const;

private:
  struct Link {
    int row = -1;  // equation that gives the eliminated state; -1: the state stays
    int to = -1;   // the state whose rate it is
    double a = 0, b = 0;
  };
  /// [A b; c^* d] with the answers of A alone: v = A^-1 b, w = A^-* c, and d - c^* v, d - w^* b.
  struct Border {
    Vector b, c, v, w;
    Complex d, right, left;
    /// [A b; c^* d]^-1 r, where `rest` answers for A alone.
    template <class Rest>
    [[nodiscard]] Vector solve(const Vector& r, Rest&& rest) const;
    [[nodiscard]] Border adjoint() const { return {c, b, w, v, std::conj(d), std::conj(left), std::conj(right)}; }
  };
  void analyse();
  bool eliminate(Complex lambda, std::vector<Block> blocks, std::vector<Link> links);
  /// Takes row and column n out of the blocks.
  [[nodiscard]] static Border split(std::vector<Block>& blocks, Eigen::Index n);
  [[nodiscard]] Vector solve_inner(const Vector& r) const;
  [[nodiscard]] Vector solve_inner_adjoint(const Vector& r) const;
  /// use(row, entry of A) for column c.
  template <class Use>
  void in_column(int c, Use&& use) const;
  /// What z_q adds to an eliminated state.
  [[nodiscard]] Complex follows(const Link& link) const { return -lambda_ * link.b / link.a; }

  Complex lambda_;
  std::vector<Block> blocks_;
  std::optional<Border> border_;
  std::vector<Link> found_, links_;       // per state: of linearise(), and those that the factors eliminate
  std::vector<int> kept_, row_of_;        // place of a state that stays / row of an equation that stays, or -1
  std::vector<int> place_, block_place_;  // of an entry of a, of blocks, among the reduced values; -1 for a zero
  bool analysed_ = false;
  Eigen::SparseMatrix<Complex> matrix_;
  core::PivotedLu<Complex> lu_;
};

}  // namespace whirl::solve
