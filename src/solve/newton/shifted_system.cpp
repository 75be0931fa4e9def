#include "solve/newton/shifted_system.hpp"

#include <petscksp.h>

#include <algorithm>
#include <cmath>

#include "solve/newton/port_elimination.hpp"
#include "solve/newton/real_form.hpp"
#include "whirl/core/direct_solver.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {

using core::check;
using Complex = std::complex<double>;

ShiftedSystem::ShiftedSystem(problem::System& system) : system_(system) {
  rest_ = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  state_scale_ = core::duplicate(rest_.get());
  residual_scale_ = core::duplicate(rest_.get());
  system.scales(state_scale_.get(), residual_scale_.get());
  row_scale_ = core::duplicate(rest_.get());
  check(VecCopy(residual_scale_.get(), row_scale_.get()));
  check(VecReciprocal(row_scale_.get()));
  jx_ = system.make_jacobian();
  jd_ = system.make_jacobian();
}

ShiftedSystem::~ShiftedSystem() = default;

void ShiftedSystem::linearise(Vec x) {
  system_.jacobian(0, x, rest_.get(), 1, 0, jx_.get());
  system_.jacobian(0, x, rest_.get(), 0, 1, jd_.get());
  for (Mat j : {jx_.get(), jd_.get()}) check(MatDiagonalScale(j, row_scale_.get(), state_scale_.get()));
}

void ShiftedSystem::make_matrix() {
  const bool last = core::rank_of(system_.comm()) == core::size_of(system_.comm()) - 1;
  matrix_ = make_real_form(jx_.get(), bordered_ ? 1 : 0, last && bordered_ ? 1 : 0, system_.size() + 1);
}

void ShiftedSystem::factorise(double omega, const ComplexVector& b, const ComplexVector& c) {
  if (!matrix_ || bordered_ != !b.empty()) {
    bordered_ = !b.empty();
    make_matrix();
    ports_.reset();
    solver_.reset();
  }
  const bool last = core::rank_of(system_.comm()) == core::size_of(system_.comm()) - 1;
  const PetscInt n = system_.size();
  put_pencil(jx_.get(), jd_.get(), Complex(0, omega), matrix_.get(), [&](PetscInt i, RealRow& row) {
    if (bordered_) row.add(n, b[static_cast<std::size_t>(i)]);
  });
  if (last && bordered_) {
    RealRow row;
    for (PetscInt i = 0; i < n; ++i) row.add(i, std::conj(c[static_cast<std::size_t>(i)]));
    row.add(n, 0);
    row.put(matrix_.get(), n);
  }
  check(MatAssemblyBegin(matrix_.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix_.get(), MAT_FINAL_ASSEMBLY));
  if (std::vector<problem::Field> fields = system_.fields(); PortElimination::serves(fields)) {
    for (problem::Field& f : fields) {
      f.begin *= 2;
      f.end *= 2;
    }
    if (!ports_) ports_ = std::make_unique<PortElimination>(std::move(fields));
    ports_->factorise(matrix_.get());
    return;
  }
  if (!solver_) solver_ = core::make_direct_solver(system_.comm(), "shifted_");
  check(KSPSetOperators(solver_.get(), matrix_.get(), matrix_.get()));
}

core::Vector ShiftedSystem::make_vector() const {
  const bool last = core::rank_of(system_.comm()) == core::size_of(system_.comm()) - 1;
  return core::make_vector(system_.comm(), 2 * system_.local_size() + (last && bordered_ ? 2 : 0), PETSC_DETERMINE);
}

// The transpose of the real matrix is the conjugate transpose of the complex one.
void ShiftedSystem::solve(bool adjoint, Vec rhs, Vec z) {
  if (ports_) {
    adjoint ? ports_->solve_transposed(rhs, z) : ports_->solve(rhs, z);
    return;
  }
  check(adjoint ? KSPSolveTranspose(solver_.get(), rhs, z) : KSPSolve(solver_.get(), rhs, z));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(solver_.get(), &reason));
  if (reason < 0) throw core::NotConverged("the matrix at this frequency is singular");
}

void ShiftedSystem::solve(Vec rhs, Vec z) {
  solve(false, rhs, z);
}

void ShiftedSystem::solve_adjoint(Vec rhs, Vec z) {
  solve(true, rhs, z);
}

void ShiftedSystem::solve(bool adjoint, const ComplexVector& rhs, ComplexVector& x, Complex& corner) {
  core::Vector b = make_vector(), z = core::duplicate(b.get());
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
  solve(adjoint, b.get(), z.get());
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
        const Complex z = v[static_cast<std::size_t>(i)];
        a[i - begin] = part == 0 ? z.real() : z.imag();
      }
    }
    check(MatMult(jd_.get(), in.get(), y.get()));
    const std::vector<double> whole = core::gather(y.get());
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += part == 0 ? Complex(whole[k], 0) : Complex(0, whole[k]);
  }
  return out;
}

}  // namespace whirl::solve
