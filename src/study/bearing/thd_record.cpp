#include "study/bearing/thd_record.hpp"

#include <algorithm>
#include <cmath>

#include "study/findings.hpp"
#include "whirl/thermal/cylinder.hpp"

namespace whirl::study {
namespace {

using thermal::Rows;

// The value below which a part of the cells lies, by counting in ever narrower bins.
double percentile(MPI_Comm comm, const std::vector<double>& all, double part, double low, double high) {
  double count = static_cast<double>(all.size());
  MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_DOUBLE, MPI_SUM, comm);
  for (int k = 0; k < 20; ++k) {
    const double middle = (low + high) / 2;
    auto below = static_cast<double>(std::count_if(all.begin(), all.end(), [&](double t) { return t <= middle; }));
    MPI_Allreduce(MPI_IN_PLACE, &below, 1, MPI_DOUBLE, MPI_SUM, comm);
    (below < part * count ? low : high) = middle;
  }
  return (low + high) / 2;
}

io::Dataset by_rows(const Rows& rows, io::Shape shape, std::vector<double> values, const char* unit,
                    const char* description) {
  io::Dataset out{std::move(shape), std::move(values), unit, description};
  if (core::size_of(rows.comm()) > 1)
    out.share = {static_cast<std::size_t>(rows.begin()), static_cast<std::size_t>(rows.mesh().nodes_along())};
  return out;
}

// Of a solid: its rows are the film's, and of a journal those beyond it.
void put_solid(Context& context, const thermal::Solid& solid, Vec temperature, const std::string& name) {
  io::Group& group = context.results.group().child(name);
  const thermal::Cylinder& shape = solid.shape();
  group.put("z", shape.z, "m", "of the nodes along the shaft, from the mid-plane of the bearing");
  std::vector<double> middles;
  for (int k = 0; k < shape.layers(); ++k) middles.push_back(shape.centre(k));
  group.put("r", middles, "m", "of the middles of the cells");
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
}

}  // namespace

TemperatureNumbers temperature_numbers(const ThdFilm& film, const std::vector<double>& temperature) {
  const Rows& rows = film.rows();
  const thermal::Mesh& mesh = rows.mesh();
  double sums[2] = {}, ends[2] = {-1e300, -1e300};
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < mesh.nodes_around(); ++i)
      for (int k = 0; k < mesh.across; ++k) {
        const double volume =
            film.thickness()[static_cast<std::size_t>(rows.node(i, j))] * mesh.width(i) * mesh.depth(j);
        const double t = temperature[static_cast<std::size_t>(rows.cell(k, i, j))];
        sums[0] += volume * t;
        sums[1] += volume;
        ends[0] = std::max(ends[0], t);
        ends[1] = std::max(ends[1], -t);
      }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, rows.comm());
  MPI_Allreduce(MPI_IN_PLACE, ends, 2, MPI_DOUBLE, MPI_MAX, rows.comm());
  TemperatureNumbers out;
  out.mean = sums[0] / sums[1];
  out.maximum = ends[0];
  out.minimum = -ends[1];
  out.percentile_1 = percentile(rows.comm(), temperature, 0.01, out.minimum, out.maximum);
  out.percentile_99 = percentile(rows.comm(), temperature, 0.99, out.minimum, out.maximum);
  return out;
}

SurfaceNumbers surface_numbers(const ThdFilm& film, const std::vector<double>& temperature) {
  const Rows& rows = film.rows();
  const thermal::Mesh& mesh = rows.mesh();
  double sums[2] = {}, most = 0;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < mesh.nodes_around(); ++i) {
      const double t = temperature[static_cast<std::size_t>(rows.node(i, j))], area = mesh.width(i) * mesh.depth(j);
      sums[0] += area * t;
      sums[1] += area;
      most = std::max(most, t);
    }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, rows.comm());
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, rows.comm());
  return {sums[0] / sums[1], most};
}

