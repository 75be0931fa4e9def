#pragma once
// Periodic solutions by orthogonal collocation, parallel over the intervals.

#include <complex>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "whirl/problem/scaled_point.hpp"
#include "whirl/solve/cycle/composition.hpp"
#include "whirl/solve/cycle/interval.hpp"
#include "whirl/solve/cycle/orbit_problem.hpp"
#include "whirl/solve/newton/adjoint.hpp"

namespace whirl::solve {

class CycleMatrix;
class FilmMarch;

struct CycleOptions {
  int degree = 2;
  Points points = Points::radau;
  int turns = 1;               ///< shaft turns per period of a forced cycle
  bool autonomous = false;     ///< no forcing: the period is an unknown and a phase condition is added
  double parameter_scale = 1;  ///< physical value of one unit of the scaled parameter
  double state_weight = 1;     ///< squared weight of the mean square scaled state in the arclength
  bool use_structure = true;   ///< condense with what the system tells of its structure
  /// How intervals are joined: by one dense matrix of all states, by sweeps of single states over all intervals, by
  /// time modes (Radau points, no own states of films), or by whichever costs less by the counts of core::cost: of
  /// all, or of the first two, which take intervals of any kind.
  enum class Joining { cheapest, dense, sweeps, modes, one_by_one } joining = Joining::cheapest;
  /// Where M is known by its products: multipliers above 0.2 that are looked for, the largest.
  int multipliers = 24;
  double mesh_tolerance = 0;  ///< error per interval for adapt(); 0 keeps the mesh
  int base_intervals = 0;     ///< adapt() never makes a mesh coarser than this uniform one; 0: its longest interval
  int max_intervals = 400;
};

/// Equations F(2 pi k s, x(s), x'(s)/T; p) = 0 at the collocation points of all intervals, with x(0) = x(1).
///
/// Each rank of `time` holds a whole System on a communicator of size 1 and a run of intervals. Unknowns per interval:
/// X_1..X_m at its nodes; its start is its left neighbour's X_m. The condensation eliminates each interval to x_(i+1) =
/// Gamma_i x_i + ..., multiplies these along the rank's run, gathers one small system from all ranks and solves it
/// together with the border (parameter, period, added rows), so that folds are regular. Products of Gamma lose log10 of
/// the largest multiplier in digits, which GMRES around it restores.
class CycleProblem : public OrbitProblem, public Adjoint {
public:
  /// `local` lives on a communicator of size 1 and outlives this.
  CycleProblem(MPI_Comm time, problem::System& local, const CycleOptions& options, std::vector<double> mesh);
  ~CycleProblem() override;

  void residual(Vec u, Vec r) override;
  [[nodiscard]] bool settles() const override;
  bool settle(Vec u) override;
  void linearise(Vec u, Vec row) override;
  void solve(Vec rhs, Vec x) override;
  [[nodiscard]] Mat matrix() override;
  /// "orbit": the states at all points of time.
  [[nodiscard]] std::vector<problem::Field> fields() const override;
  bool adapt(core::Vector& u, core::Vector& tangent) override;
  void equations_changed() override { kept_valid_ = false; }
  [[nodiscard]] std::vector<double> warm_start() override { return composition_->warm_start(); }
  void take_warm_start(const std::vector<double>& warm) override { composition_->take_warm_start(warm); }

  [[nodiscard]] const CycleOptions& options() const { return options_; }
  /// All of them, or where M is known by its products those above 0.2 and one below, at most CycleOptions::multipliers;
  /// where a dense band of them lies above 0.2, those above 0.5.
  [[nodiscard]] std::vector<std::complex<double>> multipliers() override;
  [[nodiscard]] Eigen::MatrixXd critical_motion(double mu) override;
  [[nodiscard]] Eigen::VectorXcd multiplier_vector(std::complex<double> mu) override;
  [[nodiscard]] Eigen::MatrixXd times(const Eigen::MatrixXd& v) override { return composition_->times(v); }
  [[nodiscard]] std::optional<Eigen::MatrixXd> matrix_of_period() override {
    return composition_->has_monodromy() ? std::optional(composition_->monodromy()) : std::nullopt;
  }
  void dominant(Eigen::MatrixXd& v, Eigen::MatrixXd& image) override { composition_->dominant(v, image); }
  /// Monodromy matrix [n x n] over one period at the last linearisation, in scaled states; the same copy on every rank.
  /// Large with own states of films, where nothing else forms it. Collective.
  [[nodiscard]] Eigen::MatrixXd monodromy() const;

