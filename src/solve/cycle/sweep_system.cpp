// The small system of sweeps and its preconditioner, forward and transposed, as PETSc sees them.

#include "solve/cycle/sweep_composition.hpp"

namespace whirl::solve {

using core::check;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

PetscErrorCode SweepComposition::multiply(Mat m, Vec v, Vec y) {
  void* raw = nullptr;
  PetscCall(MatShellGetContext(m, &raw));
  SweepComposition& c = of(raw);
  return c.gate_.run([&] {
    const Index n = c.run_->n, nb = c.run_->borders;
    MatrixXd state = MatrixXd::Zero(n, 1), added;
    VectorXd x;
    {
      const core::ReadArray a(v);
      if (c.last()) state = (x = Map<const VectorXd>(a.data(), n + nb)).head(n);
    }
    c.turn(state, added, false);
    const core::WriteArray out(y);
    if (!c.last()) return;
    Map<VectorXd> answer(out.data(), n + nb);
    answer.head(n) = x.head(n) - state - c.ends_ * x.tail(nb);
    answer.tail(nb) = added + c.ends_added_ * x.tail(nb);
  });
}

PetscErrorCode SweepComposition::multiply_transposed(Mat m, Vec v, Vec y) {
  void* raw = nullptr;
  PetscCall(MatShellGetContext(m, &raw));
  SweepComposition& c = of(raw);
  return c.gate_.run([&] {
    const Index n = c.run_->n, nb = c.run_->borders;
    VectorXd x, lambda = VectorXd::Zero(n), sigma = VectorXd::Zero(nb), seen;
    {
      const core::ReadArray a(v);
      if (c.last()) {
        x = Map<const VectorXd>(a.data(), n + nb);
        lambda = x.head(n);
        sigma = x.tail(nb);
      }
    }
    c.turn_back(nullptr, lambda, sigma, nullptr, seen);
    const core::WriteArray out(y);
    if (!c.last()) return;
    Map<VectorXd> answer(out.data(), n + nb);
    answer.head(n) = x.head(n) - lambda;
    answer.tail(nb) = seen + c.run_->corner.transpose() * sigma;
  });
}

PetscErrorCode SweepComposition::apply(PC pc, Vec v, Vec y) {
  void* raw = nullptr;
  PetscCall(PCShellGetContext(pc, &raw));
  const SweepComposition& c = of(raw);
  return of(raw).gate_.run([&] {
    const core::ReadArray in(v);
    const core::WriteArray out(y);
    if (!c.last()) return;
    const Index n = c.run_->n, nb = c.run_->borders, p = c.basis_.cols();
    const Map<const VectorXd> x(in.data(), n + nb);
    Map<VectorXd> answer(out.data(), n + nb);
    VectorXd z(p + nb);
    z << c.basis_.transpose() * x.head(n), x.tail(nb);
    z = c.small_.solve(z).eval();
    answer.head(n) = x.head(n) + c.image_ * z.head(p) + c.ends_ * z.tail(nb);
    answer.tail(nb) = z.tail(nb);
  });
}

// lambda = v + V z with z = (M V)^T lambda - (K V)^T sigma, which with sigma solves the small matrix transposed.
PetscErrorCode SweepComposition::apply_transposed(PC pc, Vec v, Vec y) {
  void* raw = nullptr;
  PetscCall(PCShellGetContext(pc, &raw));
  const SweepComposition& c = of(raw);
  return of(raw).gate_.run([&] {
    const core::ReadArray in(v);
    const core::WriteArray out(y);
    if (!c.last()) return;
    const Index n = c.run_->n, nb = c.run_->borders, p = c.basis_.cols();
    const Map<const VectorXd> x(in.data(), n + nb);
    Map<VectorXd> answer(out.data(), n + nb);
    VectorXd z(p + nb);
    z << c.image_.transpose() * x.head(n), x.tail(nb) + c.ends_.transpose() * x.head(n);
    z = c.small_.transpose().solve(z).eval();
    answer.head(n) = x.head(n) + c.basis_ * z.head(p);
    answer.tail(nb) = z.tail(nb);
  });
}

void SweepComposition::set_up(const Run& run) {
  rank_ = core::rank_of(run.comm);
  size_ = core::size_of(run.comm);
  const auto size = static_cast<PetscInt>(run.n + run.borders), mine = last() ? size : 0;
  right_ = core::make_vector(run.comm, mine, size);
  answer_ = core::duplicate(right_.get());
  check(MatCreateShell(run.comm, mine, mine, size, size, this, shell_.put()));
  check(MatShellSetOperation(shell_.get(), MATOP_MULT, reinterpret_cast<void (*)()>(multiply)));
  check(MatShellSetOperation(shell_.get(), MATOP_MULT_TRANSPOSE, reinterpret_cast<void (*)()>(multiply_transposed)));
  check(KSPCreate(run.comm, solver_.put()));
  check(KSPSetOptionsPrefix(solver_.get(), "turn_"));
  check(KSPSetOperators(solver_.get(), shell_.get(), shell_.get()));
  check(KSPSetType(solver_.get(), KSPGMRES));
  check(KSPSetPCSide(solver_.get(), PC_RIGHT));
  check(KSPGMRESSetRestart(solver_.get(), 100));
  // Its error is made good by the iteration around this composition.
  check(KSPSetTolerances(solver_.get(), 1e-10, 1e-300, PETSC_DEFAULT, 300));
  PC pc = nullptr;
  check(KSPGetPC(solver_.get(), &pc));
  check(PCSetType(pc, PCSHELL));
  check(PCShellSetContext(pc, this));
  check(PCShellSetApply(pc, apply));
  check(PCShellSetApplyTranspose(pc, apply_transposed));
  check(KSPSetFromOptions(solver_.get()));
  gate_ = core::Gate(run.comm);
  basis_.resize(local(), 0);
}

}  // namespace whirl::solve
