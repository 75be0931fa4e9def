#pragma once
// Film and solids of a bearing with heat as meshes for ParaView.

#include <string>

#include "study/bearing/thd_at_speed.hpp"

namespace whirl::study {

/// Four grids of what the group `film` of the results holds by now: the cells between bush and journal, and the surface
/// with pressure, thickness, walls and flow, each as it lies and unwrapped (x = radius times angle, y along the shaft;
/// the film a hundred times as thick). Collective.
void show_film(Context& context, ThdAtSpeed& film, const film::Geometry& geometry);

/// The temperature of a solid into a group `name` of the results, and its grid: a bush where the film ends, a journal
/// where it stands, a turning one as the half of a section through its axis. Collective.
void put_solid(Context& context, const ThdAtSpeed& film, const thermal::Solid& solid, Vec temperature,
               const std::string& name, const film::Geometry& geometry);

}  // namespace whirl::study
