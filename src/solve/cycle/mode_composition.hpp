#pragma once
// A cycle of a machine that is linear but for thin forces, solved in its forces.

#include <memory>
#include <vector>

#include "solve/cycle/pencil.hpp"
#include "solve/cycle/time_modes.hpp"
#include "whirl/core/shell.hpp"
#include "whirl/solve/cycle/composition.hpp"

namespace whirl::solve {

/// With S_j = df/dw at point j and their mean S_0 over the cycle, the linearised equations are
///
///     W X - B (S - S_0) C X + columns d = y,     W = V x (L0 - B S_0 C) + D x L1,     rows X + corner d = y_c.
///
/// W has constant coefficients, so that time modes take it apart into sparse matrices of the size of the states, on
/// meshes whose intervals do not differ much; compose() throws core::NotConverged on others. H = V C W^-1 B, from
/// forces to inputs, is the receptance C (L0 - B S_0 C + lambda_k L1)^-1 B of each mode. Unknown are the changes f = (S
/// - S_0) C X of the forces at all points and the border:
///
///     [ I - (S - S_0) H   (S - S_0) C W^-1 columns     ] [ f ]   [ (S - S_0) C W^-1 y ]
///     [ rows W^-1 B       corner - rows W^-1 columns   ] [ d ] = [ y_c - rows W^-1 y  ]
///
/// by GMRES, dense where that fails. Products with M, which multipliers need, are sweeps over the intervals. Each rank
/// holds a share of the modes; every rank solves the small system alike and takes rank 0's answer.
class ModeComposition final : public Composition {
public:
  void compose(const Run& run) override;
  void solve(const double* rhs, Eigen::VectorXd& border, double* x) override;
  void solve_transposed(const double* rhs, Eigen::VectorXd& border, double* x) override;
  std::vector<std::complex<double>> multipliers() override { return sweeps().multipliers(); }
  Eigen::VectorXd critical_start(double mu) override { return sweeps().critical_start(mu); }
  Eigen::MatrixXd monodromy() override { return sweeps().monodromy(); }
  bool has_monodromy() const override { return false; }
  Eigen::MatrixXd times(const Eigen::MatrixXd& v) override { return sweeps().times(v); }
  Eigen::MatrixXd times_transposed(const Eigen::MatrixXd& w) override { return sweeps().times_transposed(w); }
  void dominant(Eigen::MatrixXd& v, Eigen::MatrixXd& image) override { sweeps().dominant(v, image); }
  std::vector<double> warm_start() override;
  void take_warm_start(const std::vector<double>& warm) override;

private:
  /// S - S_0 of one force and one input at all points.
  struct Change {
    Eigen::Index force, input;
    Eigen::ArrayXd values;
  };

  Composition& sweeps();
  void set_up();
  void gather_tangents(Eigen::MatrixXd& mean);
  void find_receptances();
  void find_border();
  // Between this rank's nodes or points [n x local] and its lanes [2 lanes x n].
  [[nodiscard]] Eigen::MatrixXd to_lanes(const Eigen::MatrixXd& by_point, const double* y) const;
  void to_points(const Eigen::MatrixXd& by_point, const Eigen::MatrixXd& lanes, double* x) const;
  // The same for a few functions of time, known at all points on all ranks: [2 lanes x few] and [P x few].
  [[nodiscard]] Eigen::MatrixXd own_lanes(const Eigen::MatrixXd& by_point, const Eigen::MatrixXd& y) const;
  [[nodiscard]] Eigen::MatrixXd all_points(const Eigen::MatrixXd& by_point, const Eigen::MatrixXd& lanes) const;
  // (S - S_0) inputs and H forces at all points, and their transposes.
  [[nodiscard]] Eigen::MatrixXd changes(const Eigen::MatrixXd& v, bool transposed = false) const;
  [[nodiscard]] Eigen::MatrixXd receptance(const Eigen::MatrixXd& v, bool transposed = false) const;
  [[nodiscard]] double dot(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) const;
  // The small system: `forces` [P x r] and `border` hold the right-hand sides and take the answers.
  void small_solve(Eigen::MatrixXd& forces, Eigen::VectorXd& border, bool transposed);
  void small_product(const double* x, double* y, bool transposed) const;

  const Run* run_ = nullptr;
  int rank_ = 0, size_ = 1;
  std::vector<double> mesh_;
  Eigen::Index points_ = 0, first_ = 0, local_ = 0;  // points of the cycle, this rank's
  std::vector<int> counts_;                          // points of each rank
  TimeModes modes_;
  Pencil pencil_;
  std::vector<Change> changes_;
  Eigen::MatrixXd transfer_;  // column b + w a: from force a to input b at each mode [2 shares lanes x w r]
  // For each unknown of the border: the column in lanes, W^-1 of it, (S - S_0) C W^-1 of it; the same for the rows.
  std::vector<Eigen::MatrixXd> column_, column_answer_, column_forces_, row_, row_answer_, row_forces_;
  Eigen::MatrixXd corner_;
  bool with_rows_ = false;
  std::unique_ptr<Composition> sweeps_;
  bool swept_ = false;
  core::Gate gate_{PETSC_COMM_SELF};
  core::Matrix shell_;
  core::Vector right_, answer_;
  core::LinearSolver solver_;
};

}  // namespace whirl::solve
