#include "study/bearing/gas_bearing.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "study/bars/film_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/bearing/gas_point.hpp"
#include "study/bearing/held_film.hpp"
#include "study/columns.hpp"
#include "study/common.hpp"
#include "study/evenly.hpp"
#include "study/lost_points.hpp"
#include "study/pieces.hpp"
#include "whirl/core/error.hpp"

namespace whirl::study {
namespace {

constexpr std::array<const char*, 5> told = {"load", "attitude", "mass_flow", "normal_flow", "power_loss"};

std::array<double, 2> gas_place(double eccentricity, double direction, double clearance) {
  const double e = eccentricity * clearance;
  return {e * std::cos(direction), e * std::sin(direction)};
}

using Rows = std::vector<GasRow>;

// Films that do not wait for each other: what is asked of them, and then the answers, shared between the ranks.
class GasJob {
public:
  explicit GasJob(const GasBearingOptions& options) : options_(options) {}

  // These rows, found by find().
  struct Asked {
    std::size_t first, count;
  };
  // At one place.
  Asked at(const system::Support& s, double speed, double eccentricity, bool fields = false) {
    asked_.push_back([this, s, speed, eccentricity, fields] {
      const auto place = gas_place(eccentricity, options_.direction, s.geometry.clearance);
      GasRow row = gas_row(speed, fields, [&] { return gas_at(s, speed, place); });
      row.eccentricity = eccentricity;
      return row;
    });
    return {asked_.size() - 1, 1};
  }
  // [speed][eccentricity], with the fields of the last eccentricity.
  Asked curves(const system::Support& s, bool fields) {
    const std::size_t first = asked_.size();
    for (const deck::Quantity& speed : options_.speeds)
      for (std::size_t k = 0; k < options_.eccentricities.size(); ++k)
        (void)at(s, speed.value, options_.eccentricities[k], fields && k + 1 == options_.eccentricities.size());
    return {first, asked_.size() - first};
  }
  // Under the load, speed by speed; none without a load.
  Asked equilibria(const system::Support& s) {
    const std::size_t first = asked_.size();
    if (options_.load.values.empty()) return {first, 0};
    for (const deck::Quantity& speed : options_.speeds)
      asked_.push_back([this, s, speed = speed.value] {
        return gas_row(speed, false, [&] {
          FilmAtRest film(s, speed);
          film.carry(load_along(options_.load));
          return gas_at(s, speed, film.place());
        });
      });
    return {first, asked_.size() - first};
  }

