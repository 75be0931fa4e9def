#include "solve/cycle/dominant_subspace.hpp"

#include <fmt/core.h>
#include <slepceps.h>

#include <algorithm>
#include <cmath>

#include "whirl/core/agree.hpp"
#include "whirl/core/from_options.hpp"
#include "whirl/core/shell.hpp"

namespace whirl::solve {
namespace {

using core::check;
using EigenSolver = core::Handle<EPS, EPSDestroy>;

struct Context {
  double radius;
  bool below = false;  // an eigenvalue below the radius was met, so that all above it have converged
};

// They are looked at by falling modulus. Above the radius an eigenpair wants its tolerance relative to its eigenvalue;
// of the first one below nothing is asked but that it stays there with its residual: the moduli of contracting films
// fall by many powers of ten, and products of M do not hold the digits that a relative residual would ask for.
PetscErrorCode error_of(EPS, PetscScalar re, PetscScalar im, PetscReal residual, PetscReal* error, void* raw) {
  auto& c = *static_cast<Context*>(raw);
  const double modulus = std::hypot(re, im);
  const bool below = modulus + residual < c.radius;
  c.below = c.below || below;
  *error = below ? 0 : residual / modulus;
  return 0;
}

PetscErrorCode stop(EPS eps, PetscInt its, PetscInt max_it, PetscInt converged, PetscInt wanted,
                    EPSConvergedReason* reason, void* raw) {
  PetscCall(EPSStoppingBasic(eps, its, max_it, converged, wanted, reason, nullptr));
  if (static_cast<Context*>(raw)->below) *reason = EPS_CONVERGED_USER;
  return 0;
}

}  // namespace

DominantSubspace dominant_subspace(const std::function<void(Vec)>& multiply, Vec start,
                                   const SubspaceOptions& options) {
  MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(start));
  PetscInt local = 0, n = 0;
  check(VecGetLocalSize(start, &local));
  check(VecGetSize(start, &n));
  Context context{options.radius};
  core::Gate gate(comm);
  const core::Matrix shell = core::make_shell(comm, local, gate, [&](Vec v, Vec y) {
    check(VecCopy(v, y));
    multiply(y);
  });

  DominantSubspace out;
  const auto most = std::min<PetscInt>(n, options.most);
  for (PetscInt wanted = std::min<PetscInt>(most, options.guess);; wanted = std::min<PetscInt>(most, 2 * wanted)) {
    EigenSolver eps;
    check(EPSCreate(comm, eps.put()));
    check(EPSSetOptionsPrefix(eps.get(), "monodromy_"));
    check(EPSSetOperators(eps.get(), shell.get(), nullptr));
    check(EPSSetProblemType(eps.get(), EPS_NHEP));
    check(EPSSetType(eps.get(), EPSKRYLOVSCHUR));
    check(EPSSetWhichEigenpairs(eps.get(), EPS_LARGEST_MAGNITUDE));
    const PetscInt spare = options.spare > 0 ? std::max<PetscInt>(options.spare, wanted / 2) : wanted + 6;
    check(EPSSetDimensions(eps.get(), wanted, std::min<PetscInt>(n, wanted + spare), PETSC_DEFAULT));
    check(EPSSetTolerances(eps.get(), options.tolerance, options.restarts));
    check(EPSSetConvergenceTestFunction(eps.get(), error_of, &context, nullptr));
    check(EPSSetStoppingTestFunction(eps.get(), stop, &context, nullptr));
    context.below = false;
    check(EPSSetInitialSpace(eps.get(), 1, &start));
    core::set_from_options(eps.get());
    gate.rethrow(EPSSolve(eps.get()));
    PetscInt converged = 0;
    check(EPSGetConverged(eps.get(), &converged));
    if (converged < wanted && !context.below && options.persistent && wanted < most) continue;
    if (converged < wanted && !context.below)
      core::agree(comm, [&] {
        throw core::NotConverged(fmt::format("only {} of {} multipliers converged", converged, wanted));
      });
    out.values.clear();
    PetscInt large = 0;
    for (PetscInt i = 0; i < converged; ++i) {
      PetscScalar re = 0, im = 0;
      check(EPSGetEigenvalue(eps.get(), i, &re, &im));
      out.values.emplace_back(re, im);
      if (std::abs(out.values.back()) > options.radius) ++large;
    }
    if (large == converged && wanted < most) continue;
    std::vector<core::Vector> vectors;
    std::vector<Vec> raw;
    for (PetscInt i = 0; i < converged; ++i) {
      vectors.push_back(core::duplicate(start));
      raw.push_back(vectors.back().get());
    }
    check(EPSGetInvariantSubspace(eps.get(), raw.data()));
    out.basis.resize(local, large);
    for (PetscInt i = 0; i < large; ++i) {
      const core::ReadArray a(raw[static_cast<std::size_t>(i)]);
      out.basis.col(i) = Eigen::Map<const Eigen::VectorXd>(a.data(), local);
    }
    std::stable_sort(out.values.begin(), out.values.end(), [](auto a, auto b) { return std::abs(a) > std::abs(b); });
    return out;
  }
}

DominantSubspace dominant_multipliers(const std::function<void(Vec)>& multiply, Vec start, SubspaceOptions options,
                                      double& radius) {
  constexpr double above_a_band = 0.5;
  options.radius = radius;
  try {
    return dominant_subspace(multiply, start, options);
  } catch (const core::NotConverged&) {
    if (radius >= above_a_band) throw;
  }
  options.radius = radius = above_a_band;
  options.persistent = true;
  return dominant_subspace(multiply, start, options);
}

}  // namespace whirl::solve
