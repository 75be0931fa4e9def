#pragma once
// What a film with heat shows: numbers, and fields for pictures and ParaView.

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

}  // namespace whirl::study