void put_thd_fields(Context& context, ThdFilm& film, const film::Geometry& geometry) {
  const Rows& rows = film.rows();
  const thermal::Mesh& mesh = rows.mesh();
  const auto n = static_cast<std::size_t>(mesh.nodes_around()), r = static_cast<std::size_t>(rows.count()),
             l = static_cast<std::size_t>(mesh.across);
  io::Group& group = context.results.group().child("film");
  std::vector<double> theta, z;
  for (int i = 0; i < mesh.nodes_around(); ++i) theta.push_back(mesh.theta(i));
  for (int j = 0; j < mesh.nodes_along(); ++j) z.push_back(mesh.z(j));
  group.put("theta", theta, "rad", "of the nodes around, from +x");
  group.put("z", z, "m", "of the nodes along the shaft, from the mid-plane of the bearing");
  group.put("radius", std::vector<double>{geometry.radius}, "m", "of the journal");
  thermal::Thd& thd = film.thd();
  group.put("pressure", by_rows(rows, {r, n}, thd.flow().pressure(), "Pa",
                                "pressure [along][around]: absolute of a gas, above the ambient's of a liquid"));
  group.put("thickness", by_rows(rows, {r, n}, film.thickness(), "m", "film thickness [along][around]"));
  group.put("temperature", by_rows(rows, {r, n, l}, thd.temperature(), "K",
                                   "temperature of the cells [along][around][across], from the bush to the journal"));
  group.put("bush_wall", by_rows(rows, {r, n}, thd.bush_surface(), "K", "temperature of the bush's surface"));
  group.put("journal_wall", by_rows(rows, {r, n}, thd.journal_surface(), "K", "temperature of the journal's surface"));
  std::vector<double> around(r * n), along(r * n);
  const thermal::Flow& flow = thd.flows();
  for (std::size_t c = 0; c < r * n; ++c)
    for (std::size_t k = 0; k < l; ++k) {
      const std::size_t j = static_cast<std::size_t>(rows.begin()) + c / n;
      around[c] += flow.around[c * l + k] / mesh.depth(static_cast<int>(j));
      along[c] += flow.along[c * l + k] / mesh.width(static_cast<int>(c % n));
    }
  group.put("flow_around", by_rows(rows, {r, n}, around, "kg/(m s)", "mass flow around, to the next node"));
  group.put("flow_along", by_rows(rows, {r, n}, along, "kg/(m s)", "mass flow along, from the node before"));
  // Cells between the bush and the journal, as they lie and with their thickness a hundredfold, unwrapped.
  const std::vector<double> ends = thermal::cell_ends(theta, 2 * std::numbers::pi), rims = thermal::cell_ends(z);
  const auto gap = [&](std::size_t j, std::size_t i) {
    const std::size_t row =
        std::clamp<std::size_t>(j, static_cast<std::size_t>(rows.begin()), static_cast<std::size_t>(rows.end()) - 1) -
        static_cast<std::size_t>(rows.begin());
    return 0.5 * (film.thickness()[row * n + i % n] + film.thickness()[row * n + (i + n - 1) % n]);
  };
  const io::Shape cells{static_cast<std::size_t>(mesh.nodes_along()), n, l};
  context.results.show(io::cell_grid(group, "film", "film", "corners", cells, [&](const io::Shape& c) {
    const double radius =
        geometry.radius + geometry.clearance - gap(c[0], c[1]) * static_cast<double>(c[2]) / static_cast<double>(l);
    return std::array{radius * std::cos(ends[c[1]]), radius * std::sin(ends[c[1]]), rims[c[0]]};
  }));
  context.results.show(
      io::cell_grid(group, "film", "film unwrapped", "corners_unwrapped", cells, [&](const io::Shape& c) {
        return std::array{geometry.radius * ends[c[1]], rims[c[0]],
                          -100 * gap(c[0], c[1]) * static_cast<double>(c[2]) / static_cast<double>(l)};
      }));
  if (thd.bush()) put_solid(context, *thd.bush(), thd.bush_temperature(), "bush");
  if (thd.journal()) put_solid(context, *thd.journal(), thd.journal_temperature(), "journal");
}

}  // namespace whirl::study
