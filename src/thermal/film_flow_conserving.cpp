// The film that conserves its mass: what its faces pass where the gap is not full.
#include <algorithm>
#include <cmath>

#include "thermal/film_flow_work.hpp"

namespace whirl::thermal {

// Where a node stands for its pressure the derivative is that of the pressure's flow; where it stands for the empty
// share, that of the drag if the node lies upstream.
Flux FilmFlow::Work::through_partly(double gradient, double drag, double p, double q) const {
  const bool from_p = drag > 0;
  const double upstream = from_p ? p : q, fill = upstream < 0 ? 1 + upstream / scale : 1;
  Flux out{gradient * (std::max(q, 0.0) - std::max(p, 0.0)) + drag * fill, p < 0 ? 0 : -gradient, q < 0 ? 0 : gradient};
  if (upstream < 0) (from_p ? out.before : out.behind) += drag / scale;
  return out;
}

// With this an empty share and a pressure move about as much oil from node to node.
void FilmFlow::Work::choose_scale() {
  double sums[2] = {};
  for (const Face& face : around) {
    sums[0] += std::abs(face.drag);
    sums[1] += std::abs(face.gradient);
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, rows.comm());
  scale = sums[0] / sums[1] * mesh.dx();
}

}  // namespace whirl::thermal
