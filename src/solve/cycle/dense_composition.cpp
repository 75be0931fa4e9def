#include <cmath>

#include "whirl/core/agree.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/solve/cycle/composition.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::solve {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Runs the condensed recurrence over this rank's intervals, gathers the ranks' maps and factorises the small system
//     [ I - M   -Theta     ] [ x_0 ]   [ t       ]      x_(end) = M x_0 + Theta d + t after one turn
//     [ K       D + corner ] [ d   ] = [ y_c - s ]      added rows = K x_0 + D d + s
class DenseComposition final : public Composition {
public:
  void compose(const Run& run) override;
  void solve(const double* rhs, VectorXd& border, double* x) override;
  void solve_transposed(const double* rhs, VectorXd& border, double* x) override;
  std::vector<std::complex<double>> multipliers() override { return spectral::eigenvalues(run_->comm, monodromy_); }
  VectorXd critical_start(double mu) override;
  MatrixXd monodromy() override { return monodromy_; }
  bool has_monodromy() const override { return true; }
  MatrixXd times(const MatrixXd& v) override { return monodromy_ * v; }
  MatrixXd times_transposed(const MatrixXd& w) override { return monodromy_.transpose() * w; }
  void dominant(MatrixXd& v, MatrixXd& image) override { v = image = MatrixXd(run_->n, 0); }

private:
  const Run* run_ = nullptr;
  int rank_ = 0, size_ = 1;
  std::vector<MatrixXd> to_rank_;    // state entering each rank per (x_0, d) [n x (n + nb)]
  std::vector<MatrixXd> rank_maps_;  // gathered [(n + nb) x (n + nb)] of each rank
  core::DenseLu<double> small_;
  MatrixXd monodromy_;
};

void DenseComposition::compose(const Run& run) {
  run_ = &run;
  rank_ = core::rank_of(run.comm);
  size_ = core::size_of(run.comm);
  const Index n = run.n, nb = run.borders, all = n + nb;
  MatrixXd map = MatrixXd::Zero(all, all), state = MatrixXd::Identity(n, all), added = MatrixXd::Zero(nb, all);
  run.carry(state, added, run.loads());
  map << state, added;

  rank_maps_.assign(static_cast<std::size_t>(size_), map);
  if (size_ > 1) {
    std::vector<double> gathered(static_cast<std::size_t>(all * all * size_));
    MPI_Allgather(map.data(), static_cast<int>(all * all), MPI_DOUBLE, gathered.data(), static_cast<int>(all * all),
                  MPI_DOUBLE, run.comm);
    for (int p = 0; p < size_; ++p)
      rank_maps_[static_cast<std::size_t>(p)] =
          Map<const MatrixXd>(gathered.data() + static_cast<Index>(p) * all * all, all, all);
  }
  MatrixXd entering = MatrixXd::Identity(n, all);
  added.setZero();
  to_rank_.clear();
  for (int p = 0; p < size_; ++p) {
    const MatrixXd& q = rank_maps_[static_cast<std::size_t>(p)];
    to_rank_.push_back(entering);
    if (p == 0) {  // entering is the identity
      added = q.bottomRows(nb);
      entering = q.topRows(n);
      continue;
    }
    added += q.bottomLeftCorner(nb, n) * entering;
    added.rightCols(nb) += q.bottomRightCorner(nb, nb);
    MatrixXd next = q.topLeftCorner(n, n) * entering;
    next.rightCols(nb) += q.topRightCorner(n, nb);
    entering = std::move(next);
  }
  monodromy_ = entering.leftCols(n);
  MatrixXd small(all, all);
  small.topRows(n) = MatrixXd::Identity(n, all) - entering;
  small.bottomRows(nb) = added;
  small.bottomRightCorner(nb, nb) += run.corner;
  small_.compute(small);
}

