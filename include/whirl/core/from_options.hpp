#pragma once
// PETSc options that change a solver, but not what its answer is accurate to.

#include <petscsnes.h>

#include <initializer_list>

#include "whirl/core/petsc.hpp"

typedef struct _p_EPS* EPS;
typedef struct _p_TS* TS;

namespace whirl::core {

/// Types that solve by Newton's method with a Jacobian.
inline constexpr std::initializer_list<const char*> newton_types = {SNESNEWTONLS, SNESNEWTONTR};

/// XXXSetFromOptions(), after which the tolerances may be tighter than the ones set before, not looser: what a number
/// is off by is in its error bar with the program's own tolerance. Relative ones up to 1e-14 are rounding. Throws
/// InputError, on all ranks, that names the option, its value, and the largest one that is taken; also for
/// -PREFIX_snes_convergence_test and -PREFIX_eps_conv_..., which replace the test itself. Collective.
/// A nonlinear solver may be one of `types`; InputError if the options ask for another type, which would need what the
/// solver has not got, or for a type that does not exist.
void set_from_options(SNES solver, std::initializer_list<const char*> types = newton_types);
void set_from_options(EPS solver);
void set_from_options(TS solver);
/// Of a linear solver whose answer nothing corrects.
void set_from_options(KSP solver);

}  // namespace whirl::core
