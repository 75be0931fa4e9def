#pragma once
// Cycles of systems that are spread over ranks: what joins their intervals.

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "whirl/core/dense_lu.hpp"
#include "whirl/solve/cycle/orbit_problem.hpp"

namespace whirl::solve {

struct NewtonPicardOptions {
  int turns = 1;               ///< shaft turns per period of a forced cycle
  bool autonomous = false;     ///< the period is an unknown and a phase condition is added
  double parameter_scale = 1;  ///< physical value of one unit of the scaled parameter
  double state_weight = 1;     ///< squared weight of the mean square scaled state in the arclength
  double radius = 0.3;         ///< multipliers above it are solved by Newton, the rest by Picard iterations
  int multipliers = 1 << 20;   ///< at most so many of them, the largest, are searched for
  int picard = 3;              ///< at most so many Picard iterations on the rest per linear solve
  double multiplier_tolerance = 1e-9;
  bool constant_rates = false;  ///< dF/d(dx/dt) depends on nothing but the parameter
};

/// Cycles whose unknowns are this rank's rows of the states at the nodes of its group's intervals. What the equations
/// of an interval are is told by derived classes; eliminated, they give X_i = -A_i^-1 A0_i x_i + ... and x_(i+1) as its
/// last block, so that the monodromy matrix M is known by its products only: sweeps of a state through all intervals.
///
/// With V an orthonormal basis of the invariant subspace of the multipliers above `radius`, Q = I - V V^T and the
/// condensed system (I - M) x_0 - E d = R, K x_0 + D d = r_c (d = period, parameter), solve() takes in this order
///
///     q_R, q_E : (I - Q M) q = Q R, Q E by Picard iteration q <- Q M q + Q R
///     [ I - V^T M V   -V^T (E + M q_E) ] [ p ]   [ V^T (R + M q_R) ]
///     [ K V           K q_E + D        ] [ d ] = [ r_c - K q_R     ]
///     x_0 = V p + q_R + q_E d,  then the intervals forward.
///
/// It preconditions GMRES around multiply(), which is exact: Newton keeps its quadratic convergence, folds stay regular
/// and tangents are exact, while the subspace need not be. V is found by products of blocks at the first linearisation,
/// with a size that follows the radius; then orthogonal subspace iteration V <- orth(M V) keeps it, of which the first
/// one costs nothing, because M V is known. multipliers() takes V as long as it is invariant, two generic vectors find
/// no other multiplier above the radius, and their number stays; else it is found again. Source: Lust (1997); van de
/// Vrande (2001), Sec. 3.2 and (3.18), with errata.
///
/// Groups of ranks share the intervals: each evaluates and linearises its own, and sweeps go from group to group. A
/// Cycle has this rank's rows at the nodes of all intervals, the same in all groups.
class SpreadCycle : public OrbitProblem {
public:
  void residual(Vec u, Vec r) override;
  void linearise(Vec u, Vec row) override;
  /// Each of their digits costs products, and Newton's method needs few of them.
  [[nodiscard]] double linear_tolerance() const override { return 1e-5; }
  void multiply(Vec v, Vec y) override;
  void solve(Vec rhs, Vec x) override;

  /// All multipliers above the radius, and at least one below, or the largest if there are more than the options say;
  /// renews the subspace. Where a dense band of them lies above the radius, this is 0.5 from here on.
  [[nodiscard]] std::vector<std::complex<double>> multipliers() override;
  /// The radius, so that a branch that goes on later looks for the same multipliers.
  [[nodiscard]] std::vector<double> warm_start() override { return {radius_}; }
  void take_warm_start(const std::vector<double>& warm) override {
    if (warm.size() == 1) radius_ = warm.front();  // longer ones are those of cycles that one rank holds
  }
  /// `mu` is above the radius.
  [[nodiscard]] Eigen::MatrixXd critical_motion(double mu) override;
  /// Empty unless the subspace has it.
  [[nodiscard]] Eigen::VectorXcd multiplier_vector(std::complex<double> mu) override;
  [[nodiscard]] Eigen::MatrixXd times(const Eigen::MatrixXd& v) override;
  [[nodiscard]] std::optional<Eigen::MatrixXd> matrix_of_period() override { return {}; }
  void dominant(Eigen::MatrixXd& v, Eigen::MatrixXd& image) override { v = basis_, image = image_; }
  [[nodiscard]] Path forward(const Eigen::VectorXd& v) const override;
  [[nodiscard]] Path forced(const Eigen::MatrixXd& y, Eigen::VectorXd& end) const override;
  [[nodiscard]] std::vector<Eigen::MatrixXd> tangents(Vec u, double step, const Path& a,
                                                      const std::vector<const Path*>& b) override;
  /// Size of the subspace, and products of the monodromy matrix with a vector since the start.
  [[nodiscard]] Eigen::Index subspace() const { return basis_.cols(); }
  [[nodiscard]] long products() const { return products_; }

protected:
  /// With `inexact`, products of intervals are solved by iteration: those that only precondition take few digits, as
  /// rough() tells.
  SpreadCycle(problem::System& system, const NewtonPicardOptions& options, Scheme scheme, std::vector<double> mesh,
              bool inexact, const TimeGroups& groups);

