#pragma once
// Newton-Picard Gauss-Seidel for cycles of systems distributed in space.

#include <Eigen/Core>
#include <Eigen/LU>
#include <complex>
#include <memory>
#include <vector>

#include "whirl/problem/system.hpp"
#include "whirl/solve/cycle/periodic_problem.hpp"
#include "whirl/solve/shooting/tableau.hpp"

namespace whirl::solve {

class SparseRungeKutta;
class StepProduct;

struct NewtonPicardOptions {
  int turns = 1;               ///< shaft turns per period of a forced cycle
  bool autonomous = false;     ///< the period is an unknown and a phase condition is added
  double parameter_scale = 1;  ///< physical value of one unit of the scaled parameter
  double state_weight = 1;     ///< squared weight of the mean square scaled state in the arclength
  double radius = 0.3;         ///< multipliers above it are solved by Newton, the rest by Picard iterations
  int picard = 3;              ///< at most so many Picard iterations on the rest per linear solve
  double multiplier_tolerance = 1e-9;
  bool constant_rates = false;  ///< dF/d(dx/dt) depends on nothing but the parameter: explicit stages keep it
};

/// Equations x_(i+1) = phi_i(x_i; T, p) of ShootingProblem, with M known only by its products: the cost grows with the
/// nonzeros of dF/dx instead of n^2.
///
/// One interval: shooting-based. An explicit scheme with one step per interval: finite-difference-based. With V an
/// orthonormal basis of the invariant subspace of the multipliers above `radius`, Q = I - V V^T and the condensed
/// system (I - M) x_0 - E d = R, K x_0 + D d = r_c (d = period, parameter), solve() takes in this order
///
///     q_R, q_E : (I - Q M) q = Q R, Q E by Picard iteration q <- Q M q + Q R
///     [ I - V^T M V   -V^T (E + M q_E) ] [ p ]   [ V^T (R + M q_R) ]
///     [ K V           K q_E + D        ] [ d ] = [ r_c - K q_R     ]
///     x_0 = V p + q_R + q_E d,  then x_(i+1) = G_i x_i + ... forward.
///
/// It preconditions GMRES around multiply(), which is exact: Newton keeps its quadratic convergence, folds stay regular
/// and tangents are exact, while the subspace need not be. V is found by Krylov-Schur at the first linearisation, with
/// a size that follows the radius; then orthogonal subspace iteration V <- orth(M V) keeps it, of which the first one
/// costs nothing, because M V is known. multipliers() takes V as long as it is invariant, two generic vectors find no
/// other multiplier above the radius, and their number stays; else Krylov-Schur again. Source: Lust (1997); van de
/// Vrande (2001), Sec. 3.2 and (3.18), with errata.
class NewtonPicardProblem : public PeriodicProblem {
public:
  /// `tableau` has sequential stages; `steps` per interval of `mesh`. The communicator is that of `system`.
  NewtonPicardProblem(problem::System& system, const NewtonPicardOptions& options, Tableau tableau, int steps,
                      std::vector<double> mesh);
  ~NewtonPicardProblem() override;

  [[nodiscard]] MPI_Comm comm() const override { return system_.comm(); }
  [[nodiscard]] core::Vector make_unknown() const override;
  [[nodiscard]] Vec weights() const override { return weights_.get(); }
  [[nodiscard]] double parameter_scale() const override { return options_.parameter_scale; }
  void residual(Vec u, Vec r) override;
  void linearise(Vec u, Vec row) override;
  /// Each of their digits costs products, and Newton's method needs few of them.
  [[nodiscard]] double linear_tolerance() const override { return 1e-5; }
  void multiply(Vec v, Vec y) override;
  void solve(Vec rhs, Vec x) override;

  /// Degree 1: cycles are given by their states at the ends of the intervals.
  [[nodiscard]] const Scheme& scheme() const override { return scheme_; }
  [[nodiscard]] const std::vector<double>& mesh() const override { return mesh_; }
  [[nodiscard]] const Eigen::VectorXd& state_scale() const override { return whole_scale_; }
  [[nodiscard]] Cycle gather(Vec u) const override;
  [[nodiscard]] core::Vector scatter(const Cycle& cycle) const override;
  [[nodiscard]] Cycle orbit(Vec u) override;
  [[nodiscard]] const Scheme& orbit_scheme() const override { return quintic(); }
  /// sum h_i <x_i - ref_i, ref'_i> = 0 from now on.
  void set_phase_reference(const Cycle& reference) override;
  [[nodiscard]] double period_scale() const override { return period_scale_; }

