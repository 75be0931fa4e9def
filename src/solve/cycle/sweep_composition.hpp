#pragma once
// How sweeps join the intervals of a cycle.

#include <complex>
#include <optional>
#include <vector>

#include "whirl/core/dense_lu.hpp"
#include "whirl/core/shell.hpp"
#include "whirl/solve/cycle/composition.hpp"

namespace whirl::solve {

/// The small system of a cycle by GMRES: a product with M is one sweep of a state over all intervals, from rank to
/// rank. It is preconditioned by the answer for M ~ (M V) V^T with V a basis of the dominant invariant subspace, found
/// with the multipliers of the last point: what is left of M is contracted by each turn.
///
///     [ I - M V V^T   -Theta     ] [ x_0 ]         x_0 = t + M V z + Theta d,  z = V^T x_0:
///     [ K V V^T       D + corner ] [ d   ]         [ I - V^T M V   -V^T Theta ] [ z ]   [ V^T t ]
///                                                  [ K V           D + corner ] [ d ] = [ y_c   ]
///
/// The small vectors live on the last rank, where a turn ends; the intervals are factorised on all ranks at once, the
/// sweeps go through the ranks in turn.
class SweepComposition final : public Composition {
public:
  void compose(const Run& run) override;
  void solve(const double* rhs, Eigen::VectorXd& border, double* x) override;
  void solve_transposed(const double* rhs, Eigen::VectorXd& border, double* x) override;
  std::vector<std::complex<double>> multipliers() override;
  Eigen::VectorXd critical_start(double mu) override;
  Eigen::MatrixXd monodromy() override { return times(Eigen::MatrixXd::Identity(run_->n, run_->n)); }
  bool has_monodromy() const override { return false; }
  Eigen::MatrixXd times(const Eigen::MatrixXd& v) override;
  Eigen::MatrixXd times_transposed(const Eigen::MatrixXd& w) override;
  void dominant(Eigen::MatrixXd& v, Eigen::MatrixXd& image) override;
  std::vector<double> warm_start() override;
  void take_warm_start(const std::vector<double>& warm) override { taken_ = warm; }

private:
  [[nodiscard]] bool last() const { return rank_ == size_ - 1; }
  [[nodiscard]] Eigen::Index local() const { return last() ? run_->n : 0; }
  void set_up(const Run& run);
  // Once around: `state` [n x columns] is read on the last rank; it and the rows' sums [nb x columns] are left on all.
  void turn(Eigen::MatrixXd& state, Eigen::MatrixXd& added, const std::vector<Eigen::MatrixXd>& loads = {}) const;
  // Once around backwards: lambda [n x 1] and sigma are read on the last rank; lambda, sigma and `seen` [nb], the
  // sum of all ranks, are left on all.
  void turn_back(const double* rhs, Eigen::MatrixXd& lambda, Eigen::VectorXd& sigma, double* z,
                 Eigen::VectorXd& seen) const;
  // The last rank's on all, and the sum of all.
  template <class Values>
  void share(Values& v) const {
    if (size_ > 1) MPI_Bcast(v.data(), static_cast<int>(v.size()), MPI_DOUBLE, size_ - 1, run_->comm);
  }
  template <class Values>
  void sum(Values& v) const {
    MPI_Allreduce(MPI_IN_PLACE, v.data(), static_cast<int>(v.size()), MPI_DOUBLE, MPI_SUM, run_->comm);
  }
  void prepare();
  // The small system, and what its preconditioner makes of a vector.
  void multiply(Vec v, Vec y) const;
  void multiply_transposed(Vec v, Vec y) const;
  void precondition(Vec v, Vec y, bool transposed) const;

  const Run* run_ = nullptr;
  int rank_ = 0, size_ = 1;
  std::vector<Eigen::MatrixXd> loads_;  // A_i^-1 columns_i
  // On the last rank.
  Eigen::MatrixXd basis_, image_, basis_added_;  // V, M V [n x p], K V [nb x p]
  Eigen::MatrixXd ends_, ends_added_;            // Theta [n x nb], D + corner [nb x nb]
  core::DenseLu<double> small_;
  static constexpr double first_radius = 0.2;
  double radius_ = first_radius;              // multipliers above it are found
  std::optional<std::vector<double>> taken_;  // a warm start that waits for the next run: radius, then V
  bool found_ = false;                        // the last search for multipliers left its basis
  core::Gate gate_{MPI_COMM_SELF};
  core::Matrix shell_;
  core::Vector right_, answer_;
  core::LinearSolver solver_;
};

}  // namespace whirl::solve
