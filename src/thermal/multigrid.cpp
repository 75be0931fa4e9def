#include <petscksp.h>

#include "whirl/thermal/solid.hpp"

namespace whirl::thermal {

using core::check;

namespace {

PetscErrorCode destroy(PetscOptions* options) {
  return PetscOptionsDestroy(options);
}

}  // namespace

void use_multigrid(PC pc) {
  check(PCSetType(pc, PCHYPRE));
  check(PCHYPRESetType(pc, "boomeramg"));
  // Of hypre's settings PETSc knows options only. These are in a list of their own, so that the user's come after them.
  const char* prefix = nullptr;
  check(PCGetOptionsPrefix(pc, &prefix));
  core::Handle<PetscOptions, destroy> own;
  check(PetscOptionsCreate(own.put()));
  for (const auto& [name, value] : {std::pair{"coarsen_type", "HMIS"}, std::pair{"interp_type", "ext+i"},
                                    std::pair{"P_max", "4"}, std::pair{"agg_nl", "1"}}) {
    const std::string whole = std::string("-") + (prefix ? prefix : "") + "pc_hypre_boomeramg_" + name;
    check(PetscOptionsSetValue(own.get(), whole.c_str(), value));
  }
  PetscObject object = reinterpret_cast<PetscObject>(pc);
  PetscOptions before = nullptr;
  check(PetscObjectGetOptions(object, &before));
  check(PetscObjectSetOptions(object, own.get()));
  check(PCSetFromOptions(pc));
  check(PetscObjectSetOptions(object, before));
  check(PCSetFromOptions(pc));
}

}  // namespace whirl::thermal
