#include "solve/newton/shifted_system.hpp"

#include <petscksp.h>

#include <cmath>

#include "whirl/core/error.hpp"

namespace whirl::solve {

using core::check;
using Complex = std::complex<double>;

ShiftedSystem::ShiftedSystem(problem::System& system) : system_(system) {
  rest_ = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  residual_scale_ = core::duplicate(rest_.get());
  core::Vector state = core::duplicate(rest_.get());
  system.scales(state.get(), residual_scale_.get());
  state_scale_ = core::gather(state.get());
  jx_ = system.make_jacobian();
  jd_ = system.make_jacobian();
}

void ShiftedSystem::linearise(Vec x) {
  system_.jacobian(0, x, rest_.get(), 1, 0, jx_.get());
  system_.jacobian(0, x, rest_.get(), 0, 1, jd_.get());
}

void ShiftedSystem::factorise(double omega, const ComplexVector& b, const ComplexVector& c) {
  bordered_ = !b.empty();
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(jx_.get(), &begin, &end));
  const bool last = core::rank_of(system_.comm()) == core::size_of(system_.comm()) - 1;
  const PetscInt n = system_.size(), rows = 2 * (end - begin) + (last && bordered_ ? 2 : 0);
  std::vector<PetscInt> count(static_cast<std::size_t>(std::max<PetscInt>(rows, 1)), 2 * n + 2);
  for (PetscInt i = begin; i < end; ++i) {
    PetscInt k = 0;
    check(MatGetRow(jx_.get(), i, &k, nullptr, nullptr));
    for (PetscInt part = 0; part < 2; ++part)
      count[static_cast<std::size_t>(2 * (i - begin) + part)] = 2 * k + (bordered_ ? 2 : 0);
    check(MatRestoreRow(jx_.get(), i, &k, nullptr, nullptr));
  }
  std::vector<PetscInt> local = count;
  for (auto& k : local) k = std::min(k, rows);
  check(MatCreate(system_.comm(), matrix_.put()));
  check(MatSetSizes(matrix_.get(), rows, rows, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetType(matrix_.get(), MATAIJ));
  check(MatSeqAIJSetPreallocation(matrix_.get(), 0, count.data()));
  check(MatMPIAIJSetPreallocation(matrix_.get(), 0, local.data(), 0, count.data()));
  const auto put = [&](PetscInt row, PetscInt column, Complex z) {
    const PetscInt r[2] = {2 * row, 2 * row + 1}, k[2] = {2 * column, 2 * column + 1};
    const double block[4] = {z.real(), -z.imag(), z.imag(), z.real()};
    check(MatSetValues(matrix_.get(), 2, r, 2, k, block, INSERT_VALUES));
  };
  const core::ReadArray rs(residual_scale_.get());
  for (PetscInt i = begin; i < end; ++i) {
    // Both Jacobians have the same pattern, so that their rows run in step.
    PetscInt k = 0, kd = 0;
    const PetscInt *columns = nullptr, *columns_d = nullptr;
    const PetscScalar *a = nullptr, *d = nullptr;
    check(MatGetRow(jx_.get(), i, &k, &columns, &a));
    check(MatGetRow(jd_.get(), i, &kd, &columns_d, &d));
    core::require(k == kd, "dF/dx and dF/d(dx/dt) have one pattern");
    for (PetscInt e = 0; e < k; ++e)
      put(i, columns[e],
          Complex(a[e], omega * d[e]) * state_scale_[static_cast<std::size_t>(columns[e])] / rs[i - begin]);
    check(MatRestoreRow(jx_.get(), i, &k, &columns, &a));
    check(MatRestoreRow(jd_.get(), i, &kd, &columns_d, &d));
    if (bordered_) put(i, n, b[static_cast<std::size_t>(i)]);
  }
  if (last && bordered_) {
    for (PetscInt i = 0; i < n; ++i) put(n, i, std::conj(c[static_cast<std::size_t>(i)]));
    put(n, n, 0);
  }
  check(MatAssemblyBegin(matrix_.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix_.get(), MAT_FINAL_ASSEMBLY));
  check(KSPCreate(system_.comm(), solver_.put()));
  check(KSPSetOptionsPrefix(solver_.get(), "shifted_"));
  check(KSPSetType(solver_.get(), KSPPREONLY));
  PC pc = nullptr;
  check(KSPGetPC(solver_.get(), &pc));
  check(PCSetType(pc, PCLU));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  check(KSPSetFromOptions(solver_.get()));
  check(KSPSetOperators(solver_.get(), matrix_.get(), matrix_.get()));
}

void ShiftedSystem::solve(bool adjoint, const ComplexVector& rhs, ComplexVector& x, Complex& corner) {
  core::Vector b, z;
  check(MatCreateVecs(matrix_.get(), z.put(), b.put()));
  PetscInt begin = 0, end = 0;
  check(VecGetOwnershipRange(b.get(), &begin, &end));
  const std::size_t n = size();
  const auto entry = [&](PetscInt row) {
    return static_cast<std::size_t>(row) < n ? rhs[static_cast<std::size_t>(row)] : corner;
  };
  {
    const core::WriteArray a(b.get());
    for (PetscInt i = begin; i < end; ++i) a[i - begin] = i % 2 == 0 ? entry(i / 2).real() : entry(i / 2).imag();
  }
  // The transpose of the real matrix is the conjugate transpose of the complex one.
  check(adjoint ? KSPSolveTranspose(solver_.get(), b.get(), z.get()) : KSPSolve(solver_.get(), b.get(), z.get()));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(solver_.get(), &reason));
  if (reason < 0) throw core::NotConverged("the matrix at this frequency is singular");
  const std::vector<double> whole = core::gather(z.get());
  x.resize(n);
  for (std::size_t k = 0; k < n; ++k) x[k] = {whole[2 * k], whole[2 * k + 1]};
  if (bordered_) corner = {whole[2 * n], whole[2 * n + 1]};
}

