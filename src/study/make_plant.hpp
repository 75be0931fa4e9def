#pragma once
// The system of a deck, for studies that follow branches and motions of any kind of system, and where its equilibria
// are sought from.

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "study/parameter.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

/// Which system is wanted.
struct PlantRequest {
  std::vector<std::string> unbalance;      ///< of a rotor, applied together
  const Parameter* parameter = nullptr;    ///< that of a branch; null: a rotor's speed, and none of another system
  double value = 0;                        ///< of the parameter, SI
  double speed = 0;                        ///< of a rotor, where the parameter is another one [rad/s]
  std::array<double, 2> film_cells{1, 1};  ///< cells of its films over those of the deck
  int shaft_parts = 1;                     ///< into which each segment of its shaft is cut
};

/// The system that `machine` describes. It refers to `machine` and to the parameter, which outlive it. Collective.
[[nodiscard]] std::unique_ptr<system::Plant> make_plant(MPI_Comm comm, const system::Machine& machine,
                                                        const PlantRequest& request);

/// The equilibrium at the present parameter, without forcing. Collective; throws core::NotConverged.
[[nodiscard]] core::Vector find_rest(system::Plant& plant);

/// A state from which Newton's method finds an equilibrium at the present parameter: the guess of `plant`, or where
/// films have many states of their own the equilibrium on film meshes of half the cells in each direction, found alike.
/// What is full and what is not is then known but for a line of cells, and the number of iterations does not grow with
/// the mesh. Collective.
[[nodiscard]] core::Vector first_guess(system::Plant& plant);

}  // namespace whirl::study
