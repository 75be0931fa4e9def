#include "solve/cycle/sweep_composition.hpp"

#include <algorithm>
#include <cmath>

#include "solve/cycle/dominant_subspace.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::solve {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// No crossover: up to here all multipliers can be had from the dense matrix where a search for the dominant ones fails,
// at forty times the cost of a point (core::cost). Beyond, a branch that goes on for hours would be no service.
constexpr Index whole_up_to = 1000;

}  // namespace

void SweepComposition::turn(MatrixXd& state, MatrixXd& added, const std::vector<MatrixXd>& loads) const {
  added = MatrixXd::Zero(run_->borders, state.cols());
  share(state);
  run_->groups.in_turn(state, [&] { run_->carry(state, added, loads); });
  sum(added);
}

void SweepComposition::compose(const Run& run) {
  run_ = &run;
  if (!solver_) set_up(run);
  if (taken_) {
    const Index columns = taken_->empty() ? 0 : static_cast<Index>(taken_->size() - 1) / run.n;
    radius_ = taken_->empty() ? first_radius : taken_->front();
    basis_.resize(local(), columns);
    if (columns > 0 && last()) basis_ = Map<const MatrixXd>(taken_->data() + 1, run.n, columns);
    taken_.reset();
  }
  loads_ = run.loads();
  prepare();
}

// Everything of the preconditioner, by one turn of the basis and the border together.
void SweepComposition::prepare() {
  const Index n = run_->n, nb = run_->borders, p = basis_.cols();
  MatrixXd state = MatrixXd::Zero(n, p + nb), added;
  if (last()) state.leftCols(p) = basis_;
  turn(state, added, loads_);
  if (!last()) return;
  image_ = state.leftCols(p);
  basis_added_ = added.leftCols(p);
  ends_ = state.rightCols(nb);
  ends_added_ = added.rightCols(nb) + run_->corner;
  MatrixXd small(p + nb, p + nb);
  small.topRows(p) = MatrixXd::Identity(p, p + nb) - basis_.transpose() * state;
  small.bottomRows(nb) << basis_added_, ends_added_;
  small_.compute(small);
}

void SweepComposition::solve(const double* rhs, VectorXd& border, double* x) {
  const Index n = run_->n, nb = run_->borders;
  // Forward: the motion that the right-hand side alone drives.
  MatrixXd state = MatrixXd::Zero(n, 1);
  VectorXd added = VectorXd::Zero(nb);
  run_->groups.in_turn(state, [&] { state = run_->drive(rhs, state, nullptr, nullptr, added); });
  sum(added);
  {
    const core::WriteArray a(right_.get());
    if (last()) Map<VectorXd>(a.data(), n + nb) << state, border - added;
  }
  gate_.rethrow(KSPSolve(solver_.get(), right_.get(), answer_.get()));
  {
    const core::ReadArray a(answer_.get());
    if (last()) {
      state = Map<const VectorXd>(a.data(), n);
      border = Map<const VectorXd>(a.data() + n, nb);
    }
  }
  share(border);
  // Back: from the start and the border.
  share(state);
  run_->groups.in_turn(state, [&] { state = run_->drive(rhs, state, &border, x, added); });
}

void SweepComposition::turn_back(const double* rhs, MatrixXd& lambda, VectorXd& sigma, double* z,
                                 VectorXd& seen) const {
  seen = VectorXd::Zero(run_->borders);
  share(lambda);
  share(sigma);
  run_->groups.in_turn(
      lambda, [&] { lambda = run_->drive_back(rhs, lambda, sigma, z, seen); }, true);
  sum(seen);
}

void SweepComposition::solve_transposed(const double* rhs, VectorXd& border, double* x) {
  const Index n = run_->n, nb = run_->borders;
  MatrixXd lambda = MatrixXd::Zero(n, 1);
  VectorXd sigma = VectorXd::Zero(nb), seen;
  turn_back(rhs, lambda, sigma, nullptr, seen);
  {
    const core::WriteArray a(right_.get());
    if (last()) Map<VectorXd>(a.data(), n + nb) << lambda, border - seen;
  }
  gate_.rethrow(KSPSolveTranspose(solver_.get(), right_.get(), answer_.get()));
  {
    const core::ReadArray a(answer_.get());
    if (last()) {
      lambda = Map<const VectorXd>(a.data(), n);
      sigma = Map<const VectorXd>(a.data() + n, nb);
    }
  }
  turn_back(rhs, lambda, sigma, x, seen);
  border = sigma;
}

std::vector<std::complex<double>> SweepComposition::multipliers() {
  const Index n = run_->n;
  const auto times_m = [this](const MatrixXd& v) {
    MatrixXd state = MatrixXd::Zero(run_->n, v.cols()), added;
    if (last()) state = v;
    turn(state, added);
    return MatrixXd(state.topRows(local()));
  };
  SubspaceOptions options;
  options.most = run_->multipliers;
  DominantSubspace found;
  try {
    found = dominant_multipliers(run_->comm, times_m, basis_, options, radius_);
  } catch (const core::NotConverged&) {
    if (n > whole_up_to) throw;
    found_ = false;
    return spectral::eigenvalues(run_->comm, monodromy());
  }
  found_ = true;
  basis_ = std::move(found.basis);
  prepare();
  return found.values;
}

// The Ritz vector of V^T M V, which the invariant subspace makes an eigenvector.
VectorXd SweepComposition::critical_start(double mu) {
  (void)multipliers();
  const MatrixXd whole = found_ ? MatrixXd() : monodromy();
  VectorXd v = VectorXd::Zero(run_->n);
  if (last()) {
    const MatrixXd projected = found_ ? MatrixXd(basis_.transpose() * image_) : whole;
    const Index p = projected.rows();
    const core::DenseLu<double> lu(projected - mu * (1 + 1e-10) * MatrixXd::Identity(p, p));
    VectorXd z = VectorXd::Ones(p);
    for (int k = 0; k < 4; ++k) z = lu.solve(z).normalized();
    v = found_ ? VectorXd(basis_ * z) : z;
  }
  share(v);
  return v;
}

MatrixXd SweepComposition::times(const MatrixXd& v) {
  MatrixXd state = v, added;
  turn(state, added);
  return state;
}

MatrixXd SweepComposition::times_transposed(const MatrixXd& w) {
  MatrixXd out = w;
  MatrixXd lambda;
  VectorXd none = VectorXd::Zero(run_->borders), seen;
  for (Index k = 0; k < w.cols(); ++k) {
    lambda = w.col(k);
    turn_back(nullptr, lambda, none, nullptr, seen);
    out.col(k) = lambda;
  }
  return out;
}

std::vector<double> SweepComposition::warm_start() {
  if (taken_) return *taken_;
  if (!run_) return {};
  std::vector<double> warm(static_cast<std::size_t>(1 + run_->n * basis_.cols()));
  warm[0] = radius_;
  if (last()) std::copy_n(basis_.data(), basis_.size(), warm.data() + 1);
  share(warm);
  return warm;
}

void SweepComposition::dominant(MatrixXd& v, MatrixXd& image) {
  auto columns = static_cast<int>(basis_.cols());
  MPI_Bcast(&columns, 1, MPI_INT, size_ - 1, run_->comm);
  v.resize(run_->n, columns);
  image.resize(run_->n, columns);
  if (last()) {
    v = basis_;
    image = image_;
  }
  share(v);
  share(image);
}

std::unique_ptr<Composition> make_sweep_composition() {
  return std::make_unique<SweepComposition>();
}

}  // namespace whirl::solve
