#pragma once
// What options of PETSc ask of a nonlinear solver, where not every type of it works.

#include <petscsnes.h>

#include <initializer_list>

namespace whirl::core {

/// Calls SNESSetFromOptions; the user may choose a type among `types`. Throws core::InputError (agreed) if the options
/// ask for another type, which would need what the solver has not got, or for a type that does not exist. Collective.
void set_from_options(SNES snes, std::initializer_list<const char*> types);

/// Types that solve by Newton's method with a Jacobian.
inline constexpr std::initializer_list<const char*> newton_types = {SNESNEWTONLS, SNESNEWTONTR};

}  // namespace whirl::core
