#include "study/bearing/thd_results.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "study/columns.hpp"
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

// Means across the film of what its fluid is.
void put_fluid(io::Group& group, ThdAtSpeed& film) {
  const Rows& rows = film.rows();
  const auto n = static_cast<std::size_t>(rows.mesh().nodes_around()), r = static_cast<std::size_t>(rows.count()),
             l = static_cast<std::size_t>(rows.mesh().across);
  const thermal::Fluid& fluid = film.fluid();
  const std::vector<double>&t = film.thd().temperature(), &p = film.thd().flow().pressure();
  const auto put = [&](const char* name, const char* unit, const char* description, const auto& value) {
    std::vector<double> mean(r * n, 0.0);
    for (std::size_t c = 0; c < t.size(); ++c) mean[c / l] += value(p[c / l], t[c]) / static_cast<double>(l);
    group.put(name, by_rows(rows, {r, n}, std::move(mean), unit, description));
  };
  put("viscosity", "Pa s", "of the fluid, mean across the film [along][around]",
      [&](double, double at) { return thermal::viscosity(fluid.viscosity, at).value; });
  put("density", "kg/m^3", "of the fluid, mean across the film [along][around]; vapour of a cavity is left out",
      [&](double pressure, double at) { return fluid.rho(pressure, at); });
  put("conductivity", "W/(m K)", "of the fluid, mean across the film [along][around]",
      [&](double, double at) { return fluid.k(at); });
  put("heat_capacity", "J/(kg K)", "of the fluid at constant pressure, mean across the film [along][around]",
      [&](double, double at) { return fluid.c(at); });
}

// What heats the film and where that goes, over the area of the film.
void put_heat(io::Group& group, ThdAtSpeed& film) {
  const Rows& rows = film.rows();
  const thermal::Mesh& mesh = rows.mesh();
  const auto n = static_cast<std::size_t>(mesh.nodes_around()), r = static_cast<std::size_t>(rows.count()),
             l = static_cast<std::size_t>(mesh.across);
  thermal::ThdSolver& thd = film.thd();
  const auto put = [&](const char* name, std::vector<double> watts, const char* description) {
    for (std::size_t c = 0; c < watts.size(); ++c)
      watts[c] /= mesh.width(static_cast<int>(c % n)) * mesh.depth(rows.begin() + static_cast<int>(c / n));
    group.put(name, by_rows(rows, {r, n}, std::move(watts), "W/m^2", description));
  };
  put("heat_bush", thd.wall_heat(false), "conducted from the film to the bush [along][around]");
  put("heat_journal", thd.wall_heat(true), "conducted from the film to the journal [along][around]");
  std::vector<double> dissipation(r * n, 0.0);
  for (std::size_t c = 0; c < thd.flows().heat.size(); ++c) dissipation[c / l] += thd.flows().heat[c];
  if (film.is_gas()) {
    std::vector<double> expansion = thd.flow().expansion(thd.flows());
    for (std::size_t c = 0; c < expansion.size(); ++c) dissipation[c] -= expansion[c];
    put("expansion", std::move(expansion), "work of pressure on the film [along][around], negative where gas expands");
  }
  put("dissipation", std::move(dissipation), "viscosity times the square of the shear rate, across [along][around]");
}

// Where orifices are, at nodes of the mesh, and what they give.
void put_orifices(io::Group& results, ThdAtSpeed& film) {
  const std::vector<thermal::Orifice>& orifices = film.orifices();
  if (orifices.empty()) return;
  const thermal::Mesh& mesh = film.rows().mesh();
  io::Group& group = results.child("orifices");
  group.put("theta", column(orifices, [&](const thermal::Orifice& o) { return mesh.theta(o.i); }), "rad",
            "of the node of each orifice, from +x");
  group.put("z", column(orifices, [&](const thermal::Orifice& o) { return mesh.z(o.j); }), "m",
            "of the node of each orifice, from the mid-plane of the bearing");
  group.put("diameter", column(orifices, &thermal::Orifice::diameter), "m", "of each orifice");
  group.put("mass_flow", film.thd().flow().orifice_flows(), "kg/s", "into the film");
}

// Nodes that the deck or the pressure sets apart, as numbers.
template <class Number>
void put_marks(io::Group& group, const Rows& rows, const char* name, const std::vector<Number>& marks,
               const char* description) {
  const auto r = static_cast<std::size_t>(rows.count());
  group.put(name, by_rows(rows, {r, marks.size() / r}, {marks.begin(), marks.end()}, "1", description));
}

}  // namespace

TemperatureNumbers temperature_numbers(const ThdAtSpeed& film, const std::vector<double>& temperature) {
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

SurfaceNumbers surface_numbers(const ThdAtSpeed& film, const std::vector<double>& temperature) {
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

void put_thd_fields(Context& context, ThdAtSpeed& film, const film::Geometry& geometry) {
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
  thermal::ThdSolver& thd = film.thd();
  group.put("pressure", by_rows(rows, {r, n}, thd.flow().pressure(), "Pa",
                                "pressure [along][around]: absolute of a gas, above the ambient's of a liquid"));
  group.put("pressure_isothermal", by_rows(rows, {r, n}, film.isothermal().pressure, "Pa",
                                           "pressure of the film at the ambient's temperature [along][around]"));
  group.put("thickness", by_rows(rows, {r, n}, film.thickness(), "m", "film thickness [along][around]"));
  group.put("temperature", by_rows(rows, {r, n, l}, thd.temperature(), "K",
                                   "temperature of the cells [along][around][across], from the bush to the journal"));
  group.put("bush_wall", by_rows(rows, {r, n}, thd.surface(false), "K", "temperature of the bush's surface"));
  group.put("journal_wall", by_rows(rows, {r, n}, thd.surface(true), "K", "temperature of the journal's surface"));
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
  thermal::FilmFlow::Velocity middle = thd.flow().middle();
  group.put("velocity_around", by_rows(rows, {r, n}, std::move(middle.around), "m/s",
                                       "velocity around, half-way between bush and journal [along][around]"));
  group.put("velocity_along", by_rows(rows, {r, n}, std::move(middle.along), "m/s",
                                      "velocity along, half-way between bush and journal [along][around]"));
  group.put("speed", std::vector<double>{film.speed()}, "rad/s", "of the shaft");
  if (const std::vector<char> ruptured = thd.flow().ruptured(); !film.is_gas())
    put_marks(group, rows, "ruptured", ruptured, "1 where the film is ruptured [along][around]");
  if (thd.flow().conserves_mass())
    group.put("fill",
              by_rows(rows, {r, n}, thd.flow().fill(), "1", "share of the gap that is full of liquid [along][around]"));
  if (const std::vector<int> grooves = film.grooves(); !grooves.empty())
    put_marks(group, rows, "groove", grooves, "number of the groove that feeds a node, 0 of none [along][around]");
  put_fluid(group, film);
  put_heat(group, film);
  put_orifices(context.results.group(), film);
  show_film(context, film, geometry);
  if (thd.solid(false)) put_solid(context, film, *thd.solid(false), thd.solid_temperature(false), "bush", geometry);
  if (thd.solid(true)) put_solid(context, film, *thd.solid(true), thd.solid_temperature(true), "journal", geometry);
}

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
