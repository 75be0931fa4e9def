#include "study/bearing/gas_bearing.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>

#include "study/bars/film_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/bearing/gas_point.hpp"
#include "study/bearing/held_film.hpp"
#include "study/columns.hpp"
#include "study/common.hpp"
#include "study/lost_points.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"

namespace whirl::study {
namespace {

constexpr std::array<const char*, 5> told = {"load", "attitude", "mass_flow", "normal_flow", "power_loss"};

std::array<double, 2> gas_place(double eccentricity, double direction, double clearance) {
  const double e = eccentricity * clearance;
  return {e * std::cos(direction), e * std::sin(direction)};
}

// The film of one rank; all compute alike.
struct GasJob {
  const GasBearingOptions& options;
  MPI_Comm comm;
  Pieces& pieces;

  // [speed][eccentricity], with the fields of the last eccentricity; pieces begin with `head`.
  [[nodiscard]] std::vector<GasRow> curves(const std::string& head, const system::Support& s, bool fields) const {
    std::vector<GasRow> out;
    for (const deck::Quantity& speed : options.speeds)
      for (std::size_t k = 0; k < options.eccentricities.size(); ++k) {
        const double e = options.eccentricities[k];
        out.push_back(gas_row(comm, pieces, fmt::format("{} {:.17g} {:.17g}", head, speed.value, e), speed.value,
                              fields && k + 1 == options.eccentricities.size(), [&] {
                                return gas_at(s, speed.value, gas_place(e, options.direction, s.geometry.clearance));
                              }));
        out.back().eccentricity = e;
      }
    return out;
  }

