#include "system/start.hpp"

#include <petscksp.h>

#include "whirl/core/direct_solver.hpp"
#include "whirl/core/error.hpp"

namespace whirl::system {

using core::check;

core::Vector static_guess(RotorSystem& system) {
  Train train = system.train();
  train.unbalance.clear();
  std::erase_if(train.elements, [](const Element& e) { return !carries_static_load(e); });
  for (Support& s : train.supports) {
    if (film::facts(s.film).coefficients) continue;
    // Stiff against the film and soft against the shaft's elements, so that the solve keeps its digits.
    s.film = film::Linear{.stiffness = {1e11, 0, 0, 1e11}};
    s.elevation -= 0.45 * s.geometry.clearance;
  }
  RotorSystem springs(system.comm(), std::move(train), system.speed());
  core::Vector x = core::make_vector(system.comm(), springs.local_size(), PETSC_DETERMINE),
               f = core::duplicate(x.get()), rest = core::duplicate(x.get());
  core::Matrix j = springs.make_jacobian();
  springs.residual(0, x.get(), rest.get(), f.get());
  // What nothing pushes stays, be it held or free.
  PetscReal push = 0;
  check(VecNorm(f.get(), NORM_INFINITY, &push));
  if (push == 0 && system.own_states() == 0) return x;
  springs.jacobian(0, x.get(), rest.get(), 1, 0, j.get());
  const core::LinearSolver ksp = core::make_direct_solver(system.comm(), "start_");
  check(KSPSetOperators(ksp.get(), j.get(), j.get()));
  check(KSPSolve(ksp.get(), f.get(), x.get()));
  KSPConvergedReason why = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(ksp.get(), &why));
  if (why < 0)
    throw core::NotConverged(
        "nothing holds the rotor against its static load: the stiffness of shaft, bearings and elements is singular");
  check(VecScale(x.get(), -1));
  if (system.own_states() == 0) return x;
  // Films with own states move the rotor to the first rank.
  core::Vector whole = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  const std::vector<double> from = core::gather(x.get());
  {
    const core::WriteArray to(whole.get());
    const problem::Field machine = system.fields().front();
    PetscInt first = 0;
    check(VecGetOwnershipRange(whole.get(), &first, nullptr));
    for (PetscInt i = machine.begin; i < machine.end; ++i) to[i] = from[static_cast<std::size_t>(first + i)];
  }
  system.relax_films(whole.get());
  return whole;
}

}  // namespace whirl::system
