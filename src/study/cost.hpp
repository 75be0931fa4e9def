#pragma once
// Memory that studies take, estimated from counts: fits to measured runs, good to a factor of two. They are there to
// refuse what was not meant, not to fill a machine to its brim.

#include "whirl/system/options.hpp"

namespace whirl::study {

/// States of the equations of `machine`, displacements and velocities, with the films' own.
[[nodiscard]] double n_states(const system::Machine& machine);

/// The films' own states among them, those of all bearings; about so many, no film is made.
[[nodiscard]] double n_film_states(const system::Machine& machine);

/// A branch of equilibria, or anything that factorises one sparse Jacobian [byte].
[[nodiscard]] double memory_of_equilibria(const system::Machine& machine);

/// Cycles on `intervals` intervals of `stages` time points each, condensed to one dense block an interval; with `radau`
/// (collocation at Radau points) those of a whole shaft are solved by modes in time, without blocks. Films with states
/// of their own are bands, and where there are many no block is formed [byte].
[[nodiscard]] double memory_of_cycles(const system::Machine& machine, double intervals, double stages, bool radau);

/// The same by collocation with the states spread over ranks: the blocks of each point, an eliminated matrix for each
/// interval [byte].
[[nodiscard]] double memory_of_spread_cycles(const system::Machine& machine, double intervals, double stages);

}  // namespace whirl::study
