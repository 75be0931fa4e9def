#pragma once
// The film meshes beside the one in use, on which studies compute a number again to know its error.

#include <array>
#include <vector>

#include "study/bars/error_bar.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/solve/cycle/cycle.hpp"
#include "whirl/system/options.hpp"
#include "whirl/system/plant.hpp"
#include "whirl/system/train.hpp"

namespace whirl::study {

struct LayoutOptions;

/// Of films, or of the shaft.
using FilmMesh = OtherMesh;

/// Half and double the cells of each direction that a film of the machine has a mesh in; of fewer than 24
/// cells around or 14 along four times as many, too, because half of them shows little; two more between them where
/// forces have kinks, so that the scatter is seen; and coarser meshes only, as many of them, where films have more than
/// LayoutOptions::refined_states: finer ones would cost more than the branch. Each mesh once: few cells are rounded to
/// fewer meshes. Empty for machines without film meshes, and where LayoutOptions asks for no bars.
[[nodiscard]] std::vector<FilmMesh> film_meshes(const system::Machine& machine, const LayoutOptions& layout);

/// The train with the cells of its films multiplied and rounded: at least four, even ones for Simpson's rule.
[[nodiscard]] system::Train with_film_mesh(system::Train train, const std::array<double, 2>& factor);

/// Order of the films' equations (one with upwind differences, else two: cavitation limits it) and whether their forces
/// have kinks themselves (film::Facts::smoothness: Simpson's rule, whose weights jump where the pressure changes its
/// sign), or derivatives of them.
[[nodiscard]] MeshLaw law_of(const system::Machine& machine, const LayoutOptions& layout);

/// Order at which errors of time steps fall that a scheme of order `scheme` makes on the machine's films. A step with a
/// jump of a force's derivative k + 1 in it leaves an error of h^(k+2), in whichever place the jump stands: a film
/// whose force has k continuous derivatives (film::Facts::smoothness) limits the order to k + 2.
[[nodiscard]] double order_in_time(const system::Machine& machine, double scheme);

/// The whole state of `from` on the film meshes of `to`, distributed. Collective.
[[nodiscard]] core::Vector resampled(const system::Plant& to, const system::Plant& from,
                                     const std::vector<double>& whole);
/// The same of a cycle, point by point: of each rank its rows of `from`, and then of `to`.
[[nodiscard]] solve::Cycle resampled(const system::Plant& to, system::Plant& from, solve::Cycle cycle);

}  // namespace whirl::study
