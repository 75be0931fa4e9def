#include "study/make_plant.hpp"

#include <algorithm>
#include <cmath>

#include "study/bars/film_mesh.hpp"
#include "study/bars/shaft_mesh.hpp"
#include "study/common.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::study {

std::unique_ptr<system::Plant> make_plant(MPI_Comm comm, const system::Machine& machine, const PlantRequest& request) {
  const Parameter* varied = request.parameter && request.parameter->path != "speed" ? request.parameter : nullptr;
  const auto machine_at = [&machine, varied](double p) {
    return varied ? with_parameter(machine, varied->path, p) : machine;
  };
  const double magnitude = varied ? std::max(std::abs(varied->range.from), std::abs(varied->range.to)) : 1;
  if (!system::is_rotor(machine)) return system::make_other(comm, {machine_at, request.value, magnitude});
  const auto train_at = [machine_at, unbalance = request.unbalance, cells = request.film_cells,
                         parts = request.shaft_parts](double p) {
    return with_cut_shaft(with_film_mesh(system::train_of(machine_at(p), unbalance), cells), parts);
  };
  if (!varied) return std::make_unique<system::RotorSystem>(comm, train_at(0), request.value);
  return std::make_unique<system::RotorSystem>(comm, system::Varying{train_at, request.value, magnitude},
                                               request.speed);
}

core::Vector find_rest(system::Plant& plant) {
  if (plant.parameter_is_speed()) {
    Walker walker(plant);
    Vec there = walker.at(plant.parameter());
    core::Vector x = core::duplicate(there);
    core::check(VecCopy(there, x.get()));
    return x;
  }
  core::Vector x = first_guess(plant);
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  plant.set_forcing(false);
  const auto result = solve::find_equilibrium(plant, x.get(), newton);
  plant.set_forcing(true);
  if (!result.converged) throw core::NotConverged("no equilibrium to start from: " + result.reason);
  return x;
}

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
