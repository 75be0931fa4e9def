#include "study/bearing/thd_at_speed.hpp"

#include <algorithm>
#include <numbers>
#include <set>

namespace whirl::study {
namespace {

thermal::Mesh mesh_of(const ThdOptions& o, const film::Geometry& g) {
  thermal::Mesh mesh;
  mesh.around = o.cells[0];
  mesh.along = o.cells[1];
  mesh.across = o.cells[2];
  mesh.radius = g.radius;
  mesh.length = g.length;
  return mesh;
}

thermal::FilmFlowOptions flow_of(const ThdOptions& o, const thermal::Mesh& mesh, double speed) {
  using Cavitation = thermal::FilmFlowOptions::Cavitation;
  const bool gas = o.fluid.type == thermal::FluidOptions::Type::gas;
  thermal::FilmFlowOptions out;
  out.fluid = thermal::make_fluid(o.fluid);
  out.heat_ratio = o.fluid.heat_ratio;
  out.ambient = gas ? o.ambient.pressure : 0;
  out.speed = speed;
  out.cavitation = o.cavitation == ThdOptions::Cavitation::none              ? Cavitation::none
                   : o.cavitation == ThdOptions::Cavitation::half_sommerfeld ? Cavitation::half_sommerfeld
                   : o.cavitation == ThdOptions::Cavitation::mass_conserving ? Cavitation::mass_conserving
                                                                             : Cavitation::reynolds;
  out.turbulence = o.turbulence;
  const double step = 2 * std::numbers::pi / mesh.around;
  const auto node_around = [&](double angle) { return static_cast<int>(std::lround(angle / step)); };
  const auto node_along = [&](double z) { return static_cast<int>(std::lround((z / mesh.length + 0.5) * mesh.along)); };
  const std::vector<std::array<int, 2>> nodes = orifice_nodes(o, mesh.length);
  auto node = nodes.begin();
  for (const thermal::OrificeRing& ring : o.orifices)
    for (int k = 0; k < ring.count; ++k, ++node)
      out.orifices.push_back({(*node)[0], (*node)[1], ring.diameter, ring.pressure, ring.temperature});
  for (const thermal::SupplyGroove& groove : o.grooves) {
    const double half = groove.length.value_or(mesh.length) / 2;
    out.feeds.push_back({node_around(groove.angle - groove.width / 2), node_around(groove.angle + groove.width / 2),
                         std::max(node_along(-half), 1), std::min(node_along(half), mesh.along - 1), groove.pressure});
  }
  return out;
}

// K [r, n], of what comes from orifices and grooves; oil that fills a ruptured film comes from the first groove.
std::vector<double> supply_of(const ThdOptions& o, const thermal::Rows& rows, const thermal::FilmFlowOptions& flow) {
  const int n = rows.mesh().nodes_around();
  const double elsewhere = o.grooves.empty() ? o.ambient.temperature : o.grooves.front().temperature;
  std::vector<double> out(static_cast<std::size_t>(rows.count() * n), elsewhere);
  const auto set = [&](int i, int j, double temperature) {
    if (j >= rows.begin() && j < rows.end())
      out[static_cast<std::size_t>(rows.node(((i % n) + n) % n, j))] = temperature;
  };
  for (const thermal::Orifice& orifice : flow.orifices) set(orifice.i, orifice.j, orifice.temperature);
  for (std::size_t k = 0; k < flow.feeds.size(); ++k)
    for (int j = flow.feeds[k].first_along; j <= flow.feeds[k].last_along; ++j)
      for (int i = flow.feeds[k].first_around; i <= flow.feeds[k].last_around; ++i) set(i, j, o.grooves[k].temperature);
  return out;
}

// [r, n], the groove of each node, counted from 1 among those that are `wanted`; empty if none is.
template <class Wanted>
std::vector<int> grooves_of(const thermal::Rows& rows, const thermal::FilmFlowOptions& flow, const Wanted& wanted) {
  std::vector<int> out;
  const int n = rows.mesh().nodes_around();
  int groove = 0;
  for (std::size_t k = 0; k < flow.feeds.size(); ++k) {
    if (!wanted(k)) continue;
    out.resize(static_cast<std::size_t>(rows.count() * n));
    ++groove;
    for (int j = std::max(flow.feeds[k].first_along, rows.begin());
         j <= std::min(flow.feeds[k].last_along, rows.end() - 1); ++j)
      for (int i = flow.feeds[k].first_around; i <= flow.feeds[k].last_around; ++i)
        out[static_cast<std::size_t>(rows.node(((i % n) + n) % n, j))] = groove;
  }
  return out;
}

}  // namespace

std::vector<std::array<int, 2>> orifice_nodes(const ThdOptions& o, double length) {
  std::vector<std::array<int, 2>> out;
  const int around = o.cells[0];
  const double step = 2 * std::numbers::pi / around;
  for (const thermal::OrificeRing& ring : o.orifices)
    for (int k = 0; k < ring.count; ++k) {
      const auto i = static_cast<int>(std::lround((ring.angle + 2 * std::numbers::pi * k / ring.count) / step));
      const auto j = static_cast<int>(std::lround((ring.z / length + 0.5) * o.cells[1]));
      out.push_back({((i % around) + around) % around, j});
    }
  return out;
}

std::optional<std::size_t> orifices_at_one_node(const ThdOptions& o, double length) {
  const std::vector<std::array<int, 2>> nodes = orifice_nodes(o, length);
  std::set<std::array<int, 2>> taken;
  auto node = nodes.begin();
  for (std::size_t ring = 0; ring < o.orifices.size(); ++ring)
    for (int k = 0; k < o.orifices[ring].count; ++k, ++node)
      if (!taken.insert(*node).second) return ring;
  return std::nullopt;
}

ThdAtSpeed::ThdAtSpeed(MPI_Comm comm, const ThdOptions& o, const film::Geometry& g, double speed)
    : rows_(mesh_of(o, g), comm),
      flow_(flow_of(o, rows_.mesh(), speed)),
      supply_(supply_of(o, rows_, flow_)),
      ambient_(o.ambient.temperature),
      clearance_(g.clearance) {
  const thermal::Mesh& mesh = rows_.mesh();
  const double e = o.eccentricity.value_or(0) * g.clearance, attitude = o.attitude.value_or(0);
  place_ = {e * std::cos(attitude), e * std::sin(attitude)};
  for (int j = rows_.begin(); j < rows_.end(); ++j)
    for (int i = 0; i < mesh.nodes_around(); ++i)
      thickness_.push_back(g.clearance - e * std::cos(mesh.theta(i) - attitude));
  thermal::ThdSetup setup;
  setup.flow = flow_;
  setup.order = o.second_order ? 2 : 1;
  setup.ambient = o.ambient.temperature;
  setup.bush = o.bush;
  setup.journal = o.journal;
  setup.inlet_from_bush = !o.orifices.empty() && o.orifices.front().inlet == thermal::OrificeRing::Inlet::bush;
  setup.supply = supply_;
  setup.mixed = grooves_of(rows_, flow_, [&](std::size_t k) { return o.grooves[k].mixing; });
  setup.tolerance = o.tolerance;
  setup.most_iterations = o.most_iterations;
  thd_ = std::make_unique<thermal::ThdSolver>(rows_, std::move(setup), thickness_);
}

std::vector<int> ThdAtSpeed::grooves() const {
  return grooves_of(rows_, flow_, [](std::size_t) { return true; });
}

std::array<double, 2> ThdAtSpeed::force_beside(const std::array<double, 2>& move, std::vector<double>& pressure) const {
  const thermal::Mesh& mesh = rows_.mesh();
  std::vector<double> thickness = this->thickness();
  for (int j = rows_.begin(); j < rows_.end(); ++j)
    for (int i = 0; i < mesh.nodes_around(); ++i)
      thickness[static_cast<std::size_t>(rows_.node(i, j))] -=
          move[0] * std::cos(mesh.theta(i)) + move[1] * std::sin(mesh.theta(i));
  thermal::FilmFlow flow(rows_, flow_, std::move(thickness));
  flow.set_temperature(thd_->temperature());
  if (!pressure.empty()) flow.start(pressure);
  (void)flow.solve();
  pressure = flow.pressure();
  const thermal::FlowReport report = flow.report(flow.flow());
  return {report.force[0], report.force[1]};
}

ThdAtSpeed::Isothermal ThdAtSpeed::isothermal() const {
  std::vector<double> pressure;
  return isothermal(ambient_, pressure);
}

ThdAtSpeed::Isothermal ThdAtSpeed::isothermal(double temperature, std::vector<double>& pressure, bool grown) const {
  const thermal::Mesh& mesh = rows_.mesh();
  const auto l = static_cast<std::size_t>(mesh.across);
  thermal::FilmFlow film(rows_, flow_, grown ? thickness() : thickness_);
  film.set_temperature(std::vector<double>(thickness_.size() * l, temperature));
  if (!pressure.empty()) film.start(pressure);
  (void)film.solve();
  pressure = film.pressure();
  const thermal::Flow flow = film.flow();
  double sums[2] = {0, 0};  // kg/s, kg K/s
  const auto enters = [&](double mass, double of) {
    if (mass <= 0) return;
    sums[0] += mass;
    sums[1] += mass * of;
  };
  for (std::size_t cell = 0; cell < flow.inflow.size(); ++cell) enters(flow.inflow[cell], supply_[cell / l]);
  const std::size_t row = static_cast<std::size_t>(mesh.nodes_around()) * l;
  for (std::size_t k = 0; k < row; ++k) {
    if (rows_.begin() == 0) enters(flow.along[k], ambient_);
    if (rows_.end() == mesh.nodes_along()) enters(-flow.along[flow.along.size() - row + k], ambient_);
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, rows_.comm());
  return {film.pressure(), film.report(flow), sums[0], sums[0] > 0 ? sums[1] / sums[0] : ambient_};
}

}  // namespace whirl::study
