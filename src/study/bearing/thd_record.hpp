#pragma once
// Fields and pictures of a film with heat and of its solids.

#include <string>

#include "study/bearing/thd_at_speed.hpp"

namespace whirl::study {

/// K, of the cells of a film: by volume, and the extremes and percentiles of the cells.
struct TemperatureNumbers {
  double mean = 0, minimum = 0, maximum = 0, percentile_1 = 0, percentile_99 = 0;
};
/// Collective. Percentiles are right to a millionth of the span.
[[nodiscard]] TemperatureNumbers temperature_numbers(const ThdAtSpeed& film, const std::vector<double>& temperature);

/// K, of a surface: its mean and its greatest temperature, of arrays [r, n]. Collective.
struct SurfaceNumbers {
  double mean = 0, maximum = 0;
};
[[nodiscard]] SurfaceNumbers surface_numbers(const ThdAtSpeed& film, const std::vector<double>& temperature);

/// Fields of film and solids into `group`, rows shared by the ranks, and their meshes. Collective.
void put_thd_fields(Context& context, ThdAtSpeed& film, const film::Geometry& geometry);

/// Four grids of what the group `film` of the results holds by now: the cells between bush and journal, and the surface
/// with pressure, thickness, walls and flow, each as it lies and unwrapped (x = radius times angle, y along the shaft;
/// the film a hundred times as thick). Collective.
void show_film(Context& context, ThdAtSpeed& film, const film::Geometry& geometry);

/// The temperature of a solid into a group `name` of the results, and its grid: a bush where the film ends, a journal
/// where it stands, a turning one as the half of a section through its axis. Collective.
void put_solid(Context& context, const ThdAtSpeed& film, const thermal::Solid& solid, Vec temperature,
               const std::string& name, const film::Geometry& geometry);

}  // namespace whirl::study