  /// All multipliers above the radius, and at least one below; renews the subspace.
  [[nodiscard]] std::vector<std::complex<double>> multipliers() override;
  /// `mu` is above the radius.
  [[nodiscard]] Eigen::MatrixXd critical_motion(double mu) override;
  /// Size of the subspace, and products of the monodromy matrix with a vector since the start.
  [[nodiscard]] Eigen::Index subspace() const { return basis_.cols(); }
  [[nodiscard]] long products() const { return products_; }
  /// Whether steps are taken by the structure of the system.
  [[nodiscard]] bool structured() const;

private:
  [[nodiscard]] Eigen::Index intervals() const { return static_cast<Eigen::Index>(mesh_.size()) - 1; }
  [[nodiscard]] double length(Eigen::Index i) const;
  [[nodiscard]] double angle(double s) const;
  [[nodiscard]] Eigen::VectorXd border_of(Vec u) const;
  /// Columns [local x k] of every rank as [n x k] on all ranks.
  [[nodiscard]] Eigen::MatrixXd whole(const Eigen::MatrixXd& columns) const;
  [[nodiscard]] double begin_point(const Eigen::VectorXd& border);
  struct Links {
    Eigen::VectorXd u;                            // where: this rank's unknowns
    std::vector<std::vector<StepProduct>> steps;  // per interval
    std::vector<Eigen::MatrixXd> columns;         // dR/d(border) per interval [local x nb]
  };
  void march(Eigen::Index i, double period, Vec x, Links* links);
  void march_all(Vec u, double period, Eigen::MatrixXd& ends, Links* links);
  void sum(Eigen::MatrixXd& values) const;
  /// Each column of v [local x k] over interval i.
  void apply(Eigen::Index i, Eigen::MatrixXd& v) const;
  Eigen::MatrixXd monodromy_times(const Eigen::MatrixXd& v, Eigen::MatrixXd& added) const;
  [[nodiscard]] Eigen::MatrixXd complement(const Eigen::MatrixXd& v) const;
  Eigen::MatrixXd picard(const Eigen::MatrixXd& right, Eigen::MatrixXd& image, Eigen::MatrixXd& added) const;
  void orthonormalise(Eigen::MatrixXd& v, Eigen::Index from) const;
  std::vector<std::complex<double>> find_subspace();
  std::vector<std::complex<double>> settled_multipliers();
  void find_image();
  void prepare();

  problem::System& system_;
  NewtonPicardOptions options_;
  int steps_;
  Scheme scheme_;
  std::vector<double> mesh_;
  std::unique_ptr<SparseRungeKutta> stepper_;
  Eigen::Index local_, borders_;  // this rank's states; 1 or 2
  bool last_;
  double period_scale_ = 0, phase_offset_ = 0;
  Eigen::VectorXd scale_, whole_scale_;  // of this rank's states, of all
  core::Vector weights_, work_;
  Eigen::MatrixXd phase_row_;  // [local x N]

  // The linearisation.
  Links links_, next_;                           // of the linearisation, and of the last residual if they are free
  std::vector<Eigen::MatrixXd> rows_;            // added rows per interval, transposed [local x nb]
  Eigen::MatrixXd corner_, ends_, ends_added_;   // E [local x nb], and what it adds to the rows
  Eigen::MatrixXd basis_, image_, basis_added_;  // V, M V, and what these motions add to the rows
  Eigen::MatrixXd q_ends_, image_q_ends_;
  double contraction_ = 0;  // of the error of V by one iteration, as last seen
  Eigen::PartialPivLU<Eigen::MatrixXd> small_;
  mutable long products_ = 0;
  int solves_ = 0;  // since the linearisation: many mean that the subspace is stale
};

}  // namespace whirl::solve
