// The small system of sweeps and its preconditioner, forward and transposed.

#include "solve/cycle/sweep_composition.hpp"

namespace whirl::solve {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void SweepComposition::multiply(Vec v, Vec y) const {
  const Index n = run_->n, nb = run_->borders;
  MatrixXd state = MatrixXd::Zero(n, 1), added;
  VectorXd x;
  {
    const core::ReadArray a(v);
    if (last()) state = (x = Map<const VectorXd>(a.data(), n + nb)).head(n);
  }
  turn(state, added);
  const core::WriteArray out(y);
  if (!last()) return;
  Map<VectorXd> answer(out.data(), n + nb);
  answer.head(n) = x.head(n) - state - ends_ * x.tail(nb);
  answer.tail(nb) = added + ends_added_ * x.tail(nb);
}

void SweepComposition::multiply_transposed(Vec v, Vec y) const {
  const Index n = run_->n, nb = run_->borders;
  MatrixXd lambda = MatrixXd::Zero(n, 1);
  VectorXd x, sigma = VectorXd::Zero(nb), seen;
  {
    const core::ReadArray a(v);
    if (last()) {
      x = Map<const VectorXd>(a.data(), n + nb);
      lambda = x.head(n);
      sigma = x.tail(nb);
    }
  }
  turn_back(nullptr, lambda, sigma, nullptr, seen);
  const core::WriteArray out(y);
  if (!last()) return;
  Map<VectorXd> answer(out.data(), n + nb);
  answer.head(n) = x.head(n) - lambda;
  answer.tail(nb) = seen + run_->corner.transpose() * sigma;
}

// Transposed: lambda = v + V z with z = (M V)^T lambda - (K V)^T sigma, which with sigma solves the small matrix
// transposed.
void SweepComposition::precondition(Vec v, Vec y, bool transposed) const {
  const core::ReadArray in(v);
  const core::WriteArray out(y);
  if (!last()) return;
  const Index n = run_->n, nb = run_->borders, p = basis_.cols();
  const Map<const VectorXd> x(in.data(), n + nb);
  Map<VectorXd> answer(out.data(), n + nb);
  const MatrixXd &from = transposed ? image_ : basis_, &to = transposed ? basis_ : image_;
  VectorXd z(p + nb);
  z << from.transpose() * x.head(n), x.tail(nb);
  if (transposed) z.tail(nb) += ends_.transpose() * x.head(n);
  z = transposed ? small_.solve_transposed(z) : small_.solve(z);
  answer.head(n) = x.head(n) + to * z.head(p);
  if (!transposed) answer.head(n) += ends_ * z.tail(nb);
  answer.tail(nb) = z.tail(nb);
}

void SweepComposition::set_up(const Run& run) {
  rank_ = core::rank_of(run.comm);
  size_ = core::size_of(run.comm);
  gate_ = core::Gate(run.comm);
  const PetscInt mine = last() ? static_cast<PetscInt>(run.n + run.borders) : 0;
  right_ = core::make_vector(run.comm, mine, PETSC_DETERMINE);
  answer_ = core::duplicate(right_.get());
  shell_ = core::make_shell(
      run.comm, mine, gate_, [this](Vec v, Vec y) { multiply(v, y); },
      [this](Vec v, Vec y) { multiply_transposed(v, y); });
  // Its error is made good by the iteration around this composition.
  solver_ = core::make_krylov(
      shell_.get(), gate_, {"turn_", KSPGMRES, 1e-10, 300, 100}, [this](Vec v, Vec y) { precondition(v, y, false); },
      [this](Vec v, Vec y) { precondition(v, y, true); });
  basis_.resize(local(), 0);
}

}  // namespace whirl::solve
