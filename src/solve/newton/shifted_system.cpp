#include "solve/newton/shifted_system.hpp"

#include <algorithm>
#include <cmath>

#include "solve/newton/port_elimination.hpp"
#include "solve/newton/real_form.hpp"
#include "whirl/core/direct_solver.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/shell.hpp"
#include "whirl/solve/newton/frequency_solver.hpp"

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
  if (!matrix_ || bordered_ != (b.size() > 0)) {
    bordered_ = b.size() > 0;
    make_matrix();
    ports_.reset();
    solver_.reset();
  }
  const bool last = core::rank_of(system_.comm()) == core::size_of(system_.comm()) - 1;
  const PetscInt n = system_.size();
  put_pencil(jx_.get(), jd_.get(), Complex(0, omega), matrix_.get(), [&](PetscInt i, RealRow& row) {
    if (bordered_) row.add(n, b(i));
  });
  if (last && bordered_) {
    RealRow row;
    for (PetscInt i = 0; i < n; ++i) row.add(i, std::conj(c(i)));
    row.add(n, 0);
    row.put(matrix_.get(), n);
  }
  check(MatAssemblyBegin(matrix_.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix_.get(), MAT_FINAL_ASSEMBLY));
  if (std::vector<problem::Field> fields = problem::parts_of(system_.fields()); PortElimination::serves(fields)) {
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
  if (core::reason_of(solver_.get()) < 0) throw core::NotConverged(singular_at_frequency);
}

void ShiftedSystem::solve(Vec rhs, Vec z) {
  solve(false, rhs, z);
}

void ShiftedSystem::solve_adjoint(Vec rhs, Vec z) {
  solve(true, rhs, z);
}

void ShiftedSystem::solve(bool adjoint, const ComplexVector& rhs, ComplexVector& x, Complex& corner) {
  core::Vector b = make_vector(), z = core::duplicate(b.get());
  const Eigen::Index n = size(), all = n + (bordered_ ? 1 : 0);
  std::vector<double> whole(static_cast<std::size_t>(2 * all));
  const auto complex = [&] { return Eigen::Map<ComplexVector>(reinterpret_cast<Complex*>(whole.data()), all); };
  complex().head(n) = rhs;
  if (bordered_) complex()(n) = corner;
  core::fill(b.get(), whole);
  solve(adjoint, b.get(), z.get());
  whole = core::gather(z.get());
  x = complex().head(n);
  if (bordered_) corner = complex()(n);
}

void ShiftedSystem::solve(const ComplexVector& rhs, ComplexVector& x, Complex& corner) {
  solve(false, rhs, x, corner);
}

void ShiftedSystem::solve_adjoint(const ComplexVector& rhs, ComplexVector& x, Complex& corner) {
  solve(true, rhs, x, corner);
}

CriticalVectors generic_vectors(Eigen::Index n) {
  CriticalVectors out{ComplexVector(n), ComplexVector(n)};
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto t = static_cast<double>(k);
    out.p(k) = {std::sin(1 + t), std::cos(2 + 0.7 * t)};
    out.q(k) = {std::cos(3 + 1.3 * t), std::sin(2 + 1.7 * t)};
  }
  for (ComplexVector* v : {&out.q, &out.p}) v->normalize();
  return out;
}

// The first borders are generic, the second ones the null vectors themselves.
CriticalVectors critical_vectors(ShiftedSystem& shifted, double omega) {
  const Eigen::Index n = shifted.size();
  const ComplexVector none = ComplexVector::Zero(n);
  CriticalVectors out = generic_vectors(n);
  for (int pass = 0; pass < 2; ++pass) {
    for (ComplexVector* v : {&out.q, &out.p}) *v *= std::sqrt(static_cast<double>(n)) / v->norm();
    shifted.factorise(omega, out.p, out.q);
    Complex corner = 1, other = 1;
    shifted.solve(none, out.q, corner);
    shifted.solve_adjoint(none, out.p, other);
  }
  for (ComplexVector* v : {&out.q, &out.p}) *v *= std::sqrt(static_cast<double>(n)) / v->norm();
  return out;
}

ComplexVector ShiftedSystem::rates_times(const ComplexVector& v) const {
  core::Vector in = core::duplicate(rest_.get()), y = core::duplicate(rest_.get());
  const auto times = [&](const Eigen::VectorXd& part) -> Eigen::VectorXd {
    core::fill(in.get(), {part.begin(), part.end()});
    check(MatMult(jd_.get(), in.get(), y.get()));
    const std::vector<double> whole = core::gather(y.get());
    return Eigen::Map<const Eigen::VectorXd>(whole.data(), part.size());
  };
  return times(v.real()) + Complex(0, 1) * times(v.imag());
}

}  // namespace whirl::solve
