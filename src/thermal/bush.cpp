#include "thermal/bush.hpp"

#include <utility>

#include "whirl/core/agree.hpp"

namespace whirl::thermal {

Solid make_solid(const Rows& film, const Bush& bush) {
  const Mesh& mesh = film.mesh();
  core::agree(film.comm(), [&] {
    if (!(bush.outer_radius > mesh.radius))
      throw core::InputError("the bush has no thickness: its outer radius is too small");
  });
  Cylinder shape;
  shape.r = graded(mesh.radius, bush.outer_radius, bush.layers, bush.grading);
  shape.theta = columns_beside(mesh, bush.ring);
  shape.closed = mesh.closed || bush.ring;
  for (int j = 0; j < mesh.nodes_along(); ++j) shape.z.push_back(mesh.z(j));
  return {film, std::move(shape), bush.material, bush.surfaces, "bush_"};
}

}  // namespace whirl::thermal