void DenseComposition::solve(const double* rhs, VectorXd& border, double* x) {
  const Index n = run_->n, nb = run_->borders, all = n + nb;
  // Forward: response of this rank's run to the right-hand side alone.
  VectorXd own(all), s = VectorXd::Zero(nb);
  own.head(n) = run_->drive(rhs, VectorXd::Zero(n), nullptr, nullptr, s);
  own.tail(nb) = s;
  VectorXd gathered = own;
  if (size_ > 1) {
    gathered.resize(all * size_);
    MPI_Allgather(own.data(), static_cast<int>(all), MPI_DOUBLE, gathered.data(), static_cast<int>(all), MPI_DOUBLE,
                  run_->comm);
  }
  VectorXd through = VectorXd::Zero(n), entering = through, added = VectorXd::Zero(nb);
  for (int p = 0; p < size_; ++p) {
    const MatrixXd& q = rank_maps_[static_cast<std::size_t>(p)];
    const auto part = gathered.segment(static_cast<Index>(p) * all, all);
    if (p == rank_) entering = through;
    added += part.tail(nb) + q.bottomLeftCorner(nb, n) * through;
    through = (part.head(n) + q.topLeftCorner(n, n) * through).eval();
  }
  VectorXd small(all);
  small << through, border - added;
  small = small_.solve(small);
  border = small.tail(nb);
  // Back: with the state entering this rank and the border known, each interval follows from its left neighbour.
  entering += to_rank_[static_cast<std::size_t>(rank_)] * small;
  (void)run_->drive(rhs, entering, &border, x, s);
}

// Closes by the transpose of the small system of the forward solve, lambda_N = lambda_0.
void DenseComposition::solve_transposed(const double* rhs, VectorXd& border, double* x) {
  const Index n = run_->n, nb = run_->borders, all = n + nb;
  // Of this rank: adjoint of the state before it, and what its columns see.
  VectorXd part(all), sum = VectorXd::Zero(nb);
  part.head(n) = run_->drive_back(rhs, VectorXd::Zero(n), VectorXd::Zero(nb), nullptr, sum);
  part.tail(nb) = sum;
  VectorXd gathered(all * size_);
  MPI_Allgather(part.data(), static_cast<int>(all), MPI_DOUBLE, gathered.data(), static_cast<int>(all), MPI_DOUBLE,
                run_->comm);
  VectorXd small(all), lambda = VectorXd::Zero(n), seen = VectorXd::Zero(nb);
  for (int p = size_ - 1; p >= 0; --p) {
    const MatrixXd& q = rank_maps_[static_cast<std::size_t>(p)];
    const auto own = gathered.segment(static_cast<Index>(p) * all, all);
    seen += own.tail(nb) - q.topRightCorner(n, nb).transpose() * lambda;
    lambda = (own.head(n) + q.topLeftCorner(n, n).transpose() * lambda).eval();
  }
  small << lambda, border - seen;
  small = small_.solve_transposed(small);
  const VectorXd sigma = small.tail(nb);
  lambda = small.head(n);
  for (int p = size_ - 1; p > rank_; --p) {
    const MatrixXd& q = rank_maps_[static_cast<std::size_t>(p)];
    lambda = (gathered.segment(static_cast<Index>(p) * all, n) + q.topLeftCorner(n, n).transpose() * lambda -
              q.bottomLeftCorner(nb, n).transpose() * sigma)
                 .eval();
  }
  (void)run_->drive_back(rhs, lambda, sigma, x, sum);
  border = sigma;
}

VectorXd DenseComposition::critical_start(double mu) {
  const Index n = run_->n;
  // The shift stands beside the multiplier, where the matrix is regular.
  const core::DenseLu<double> lu(monodromy_ - mu * (1 + 1e-10) * MatrixXd::Identity(n, n));
  VectorXd v(n);
  for (Index k = 0; k < n; ++k) v(k) = std::sin(1.0 + static_cast<double>(k));
  for (int k = 0; k < 4; ++k) v = lu.solve(v).normalized();
  core::share(run_->comm, v.data(), static_cast<std::size_t>(n));
  return v;
}

}  // namespace

std::unique_ptr<Composition> make_dense_composition() {
  return std::make_unique<DenseComposition>();
}

}  // namespace whirl::solve