  /// What joins the intervals, which knows products of monodromy(). Collective.
  [[nodiscard]] Composition& composition() { return *composition_; }

  /// Solution of the linearised equations over one period from the scaled start v [n], at the nodes like Cycle::x but
  /// scaled [n x N m]; its last column is monodromy() v. Collective.
  [[nodiscard]] Eigen::MatrixXd propagate(const Eigen::VectorXd& v) const;

  // Adjoint equations and second derivatives along the cycle.

  void solve_transposed(Vec rhs, Vec x) override;
  void curvature(Vec u, Vec v, Vec w, Vec out) override;
  [[nodiscard]] bool has_adjoint() const override { return true; }
  [[nodiscard]] std::unique_ptr<Condition> condition(Event event, std::complex<double> critical) override;
  [[nodiscard]] Path forward(const Eigen::VectorXd& v) const override;
  [[nodiscard]] Path forced(const Eigen::MatrixXd& y, Eigen::VectorXd& end) const override;
  /// Weights [mn x local intervals] of the equations with w . monodromy() v = -(sum weights . dR V) for changes dR of
  /// the linearised equations along the motion V = forward(v). Collective.
  [[nodiscard]] Eigen::MatrixXd backward(const Eigen::VectorXd& w) const;
  /// Gradients [layout of u] of sum_i weights_i . dR_i/dx(u) V, one for each `weights`: those of -w . monodromy() v.
  [[nodiscard]] std::vector<core::Vector> gradients(Vec u, const Path& v, const std::vector<Eigen::MatrixXd>& weights);
  [[nodiscard]] std::vector<Eigen::MatrixXd> tangents(Vec u, double step, const Path& a,
                                                      const std::vector<const Path*>& b) override;

protected:
  /// False where the equations of an interval are not those of collocation, and films cannot settle in it by
  /// themselves.
  [[nodiscard]] virtual bool collocates() const { return true; }
  /// What an interval's equations are; the scheme's collocation unless a derived problem says otherwise. `i` counts
  /// this rank's intervals, `own` are the scaled values at its nodes [n x m], `start` is the state before them. Not
  /// collective; thrown errors are agreed by the caller.
  virtual void interval_residual(Eigen::Index i, const double* own, const Eigen::VectorXd& start, double period,
                                 double* out);
  /// The linearised interval, with dR/d(period, parameter) [mn x borders] in `columns`.
  [[nodiscard]] virtual std::unique_ptr<Interval> linearise_interval(Eigen::Index i, const double* own,
                                                                     const Eigen::VectorXd& start, double period,
                                                                     Eigen::MatrixXd& columns);
  /// Transposed tangents of interval i at the given states for each column of y [mn x k]: own [mn x k] +=
  /// (dR/dX)^T y, before [n x k] += (dR/dx_start)^T y, border [nb x k] += (dR/d(period, parameter))^T y.
  virtual void interval_transposed(Eigen::Index i, const double* own, const Eigen::VectorXd& start, double period,
                                   const Eigen::MatrixXd& y, Eigen::MatrixXd& to_own, Eigen::MatrixXd& to_start,
                                   Eigen::MatrixXd& to_border);
  /// dR/dX d_own + dR/dx_start d_start [mn x k] of interval i at the given states; d_own [mn x k], d_start [n x k].
  [[nodiscard]] virtual Eigen::MatrixXd interval_tangent(Eigen::Index i, const double* own,
                                                         const Eigen::VectorXd& start, double period,
                                                         const Eigen::MatrixXd& d_own, const Eigen::MatrixXd& d_start);
  /// x'(s) in SI at node l = 1..m of interval g of the whole mesh, for the phase condition.
  [[nodiscard]] virtual Eigen::VectorXd reference_rate(const Cycle& reference, Eigen::Index g, Eigen::Index l);

