#include "study/bearing/thd_shown.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "study/findings.hpp"
#include "whirl/thermal/cylinder.hpp"

namespace whirl::study {
namespace {

using thermal::Rows;

constexpr double magnified = 100;  // the film where it is unwrapped
constexpr double turn = 2 * std::numbers::pi;

}  // namespace

void show_film(Context& context, ThdAtSpeed& film, const film::Geometry& geometry) {
  const Rows& rows = film.rows();
  const thermal::Mesh& mesh = rows.mesh();
  const auto n = static_cast<std::size_t>(mesh.nodes_around()), l = static_cast<std::size_t>(mesh.across);
  io::Group& group = context.results.group().child("film");
  const std::vector<double> ends = thermal::cell_ends(group.reals("theta"), turn),
                            rims = thermal::cell_ends(group.reals("z"));
  const double bore = geometry.radius + geometry.clearance;
  // m, depth of a corner below the bush; corners between two rows have the thickness of the one behind.
  const auto depth = [&](const io::Shape& c) {
    const std::size_t row = std::clamp<std::size_t>(c[0], static_cast<std::size_t>(rows.begin()),
                                                    static_cast<std::size_t>(rows.end()) - 1) -
                            static_cast<std::size_t>(rows.begin());
    const double gap = 0.5 * (film.thickness()[row * n + c[1] % n] + film.thickness()[row * n + (c[1] + n - 1) % n]);
    return gap * static_cast<double>(c[2]) / static_cast<double>(l);
  };
  const auto wrapped = [&](const io::Shape& c, double radius) {
    return std::array{radius * std::cos(ends[c[1]]), radius * std::sin(ends[c[1]]), rims[c[0]]};
  };
  const auto flat = [&](const io::Shape& c, double height) {
    return std::array{geometry.radius * ends[c[1]], rims[c[0]], height};
  };
  const io::Shape surface{static_cast<std::size_t>(mesh.nodes_along()), n}, cells{surface[0], n, l};
  const auto show = [&](const char* name, const char* corners, const io::Shape& shape, const auto& position) {
    context.results.show(io::cell_grid(group, "film", name, corners, shape, position));
  };
  show("film", "corners", cells, [&](const io::Shape& c) { return wrapped(c, bore - depth(c)); });
  show("film unwrapped", "corners_unwrapped", cells,
       [&](const io::Shape& c) { return flat(c, -magnified * depth(c)); });
  show("film surface", "corners_surface", surface, [&](const io::Shape& c) { return wrapped(c, bore); });
  show("film surface unwrapped", "corners_surface_unwrapped", surface, [&](const io::Shape& c) { return flat(c, 0); });
}

void put_solid(Context& context, const ThdAtSpeed& film, const thermal::Solid& solid, Vec temperature,
               const std::string& name, const film::Geometry& geometry) {
  io::Group& group = context.results.group().child(name);
  const thermal::Cylinder& shape = solid.shape();
  group.put("z", shape.z, "m", "of the nodes along the shaft, from the mid-plane of the bearing");
  std::vector<double> middles;
  for (int k = 0; k < shape.layers(); ++k) middles.push_back(shape.centre(k));
  group.put("r", middles, "m", "of the middles of the cells");
  group.put("r_faces", shape.r, "m", "between the cells; of a turning journal the last cell is its surface");
  const bool round = shape.columns() > 1;
  if (round) group.put("theta", shape.theta, "rad", "of the nodes around, from +x");
  const core::ReadArray t(temperature);
  io::Shape extents{static_cast<std::size_t>(solid.end() - solid.begin())};
  if (round) extents.push_back(static_cast<std::size_t>(shape.columns()));
  extents.push_back(static_cast<std::size_t>(shape.layers()));
  io::Dataset data{extents, std::vector<double>(t.data(), t.data() + t.size()), "K",
                   "temperature of the cells [along][around][r], of a turning journal [along][r]"};
  if (core::size_of(solid.comm()) > 1) data.share = {static_cast<std::size_t>(solid.begin()), shape.z.size()};
  group.put("temperature", std::move(data));

  const std::vector<double> rims = thermal::cell_ends(shape.z);
  io::Shape cells{shape.z.size(), static_cast<std::size_t>(shape.layers())};
  if (!round) {
    context.results.show(io::cell_grid(group, name, name, "corners", cells, [&](const io::Shape& c) {
      return std::array{film.place()[0] + shape.r[c[1]], film.place()[1], rims[c[0]]};
    }));
    return;
  }
  const std::vector<double> ends = thermal::cell_ends(shape.theta, turn);
  cells.insert(cells.begin() + 1, static_cast<std::size_t>(shape.columns()));
  context.results.show(io::cell_grid(group, name, name, "corners", cells, [&](const io::Shape& c) {
    const double radius = shape.r[c[2]] + (shape.outside ? geometry.clearance : 0);
    const std::array<double, 2> middle = shape.outside ? std::array{0.0, 0.0} : film.place();
    return std::array{middle[0] + radius * std::cos(ends[c[1]]), middle[1] + radius * std::sin(ends[c[1]]), rims[c[0]]};
  }));
}

}  // namespace whirl::study
