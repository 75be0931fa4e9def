#pragma once
// What is recorded of a fold or Hopf point of equilibria beside its place: bars, frequency, criticality.

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "study/bars/film_mesh.hpp"
#include "study/equilibrium/equilibrium_branch.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/solve/branch/continuation.hpp"
#include "whirl/solve/newton/newton.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

/// Lengths of the differences behind third derivatives, in steps of 1.2e-4 clearances at the place that moves most.
///
/// Films that cavitate on a mesh have third derivatives that belong to it where differences are short. Over a hundredth
/// and a fiftieth of a clearance, less than the motions that are born, their forces are smooth, and up to ten times
/// that coefficients hardly move. Forces in closed form take shorter ones.
struct DifferenceSteps {
  double shorter, longer;
};
[[nodiscard]] inline DifferenceSteps steps_of(const MeshLaw& law) {
  return law.piecewise ? DifferenceSteps{80, 160} : DifferenceSteps{8, 16};
}
/// Of the coefficient by the longer one: truncation makes it 4/3 of what the shorter one says differently, the rest is
/// for kinks.
[[nodiscard]] inline double doubt_of_steps(double shorter, double longer) {
  return 2 * std::abs(shorter - longer);
}

/// Newton's method for the place of a bifurcation. Where tangents jump it arrives within the smooth piece that it
/// begins in or not at all: a few whole steps tell.
[[nodiscard]] inline solve::NewtonOptions to_refine(solve::NewtonOptions newton, const MeshLaw& law) {
  if (law.kinks) newton.max_iterations = 6, newton.searches = false;
  return newton;
}

/// A bifurcation of equilibria that a branch found, and how to meet it on other film meshes.
struct EquilibriumEvent {
  using Rows = std::vector<std::vector<double>>;
  using Work = std::function<std::vector<double>(std::size_t k)>;
  system::Plant& system;             ///< the one that is followed; left at the parameter of the event
  Vec x;                             ///< the equilibrium [SI]
  const solve::LocatedEvent& found;  ///< in the scaled parameter of the branch
  double scale = 1;                  ///< SI value of one unit of it
  double state_weight = 1;           ///< of the arclength
  solve::NewtonOptions newton = {};
  std::vector<FilmMesh> meshes = {};
  MeshLaw law = {};
  /// The system with these cells over those of the deck.
  std::function<std::unique_ptr<system::Plant>(const std::array<double, 2>&)> make = {};
  /// Rows of that name: those that are known already, else work(k), shared between the ranks; nothing: always `work`.
  std::function<Rows(const std::string& name, std::size_t n, const Work& work)> share = {};
  /// The system with its shaft cut into elements half as long; nothing where it has no such mesh.
  std::function<std::unique_ptr<system::Plant>()> cut = {};
  bool cycles = true;  ///< cycles may decide on the criticality: they need the whole machine on one rank
};

/// Puts the uncertainty of the place, the whirl frequency of a Hopf point and its uncertainty, and the criticality with
/// its coefficient and uncertainty into `b`. On each other film mesh the same bifurcation is located by Newton's method
/// from the resampled equilibrium, and on the shaft of shorter elements from the equilibrium there. Criticality is that
/// of the first Lyapunov coefficient, or where its bar contains zero and forces are smooth by pieces only, that of
/// cycles at three amplitudes; of a fold the side on which the equilibria exist by its second derivative;
/// "undetermined" where the bar of that contains zero, too. Collective.
void describe(io::Bifurcation& b, const EquilibriumEvent& at);

/// Place, whirl frequency and coefficient of the same bifurcation with these cells over those of the deck; empty if it
/// cannot be had there. Collective.
[[nodiscard]] std::vector<double> numbers_on(const EquilibriumEvent& at, const std::array<double, 2>& film_cells);

/// The system of a branch of equilibria, and how the branch is followed. Collective.
[[nodiscard]] std::unique_ptr<system::Plant> plant_of(const Context& context, const EquilibriumBranchOptions& options,
                                                      const std::array<double, 2>& film_cells = {1, 1},
                                                      int shaft_parts = 1);
[[nodiscard]] solve::ContinuationOptions continuation_of(const EquilibriumBranchOptions& options);

/// Puts `coefficient` with the verdict on it into `b`: `negative` or `positive`, or "undetermined" where the bar
/// contains zero.
void put_criticality(io::Bifurcation& b, double coefficient, double uncertainty, const char* negative,
                     const char* positive, const std::string& by);

}  // namespace whirl::study
