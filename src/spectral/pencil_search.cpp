#include "spectral/pencil_search.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/core/agree.hpp"
#include "whirl/core/direct_solver.hpp"
#include "whirl/core/error.hpp"

namespace whirl::spectral {

using core::check;

ScaledPencil scaled_pencil(problem::System& system, Vec x) {
  core::Vector rest = core::duplicate(x), xs = core::duplicate(x), fs = core::duplicate(x);
  check(VecSet(rest.get(), 0.0));
  system.scales(xs.get(), fs.get());
  ScaledPencil out{system.make_jacobian(), system.make_jacobian(), core::gather(xs.get()), core::gather(fs.get())};
  check(VecReciprocal(fs.get()));
  system.jacobian(0, x, rest.get(), 1, 0, out.a.get());
  system.jacobian(0, x, rest.get(), 0, -1, out.b.get());
  check(MatDiagonalScale(out.a.get(), fs.get(), xs.get()));
  check(MatDiagonalScale(out.b.get(), fs.get(), xs.get()));
  return out;
}

core::Matrix redundant_dense(Mat m) {
  core::Matrix whole, dense;
  const int size = core::size_of(PetscObjectComm(reinterpret_cast<PetscObject>(m)));
  if (size == 1) {
    check(MatConvert(m, MATSEQDENSE, MAT_INITIAL_MATRIX, dense.put()));
    return dense;
  }
  check(MatCreateRedundantMatrix(m, size, MPI_COMM_NULL, MAT_INITIAL_MATRIX, whole.put()));
  check(MatConvert(whole.get(), MATSEQDENSE, MAT_INITIAL_MATRIX, dense.put()));
  return dense;
}

Pair pair_of(EPS eps, PetscInt i, Vec re, Vec im, bool vectors) {
  PetscScalar a = 0, b = 0;
  Pair p;
  if (vectors) {
    check(EPSGetEigenpair(eps, i, &a, &b, re, im));
    p.real = core::gather(re);
    p.imaginary = core::gather(im);
  } else {
    check(EPSGetEigenvalue(eps, i, &a, &b));
  }
  p.value = {a, b};
  return p;
}

void share(MPI_Comm comm, std::vector<Complex>& values) {
  auto count = static_cast<unsigned long>(values.size());
  MPI_Bcast(&count, 1, MPI_UNSIGNED_LONG, 0, comm);
  values.resize(count);
  core::share(comm, reinterpret_cast<double*>(values.data()), 2 * values.size());
}

namespace {

PetscErrorCode all_alike(PetscScalar, PetscScalar, PetscScalar, PetscScalar, PetscInt* result, void*) {
  *result = 0;
  return 0;
}

// The nearer to the target of two eigenvalues; alike where a search could not tell them apart: it swaps none of these,
// and what is wanted stands first within a millionth all the same.
PetscErrorCode nearer(PetscScalar ar, PetscScalar ai, PetscScalar br, PetscScalar bi, PetscInt* result, void* search) {
  PetscScalar at = 0;
  const PetscErrorCode code = EPSGetTarget(static_cast<EPS>(search), &at);
  const double a = std::hypot(ar - at, ai), b = std::hypot(br - at, bi);
  *result = a == b || std::abs(a - b) <= 1e-6 * std::max(a, b) ? 0 : a < b ? -1 : 1;
  return code;
}

}  // namespace

// LAPACK may refuse to sort a generalised Schur form: neighbours are too close (thin films swept along by the journal,
// double eigenvalues of an isotropic rotor at rest). What is never swapped is never refused. The standard form b^-1 a
// is no way out: where b is ill-conditioned (curvatures at the ends of short beams), it leaves three digits of an
// eigenvalue.
void solve_dense(EigenSolver& eps, Mat a, Mat b) {
  try {
    check(EPSSolve(eps.get()));
    return;
  } catch (const core::LibraryError&) {
    eps.reset();
  }
  check(EPSCreate(PETSC_COMM_SELF, eps.put()));
  check(EPSSetOptionsPrefix(eps.get(), "modes_"));
  check(EPSSetOperators(eps.get(), a, b));
  check(EPSSetProblemType(eps.get(), EPS_GNHEP));
  check(EPSSetType(eps.get(), EPSLAPACK));
  check(EPSSetWhichEigenpairs(eps.get(), EPS_WHICH_USER));
  check(EPSSetEigenvalueComparison(eps.get(), all_alike, nullptr));
  check(EPSSetFromOptions(eps.get()));
  check(EPSSolve(eps.get()));
}

// Both of a double eigenvalue (an isotropic rotor at rest) are in a large basis, where LAPACK refuses to swap them when
// rounding sorts them the other way round: none is the nearer.
void search_near(EPS eps, Mat a, double target, PetscInt wanted, InverseShell* shell) {
  PetscInt n = 0;
  check(MatGetSize(a, &n, nullptr));
  check(EPSSetType(eps, EPSKRYLOVSCHUR));
  check(EPSSetDimensions(eps, wanted, std::min<PetscInt>(n, 2 * wanted + 20), PETSC_DEFAULT));
  check(EPSSetTolerances(eps, search_tolerance, 200));
  check(EPSSetTarget(eps, target));
  check(EPSSetWhichEigenpairs(eps, EPS_WHICH_USER));
  check(EPSSetEigenvalueComparison(eps, nearer, eps));
  ST st = nullptr;
  KSP ksp = nullptr;
  check(EPSGetST(eps, &st));
  check(STSetType(st, STSINVERT));
  check(STGetKSP(st, &ksp));
  if (shell)
    shell->serve(ksp);
  else
    core::make_direct(ksp, n);
  // The same start vector on any number of ranks.
  core::Vector start;
  check(MatCreateVecs(a, start.put(), nullptr));
  PetscInt begin = 0;
  check(VecGetOwnershipRange(start.get(), &begin, nullptr));
  {
    const core::WriteArray s(start.get());
    for (PetscInt i = 0; i < s.size(); ++i) s[i] = 1 + std::sin(0.7 * static_cast<double>(begin + i));
  }
  Vec first = start.get();
  check(EPSSetInitialSpace(eps, 1, &first));
}

}  // namespace whirl::spectral
