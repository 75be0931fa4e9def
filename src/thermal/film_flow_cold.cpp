// Where a film that ruptures begins its search for the pressure.
#include <algorithm>
#include <cmath>

#include "thermal/film_flow_work.hpp"
#include "whirl/core/error.hpp"

namespace whirl::thermal {
namespace {

// Below this many intervals around the borders of the cavity are found in a few steps.
constexpr int few = 32;

Mesh halved(Mesh mesh) {
  mesh.around /= 2;
  return mesh;
}

}  // namespace

// The set of nodes that are free grows by one row a step where the film ruptures later than was thought, so that from
// no pressure at all the steps are as many as the nodes that the border passes. Every other node around knows the
// border to its own spacing: the rest is a few steps on each of the meshes from coarse to fine. The rows along, and
// with them the ranks, are the same on all.
void FilmFlow::Work::begin_on_half() {
  const bool ruptures = options.cavitation == FilmFlowOptions::Cavitation::reynolds;
  if (!ruptures || !options.orifices.empty() || mesh.around % 2 != 0 || mesh.around <= few) return;
  const Rows half(halved(mesh), rows.comm());
  const int many = half.mesh().nodes_around();
  const auto l = at(mesh.across);
  std::vector<double> thickness, warm;
  for (int q = rows.begin(); q < rows.end(); ++q)
    for (int i = 0; i < many; ++i) {
      const std::size_t node = halo(2 * i, q);
      thickness.push_back(h[node]);
      for (std::size_t k = 0; k < l; ++k) warm.push_back(temperature[node * l + k]);
    }
  FilmFlowOptions there = options;
  for (Feed& feed : there.feeds) {
    feed.first_around = static_cast<int>(std::floor(feed.first_around / 2.0));
    feed.last_around = static_cast<int>(std::ceil(feed.last_around / 2.0));
    if (!mesh.closed) feed.last_around = std::min(feed.last_around, many - 1);
  }
  FilmFlow coarse(half, there, std::move(thickness));
  coarse.set_temperature(warm);
  try {
    (void)coarse.solve();
  } catch (const core::NotConverged&) {  // on all ranks: it is a guess only
    return;
  }
  const std::vector<double>& p = coarse.pressure();
  for (int q = rows.begin(); q < rows.end(); ++q)
    for (int i = 0; i < n; ++i) {
      const double left = p[at(half.node(i / 2, q))], right = p[at(half.node((i + 1) / 2 % many, q))];
      pressure[at(rows.node(i, q))] = 0.5 * (left + right);
    }
}

}  // namespace whirl::thermal
