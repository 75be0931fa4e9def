// How the linear equations of the pressure are solved.
#include <petscksp.h>

#include "thermal/film_flow_work.hpp"
#include "whirl/core/direct_solver.hpp"
#include "whirl/core/plan.hpp"
#include "whirl/thermal/solid.hpp"

namespace whirl::thermal {

using core::check;

namespace {

// Iterations a step with factors of an earlier Jacobian; new ones cost as much as many more than these.
constexpr int most_krylov = 4;

using Places = core::Handle<IS, ISDestroy>;

}  // namespace

// A matrix of rims and nodes: rims, each joined to its node alone, are eliminated exactly, as their block is diagonal.
void FilmFlow::Work::split_rims(PC pc) const {
  check(PCSetType(pc, PCFIELDSPLIT));
  const auto nodes = static_cast<PetscInt>(n * rows.count());
  Places rim, node;
  check(ISCreateStride(rows.comm(), static_cast<PetscInt>(here.size()), first + nodes, 1, rim.put()));
  check(ISCreateStride(rows.comm(), nodes, first, 1, node.put()));
  check(PCFieldSplitSetIS(pc, "rims", rim.get()));
  check(PCFieldSplitSetIS(pc, "nodes", node.get()));
  check(PCFieldSplitSetType(pc, PC_COMPOSITE_SCHUR));
  check(PCFieldSplitSetSchurFactType(pc, PC_FIELDSPLIT_SCHUR_FACT_FULL));
  check(PCFieldSplitSetSchurPre(pc, PC_FIELDSPLIT_SCHUR_PRE_SELFP, nullptr));
}

void FilmFlow::Work::choose_linear_solver() {
  const bool ruptures = conserving || options.cavitation == FilmFlowOptions::Cavitation::reynolds;
  const auto way = core::plan::pressure(std::int64_t{mesh.nodes_around()} * mesh.nodes_along());
  KSP ksp = nullptr;
  PC pc = nullptr;
  check(SNESGetKSP(snes.get(), &ksp));
  check(KSPGetPC(ksp, &pc));
  // What a cavity carries downstream is no elliptic equation: multigrid would not smooth it.
  multigrid = !conserving && way == core::plan::PressureWay::multigrid;
  core::plan::note(multigrid ? way : core::plan::PressureWay::direct);
  if (!multigrid) core::make_direct(ksp);
  // The set of unknowns that an active set leaves changes from step to step.
  if (!multigrid && ruptures) return;
  // The flexible kind keeps what the preconditioner has made of each vector: GMRES from the right would apply it once
  // more at the end, which is half of the work where one iteration does.
  check(KSPSetType(ksp, KSPFGMRES));
  check(KSPSetTolerances(ksp, 1e-3, 1e-50, PETSC_DEFAULT, 200));
  if (!ruptures) check(SNESSetLagPreconditionerPersists(snes.get(), PETSC_TRUE));
  if (!multigrid) return;
  if (options.orifices.empty()) {
    use_multigrid(pc);
    return;
  }
  split_rims(pc);
  check(KSPSetOperators(ksp, j.get(), j.get()));
}

// The parts of a split solver exist once it has a matrix.
void FilmFlow::Work::finish_linear_solver() {
  if (!multigrid || split_done || options.orifices.empty()) return;
  KSP ksp = nullptr;
  PC pc = nullptr;
  check(SNESGetKSP(snes.get(), &ksp));
  check(KSPGetPC(ksp, &pc));
  PetscBool split = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCFIELDSPLIT, &split));
  split_done = true;
  if (!split) return;
  jacobian(u.get(), j.get());
  check(KSPSetUp(ksp));
  PetscInt count = 0;
  KSP* parts = nullptr;
  check(PCFieldSplitGetSubKSP(pc, &count, &parts));
  PC part = nullptr;
  check(KSPSetType(parts[0], KSPPREONLY));
  check(KSPGetPC(parts[0], &part));
  check(PCSetType(part, PCJACOBI));
  check(KSPSetType(parts[1], KSPPREONLY));
  check(KSPGetPC(parts[1], &part));
  use_multigrid(part);
  check(PetscFree(parts));
}

// No step is solved further than the whole equation has to be.
void FilmFlow::Work::limit_linear_solver(double residual) {
  KSP ksp = nullptr;
  check(SNESGetKSP(snes.get(), &ksp));
  PetscReal relative = 0;
  PetscInt most = 0;
  check(KSPGetTolerances(ksp, &relative, nullptr, nullptr, &most));
  check(KSPSetTolerances(ksp, relative, residual, PETSC_DEFAULT, most));
}

// New factors in every step of the first solution and where those at hand have become poor.
void FilmFlow::Work::choose_lag(int newton, int krylov) {
  if (conserving || options.cavitation == FilmFlowOptions::Cavitation::reynolds) return;
  const bool poor = newton > 0 && krylov > most_krylov * newton * (multigrid ? 3 : 1);
  check(SNESSetLagPreconditioner(snes.get(), poor ? -2 : -1));
}

}  // namespace whirl::thermal
