#include "study/bearing/dynamic_coefficients.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <utility>

#include "study/bars/film_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/bars/table_bars.hpp"
#include "study/bearing/coefficients_at.hpp"
#include "study/bearing/enforced_motion.hpp"
#include "study/bearing/held_film.hpp"
#include "study/columns.hpp"
#include "study/common.hpp"
#include "study/lost_points.hpp"
#include "study/pieces.hpp"
#include "whirl/core/error.hpp"
#include "whirl/film/use/coefficients.hpp"

namespace whirl::study {
namespace {

// Speed by speed, each from the last one with an answer; pieces begin with `head`.
std::vector<AtSpeed> computed(Pieces& pieces, const std::string& head, const DynamicCoefficientsOptions& options,
                              system::Support support) {
  if (options.tilt) support.film = film::tilting(support.film).value();
  const auto film = film::make_film(support.geometry, support.film, support.lubricant);
  std::vector<AtSpeed> out;
  std::optional<std::size_t> last;
  for (std::size_t k = 0; k < options.speeds.size(); ++k) {
    out.push_back(at_speed(pieces, fmt::format("{} speed {}", head, k + 1), options.speeds[k].value, [&] {
      return coefficients_at(*film, options, support, options.speeds[k].value, last ? &out[*last].place : nullptr);
    }));
    if (out.back().found())
      last = k;
    else
      out.back().fill(film->ports().size(), options.all_frequencies().size(), options.amplitudes.size());
  }
  return out;
}

// Empty without amplitudes.
std::vector<std::vector<std::vector<EnforcedAt>>> enforced_of(const std::vector<AtSpeed>& found) {
  std::vector<std::vector<std::vector<EnforcedAt>>> out;
  for (const AtSpeed& a : found)
    if (!a.enforced.empty()) out.push_back(a.enforced);
  return out;
}

void put_summary(io::StudySummary& summary, const DynamicCoefficientsOptions& options, double clearance,
                 const std::vector<AtSpeed>& found) {
  for (std::size_t s = 0; s < found.size(); ++s) {
    const AtSpeed& a = found[s];
    if (!a.found()) continue;
    const std::string head = fmt::format("speed.{}.", number_text(options.speeds[s].value, options.speeds[s].unit));
    const auto& at = a.place.motion.position;
    summary.set(head + "speed", deck::from_si(options.speeds[s].value, options.speeds[s].unit), options.speeds[s].unit);
    summary.set(head + "x", at[0], "m");
    summary.set(head + "y", at[1], "m");
    summary.set(head + "eccentricity", a.eccentricity(clearance), "1");
    summary.set(head + "min_thickness", a.thickness, "m");
    summary.set(head + "force.x", a.place.force[0], "N");
    summary.set(head + "force.y", a.place.force[1], "N");
    for (std::size_t f = 0; f < options.frequencies.size(); ++f) {
      const std::string at_ratio = fmt::format("{}ratio.{:.6g}.", head, options.frequencies[f]);
      put_matrices(summary, at_ratio, a.coefficients[f]);
      if (!a.enforced.empty()) put_enforced(summary, at_ratio, options.amplitudes, a.enforced[f]);
    }
  }
}

// Places of the journal, and K and B entries [speed][frequency].
void put_tables(io::Group& group, const DynamicCoefficientsOptions& options, double clearance,
                const std::vector<AtSpeed>& found) {
  const std::vector<double> ratios = options.all_frequencies(), speeds = column(options.speeds, &deck::Quantity::value);
  const auto position = [&](std::size_t axis) {
    return column(found, [axis](const AtSpeed& a) { return a.place.motion.position[axis]; });
  };
  const auto force = [&](std::size_t axis) {
    return column(found, [axis](const AtSpeed& a) { return a.place.force[axis]; });
  };
  auto& places = group.child("places");
  places.put("speed", speeds, "rad/s", "shaft speed");
  places.put("x", position(0), "m", "place of the journal, to the right of the bearing centre");
  places.put("y", position(1), "m", "place of the journal, above the bearing centre");
  places.put("eccentricity", column(found, [&](const AtSpeed& a) { return a.eccentricity(clearance); }), "1",
             "in clearances");
  places.put("min_thickness", column(found, &AtSpeed::thickness), "m", "least thickness of the film");
  places.put("force_x", force(0), "N", "of the film on the journal");
  places.put("force_y", force(1), "N", "of the film on the journal");
  if (!std::ranges::all_of(found, &AtSpeed::found))
    places.put("reason", column(found, &AtSpeed::reason), "why a speed has no coefficients; empty: it has");
  auto& table = group.child("coefficients");
  table.put("speed", speeds, "rad/s", "shaft speed");
  table.put("ratio", ratios, "1", "frequency over speed, omega/Omega");
  std::vector<film::PortCoefficients> all;
  for (const AtSpeed& a : found) all.insert(all.end(), a.coefficients.begin(), a.coefficients.end());
  put_matrices(table, {speeds.size(), ratios.size()}, "[speed][frequency]", all);
  table.label_each({io::labels_of(ratios)});
  if (!options.amplitudes.empty()) put_enforced_tables(group, speeds, ratios, options.amplitudes, enforced_of(found));
}

// Bars of K and B.
TableBars bars_of(io::Group& table, const MeshLaw& law) {
  std::vector<std::string> names;
  for (const auto& [name, data] : table.datasets())
    if (name.starts_with("k_") || name.starts_with("c_")) names.push_back(name);
  return {table, std::move(names), law};
}

}  // namespace

StudyResult DynamicCoefficients::run(Context& context) {
  const system::Train train = system::train_of(context.machine);
  const std::size_t which = options.bearing.empty() ? 0 : *system::find_bearing(context.machine, options.bearing);
  const double clearance = train.supports[which].geometry.clearance;
  auto& summary = context.results.summary();
  auto& group = context.results.group();

  Pieces pieces(context.results, context.resume);
  const std::vector<FilmMesh> meshes = film_meshes(context.machine, context.layout);
  // The deck's mesh and the others. A coarse one may not hold what the deck asks for.
  const auto on = [&](Pieces& own, std::size_t m) {
    const std::array<double, 2> factor = m == 0 ? std::array{1.0, 1.0} : meshes[m - 1].factor;
    return answered([&] {
      return computed(own, fmt::format("on mesh {}", m), options, with_film_mesh(train, factor).supports[which]);
    });
  };
  const auto on_meshes =
      distribute_pieces(context, plan(context, Sharing::films), 1 + meshes.size(), on, pieces, "mesh");
  if (!on_meshes[0].found) throw core::NotConverged(on_meshes[0].reason);
  const std::vector<AtSpeed>& found = *on_meshes[0].found;
  const std::vector<std::string> reasons = column(found, &AtSpeed::reason);
  const std::vector<std::string> speeds =
      column(options.speeds, [](const deck::Quantity& q) { return number_text(q.value, q.unit) + " " + q.unit; });
  const auto none = std::ranges::find_if(found, [](const AtSpeed& a) { return a.most.has_value(); });
  if (none != found.end()) put_capacity(summary, *none->most);
  if (std::ranges::none_of(found, &AtSpeed::found)) return context.results.finish(reasons.front(), false);
  put_summary(summary, options, clearance, found);
  warn_of_lost_points(summary, "no coefficients at", reasons, [&](std::size_t k) { return speeds[k]; });
  for (std::size_t k = 0; k < found.size(); ++k)
    if (found[k].centre) summary.warnings.push_back(fmt::format("{}: {}", speeds[k], of_the_centre(found[k])));
  for (std::string& line : lost_motions(enforced_of(found), speeds, options.all_frequencies(), options.amplitudes))
    summary.warnings.push_back(std::move(line));

  put_tables(group, options, clearance, found);
  const MeshLaw law = law_of(context.machine, context.layout);
  SummaryBars of_summary(summary, law);
  std::map<std::string, TableBars> of_tables;
  for (const char* name : {"coefficients", "enforced"})
    if (group.has_group(name)) of_tables.emplace(name, bars_of(group.child(name), law));
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const std::vector<AtSpeed> other = on_meshes[m + 1].found.value_or(std::vector<AtSpeed>());
    io::StudySummary there;
    put_summary(there, options, clearance, other);
    const auto at_most = static_cast<std::size_t>(none - found.begin());
    if (at_most < other.size() && other[at_most].most) put_capacity(there, *other[at_most].most);
    of_summary.add(meshes[m].axis, meshes[m].spacing, there);
    io::Group tables;
    if (!other.empty()) put_tables(tables, options, clearance, other);
    for (auto& [name, bars] : of_tables) bars.add(meshes[m].axis, meshes[m].spacing, tables.child(name));
  }
  of_summary.write(place_tolerance);
  for (auto& [name, bars] : of_tables) bars.write();

  group.set("bearing", context.machine.bearings[which].name);
  const auto lost = static_cast<std::size_t>(std::ranges::count_if(reasons, [](const auto& r) { return !r.empty(); }));
  summary.points = static_cast<long>(found.size() - lost);
  if (lost > 0) return context.results.finish(status_of(lost, found.size(), "speeds", "coefficients"), true);
  const auto [without, all] = motions_without_values(enforced_of(found));
  // Coefficients of a small motion are written beside the enforced ones. They do not count as enforced motions.
  return context.results.finish(status_of(without, all, "enforced motions", "values"), all == 0 || without < all);
}

}  // namespace whirl::study
