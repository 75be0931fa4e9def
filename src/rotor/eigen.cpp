#include "eigen.hpp"

#include <fmt/core.h>
#include <slepceps.h>

#include <algorithm>

#include "planar.hpp"
#include "whirl/core/from_options.hpp"

namespace whirl::rotor {

using core::check;

std::vector<double> lowest_eigenvalues(Mat stiffness, Mat mass, double shift, PetscInt count,
                                       const std::vector<Vec>& rigid, const std::function<void(PetscInt, Vec)>& take) {
  PetscInt n = 0;
  check(MatGetSize(stiffness, &n, nullptr));
  const PetscInt n_rigid = static_cast<PetscInt>(rigid.size());
  count = std::min(count, n - n_rigid);
  if (count <= 0) return {};

  core::Handle<EPS, EPSDestroy> eps;
  check(EPSCreate(PetscObjectComm(reinterpret_cast<PetscObject>(stiffness)), eps.put()));
  check(EPSSetOperators(eps.get(), stiffness, mass));
  check(EPSSetProblemType(eps.get(), EPS_GHEP));
  check(EPSSetOptionsPrefix(eps.get(), "rotor_"));
  check(EPSSetTarget(eps.get(), shift));
  check(EPSSetWhichEigenpairs(eps.get(), EPS_TARGET_MAGNITUDE));
  // Nearly all of them: a subspace cannot hold more vectors than there are, so a dense solver finds them, rigid motions
  // too.
  const bool dense = count + 1 > n - n_rigid;
  if (dense)
    check(EPSSetType(eps.get(), EPSLAPACK));
  else
    check(EPSSetDimensions(eps.get(), count, std::min(n - n_rigid, std::max(2 * count, count + 15)), PETSC_DEFAULT));
  check(EPSSetTolerances(eps.get(), 1e-13, 1000));
  ST st = nullptr;
  KSP ksp = nullptr;
  check(EPSGetST(eps.get(), &st));
  check(STSetType(st, STSINVERT));
  check(STGetKSP(st, &ksp));
  make_direct(ksp);
  std::vector<Vec> space(rigid);
  if (n_rigid > 0 && !dense) check(EPSSetDeflationSpace(eps.get(), n_rigid, space.data()));
  core::set_from_options(eps.get());
  check(EPSSolve(eps.get()));

  const PetscInt skip = dense ? n_rigid : 0;  // zero is nearest to the shift
  PetscInt converged = 0;
  check(EPSGetConverged(eps.get(), &converged));
  if (converged < count + skip)
    throw core::NotConverged(fmt::format("only {} of {} natural frequencies converged", converged - skip, count));
  core::Vector v;
  check(MatCreateVecs(stiffness, v.put(), nullptr));
  std::vector<double> values;
  for (PetscInt i = 0; i < count; ++i) {
    double value = 0;
    check(EPSGetEigenpair(eps.get(), i + skip, &value, nullptr, v.get(), nullptr));
    values.push_back(value);
    if (take) take(i, v.get());
  }
  return values;
}

}  // namespace whirl::rotor
