#include "thermal/journal.hpp"

#include <algorithm>
#include <utility>

#include "whirl/core/agree.hpp"

namespace whirl::thermal {

Solid make_solid(const Rows& film, const Journal& journal) {
  const Mesh& mesh = film.mesh();
  const double after = journal.length - journal.before - mesh.length;
  core::agree(film.comm(), [&] {
    if (journal.before < 0 || after < -1e-9 * mesh.length)
      throw core::InputError("the film reaches beyond the journal: its length or the place of the film are wrong");
    if (!(journal.bore_radius < mesh.radius))
      throw core::InputError("the bore of the journal is as large as the journal");
  });
  Cylinder shape;
  shape.outside = false;
  shape.r = graded(mesh.radius, journal.bore_radius, journal.layers, journal.grading);
  std::reverse(shape.r.begin(), shape.r.end());
  if (journal.rotating) {
    shape.theta = {mesh.begin};
    shape.r.push_back(mesh.radius);  // the surface
  } else {
    shape.theta = columns_beside(mesh, true);
  }
  const std::vector<double> low = beyond(journal.before, mesh.dz(), journal.growth),
                            high = beyond(std::max(after, 0.0), mesh.dz(), journal.growth);
  for (auto step = low.rbegin(); step != low.rend(); ++step) shape.z.push_back(mesh.z(0) - *step);
  for (int j = 0; j < mesh.nodes_along(); ++j) shape.z.push_back(mesh.z(j));
  for (const double step : high) shape.z.push_back(mesh.z(mesh.along) + step);
  shape.film_row = static_cast<int>(low.size());
  return {film, std::move(shape), journal.material, journal.surfaces, "journal_"};
}

}  // namespace whirl::thermal
