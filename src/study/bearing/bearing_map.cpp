#include "study/bearing/bearing_map.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <type_traits>
#include <variant>

#include "study/bars/film_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/bearing/bearing_mapper.hpp"
#include "study/columns.hpp"
#include "study/common.hpp"
#include "whirl/core/error.hpp"
#include "whirl/film/contract/elastic.hpp"
#include "whirl/film/contract/options.hpp"
#include "whirl/system/dimensionless_groups.hpp"

namespace whirl::study {
namespace {

constexpr std::array<const char*, 4> entries = {"xx", "xy", "yx", "yy"};

void put_locus(io::Group& group, const std::vector<MapPoint>& locus, const std::vector<double>& frequencies) {
  using P = MapPoint;
  auto& table = group.child("locus");
  table.put("eccentricity", column(locus, [](const P& p) { return p.at.eccentricity; }), "1", "in clearances");
  table.put("attitude", column(locus, [](const P& p) { return p.at.attitude; }), "rad", "from the load to the journal");
  table.put("sommerfeld", column(locus, [](const P& p) { return p.at.sommerfeld; }), "1",
            "S = (c/R)^2 load/(mu Omega L D)");
  table.put("x", column(locus, [](const P& p) { return p.at.eccentricity * std::sin(p.at.attitude); }), "1",
            "in clearances");
  table.put("y", column(locus, [](const P& p) { return -p.at.eccentricity * std::cos(p.at.attitude); }), "1",
            "in clearances");
  table.put("min_thickness", column(locus, &P::thickness), "m", "least thickness of the film");
  table.put("speed_limit", column(locus, [](const P& p) { return p.at.speed_limit; }), "1",
            "Omega* = Omega sqrt(m c/load) of a rigid rotor at the border of stability; NaN: stable at every speed");
  table.put("whirl_ratio", column(locus, [](const P& p) { return p.at.whirl_ratio; }), "1",
            "whirl frequency there over Omega");
  table.set("frequency_ratio", frequencies.front());
  for (std::size_t i = 0; i < 4; ++i) {
    table.put(fmt::format("k_{}", entries[i]), column(locus, [i](const P& p) { return p.coefficients[0].k[i]; }), "1",
              "stiffness c k/(load/S)");
    table.put(fmt::format("c_{}", entries[i]), column(locus, [i](const P& p) { return p.coefficients[0].b[i]; }), "1",
              "damping c Omega C/(load/S)");
  }
  if (frequencies.size() < 2) return;
  auto& over = group.child("frequencies");
  over.put("ratio", frequencies, "1", "omega/Omega");
  for (std::size_t i = 0; i < 4; ++i) {
    std::vector<double> k, b;
    for (const MapPoint& p : locus)
      for (const BearingCoefficients& c : p.coefficients) {
        k.push_back(c.k[i]);
        b.push_back(c.b[i]);
      }
    const io::Shape shape{locus.size(), frequencies.size()};
    over.put(fmt::format("k_{}", entries[i]), shape, k, "1", "stiffness [point of the locus][frequency]");
    over.put(fmt::format("c_{}", entries[i]), shape, b, "1", "damping [point of the locus][frequency]");
  }
  over.label_each({io::labels_of(frequencies)});
}

void put_loaded(io::Group& group, io::StudySummary& summary, const std::vector<LoadedPoint>& loaded) {
  std::vector<double> sommerfeld, pressure, thickness;
  for (const LoadedPoint& l : loaded) {
    const std::string head = fmt::format("sommerfeld.{:.6g}.", l.sommerfeld);
    summary.set(head + "eccentricity", l.point.at.eccentricity, "1");
    summary.set(head + "attitude", l.point.at.attitude, "rad");
    summary.set(head + "speed_limit", l.point.at.speed_limit, "1");
    summary.set(head + "whirl_ratio", l.point.at.whirl_ratio, "1");
    for (std::size_t i = 0; i < 4; ++i) {
      summary.set(fmt::format("{}k.{}", head, entries[i]), l.point.coefficients[0].k[i], "1");
      summary.set(fmt::format("{}c.{}", head, entries[i]), l.point.coefficients[0].b[i], "1");
    }
    if (l.profile.pressure.empty()) continue;
    sommerfeld.push_back(l.sommerfeld);
    pressure.insert(pressure.end(), l.profile.pressure.begin(), l.profile.pressure.end());
    thickness.insert(thickness.end(), l.profile.thickness.begin(), l.profile.thickness.end());
  }
  if (sommerfeld.empty()) return;
  auto& table = group.child("profiles");
  const io::Shape shape{sommerfeld.size(), loaded.back().profile.theta.size()};
  table.put("sommerfeld", sommerfeld, "1", "load S");
  table.put("theta", loaded.back().profile.theta, "rad", "angle from +x");
  table.put("pressure", shape, pressure, "1", "(c/R)^2 p/(6 mu Omega) in the mid-plane [load][theta]");
  table.put("thickness", shape, thickness, "1", "film thickness in clearances [load][theta]");
  table.label_each({io::labels_of(loaded.back().profile.theta)});
}

void put_threshold(io::StudySummary& summary, const Mapper& map,
                   const std::optional<system::DimensionlessGroups>& groups) {
  if (!map.threshold) return;
  const double speed = groups->load / (groups->bearings * map.threshold->sommerfeld);
  summary.set("threshold.nondimensional_speed", speed, "1");
  summary.set("threshold.speed", speed * groups->speed_scale, "rad/s");
  summary.set("threshold.eccentricity", map.threshold->eccentricity, "1");
  summary.set("threshold.whirl_ratio", map.threshold->whirl_ratio, "1");
}

void put_limit(io::StudySummary& summary, const Mapper& map) {
  if (map.limit) summary.set("limit.eccentricity", map.limit->eccentricity, "1");
}

// Whether the same film goes on beyond the limit with upwind differences, which make no waves of the mesh. Collective.
bool goes_on_upwind(Pieces& pieces, BearingMapOptions options, const system::Support& support, const MapLimit& limit) {
  const auto* compliant = film::find<film::Compliant>(support.film);
  if (!compliant || compliant->differences == film::Compliant::Differences::upwind) return false;
  system::Support other = support;
  std::visit(
      [](auto& kind) {
        if constexpr (std::is_base_of_v<film::Compliant, std::decay_t<decltype(kind)>>)
          kind.differences = film::Compliant::Differences::upwind;
      },
      other.film.kind);
  options.max_eccentricity = std::min(options.max_eccentricity, 1.1 * limit.eccentricity);
  options.points = 1;
  return has_answer([&] {
    Mapper upwind(pieces, "upwind ", options, other);
    upwind.follow();
    if (upwind.limit || upwind.locus.empty()) throw core::NotConverged("it ends as well");
  });
}

std::string in_words(const MapLimit& limit) {
  return fmt::format("ended at eccentricity {:.6g}: {}{}", limit.eccentricity,
                     limit.fold ? "the locus turns back there (a fold)" : "beyond it no film was found",
                     limit.why.empty() ? "" : " (" + limit.why + ")");
}

// Where the locus turns back and forth it passes the eccentricities between three times.
std::string of_folds(const std::vector<double>& folds) {
  std::vector<std::string> ranges;
  for (std::size_t k = 0; k + 1 < folds.size(); k += 2)
    ranges.push_back(fmt::format("{:.6g} to {:.6g}", folds[k + 1], folds[k]));
  return fmt::format(
      "the locus turns back and forth and has several equilibria at one eccentricity ({}): the map has the first one "
      "along the locus, and jumps where this one ends",
      fmt::join(ranges, ", "));
}

// What the locus says at one eccentricity, in the order of `with_bars`.
constexpr std::array<const char*, 12> with_bars = {"attitude", "sommerfeld", "speed_limit", "whirl_ratio",
                                                   "k_xx",     "k_xy",       "k_yx",        "k_yy",
                                                   "c_xx",     "c_xy",       "c_yx",        "c_yy"};
std::vector<double> numbers_of(const std::vector<MapPoint>& locus, const std::vector<MapPoint>& like) {
  std::vector<double> out;
  for (const MapPoint& wanted : like) {
    const auto at = std::find_if(locus.begin(), locus.end(),
                                 [&](const MapPoint& p) { return p.at.eccentricity == wanted.at.eccentricity; });
    if (at == locus.end()) {
      out.insert(out.end(), with_bars.size(), io::no_value);
      continue;
    }
    out.insert(out.end(), {at->at.attitude, at->at.sommerfeld, at->at.speed_limit, at->at.whirl_ratio});
    const BearingCoefficients& c = at->coefficients.front();
    out.insert(out.end(), c.k.begin(), c.k.end());
    out.insert(out.end(), c.b.begin(), c.b.end());
  }
  return out;
}

// The map on other film meshes: bars of the locus and of all that the summary says of it.
void put_bars(const Context& context, Pieces& pieces, const BearingMapOptions& options, std::size_t which,
              const Mapper& map, const std::optional<system::DimensionlessGroups>& groups) {
  io::StudySummary& summary = context.results.summary();
  Bars bars(numbers_of(map.locus, map.locus), law_of(context.machine, context.layout));
  SummaryBars of_summary(summary, law_of(context.machine, context.layout));
  const std::vector<FilmMesh> meshes = film_meshes(context.machine, context.layout);
  // Numbers of the locus, and those of the summary.
  const auto on = [&](Pieces& own, std::size_t m) {
    std::pair<std::vector<double>, std::vector<double>> out;
    io::StudySummary there;
    const bool answered = has_answer([&] {
      Mapper other(own, fmt::format("on mesh {} ", m + 1), options,
                   with_film_mesh(system::train_of(context.machine), meshes[m].factor).supports[which]);
      other.follow();
      other.find_threshold(groups);
      other.load();
      out.first = numbers_of(other.locus, map.locus);
      io::Group unused;
      put_loaded(unused, there, other.loaded);
      put_threshold(there, other, groups);
      put_limit(there, other);
    });
    if (!answered) out.first.clear();
    out.second = of_summary.row(there);
    return out;
  };
  const auto on_meshes = distribute_pieces(context, plan(context, Sharing::films), meshes.size(), on, pieces, "mesh");
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    bars.add(meshes[m].axis, meshes[m].spacing, on_meshes[m].first);
    of_summary.add(meshes[m].axis, meshes[m].spacing, on_meshes[m].second);
  }
  of_summary.write(1e-9);
  if (meshes.empty()) return;
  auto& table = context.results.group().child("locus");
  for (std::size_t k = 0; k < with_bars.size(); ++k) {
    std::vector<double> column;
    for (std::size_t i = 0; i < map.locus.size(); ++i) column.push_back(bars[i * with_bars.size() + k].total());
    // Neighbours on the locus err alike: a difference of meshes that vanishes by chance hides nothing.
    std::vector<double> floored = column;
    for (std::size_t i = 0; i < column.size(); ++i)
      for (const std::size_t j : {i - 1, i + 1})
        if (j < column.size()) floored[i] = std::max(floored[i], column[j] / 2);
    table.put(std::string(with_bars[k]) + "_uncertainty", floored, k == 0 ? "rad" : "1",
              std::string("estimated error of ") + with_bars[k] + " from the film mesh");
  }
}

}  // namespace

