#pragma once
// How condensed intervals are joined around a cycle.

#include <mpi.h>

#include <Eigen/Core>
#include <complex>
#include <memory>
#include <optional>
#include <vector>

#include "whirl/problem/thin_blocks.hpp"
#include "whirl/solve/cycle/interval.hpp"
#include "whirl/solve/cycle/time_groups.hpp"

namespace whirl::solve {

/// What a run is made of where its system is linear but for thin forces, to those who do not want it interval by
/// interval. The blocks belong to the problem.
struct ThinRun {
  const problem::ThinBlocks* blocks;
  const Scheme* scheme;
  const std::vector<double>* mesh;               ///< of the whole cycle
  double period;                                 ///< s
  std::vector<const Eigen::MatrixXd*> tangents;  ///< df/dw [r x w] at this rank's points
};

/// The linearised equations of a cycle, this rank's run of intervals; ranks follow one another around the cycle.
///
///     interval i:  A0_i x_i + A_i X_i + columns_i d = y_i       x_(i+1) = last block of X_i, x_N = x_0
///     added rows:  sum rows_i X_i + corner d = y_c              d: period and parameter [nb]
struct Run {
  MPI_Comm comm;
  const TimeGroups& groups;                          ///< each of one rank, those of comm
  Eigen::Index n = 0, borders = 0;                   ///< states, nb
  std::vector<std::unique_ptr<Interval>> intervals;  ///< this rank's
  std::vector<Eigen::MatrixXd> columns;              ///< [mn x nb]
  const std::vector<Eigen::MatrixXd>& rows;          ///< [nb x mn]
  const Eigen::MatrixXd& corner;                     ///< [nb x nb]
  std::optional<ThinRun> thin;
  int multipliers = 24;  ///< looked for at most where M is known by its products

  /// A_i^-1 columns_i of this rank's intervals.
  [[nodiscard]] std::vector<Eigen::MatrixXd> loads() const;
  /// Carries states [n x k] over this rank's intervals; added += rows X [nb x k]. The last nb columns bear these loads,
  /// if there are any.
  void carry(Eigen::MatrixXd& state, Eigen::MatrixXd& added, const std::vector<Eigen::MatrixXd>& loads) const;
  /// Particular solution of this rank's intervals from a start state: `rhs` and, if not null, `x` [intervals m n];
  /// minus the columns times `border` where that is not null. Returns the end state; added += rows X.
  [[nodiscard]] Eigen::VectorXd drive(const double* rhs, const Eigen::VectorXd& start, const Eigen::VectorXd* border,
                                      double* x, Eigen::VectorXd& added) const;
  /// The transposed equations backwards over this rank's intervals: from lambda [n] at their end, with right-hand sides
  /// `rhs` at the nodes if that is not null and sigma [nb] at the added rows,
  ///
  ///     A_i^T z_i = rhs_i + E^T lambda_i - rows_i^T sigma,    lambda_(i-1) = -A0_i^T z_i
  ///
  /// returns lambda before the first of them; `z` (if not null) takes the z_i, seen += columns^T z [nb].
  [[nodiscard]] Eigen::VectorXd drive_back(const double* rhs, const Eigen::VectorXd& lambda,
                                           const Eigen::VectorXd& sigma, double* z, Eigen::VectorXd& seen) const;
};

/// Solves them with the intervals eliminated. Collective throughout.
class Composition {
public:
  Composition() = default;
  Composition(const Composition&) = delete;
  Composition& operator=(const Composition&) = delete;
  virtual ~Composition() = default;

  /// To be called after each change of the run, which must outlive the calls of the others.
  virtual void compose(const Run& run) = 0;
  /// All intervals and the border from their right-hand sides; `border` takes y_c and returns d.
  virtual void solve(const double* rhs, Eigen::VectorXd& border, double* x) = 0;
  /// The transposed system: right-hand sides at the nodes and, in `border`, of the border unknowns; answers at the
  /// equations of all intervals and, in `border`, of the added rows.
  virtual void solve_transposed(const double* rhs, Eigen::VectorXd& border, double* x) = 0;
  /// Multipliers by falling modulus: all, or all above some modulus and at least one below.
  [[nodiscard]] virtual std::vector<std::complex<double>> multipliers() = 0;
  /// The start v [n], of norm one, of the motion of the real multiplier nearest to `mu`.
  [[nodiscard]] virtual Eigen::VectorXd critical_start(double mu) = 0;
  /// M [n x n], on every rank, and true if it is at hand.
  [[nodiscard]] virtual Eigen::MatrixXd monodromy() = 0;
  [[nodiscard]] virtual bool has_monodromy() const = 0;
  /// M v and M^T w [n x k], on every rank.
  [[nodiscard]] virtual Eigen::MatrixXd times(const Eigen::MatrixXd& v) = 0;
  [[nodiscard]] virtual Eigen::MatrixXd times_transposed(const Eigen::MatrixXd& w) = 0;
  /// V [n x p] and M V on every rank: an orthonormal basis that once belonged to the largest multipliers, so that
  /// M ~ (M V) V^T. Empty if none is known.
  virtual void dominant(Eigen::MatrixXd& v, Eigen::MatrixXd& image) = 0;
  /// What V is known by, on every rank, for another composition of as many states; to be taken before compose().
  [[nodiscard]] virtual std::vector<double> warm_start() { return {}; }
  virtual void take_warm_start(const std::vector<double>& /*warm*/) {}
};

/// Multiplies the maps of all intervals into one dense matrix; time-parallel. For up to some hundred states.
[[nodiscard]] std::unique_ptr<Composition> make_dense_composition();
/// Takes the equations apart by modes in time and solves for the changes of the thin forces; wants Run::thin. For
/// machines of many states with sparse blocks.
[[nodiscard]] std::unique_ptr<Composition> make_mode_composition();
/// Never forms the monodromy matrix M: sweeps over the intervals give its products.
[[nodiscard]] std::unique_ptr<Composition> make_sweep_composition();

}  // namespace whirl::solve