  // Collective.
  void find(const Layout& layout, Pieces& pieces) {
    rows_ = distribute(
        layout, asked_.size(), [this](std::size_t k) { return asked_[k](); }, pieces, "film", no_trail);
  }
  [[nodiscard]] Rows operator[](const Asked& of) const {
    const auto first = rows_.begin() + static_cast<std::ptrdiff_t>(of.first);
    return {first, first + static_cast<std::ptrdiff_t>(of.count)};
  }

private:
  const GasBearingOptions& options_;
  std::vector<std::function<GasRow()>> asked_;
  Rows rows_;
};

void put_gas_summary(io::StudySummary& summary, const Rows& points, const std::string& head) {
  for (const GasRow& p : points) {
    if (!p.found()) continue;
    const std::string which = head.empty() ? fmt::format("speed.{:.6g}.eccentricity.{:.6g}.", p.speed, p.eccentricity)
                                           : fmt::format("{}.speed.{:.6g}.", head, p.speed);
    for (const char* name : told) {
      const std::size_t k = gas_quantity(name);
      summary.set(which + name, p.values[k], gas_quantities()[k].unit);
    }
    if (head.empty()) continue;
    summary.set(which + "x", p.place[0], "m");
    summary.set(which + "y", p.place[1], "m");
    summary.set(which + "eccentricity", p.eccentricity, "1");
  }
}

// Why rows have no film, if any has none.
void put_reasons(io::Group& table, const io::Shape& shape, const Rows& rows) {
  if (std::ranges::all_of(rows, &GasRow::found)) return;
  table.put("reason",
            io::Dataset{shape, column(rows, &GasRow::reason), "", "why there is no film; empty: there is one"});
}

void put_gas_table(io::Group& table, const io::Shape& shape, const Rows& rows) {
  for (std::size_t k = 0; k < gas_quantities().size(); ++k) {
    const GasQuantity& q = gas_quantities()[k];
    table.put(q.name, shape, column(rows, [k](const GasRow& r) { return r.values[k]; }), q.unit,
              std::string(q.text) + (shape.size() > 1 ? " [speed][eccentricity]" : ""));
  }
  put_reasons(table, shape, rows);
}

// Of the last eccentricity, speed by speed; not numbers at a speed without a film there.
void put_gas_fields(io::Group& group, const GasBearingOptions& o, const Rows& rows) {
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

// From coarse to fine, each with the pressure at the rims of the orifices and with that of their nodes.
GasJob::Asked ask_gas_meshes(GasJob& job, const GasBearingOptions& o, const system::Support& s) {
  GasJob::Asked out{};
  for (int k = o.meshes - 1; k >= 0; --k)
    for (const auto source : {film::Gas::Source::rim, film::Gas::Source::node}) {
      system::Support there = s;
      film::Gas& gas = film::as<film::Gas>(there.film);
      for (int& n : gas.cells) n >>= k;
      gas.source = source;
      const auto one = job.at(there, o.speeds.front().value, o.eccentricities.back());
      out = {out.count == 0 ? one.first : out.first, out.count + 1};
    }
  return out;
}

void put_gas_meshes(io::Group& group, io::StudySummary& summary, const GasBearingOptions& o, const film::Gas& gas,
                    const Rows& rows) {
  std::vector<double> around, along;
  std::array<std::vector<double>, 2> load;
  std::vector<std::string> reasons;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    load[k % 2].push_back(rows[k].values[0]);
    if (k % 2 != 0) continue;
    const int halvings = o.meshes - 1 - static_cast<int>(k / 2);
    around.push_back(gas.cells[0] >> halvings);
    along.push_back(gas.cells[1] >> halvings);
    reasons.push_back(rows[k].reason);  // pockets have no source in a node
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

// [clearance][diameter].
GasJob::Asked ask_gas_map(GasJob& job, const GasBearingOptions& o, const system::Support& s) {
  GasJob::Asked out{};
  for (const deck::Quantity& c : o.map->clearances)
    for (const deck::Quantity& d : o.map->diameters) {
      system::Support there = s;
      there.geometry.clearance = c.value;
      for (film::OrificeRow& row : film::as<film::Gas>(there.film).orifices) row.diameter = d.value;
      const auto one = job.at(there, o.speeds.front().value, o.map->eccentricity);
      out = {out.count == 0 ? one.first : out.first, out.count + 1};
    }
  return out;
}

void put_gas_map(io::Group& group, const GasMapOptions& map, const Rows& rows) {
  auto& table = group.child("map");
  const io::Shape shape{map.clearances.size(), map.diameters.size()};
  table.put("clearance", column(map.clearances, &deck::Quantity::value), "m", "of the bearing");
  table.put("diameter", column(map.diameters, &deck::Quantity::value), "m", "of all orifices");
  for (const char* name : {"load", "mass_flow", "power_loss"}) {
    const std::size_t k = gas_quantity(name);
    table.put(name, shape, column(rows, [k](const GasRow& r) { return r.values[k]; }), gas_quantities()[k].unit,
              "at the eccentricity of the map [clearance][diameter]");
  }
  put_reasons(table, shape, rows);
  table.label_each({io::labels_of(column(map.diameters, &deck::Quantity::value))});
  table.set("eccentricity", map.eccentricity);
}

// Thickness of a film at Knudsen numbers where slip begins to show, where it has to be counted, and of free molecules.
void put_knudsen(io::Group& group, const film::Gas& gas, double viscosity) {
  constexpr double lowest = 0.1, highest = 100;  // times the pressure of the ends
  const std::vector<double> pressure = by_ratios(lowest * gas.ambient, highest * gas.ambient, 41);
  auto& table = group.child("knudsen");
  table.put("pressure", pressure, "Pa", "of the gas, absolute");
  for (const auto& [name, number] : {std::pair{"slip_begins", 0.01}, {"transition", 0.1}, {"free_molecules", 10.0}}) {
    const auto thickness = [&](double p) { return mean_free_path(gas, viscosity, p) / number; };
    table.put(name, column(pressure, thickness), "m",
              fmt::format("thickness of a film with a Knudsen number of {}", number));
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
  const Layout layout = plan(context, Sharing::films);
  const std::vector<FilmMesh> meshes = film_meshes(context.machine, context.layout);
  GasJob job(options);
  const auto on_curves = job.curves(support, true), at_load = job.equilibria(support);
  const auto of_meshes = ask_gas_meshes(job, options, support);
  const auto of_map = options.map ? ask_gas_map(job, options, support) : GasJob::Asked{};
  std::vector<system::Support> others;
  std::vector<std::array<GasJob::Asked, 2>> elsewhere;
  for (const FilmMesh& mesh : meshes) {
    others.push_back(with_film_mesh(train, mesh.factor).supports[which]);
    elsewhere.push_back({job.curves(others.back(), false), job.equilibria(others.back())});
  }
  job.find(layout, pieces);
  const Rows curves = job[on_curves], equilibria = job[at_load], map = job[of_map];
  if (options.meshes > 0) put_gas_meshes(group, summary, options, *film::find<film::Gas>(support.film), job[of_meshes]);
  if (options.map) put_gas_map(group, *options.map, map);
  put_gas_summary(summary, curves, "");
  put_gas_summary(summary, equilibria, "equilibrium");
  // The first speed at which the film does not carry the load.
  const auto none = std::ranges::find_if(equilibria, [](const GasRow& r) { return r.most.has_value(); });
  if (none != equilibria.end()) put_capacity(summary, *none->most);

  SummaryBars bars(summary, law_of(context.machine, context.layout));
  std::vector<Answered<Capacity>> most(meshes.size());
  if (none != equilibria.end())
    most = distribute(
        layout, meshes.size(),
        [&](std::size_t k) {
          return answered([&] { return FilmAtRest(others[k], none->speed).capacity(load_along(options.load)); });
        },
        pieces, "capacity", no_trail);
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    io::StudySummary there;
    put_gas_summary(there, job[elsewhere[k][0]], "");
    put_gas_summary(there, job[elsewhere[k][1]], "equilibrium");
    if (most[k].found) put_capacity(there, *most[k].found);
    bars.add(meshes[k].axis, meshes[k].spacing, there);
  }
  constexpr double location = 1e-9;
  bars.write(location);

  group.set("bearing", context.machine.bearings[which].name);
  group.set("clearance", support.geometry.clearance);
  auto& table = group.child("curves");
  table.put("speed", column(options.speeds, &deck::Quantity::value), "rad/s", "of the shaft");
  table.put("eccentricity", options.eccentricities, "1", "of the journal, in clearances");
  put_gas_table(table, {options.speeds.size(), options.eccentricities.size()}, curves);
  const auto found = [](const Rows& rows) { return std::ranges::count_if(rows, &GasRow::found); };
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
  const auto warn = [&](const Rows& rows, const std::function<std::string(std::size_t)>& words) {
    warn_of_lost_points(summary, "no film at", column(rows, &GasRow::reason), words);
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
