#pragma once
// alpha dF/du + sigma dF/d(du/dt) of a machine that tells its structure, and its inverse: no matrix of all states is
// made.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "whirl/core/dense_lu.hpp"
#include "whirl/core/pivoted_lu.hpp"
#include "whirl/core/sparse_lu.hpp"
#include "whirl/problem/scaled_point.hpp"
#include "whirl/problem/structure.hpp"

namespace whirl::transient {

/// A = alpha dF/du + sigma dF/d(du/dt) at one point, in scaled states and residuals.
struct ThinOperator {
  double alpha = 1, sigma = 0;
  double parameter = 0;    ///< of the system there
  long version = 0;        ///< counts its changes
  problem::PointState at;  ///< with tangents
};

/// x = A^-1 y by elimination of what hardly changes from step to step.
///
/// With tau = alpha/sigma, the rotor's part L1 + tau L0 and each film's dg/ds' + tau dg/ds are factorised once and kept
/// while steps and speed are nearly the same; what changes with the place of the journals (r forces) enters by a matrix
/// of size r (Woodbury), at the point itself. What the kept factors are off by is put right by refinement; where that
/// does not converge fast they are made anew. Single rank; throws core::NotConverged if A is singular.
class ThinInverse {
public:
  /// `point` with sparse blocks and `structure` outlive this.
  ThinInverse(const problem::ScaledPoint& point, const problem::BlockStructure& structure)
      : point_(point), structure_(structure) {}

  /// To |y - A x| <= tolerance |y|.
  void solve(const ThinOperator& a, const Eigen::VectorXd& y, Eigen::VectorXd& x, double tolerance = 1e-6);

  /// Makes ready for apply(): the journals' places enter exactly, all else by the factors that are kept, if some are
  /// near, or
  void place(const ThinOperator& a);
  /// by new ones of this very point.
  void factorise_at(const ThinOperator& a) { prepare(a, factorise(a)); }
  /// Whether what was made ready is near a step of alpha/sigma = `tau` at `parameter`.
  [[nodiscard]] bool fits(double tau, double parameter) const;
  /// By how much of an error at most apply() is off for a step of alpha/sigma = `tau` at `parameter`, by the factors
  /// that were made ready: with A = L1 + tau L0 and A_f of those, A_f^-1 A - 1 = (tau/tau_f - 1) (1 - A_f^-1 L1), whose
  /// second factor is near one along stiff directions, zero along soft ones; the part of L0 that goes with the speed is
  /// off by its ratio likewise. Films' own states apart.
  [[nodiscard]] double mismatch(double tau, double parameter) const;
  /// x = about A^-1 y, without refinement.
  void apply(const ThinOperator& a, const Eigen::VectorXd& y, Eigen::VectorXd& x);
  /// Drops all factors.
  void forget();
  /// Factorisations of the rotor's part so far; those of films stand behind them.
  [[nodiscard]] long factorisations() const { return factorisations_; }

private:
  using Sparse = Eigen::SparseMatrix<double>;
  struct Film {
    core::SparseLu lu;         // of dg/ds' + tau dg/ds
    Eigen::MatrixXd by_input;  // its inverse times dg/dw [k x w]
    Eigen::MatrixXd forces;    // df/ds' + tau df/ds [f x k]
  };
  struct Factors {
    double tau = 0, parameter = 0;
    Eigen::MatrixXd inverse;  // of L1 + tau L0 if that is small, or
    std::unique_ptr<core::PivotedLu<double>> sparse;
    Eigen::MatrixXd lead, seen;  // its inverse times B [n x r], and C times that [w x r]
    std::vector<std::unique_ptr<Film>> films;
    long used = 0;
  };

  [[nodiscard]] Factors* nearest(double tau, double parameter);
  Factors& factorise(const ThinOperator& a);
  void factorise_film(const ThinOperator& a, std::size_t which, Film& film) const;
  /// The matrix of size r for the point of `a`.
  void prepare(const ThinOperator& a, Factors& f);
  [[nodiscard]] bool exact(const ThinOperator& a) const;

  const problem::ScaledPoint& point_;
  const problem::BlockStructure& structure_;
  std::vector<std::unique_ptr<Factors>> kept_;
  Factors* now_ = nullptr;  // what was prepared:
  const ThinOperator* prepared_ = nullptr;
  long version_ = -1;
  Eigen::MatrixXd by_input_;                    // df/dw with what the films' states add [r x w]
  Eigen::MatrixXd small_matrix_;                // I - tau by_input C (L1 + tau L0)^-1 B
  Eigen::PartialPivLU<Eigen::MatrixXd> small_;  // not core::DenseLu, whose answers are new vectors
  long factorisations_ = 0, clock_ = 0;
  Eigen::VectorXd left_, more_;                       // work space of the refinement
  Eigen::VectorXd forces_, rhs_, inputs_, by_force_;  // and of apply()
};

}  // namespace whirl::transient
