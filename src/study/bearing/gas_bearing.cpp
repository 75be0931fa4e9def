#include "whirl/study/bearing/gas_bearing.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include "study/bars/film_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/bearing/gas_point.hpp"
#include "study/bearing/held_film.hpp"
#include "study/common.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"

namespace whirl::study {
namespace {

struct GasQuantity {
  const char *name, *unit, *text;
  std::function<double(const GasPoint&)> of;
};

const std::vector<GasQuantity>& gas_quantities() {
  static const std::vector<GasQuantity> all{
      {"load", "N", "that the film carries", [](const GasPoint& p) { return p.load; }},
      {"attitude", "rad", "from the load to the journal, with the rotation",
       [](const GasPoint& p) { return p.attitude; }},
      {"min_thickness", "m", "of the film", [](const GasPoint& p) { return p.report.min_thickness; }},
      {"max_pressure", "Pa", "in the film and behind orifices",
       [](const GasPoint& p) { return p.report.max_pressure; }},
      {"mass_flow", "kg/s", "through all orifices", [](const GasPoint& p) { return p.report.mass_flow; }},
      {"normal_flow", "l/min", "the same as gas at 0 degC and 101325 Pa",
       [](const GasPoint& p) { return p.normal_flow; }},
      {"drag_torque", "N m", "of the film on the journal", [](const GasPoint& p) { return p.report.drag_torque; }},
      {"power_loss", "W", "drag times speed", [](const GasPoint& p) { return p.report.power_loss; }},
      {"knudsen", "1", "mean free path at the pressure of the ends over the least thickness",
       [](const GasPoint& p) { return p.knudsen; }},
      {"reynolds", "1", "rho Omega R c/mu, rho at the highest pressure", [](const GasPoint& p) { return p.reynolds; }},
      {"squeeze_reynolds", "1", "rho Omega c^2/mu", [](const GasPoint& p) { return p.squeeze_reynolds; }},
      {"taylor", "1", "rho Omega R c/mu sqrt(c/R); vortices above 41", [](const GasPoint& p) { return p.taylor; }},
      {"factorisations", "1", "of Newton's method from the film between parallel plates",
       [](const GasPoint& p) { return static_cast<double>(p.factorisations); }}};
  return all;
}
constexpr std::array<const char*, 5> told = {"load", "attitude", "mass_flow", "normal_flow", "power_loss"};

std::array<double, 2> gas_place(double eccentricity, double direction, double clearance) {
  const double e = eccentricity * clearance;
  return {e * std::cos(direction), e * std::sin(direction)};
}

// [speed][eccentricity].
std::vector<GasPoint> gas_curves(const GasBearingOptions& o, const system::Support& s) {
  std::vector<GasPoint> out;
  for (const deck::Quantity& speed : o.speeds)
    for (const double e : o.eccentricities)
      out.push_back(gas_at(s, speed.value, gas_place(e, o.direction, s.geometry.clearance)));
  return out;
}

// Under the load, speed by speed.
std::vector<GasPoint> gas_equilibria(const GasBearingOptions& o, const system::Support& s) {
  std::vector<GasPoint> out;
  for (const deck::Quantity& speed : o.speeds) {
    FilmAtRest film(s, speed.value);
    film.carry(load_along(o.load));
    out.push_back(gas_at(s, speed.value, film.place()));
  }
  return out;
}

void put_gas_summary(io::StudySummary& summary, const std::vector<GasPoint>& points, const std::string& head) {
  for (const GasPoint& p : points) {
    const std::string which = head.empty() ? fmt::format("speed.{:.6g}.eccentricity.{:.6g}.", p.speed, p.eccentricity)
                                           : fmt::format("{}.speed.{:.6g}.", head, p.speed);
    for (const char* name : told) {
      const auto q = std::ranges::find(gas_quantities(), std::string_view(name), &GasQuantity::name);
      summary.set(which + name, q->of(p), q->unit);
    }
    if (head.empty()) continue;
    summary.set(which + "x", p.place[0], "m");
    summary.set(which + "y", p.place[1], "m");
    summary.set(which + "eccentricity", p.eccentricity, "1");
  }
}

void put_gas_table(io::Group& table, const io::Shape& shape, const std::vector<GasPoint>& points) {
  for (const GasQuantity& q : gas_quantities()) {
    std::vector<double> column;
    for (const GasPoint& p : points) column.push_back(q.of(p));
    table.put(q.name, shape, column, q.unit, std::string(q.text) + (shape.size() > 1 ? " [speed][eccentricity]" : ""));
  }
}

std::vector<double> values_of(const std::vector<deck::Quantity>& list) {
  std::vector<double> out;
  for (const deck::Quantity& q : list) out.push_back(q.value);
  return out;
}

// Of the last eccentricity, speed by speed.
void put_gas_fields(io::Group& group, const GasBearingOptions& o, const std::vector<GasPoint>& points) {
  std::map<std::string, std::vector<double>> all;
  auto& table = group.child("fields");
  const std::size_t each = o.eccentricities.size();
  for (std::size_t s = 0; s < o.speeds.size(); ++s)
    for (const film::NodalField& f : points[(s + 1) * each - 1].fields) {
      if (f.shape.size() == 1 && s == 0) table.put(f.name, f.values, f.unit, "of the nodes");
      if (f.shape.size() == 2) all[f.name].insert(all[f.name].end(), f.values.begin(), f.values.end());
    }
  for (const film::NodalField& f : points.back().fields)
    if (f.shape.size() == 2)
      table.put(f.name, {o.speeds.size(), f.shape[0], f.shape[1]}, all[f.name], f.unit,
                f.name + " at the last eccentricity [speed][theta][z]");
}

// Orders by three meshes in turn: of the last two differences.
double observed_order(const std::vector<double>& v) {
  const std::size_t n = v.size();
  return n < 3 ? io::no_value : std::log2(std::abs((v[n - 2] - v[n - 3]) / (v[n - 1] - v[n - 2])));
}

void put_gas_meshes(io::Group& group, io::StudySummary& summary, const GasBearingOptions& o, const system::Support& s) {
  std::vector<double> around, along;
  std::array<std::vector<double>, 2> load;
  for (int k = o.meshes - 1; k >= 0; --k) {
    system::Support there = s;
    film::Gas& gas = film::as<film::Gas>(there.film);
    for (int& n : gas.cells) n >>= k;
    around.push_back(gas.cells[0]);
    along.push_back(gas.cells[1]);
    for (const auto source : {film::Gas::Source::rim, film::Gas::Source::node}) {
      gas.source = source;
      const auto at = gas_place(o.eccentricities.back(), o.direction, s.geometry.clearance);
      double found = io::no_value;
      const auto compute = [&] { found = gas_at(there, o.speeds.front().value, at).load; };
      // Pockets have no source in a node.
      if (source == film::Gas::Source::rim)
        compute();
      else
        (void)has_answer(compute);
      load[source == film::Gas::Source::rim ? 0 : 1].push_back(found);
    }
  }
  auto& table = group.child("meshes");
  table.put("around", around, "1", "cells around the bearing");
  table.put("along", along, "1", "cells along the bearing");
  table.put("load", load[0], "N", "with the pressure at the rims of the orifices");
  table.put("load_of_node_source", load[1], "N",
            "with the pressure of their nodes: a source has none there, so that it drifts");
  if (o.meshes < 3) return;
  summary.set("meshes.order", observed_order(load[0]), "1");
  summary.set("meshes.order_of_node_source", observed_order(load[1]), "1");
}

void put_gas_map(io::Group& group, const GasBearingOptions& o, const system::Support& s) {
  const GasMapOptions& map = *o.map;
  std::vector<double> load, flow, power;
  for (const deck::Quantity& c : map.clearances)
    for (const deck::Quantity& d : map.diameters) {
      system::Support there = s;
      there.geometry.clearance = c.value;
      for (film::OrificeRow& row : film::as<film::Gas>(there.film).orifices) row.diameter = d.value;
      GasPoint p;
      p.load = p.report.mass_flow = p.report.power_loss = io::no_value;
      (void)has_answer(
          [&] { p = gas_at(there, o.speeds.front().value, gas_place(map.eccentricity, o.direction, c.value)); });
      load.push_back(p.load);
      flow.push_back(p.report.mass_flow);
      power.push_back(p.report.power_loss);
    }
  auto& table = group.child("map");
  const io::Shape shape{map.clearances.size(), map.diameters.size()};
  table.put("clearance", values_of(map.clearances), "m", "of the bearing");
  table.put("diameter", values_of(map.diameters), "m", "of all orifices");
  table.put("load", shape, load, "N", "at the eccentricity of the map [clearance][diameter]");
  table.put("mass_flow", shape, flow, "kg/s", "the same");
  table.put("power_loss", shape, power, "W", "the same");
  table.label_each({io::labels_of(values_of(map.diameters))});
  table.set("eccentricity", map.eccentricity);
}

// Thickness of a film at Knudsen numbers where slip begins to show, where it has to be counted, and of free molecules.
void put_knudsen(io::Group& group, const film::Gas& gas, double viscosity) {
  constexpr int points = 41;
  constexpr double decades = 3, lowest = 0.1;  // times the pressure of the ends
  std::vector<double> pressure;
  for (int k = 0; k < points; ++k)
    pressure.push_back(gas.ambient * lowest * std::pow(10.0, decades * k / (points - 1)));
  auto& table = group.child("knudsen");
  table.put("pressure", pressure, "Pa", "of the gas, absolute");
  for (const auto& [name, number] : {std::pair{"slip_begins", 0.01}, {"transition", 0.1}, {"free_molecules", 10.0}}) {
    std::vector<double> thickness;
    for (const double p : pressure) thickness.push_back(mean_free_path(gas, viscosity, p) / number);
    table.put(name, thickness, "m", fmt::format("thickness of a film with a Knudsen number of {}", number));
  }
}

}  // namespace

StudyResult GasBearing::run(Context& context) {
  const system::Train train = system::train_of(context.machine);
  const std::size_t which = options.bearing.empty() ? 0 : *system::find_bearing(context.machine, options.bearing);
  const system::Support& support = train.supports[which];
  auto& results = context.results;
  auto& summary = results.summary();
  auto& group = results.group();
  std::vector<GasPoint> curves, equilibria;
  core::agree(context.comm, [&] {
    curves = gas_curves(options, support);
    if (options.meshes > 0) put_gas_meshes(group, summary, options, support);
    if (options.map) put_gas_map(group, options, support);
  });
  std::optional<NoPlace> none;
  if (!options.load.values.empty())
    none = agreed_place(context.comm, [&] { equilibria = gas_equilibria(options, support); });
  if (none) equilibria.clear();
  put_gas_summary(summary, curves, "");
  put_gas_summary(summary, equilibria, "equilibrium");
  if (none) {
    summary.set("capacity.load", none->most.load, "N");
    summary.set("capacity.eccentricity", none->most.eccentricity, "1");
  }

  SummaryBars bars(summary, law_of(context.machine));
  for (const FilmMesh& mesh : film_meshes(context.machine, context.layout)) {
    io::StudySummary there;
    core::agree(context.comm, [&] {
      const system::Train other = with_film_mesh(train, mesh.factor);
      (void)has_answer([&] { put_gas_summary(there, gas_curves(options, other.supports[which]), ""); });
      if (!none && !options.load.values.empty())
        (void)has_answer(
            [&] { put_gas_summary(there, gas_equilibria(options, other.supports[which]), "equilibrium"); });
      if (none) {
        (void)has_answer([&] {
          const Capacity c = FilmAtRest(other.supports[which], none->speed).capacity(load_along(options.load));
          there.set("capacity.load", c.load, "N");
          there.set("capacity.eccentricity", c.eccentricity, "1");
        });
      }
    });
    bars.add(mesh.axis, mesh.spacing, there);
  }
  constexpr double location = 1e-9;
  bars.write(location);

  group.set("bearing", context.machine.bearings[which].name);
  group.set("clearance", support.geometry.clearance);
  auto& table = group.child("curves");
  table.put("speed", values_of(options.speeds), "rad/s", "of the shaft");
  table.put("eccentricity", options.eccentricities, "1", "of the journal, in clearances");
  put_gas_table(table, {options.speeds.size(), options.eccentricities.size()}, curves);
  if (!equilibria.empty()) {
    auto& at = group.child("equilibria");
    at.put("speed", values_of(options.speeds), "rad/s", "of the shaft");
    std::vector<double> x, y;
    for (const GasPoint& p : equilibria) {
      x.push_back(p.place[0]);
      y.push_back(p.place[1]);
    }
    at.put("x", x, "m", "of the journal, from the centre of the bearing");
    at.put("y", y, "m", "of the journal, from the centre of the bearing");
    put_gas_table(at, {equilibria.size()}, equilibria);
  }
  put_gas_fields(group, options, curves);
  put_knudsen(group, *film::find<film::Gas>(support.film), support.lubricant.viscosity);
  summary.points = static_cast<long>(curves.size() + equilibria.size());
  return none ? results.finish(none->what(), false) : results.finish("completed", true);
}

}  // namespace whirl::study