  // Under the load, speed by speed; none without a load.
  [[nodiscard]] std::vector<GasRow> equilibria(const std::string& head, const system::Support& s) const {
    std::vector<GasRow> out;
    if (options.load.values.empty()) return out;
    for (const deck::Quantity& speed : options.speeds)
      out.push_back(gas_row(comm, pieces, fmt::format("{} load {:.17g}", head, speed.value), speed.value, false, [&] {
        FilmAtRest film(s, speed.value);
        film.carry(load_along(options.load));
        return gas_at(s, speed.value, film.place());
      }));
    return out;
  }
};

void put_gas_summary(io::StudySummary& summary, const std::vector<GasRow>& points, const std::string& head) {
  for (const GasRow& p : points) {
    if (!p.found()) continue;
    const std::string which = head.empty() ? fmt::format("speed.{:.6g}.eccentricity.{:.6g}.", p.speed, p.eccentricity)
                                           : fmt::format("{}.speed.{:.6g}.", head, p.speed);
    for (const char* name : told) {
      const auto all = gas_quantities();
      const auto q = std::ranges::find(all, std::string_view(name), &GasQuantity::name);
      summary.set(which + name, p.values[static_cast<std::size_t>(q - all.begin())], q->unit);
    }
    if (head.empty()) continue;
    summary.set(which + "x", p.place[0], "m");
    summary.set(which + "y", p.place[1], "m");
    summary.set(which + "eccentricity", p.eccentricity, "1");
  }
}

// Why rows have no film, if any has none.
void put_reasons(io::Group& table, const io::Shape& shape, const std::vector<GasRow>& rows) {
  if (std::ranges::all_of(rows, &GasRow::found)) return;
  table.put("reason",
            io::Dataset{shape, column(rows, &GasRow::reason), "", "why there is no film; empty: there is one"});
}

void put_gas_table(io::Group& table, const io::Shape& shape, const std::vector<GasRow>& rows) {
  for (std::size_t k = 0; k < gas_quantities().size(); ++k) {
    const GasQuantity& q = gas_quantities()[k];
    table.put(q.name, shape, column(rows, [k](const GasRow& r) { return r.values[k]; }), q.unit,
              std::string(q.text) + (shape.size() > 1 ? " [speed][eccentricity]" : ""));
  }
  put_reasons(table, shape, rows);
}

// Of the last eccentricity, speed by speed; not numbers at a speed without a film there.
void put_gas_fields(io::Group& group, const GasBearingOptions& o, const std::vector<GasRow>& rows) {
  const std::size_t each = o.eccentricities.size();
  const auto of = [&](std::size_t speed) -> const GasRow& { return rows[(speed + 1) * each - 1]; };
  std::size_t known = 0;
  while (known < o.speeds.size() && !of(known).found()) ++known;
  if (known == o.speeds.size()) return;
  auto& table = group.child("fields");
  const std::vector<film::NodalField>& like = of(known).fields;
  for (std::size_t f = 0; f < like.size(); ++f) {
    if (like[f].shape.size() == 1) table.put(like[f].name, like[f].values, like[f].unit, "of the nodes");
    if (like[f].shape.size() != 2) continue;
    std::vector<double> all;
    for (std::size_t s = 0; s < o.speeds.size(); ++s)
      if (of(s).found())
        all.insert(all.end(), of(s).fields[f].values.begin(), of(s).fields[f].values.end());
      else
        all.insert(all.end(), like[f].values.size(), io::no_value);
    table.put(like[f].name, {o.speeds.size(), like[f].shape[0], like[f].shape[1]}, std::move(all), like[f].unit,
              like[f].name + " at the last eccentricity [speed][theta][z]");
  }
}

// Orders by three meshes in turn: of the last two differences.
double observed_order(const std::vector<double>& v) {
  const std::size_t n = v.size();
  return n < 3 ? io::no_value : std::log2(std::abs((v[n - 2] - v[n - 3]) / (v[n - 1] - v[n - 2])));
}

void put_gas_meshes(io::Group& group, io::StudySummary& summary, const GasJob& job, const system::Support& s) {
  const GasBearingOptions& o = job.options;
  std::vector<double> around, along;
  std::array<std::vector<double>, 2> load;
  std::vector<std::string> reasons;
  for (int k = o.meshes - 1; k >= 0; --k) {
    system::Support there = s;
    film::Gas& gas = film::as<film::Gas>(there.film);
    for (int& n : gas.cells) n >>= k;
    around.push_back(gas.cells[0]);
    along.push_back(gas.cells[1]);
    for (const auto source : {film::Gas::Source::rim, film::Gas::Source::node}) {
      gas.source = source;
      const bool rim = source == film::Gas::Source::rim;
      const auto at = gas_place(o.eccentricities.back(), o.direction, s.geometry.clearance);
      const double speed = o.speeds.front().value;
      const GasRow row = gas_row(job.comm, job.pieces, fmt::format("meshes {} {}", k, rim ? "rim" : "node"), speed,
                                 false, [&] { return gas_at(there, speed, at); });
      load[rim ? 0 : 1].push_back(row.values[0]);
      // Pockets have no source in a node.
      if (rim) reasons.push_back(row.reason);
    }
  }
  auto& table = group.child("meshes");
  table.put("around", around, "1", "cells around the bearing");
  table.put("along", along, "1", "cells along the bearing");
  table.put("load", load[0], "N", "with the pressure at the rims of the orifices");
  table.put("load_of_node_source", load[1], "N",
            "with the pressure of their nodes: a source has none there, so that it drifts");
  if (std::ranges::any_of(reasons, [](const std::string& why) { return !why.empty(); }))
    table.put("reason", std::move(reasons), "why there is no film on a mesh; empty: there is one");
  if (o.meshes < 3) return;
  for (const auto& [name, of] : {std::pair{"meshes.order", 0U}, {"meshes.order_of_node_source", 1U}})
    if (const double order = observed_order(load[of]); std::isfinite(order)) summary.set(name, order, "1");
}

// Rows [clearance][diameter].
std::vector<GasRow> put_gas_map(io::Group& group, const GasJob& job, const system::Support& s) {
  const GasBearingOptions& o = job.options;
  const GasMapOptions& map = *o.map;
  const double speed = o.speeds.front().value;
  std::vector<GasRow> rows;
  for (const deck::Quantity& c : map.clearances)
    for (const deck::Quantity& d : map.diameters) {
      system::Support there = s;
      there.geometry.clearance = c.value;
      for (film::OrificeRow& row : film::as<film::Gas>(there.film).orifices) row.diameter = d.value;
      rows.push_back(gas_row(job.comm, job.pieces, fmt::format("map {:.17g} {:.17g}", c.value, d.value), speed, false,
                             [&] { return gas_at(there, speed, gas_place(map.eccentricity, o.direction, c.value)); }));
    }
  auto& table = group.child("map");
  const io::Shape shape{map.clearances.size(), map.diameters.size()};
  table.put("clearance", column(map.clearances, &deck::Quantity::value), "m", "of the bearing");
  table.put("diameter", column(map.diameters, &deck::Quantity::value), "m", "of all orifices");
  for (const char* name : {"load", "mass_flow", "power_loss"}) {
    const auto all = gas_quantities();
    const auto q = std::ranges::find(all, std::string_view(name), &GasQuantity::name);
    const auto k = static_cast<std::size_t>(q - all.begin());
    table.put(name, shape, column(rows, [k](const GasRow& r) { return r.values[k]; }), q->unit,
              "at the eccentricity of the map [clearance][diameter]");
  }
  put_reasons(table, shape, rows);
  table.label_each({io::labels_of(column(map.diameters, &deck::Quantity::value))});
  table.set("eccentricity", map.eccentricity);
  return rows;
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
  Pieces pieces(results, context.resume);
  const GasJob job{options, context.comm, pieces};
  const std::vector<GasRow> curves = job.curves("curve", support, true), equilibria = job.equilibria("", support);
  if (options.meshes > 0) put_gas_meshes(group, summary, job, support);
  std::vector<GasRow> map;
  if (options.map) map = put_gas_map(group, job, support);
  put_gas_summary(summary, curves, "");
  put_gas_summary(summary, equilibria, "equilibrium");
  // The first speed at which the film does not carry the load.
  const auto none = std::ranges::find_if(equilibria, [](const GasRow& r) { return std::isfinite(r.capacity); });
  if (none != equilibria.end()) {
    summary.set("capacity.load", none->capacity, "N");
    summary.set("capacity.eccentricity", none->at_capacity, "1");
  }

  SummaryBars bars(summary, law_of(context.machine, context.layout));
  int mesh_number = 0;
  for (const FilmMesh& mesh : film_meshes(context.machine, context.layout)) {
    const std::string head = fmt::format("mesh {}", ++mesh_number);
    io::StudySummary there;
    system::Support other;
    core::agree(context.comm, [&] { other = with_film_mesh(train, mesh.factor).supports[which]; });
    put_gas_summary(there, job.curves(head, other, false), "");
    put_gas_summary(there, job.equilibria(head, other), "equilibrium");
    if (none != equilibria.end()) {
      const std::vector<double> most = pieces.numbers(head + " capacity", [&] {
        std::vector<double> out;
        core::agree(context.comm, [&] {
          (void)has_answer([&] {
            const Capacity c = FilmAtRest(other, none->speed).capacity(load_along(options.load));
            out = {c.load, c.eccentricity};
          });
        });
        return out;
      });
      if (!most.empty()) {
        there.set("capacity.load", most[0], "N");
        there.set("capacity.eccentricity", most[1], "1");
      }
    }
    bars.add(mesh.axis, mesh.spacing, there);
  }
  constexpr double location = 1e-9;
  bars.write(location);

  group.set("bearing", context.machine.bearings[which].name);
  group.set("clearance", support.geometry.clearance);
  auto& table = group.child("curves");
  table.put("speed", column(options.speeds, &deck::Quantity::value), "rad/s", "of the shaft");
  table.put("eccentricity", options.eccentricities, "1", "of the journal, in clearances");
  put_gas_table(table, {options.speeds.size(), options.eccentricities.size()}, curves);
  const auto found = [](const std::vector<GasRow>& rows) { return std::ranges::count_if(rows, &GasRow::found); };
  if (found(equilibria) > 0) {
    auto& at = group.child("equilibria");
    at.put("speed", column(options.speeds, &deck::Quantity::value), "rad/s", "of the shaft");
    for (const std::size_t d : {0U, 1U})
      at.put(d == 0 ? "x" : "y", column(equilibria, [d](const GasRow& r) { return r.place[d]; }), "m",
             "of the journal, from the centre of the bearing");
    put_gas_table(at, {equilibria.size()}, equilibria);
  }
  put_gas_fields(group, options, curves);
  put_knudsen(group, *film::find<film::Gas>(support.film), support.lubricant.viscosity);
  summary.points = static_cast<long>(found(curves) + found(equilibria));
  const auto warn = [&](const std::vector<GasRow>& rows, const std::function<std::string(std::size_t)>& words) {
    for (std::string& line : lost_points("no film at", column(rows, &GasRow::reason), words))
      summary.warnings.push_back(std::move(line));
  };
  warn(curves, [&](std::size_t k) {
    return fmt::format("{:.6g} rad/s, eccentricity {:.6g}", curves[k].speed, curves[k].eccentricity);
  });
  warn(map, [&](std::size_t k) {
    const std::size_t each = options.map->diameters.size();
    return fmt::format("clearance {:.6g} um with orifices of {:.6g} mm", 1e6 * options.map->clearances[k / each].value,
                       1e3 * options.map->diameters[k % each].value);
  });
  // A load that is not carried at any speed is what was asked for, and is not there.
  if (!equilibria.empty() && found(equilibria) == 0) return results.finish(equilibria.front().reason, false);
  warn(equilibria, [&](std::size_t k) { return fmt::format("{:.6g} rad/s under the load", equilibria[k].speed); });
  if (found(curves) == 0) return results.finish(summary.warnings.front(), false);
  const std::size_t asked = curves.size() + equilibria.size() + map.size();
  const auto there = static_cast<std::size_t>(found(curves) + found(equilibria) + found(map));
  return results.finish(status_of(asked - there, asked, "points", "film"), true);
}

}  // namespace whirl::study
