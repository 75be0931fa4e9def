#include "study/bearing/thd_film.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

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
                                                                             : Cavitation::reynolds;
  const double step = 2 * std::numbers::pi / mesh.around;
  const auto node_around = [&](double angle) { return static_cast<int>(std::lround(angle / step)); };
  const auto node_along = [&](double z) { return static_cast<int>(std::lround((z / mesh.length + 0.5) * mesh.along)); };
  for (const thermal::OrificeRing& ring : o.orifices)
    for (int k = 0; k < ring.count; ++k) {
      const int i = node_around(ring.angle + 2 * std::numbers::pi * k / ring.count);
      out.orifices.push_back({((i % mesh.around) + mesh.around) % mesh.around, node_along(ring.z), ring.diameter,
                              ring.pressure, ring.temperature});
    }
  for (const thermal::SupplyGroove& groove : o.grooves) {
    const double half = groove.length.value_or(mesh.length) / 2;
    out.feeds.push_back({node_around(groove.angle - groove.width / 2), node_around(groove.angle + groove.width / 2),
                         std::max(node_along(-half), 1), std::min(node_along(half), mesh.along - 1), groove.pressure});
  }
  return out;
}

// K [r, n], of what comes from orifices and grooves.
std::vector<double> supply_of(const ThdOptions& o, const thermal::Rows& rows, const thermal::FilmFlowOptions& flow) {
  const int n = rows.mesh().nodes_around();
  std::vector<double> out(static_cast<std::size_t>(rows.count() * n), o.ambient.temperature);
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

}  // namespace

ThdFilm::ThdFilm(MPI_Comm comm, const ThdOptions& o, const film::Geometry& g, double speed)
    : rows_(mesh_of(o, g), comm), flow_(flow_of(o, rows_.mesh(), speed)), ambient_(o.ambient.temperature) {
  const thermal::Mesh& mesh = rows_.mesh();
  const double e = o.eccentricity * g.clearance;
  place_ = {e * std::cos(o.attitude), e * std::sin(o.attitude)};
  for (int j = rows_.begin(); j < rows_.end(); ++j)
    for (int i = 0; i < mesh.nodes_around(); ++i)
      thickness_.push_back(g.clearance - e * std::cos(mesh.theta(i) - o.attitude));
  thermal::ThdSetup setup;
  setup.flow = flow_;
  setup.order = o.second_order ? 2 : 1;
  setup.ambient = o.ambient.temperature;
  setup.bush = o.bush;
  setup.journal = o.journal;
  setup.inlet_from_bush = !o.orifices.empty() && o.orifices.front().inlet == thermal::OrificeRing::Inlet::bush;
  setup.supply = supply_of(o, rows_, flow_);
  setup.tolerance = o.tolerance;
  setup.most_iterations = o.most_iterations;
  thd_ = std::make_unique<thermal::Thd>(rows_, std::move(setup), thickness_);
}

ThdFilm::Isothermal ThdFilm::isothermal() const {
  thermal::FilmFlow flow(rows_, flow_, thickness_);
  flow.set_temperature(
      std::vector<double>(thickness_.size() * static_cast<std::size_t>(rows_.mesh().across), ambient_));
  (void)flow.solve();
  return {flow.pressure(), flow.report(flow.flow())};
}

}  // namespace whirl::study