  // What a derived class tells of its group's intervals. Collective on the system's communicator; states are scaled,
  // this rank's rows.

  /// The parameter of the system has changed.
  virtual void refresh() = 0;
  /// R [m local x N] at nodes x.
  virtual void residuals(const Eigen::MatrixXd& x, double period, Eigen::MatrixXd& r) = 0;
  /// Takes A0_i, A_i and columns(i) at nodes x.
  virtual void linearise_intervals(const Eigen::MatrixXd& x, double period) = 0;
  /// X = A_i^-1 (rhs - A0_i start) [m local x k]; `rhs` may be null. With `rest` the start is zero.
  [[nodiscard]] virtual Eigen::MatrixXd advance(Eigen::Index i, const Eigen::MatrixXd& start,
                                                const Eigen::MatrixXd* rhs, bool rest) const = 0;
  /// The derivative of R at nodes x along each of the motions b, given at the nodes like x: [m local x N] each. The
  /// linearisation stays.
  [[nodiscard]] virtual std::vector<Eigen::MatrixXd> tangents_at(const Eigen::MatrixXd& x, double period,
                                                                 const std::vector<Eigen::MatrixXd>& b) = 0;
  /// x'(s) of a reference at node l = 1..m of interval i, in scaled states [local]; `x` are its nodes.
  [[nodiscard]] virtual Eigen::VectorXd reference_rate(const Eigen::MatrixXd& x, double period, Eigen::Index i,
                                                       Eigen::Index l) = 0;

  [[nodiscard]] Eigen::MatrixXd reference_rates(const Cycle& reference) override;

  [[nodiscard]] const NewtonPicardOptions& options() const { return options_; }
  [[nodiscard]] bool rough() const { return rough_; }
  /// Sets the parameter and returns the period.
  [[nodiscard]] double begin_point(const Eigen::VectorXd& border);
  /// A vector of this rank's states, for whoever needs one for a moment.
  [[nodiscard]] Vec work() const { return work_.get(); }

private:
  /// The sum of what stands at one time over the ranks of the system.
  void sum(Eigen::MatrixXd& values) const;
  /// state := that after interval i, added += rows X.
  void carry(Eigen::Index i, Eigen::MatrixXd& state, const Eigen::MatrixXd* rhs, bool rest,
             Eigen::MatrixXd& added) const;
  [[nodiscard]] Path driven(const Eigen::VectorXd& start, const Eigen::MatrixXd* y, Eigen::VectorXd& end) const;
  Eigen::MatrixXd monodromy_times(const Eigen::MatrixXd& v, Eigen::MatrixXd& added) const;
  [[nodiscard]] Eigen::MatrixXd complement(const Eigen::MatrixXd& v) const;
  Eigen::MatrixXd picard(const Eigen::MatrixXd& right, Eigen::MatrixXd& image, Eigen::MatrixXd& added) const;
  std::vector<std::complex<double>> find_subspace();
  std::vector<std::complex<double>> refined_multipliers();
  void find_image();
  void prepare();

  NewtonPicardOptions options_;
  double radius_;         // multipliers above it are found
  bool limited_ = false;  // and there are more than were asked for
  bool inexact_, rough_ = false;
  core::Vector work_;

  // The linearisation.
  Eigen::MatrixXd ends_, ends_added_;            // E [local x nb], and what it adds to the rows
  Eigen::MatrixXd basis_, image_, basis_added_;  // V, M V, and what these motions add to the rows
  Eigen::MatrixXd q_ends_, image_q_ends_;
  bool image_known_ = false, rough_image_ = false;  // the same on all ranks: sizes are not, some have no states
  bool exact_ = false;                              // multipliers() left V and M V
  double contraction_ = 0;                          // of the error of V by one iteration, as last seen
  core::DenseLu<double> small_;
  mutable long products_ = 0;
  int solves_ = 0;  // since the linearisation: many mean that the subspace is stale
};

}  // namespace whirl::solve
