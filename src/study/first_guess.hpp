#pragma once
// Where Newton's method for an equilibrium starts.

#include "whirl/core/petsc.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

/// A state from which Newton's method finds an equilibrium at the present parameter: the guess of `plant`, or where
/// films have many states of their own the equilibrium on film meshes of half the cells in each direction, found alike.
/// What is full and what is not is then known but for a line of cells, and the number of iterations does not grow with
/// the mesh. Collective.
[[nodiscard]] core::Vector first_guess(system::Plant& plant);

}  // namespace whirl::study