StudyResult BearingMap::run(Context& context) {
  const system::Train train = system::train_of(context.machine);
  const std::size_t which = options.bearing.empty() ? 0 : *system::find_bearing(context.machine, options.bearing);
  auto& results = context.results;
  auto& summary = results.summary();
  auto& group = results.group();
  const auto groups = system::dimensionless_groups(train);
  put_groups(summary, train);

  Pieces pieces(results, context.resume);
  Mapper map(pieces, "", options, train.supports[which]);
  map.follow();
  map.find_threshold(groups);
  map.load();
  map.squeeze();
  if (map.locus.empty()) throw core::NotConverged("no eccentricity carries a vertical load");

  group.set("bearing", context.machine.bearings[which].name);
  group.set("speed", options.speed.value);
  put_locus(group, map.locus, options.frequencies);
  put_loaded(group, summary, map.loaded);
  if (!map.radii.empty()) {
    auto& table = group.child("impedance");
    const io::Shape shape{map.radii.size(), map.angles.size()};
    table.put("eccentricity", map.radii, "1", "distance of the journal from the centre, in clearances");
    table.put("angle", map.angles, "rad", "from the squeeze velocity to the journal, counter-clockwise");
    table.put("W_along", shape, map.along, "1", "impedance [eccentricity][angle], resisting the squeeze");
    table.put("W_across", shape, map.across, "1", "impedance [eccentricity][angle], to the left of the squeeze");
    table.label_each({io::labels_of(map.angles)});
  }
  put_threshold(summary, map, groups);
  put_limit(summary, map);
  put_bars(context, pieces, options, which, map, groups);
  summary.points = static_cast<long>(map.locus.size());
  if (!map.refused.empty()) return results.finish(map.refused, false);
  const double end = map.limit ? map.limit->eccentricity : options.max_eccentricity;
  std::string gaps;
  for (const double e : map.missing)
    if (e > map.locus.front().at.eccentricity && e < end) gaps += fmt::format("{}{:.4g}", gaps.empty() ? "" : ", ", e);
  if (!gaps.empty()) summary.warnings.push_back("no film was found at the eccentricities " + gaps);
  if (map.folds.size() > 1) summary.warnings.push_back(of_folds(map.folds));
  if (map.limit && goes_on_upwind(pieces, options, train.supports[which], *map.limit))
    summary.warnings.push_back(
        "with 'differences: upwind' the locus goes on beyond its end: waves of the mesh end it, not the bearing");
  return results.finish(map.limit ? in_words(*map.limit) : "completed", true);
}

}  // namespace whirl::study