void ShiftedSystem::solve(const ComplexVector& rhs, ComplexVector& x, Complex& corner) {
  solve(false, rhs, x, corner);
}

void ShiftedSystem::solve_adjoint(const ComplexVector& rhs, ComplexVector& x, Complex& corner) {
  solve(true, rhs, x, corner);
}

// The first borders are generic, the second ones the null vectors themselves.
CriticalVectors critical_vectors(ShiftedSystem& shifted, double omega) {
  const std::size_t n = shifted.size();
  ComplexVector b(n), c(n), none(n);
  CriticalVectors out;
  for (std::size_t k = 0; k < n; ++k) {
    const auto t = static_cast<double>(k);
    b[k] = {std::sin(1 + t), std::cos(2 + 0.7 * t)};
    c[k] = {std::cos(3 + 1.3 * t), std::sin(2 + 1.7 * t)};
  }
  for (int pass = 0; pass < 2; ++pass) {
    shifted.factorise(omega, b, c);
    Complex corner = 1, other = 1;
    shifted.solve(none, out.q, corner);
    shifted.solve_adjoint(none, out.p, other);
    for (ComplexVector* v : {&out.q, &out.p}) {
      double sum = 0;
      for (const Complex& e : *v) sum += std::norm(e);
      for (Complex& e : *v) e *= std::sqrt(static_cast<double>(n) / sum);
    }
    b = out.p;
    c = out.q;
  }
  return out;
}

ComplexVector ShiftedSystem::rates_times(const ComplexVector& v) const {
  ComplexVector out(size());
  core::Vector in = core::duplicate(rest_.get()), y = core::duplicate(rest_.get());
  PetscInt begin = 0, end = 0;
  check(VecGetOwnershipRange(in.get(), &begin, &end));
  for (int part = 0; part < 2; ++part) {
    {
      const core::WriteArray a(in.get());
      for (PetscInt i = begin; i < end; ++i) {
        const auto k = static_cast<std::size_t>(i);
        a[i - begin] = (part == 0 ? v[k].real() : v[k].imag()) * state_scale_[k];
      }
    }
    check(MatMult(jd_.get(), in.get(), y.get()));
    check(VecPointwiseDivide(y.get(), y.get(), residual_scale_.get()));
    const std::vector<double> whole = core::gather(y.get());
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += part == 0 ? Complex(whole[k], 0) : Complex(0, whole[k]);
  }
  return out;
}

}  // namespace whirl::solve
