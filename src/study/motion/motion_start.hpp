#pragma once
// The state a motion begins with.

#include <complex>
#include <string>
#include <vector>

#include "study/bars/film_limit.hpp"
#include "study/layout.hpp"
#include "study/motion/motion.hpp"
#include "whirl/system/plant.hpp"
#include "whirl/transient/steps/integrator.hpp"

namespace whirl::study {

struct StartState {
  core::Vector x;                                 ///< SI
  std::vector<std::complex<double>> multipliers;  ///< of the cycle it lies on, the largest first; empty if on none
};

/// A cycle to start from wants the whole machine on one rank.
[[nodiscard]] inline Sharing sharing_of(const MotionStart& start) {
  return start.from == MotionStart::From::cycle ? Sharing::nothing : Sharing::machine;
}

/// Reports a start that this machine does not have.
void check_start(const MotionStart& start, const system::Machine& machine, const deck::Report& report);

/// The state at shaft angle zero. Collective on the system's communicator; throws core::NotConverged.
[[nodiscard]] StartState start_state(system::Plant& system, const MotionStart& start);

/// "; the film of bearing B4 is 0.2 um thick" where the motion stands, for one that ended; `x` is room for a state, SI.
/// Empty without films, and where nothing can be told of them. Collective.
[[nodiscard]] std::string thinnest(const FilmLimit& films, system::Plant& system, const transient::Integrator& motion,
                                   Vec x);

}  // namespace whirl::study
