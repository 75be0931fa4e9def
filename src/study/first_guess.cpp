#include "first_guess.hpp"

#include "common.hpp"
#include "study/bars/film_mesh.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::study {

core::Vector first_guess(system::Plant& plant) {
  constexpr int few_states = 4000;  // no cost: so many were found from anywhere
  const auto* const fine = dynamic_cast<const system::RotorSystem*>(&plant);
  if (!fine || fine->own_states() <= few_states) return plant.guess();
  try {
    system::RotorSystem coarse(plant.comm(), with_film_mesh(fine->train(), {0.5, 0.5}), plant.speed());
    if (coarse.own_states() > fine->own_states() / 2) return plant.guess();
    // Only the coarsest films are tried at other speeds: each level trying all would take all times all.
    if (coarse.own_states() <= few_states) {
      Walker walker(coarse);
      return resampled(plant, coarse, coarse.gather(walker.at(plant.speed())));
    }
    coarse.set_forcing(false);
    const core::Vector x = first_guess(coarse);
    solve::NewtonOptions options;
    options.max_iterations = 30;
    if (solve::find_equilibrium(coarse, x.get(), options).converged)
      return resampled(plant, coarse, coarse.gather(x.get()));
  } catch (const core::NotConverged&) {
  } catch (const core::DomainError&) {
  } catch (const core::InputError&) {  // a mesh too coarse for what the films hold
  }
  return plant.guess();
}

}  // namespace whirl::study
