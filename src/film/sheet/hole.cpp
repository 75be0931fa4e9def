#include "film/sheet/hole.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "film/sheet/groove.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {
namespace {

using std::numbers::pi;

constexpr double rim_tolerance = 1e-3;  // of a step: nodes nearer to the rim belong to the hole, no way is shorter

// Where a node lies as seen from the middle of a hole, on the developed bore.
struct Place {
  double x = 0.0, z = 0.0;
};

Place from_hole(const Pad& pad, const Hole& hole, double theta, double z) {
  return {pad.radius * std::remainder(theta - hole.angle, 2.0 * pi), z - hole.z};
}

// Part of the way from `out` to `in` that lies outside the rim.
double outside(const Place& out, const Place& in, double radius) {
  const double dx = in.x - out.x, dz = in.z - out.z, a = dx * dx + dz * dz, b = out.x * dx + out.z * dz,
               c = out.x * out.x + out.z * out.z - radius * radius, root = b * b - a * c;
  return root > 0.0 ? std::min(1.0, (-b - std::sqrt(root)) / a) : 1.0;
}

// Free of both edges; a closed pad has none.
bool stands_on(const Pad& pad, const Hole& hole) {
  const double radius = 0.5 * hole.diameter;
  if (pad.closed) return radius < pi * pad.radius;
  double behind = std::fmod(hole.angle - pad.start, 2.0 * pi);
  if (behind < 0.0) behind += 2.0 * pi;
  return pad.radius * behind > radius && pad.radius * (pad.arc - behind) > radius;
}

// A groove that leaves nothing of the bearing is refused for that.
bool meets(const HoleMesh& mesh, int n, const Groove& groove) {
  try {
    return mesh.meets(grooved(n, {groove}));
  } catch (const core::InputError&) {
    return false;
  }
}

}  // namespace

HoleMesh::HoleMesh(const Pad& pad, const Grid& grid, const std::vector<Hole>& holes) : rows_(grid.n_z - 1) {
  const int n = grid.n_theta, first = pad.closed ? 0 : 1;
  const double tolerance = rim_tolerance * std::min(pad.radius * grid.dtheta, grid.dz);
  // Part of a face outside all rims; the rims of two holes may cut the same one.
  using Free = std::map<std::pair<int, int>, double>;
  Free around, along;
  for (std::size_t k = 0; k < holes.size(); ++k) {
    const Hole& hole = holes[k];
    if (!stands_on(pad, hole)) continue;
    if (nodes_.empty()) nodes_.assign(static_cast<std::size_t>((n + 1) * rows_), 0);
    const double radius = 0.5 * hole.diameter;
    const auto place = [&](int i, int j) {
      return from_hole(pad, hole, pad.start + i * grid.dtheta, (j + 1) * grid.dz - 0.5 * pad.length);
    };
    const auto within = [&](int i, int j) {
      const Place at = place(i, j);
      return std::hypot(at.x, at.z) <= radius + tolerance;
    };
    bool any = false;
    for (int i = first; i < n; ++i)
      for (int j = 0; j < rows_; ++j) {
        if (!within(i, j)) continue;
        any = true;
        nodes_[static_cast<std::size_t>(i * rows_ + j)] = static_cast<int>(k) + 1;
        if (i == 0) nodes_[static_cast<std::size_t>(n * rows_ + j)] = static_cast<int>(k) + 1;
        const Place in = place(i, j);
        const double step = pad.radius * grid.dtheta;
        const auto cut = [&](Free& free, int face_i, int face_j, const Place& out) {
          free.try_emplace({face_i, face_j}, 1.0).first->second -= 1.0 - outside(out, in, radius);
        };
        if (!within(i - 1, j)) cut(around, pad.closed ? (i + n - 1) % n : i - 1, j, {in.x - step, in.z});
        if (!within(i + 1, j)) cut(around, i, j, {in.x + step, in.z});
        if (!within(i, j - 1)) cut(along, i, j, {in.x, in.z - grid.dz});
        if (!within(i, j + 1)) cut(along, i, j + 1, {in.x, in.z + grid.dz});
      }
    if (!any) throw core::InputError(fmt::format("film: no node of the mesh lies within hole {}", k + 1));
  }
  const auto put = [tolerance](const Free& free, double length, std::vector<Cut>& cuts) {
    for (const auto& [face, part] : free)
      cuts.push_back({face.first, face.second, 1.0 / std::max(part, tolerance / length)});
  };
  put(around, pad.radius * grid.dtheta, around_);
  put(along, grid.dz, along_);
}

bool HoleMesh::meets(const std::vector<bool>& columns) const {
  if (empty()) return false;
  for (std::size_t i = 0; i < columns.size(); ++i)
    for (int j = 0; columns[i] && j < rows_; ++j)
      if (at(static_cast<int>(i), j) > 0) return true;
  return false;
}

std::optional<MisplacedHole> misplaced_hole(const Reynolds& o, const Geometry& g) {
  const std::vector<Pad> pads = make_pads(g, o.inlet);
  for (std::size_t k = 0; k < o.holes.size(); ++k) {
    const Hole& hole = o.holes[k];
    const double radius = 0.5 * hole.diameter;
    const auto apart = [&](double angle, double z) {
      return std::hypot(g.radius * std::remainder(hole.angle - angle, 2.0 * pi), hole.z - z);
    };
    if (std::abs(hole.z) + radius >= 0.5 * g.length) return {{k, "the hole reaches over a side of the bearing"}};
    const auto pad = std::find_if(pads.begin(), pads.end(), [&](const Pad& p) { return stands_on(p, hole); });
    if (pad == pads.end()) return {{k, "the hole does not lie on a pad, free of its edges"}};
    for (std::size_t other = 0; other < k; ++other)
      if (apart(o.holes[other].angle, o.holes[other].z) <= radius + 0.5 * o.holes[other].diameter)
        return {{k, fmt::format("the hole overlaps hole {}", other + 1)}};
    for (std::size_t groove = 0; groove < o.grooves.size(); ++groove)
      if (apart(o.grooves[groove].angle, hole.z) <= radius + 0.5 * g.radius * o.grooves[groove].width)
        return {{k, fmt::format("the hole overlaps groove {}", groove + 1)}};
    try {
      const HoleMesh mesh(*pad, Grid(*pad, o.cells), {hole});
      for (std::size_t groove = 0; pad->closed && groove < o.grooves.size(); ++groove)
        if (meets(mesh, o.cells[0], o.grooves[groove]))
          return {
              {k, fmt::format("the hole overlaps groove {}, whose edges are moved to the nearest nodes: 'cells' are "
                              "{:.3g} mm long",
                              groove + 1, 1e3 * g.radius * pad->arc / o.cells[0])}};
    } catch (const core::InputError&) {
      return {{k, fmt::format("no node of the mesh lies within the hole: 'cells' are {:.3g} mm and {:.3g} mm long",
                              1e3 * g.radius * pad->arc / o.cells[0], 1e3 * g.length / o.cells[1])}};
    }
  }
  return {};
}

}  // namespace whirl::film
