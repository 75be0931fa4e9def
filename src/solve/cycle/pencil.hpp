#pragma once
// L0 + lambda L1 for many lambda at once: one sparse pattern, the numbers of all lambda side by side.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "whirl/problem/kinematic.hpp"

namespace whirl::solve {

/// Solves (L0 + lambda_k L1) x_k = y_k, L0 and L1 real [n x n], for complex lambda_k, k = 1..lanes.
///
/// Rows alpha x_a' + beta x_b = y_i (as q' = v) are eliminated first, x_b = (y_i - alpha lambda x_a)/beta. What is
/// left,
///
///     T(lambda) = L0_ra + lambda (L1_ra - L0_rb alpha/beta) - lambda^2 L1_rb alpha/beta,
///
/// is lambda^2 M + lambda C + K of a rotor. One minimum-degree ordering and one symbolic factorisation serve all k, and
/// for all later matrices of the same pattern; each number of the LU is an array over k, which fills vector registers.
/// There are no row exchanges: kinematic rows, which have no diagonal, have to be named, and lightly damped parts of
/// the shaft may cost some digits, which an iteration around gives back. Cost for n = 1500 of a shaft, 64 lanes: about
/// 40 000 complex operations a lane to factorise, 12 000 to solve.
class Pencil {
public:
  using Matrix = Eigen::SparseMatrix<double>;

  /// `kinematic` are rows of both. Throws core::NotConverged if a pivot vanishes.
  void compute(const Matrix& l1, const Matrix& l0, const std::vector<problem::KinematicRow>& kinematic,
               const Eigen::ArrayXcd& lambda);
  [[nodiscard]] Eigen::Index size() const { return n_; }
  [[nodiscard]] Eigen::Index lanes() const { return lanes_; }
  /// Number of states eliminated by rows of the form q' = v.
  [[nodiscard]] Eigen::Index eliminated() const { return static_cast<Eigen::Index>(rates_.size()); }

  /// x := (L0 + lambda L1)^-1 x for `columns` right-hand sides at once. Column s of x [2 lanes columns x n] holds state
  /// s: real parts [lanes x columns], then imaginary parts.
  void solve(Eigen::MatrixXd& x, Eigen::Index columns = 1) const;
  /// The same with the conjugate transpose.
  void solve_adjoint(Eigen::MatrixXd& x, Eigen::Index columns = 1) const;

private:
  // Row `row` reads alpha x_a' + beta x_b; places of its values in L1 and L0.
  struct Rate {
    Eigen::Index row, a, b, place_a;
    double alpha, beta;
  };
  // Where an entry of L0 (degree 0) or L1 (degree 1) goes: a slot of the LU, or a coupling with an eliminated state.
  struct Target {
    Eigen::Index slot = -1, rate = -1;
    int degree = 0;
  };
  struct Coupling {
    Eigen::Index place, rate;
    int degree;
    double value;
  };

  void analyse(const Matrix& l1, const Matrix& l0, const std::vector<problem::KinematicRow>& kinematic);
  void take_pairs(const std::vector<problem::KinematicRow>& kinematic);
  void find_slots(const Matrix& pattern);
  void fill(const Matrix& l1, const Matrix& l0);
  void factorise();
  // product = lambda v, both [2 lanes columns] as solve() has them; returns its data.
  const double* times_lambda(const double* v, Eigen::ArrayXd& product) const;
  [[nodiscard]] bool same_pattern(const Matrix& l1, const Matrix& l0) const;
  [[nodiscard]] double* at(Eigen::Index slot) { return lu_.data() + slot * 2 * lanes_; }
  [[nodiscard]] const double* at(Eigen::Index slot) const { return lu_.data() + slot * 2 * lanes_; }

  Eigen::Index n_ = 0, kept_ = 0, lanes_ = 0;
  std::vector<int> pattern_;  // of L1 and L0, to know it again
  std::vector<Rate> rates_;
  std::vector<Eigen::Index> row_, state_;  // rows and states that are kept, by their place in the elimination
  std::vector<Target> targets_;            // of the entries of L0, then of L1
  std::vector<Coupling> couplings_;
  // Row i of the LU: slots begin_[i]..diagonal_[i]-1 of L, the inverse of the pivot, slots of U to begin_[i+1]-1.
  std::vector<Eigen::Index> begin_, diagonal_, column_;
  std::vector<double> coefficients_;  // of 1, lambda, lambda^2 in each slot
  Eigen::ArrayXd lambda_, square_;    // real parts, then imaginary parts [2 lanes]
  Eigen::ArrayXd lu_;                 // [2 lanes x slots]
};

}  // namespace whirl::solve