  /// Shaft angle at t in [0, 1] of this rank's interval i; 0 on an autonomous cycle.
  [[nodiscard]] double angle_at(Eigen::Index i, double t) const { return angle(begin(i) + length(i) * t); }
  [[nodiscard]] double interval_length(Eigen::Index i) const { return length(i); }
  [[nodiscard]] problem::ScaledPoint& point() { return point_; }

private:
  [[nodiscard]] const Eigen::MatrixXd& columns(Eigen::Index i) const override {
    return run_.columns[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] Eigen::VectorXd product(Eigen::Index i, const Eigen::VectorXd& start,
                                        const Eigen::VectorXd& x) const override {
    return run_.intervals[static_cast<std::size_t>(i)]->multiply(start, x);
  }
  [[nodiscard]] Eigen::MatrixXd reference_rates(const Cycle& reference) override;
  void forget_mesh() override;
  [[nodiscard]] Eigen::VectorXd previous_end(const double* own) const;
  /// Sets the parameter and returns the period.
  double begin_point(const Eigen::VectorXd& border);
  void interpolate(Eigen::Index i, Eigen::Index j, const double* own, const Eigen::VectorXd& start, double period,
                   Eigen::VectorXd& value, Eigen::VectorXd& slope) const;
  /// d/d(period, parameter) of the equations at one point [n x borders], from dF/dp and (dF/d(dx/dt)) x'.
  [[nodiscard]] Eigen::MatrixXd border_columns(const Eigen::VectorXd& d_parameter, const Eigen::VectorXd& rate,
                                               double period) const;
  void keep(const core::ReadArray& u, const Eigen::VectorXd& before, const Eigen::VectorXd& border);
  [[nodiscard]] bool same_as_kept(const core::ReadArray& u, const Eigen::VectorXd& before,
                                  const Eigen::VectorXd& border) const;

  void displaced(Vec u, double step, const Path& along,
                 const std::function<void(Eigen::Index, const double*, const Eigen::VectorXd&, double)>& work);
  [[nodiscard]] Path path_of(Vec v) const;
  [[nodiscard]] Path driven(const Eigen::VectorXd& start, const double* rhs, Eigen::VectorXd& end) const;
  [[nodiscard]] static double largest(const Path& path, MPI_Comm comm);

  /// How an interval is condensed.
  enum class Way { dense, low_rank, own_states, sparse };
  [[nodiscard]] static Way way_of(const CycleOptions& options, problem::BlockStructure* structure,
                                  std::size_t intervals);

  problem::BlockStructure* structure_;
  CycleOptions options_;
  Way way_;
  problem::ScaledPoint point_;

  // What residual() or linearise() kept of the points, which spares linearise() at the same u their evaluation.
  std::vector<problem::PointState> kept_;
  Eigen::VectorXd kept_u_, kept_before_, kept_border_;
  bool kept_valid_ = false;
  Eigen::VectorXd value_, slope_;  // work space

  // The linearisation: linear parts by length, intervals, border columns, and how they are joined.
  std::map<double, std::shared_ptr<const LinearPart>> parts_;
  problem::ThinBlocks thin_;
  std::map<double, std::shared_ptr<const SparsePart>> sparse_parts_;
  Run run_;
  std::unique_ptr<Composition> composition_;
  std::unique_ptr<CycleMatrix> matrix_;  // once it was asked for
  bool linearised_ = false;              // run_ is whole
  std::unique_ptr<FilmMarch> march_;
};

}  // namespace whirl::solve
