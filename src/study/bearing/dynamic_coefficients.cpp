#include "study/bearing/dynamic_coefficients.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "study/bars/film_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/bearing/coefficients_at.hpp"
#include "study/bearing/enforced_motion.hpp"
#include "study/bearing/held_film.hpp"
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

// Every number that may have a bar, in the order of the tables: places, then entries of K and B.
std::vector<double> numbers_of(const std::vector<AtSpeed>& found) {
  std::vector<double> out;
  for (const AtSpeed& a : found) out.insert(out.end(), {a.place.motion.position[0], a.place.motion.position[1]});
  if (found.empty()) return out;
  const std::size_t n = found.front().coefficients.front().ports;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      for (const AtSpeed& a : found)
        for (const film::PortCoefficients& c : a.coefficients)
          out.insert(out.end(), {c.stiffness[i][j], c.damping[i][j]});
  add_numbers(enforced_of(found), out);
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
    summary.set(head + "eccentricity", std::hypot(at[0], at[1]) / clearance, "1");
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

// One table of K or B entries [speed][frequency] with bars.
void put_tables(io::Group& group, const DynamicCoefficientsOptions& options, double clearance,
                const std::vector<AtSpeed>& found, const Bars* bars) {
  const std::vector<double> ratios = options.all_frequencies();
  std::vector<double> speeds, x, y, e, thickness, force_x, force_y;
  std::vector<std::string> reasons;
  for (const AtSpeed& a : found) {
    const auto& at = a.place.motion.position;
    speeds.push_back(a.place.motion.speed);
    reasons.push_back(a.reason);
    x.push_back(at[0]);
    y.push_back(at[1]);
    e.push_back(std::hypot(at[0], at[1]) / clearance);
    thickness.push_back(a.thickness);
    force_x.push_back(a.place.force[0]);
    force_y.push_back(a.place.force[1]);
  }
  auto& places = group.child("places");
  places.put("speed", speeds, "rad/s", "shaft speed");
  places.put("x", x, "m", "place of the journal, to the right of the bearing centre");
  places.put("y", y, "m", "place of the journal, above the bearing centre");
  places.put("eccentricity", e, "1", "in clearances");
  places.put("min_thickness", thickness, "m", "least thickness of the film");
  places.put("force_x", force_x, "N", "of the film on the journal");
  places.put("force_y", force_y, "N", "of the film on the journal");
  if (std::ranges::any_of(reasons, [](const std::string& why) { return !why.empty(); }))
    places.put("reason", std::move(reasons), "why a speed has no coefficients; empty: it has");
  auto& table = group.child("coefficients");
  table.put("speed", speeds, "rad/s", "shaft speed");
  table.put("ratio", ratios, "1", "frequency over speed, omega/Omega");
  const io::Shape shape{speeds.size(), ratios.size()};
  const std::size_t n = found.front().coefficients.front().ports;
  std::size_t next = 2 * found.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      std::array<std::vector<double>, 2> values, errors;
      for (const AtSpeed& a : found)
        for (const film::PortCoefficients& c : a.coefficients) {
          values[0].push_back(c.stiffness[i][j]);
          values[1].push_back(c.damping[i][j]);
          for (std::size_t k = 0; k < 2; ++k, ++next)
            if (bars) errors[k].push_back((*bars)[next].total());
        }
      for (std::size_t k = 0; k < 2; ++k) {
        const std::string name = (k == 0 ? "k_" : "c_") + pair_name(i, j, "_");
        const char* unit = (k == 0 ? stiffness_units : damping_units)[slopes_in(i, j)];
        const char* what = k == 0 ? "stiffness" : "damping";
        table.put(name, shape, values[k], unit, fmt::format("{} [speed][frequency]", what));
        if (bars)
          table.put(name + "_uncertainty", shape, errors[k], unit,
                    fmt::format("estimated error of {} from the film mesh", name));
      }
    }
  table.label_each({io::labels_of(ratios)});
  if (!options.amplitudes.empty())
    put_enforced_tables(group, speeds, ratios, options.amplitudes, enforced_of(found), bars, next);
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
  std::vector<std::string> speeds, reasons;
  for (const deck::Quantity& q : options.speeds) speeds.push_back(number_text(q.value, q.unit) + " " + q.unit);
  for (const AtSpeed& a : found) reasons.push_back(a.reason);
  const auto none = std::ranges::find_if(found, [](const AtSpeed& a) { return a.most.has_value(); });
  if (none != found.end()) {
    summary.set("capacity.load", none->most->load, "N");
    summary.set("capacity.eccentricity", none->most->eccentricity, "1");
  }
  if (std::ranges::none_of(found, &AtSpeed::found)) return context.results.finish(reasons.front(), false);
  put_summary(summary, options, clearance, found);
  for (std::string& line : lost_points("no coefficients at", reasons, [&](std::size_t k) { return speeds[k]; }))
    summary.warnings.push_back(std::move(line));
  for (std::size_t k = 0; k < found.size(); ++k)
    if (found[k].centre) summary.warnings.push_back(fmt::format("{}: {}", speeds[k], of_the_centre(found[k])));
  for (std::string& line : lost_motions(enforced_of(found), speeds, options.all_frequencies(), options.amplitudes))
    summary.warnings.push_back(std::move(line));

  const MeshLaw law = law_of(context.machine, context.layout);
  Bars bars(numbers_of(found), law);
  SummaryBars of_summary(summary, law);
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const std::vector<AtSpeed> other = on_meshes[m + 1].found.value_or(std::vector<AtSpeed>());
    io::StudySummary there;
    put_summary(there, options, clearance, other);
    of_summary.add(meshes[m].axis, meshes[m].spacing, there);
    bars.add(meshes[m].axis, meshes[m].spacing, numbers_of(other));
  }
  of_summary.write(place_tolerance);

  group.set("bearing", context.machine.bearings[which].name);
  put_tables(group, options, clearance, found, meshes.empty() ? nullptr : &bars);
  const auto lost = static_cast<std::size_t>(std::ranges::count_if(reasons, [](const auto& r) { return !r.empty(); }));
  summary.points = static_cast<long>(found.size() - lost);
  if (lost > 0) return context.results.finish(status_of(lost, found.size(), "speeds", "coefficients"), true);
  const auto [without, all] = motions_without_values(enforced_of(found));
  // Coefficients of a small motion are written beside the enforced ones. They do not count as enforced motions.
  return context.results.finish(status_of(without, all, "enforced motions", "values"), all == 0 || without < all);
}

}  // namespace whirl::study
