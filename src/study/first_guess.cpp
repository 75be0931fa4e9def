#include "first_guess.hpp"

#include "common.hpp"
#include "study/bars/film_mesh.hpp"
#include "whirl/core/error.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::study {

core::Vector first_guess(system::Plant& plant) {
  constexpr int few_states = 4000;  // are found from anywhere
  const auto* const fine = dynamic_cast<const system::RotorSystem*>(&plant);
  if (!fine || fine->own_states() <= few_states) return plant.guess();
  system::RotorSystem coarse(plant.comm(), with_film_mesh(fine->train(), {0.5, 0.5}), plant.speed());
  if (coarse.own_states() > fine->own_states() / 2) return plant.guess();
  try {
    Walker walker(coarse);
    return resampled(plant, coarse, coarse.gather(walker.at(plant.speed())));
  } catch (const core::NotConverged&) {
    return plant.guess();
  }
}

}  // namespace whirl::study
