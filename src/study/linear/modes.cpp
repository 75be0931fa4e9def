#include "study/linear/modes.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "study/bars/mesh_wave.hpp"
#include "study/bars/verdict.hpp"
#include "study/columns.hpp"
#include "study/common.hpp"
#include "study/evenly.hpp"
#include "study/layout.hpp"
#include "study/linear/mode_bars.hpp"
#include "study/linear/mode_stations.hpp"
#include "study/linear/mode_tables.hpp"
#include "study/linear/mode_values.hpp"
#include "study/linear/peak_list.hpp"
#include "study/linear/separation.hpp"
#include "study/linear/shaft_modes.hpp"
#include "study/pieces.hpp"
#include "study/service_speeds.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/table.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/spectral/whirl.hpp"

namespace whirl::study {
namespace {

// Modes above those asked for: some come down between two speeds, and a coarse mesh may have one in another place.
constexpr int beyond_over_speeds = 8, beyond_over_meshes = 2, beyond_to_find = 60;

// The regions of searches by transfer functions, over speed; of one speed in the summary too.
void put_searches(io::Group& group, io::StudySummary& summary, const std::vector<double>& speeds,
                  const std::map<double, ModeSearch>& searches) {
  std::vector<double> at;
  std::vector<ModeSearch> known;
  for (const double speed : speeds) {
    const auto found = searches.find(speed);
    if (found == searches.end() || found->second.frequency == 0) continue;
    at.push_back(speed);
    known.push_back(found->second);
  }
  if (at.empty()) return;
  auto& search = group.child("search");
  search.put("speed", at, "rad/s", "shaft speed");
  search.put("frequency", column(known, &ModeSearch::frequency), "rad/s",
             "up to which the region of the search reaches, and to the right as far");
  search.put("decay", column(known, &ModeSearch::decay), "1/s", "as far as it reaches to the left");
  search.put("counted", column(known, &ModeSearch::counted), "1", "eigenvalues in the region, both of each pair");
  search.put("missed", column(known, &ModeSearch::missed), "1", "of these not found; -1: the count is not sure");
  if (at.size() > 1) return;
  summary.set("search.frequency", known[0].frequency, "rad/s");
  summary.set("search.decay", known[0].decay, "1/s");
  summary.set("search.counted", known[0].counted, "1");
  summary.set("search.missed", known[0].missed, "1");
}

// What is true at the speed of service is computed there, with its bars, and not read off between two speeds.
std::vector<double> with_service_speed(const ModesOptions& options, const std::optional<deck::Quantity>& service) {
  std::vector<double> speeds = options.all_speeds();
  if (!options.range || !service || !std::ranges::is_sorted(speeds)) return speeds;
  put_between(speeds, service->value);
  return speeds;
}

}  // namespace

StudyResult Modes::run(Context& context) {
  if (of_shaft_alone(options)) return modes_of_shaft_alone(context, options);
  const std::vector<double> speeds = with_service_speed(options, context.machine.service_speed);
  const std::vector<double> shape_speeds = options.all_shape_speeds();
  const std::string unit = options.unit();
  const double limit = options.max_frequency.value_or(std::numeric_limits<double>::infinity());
  const auto count = static_cast<std::size_t>(options.count);
  const bool one_speed = speeds.size() == 1 && std::all_of(shape_speeds.begin(), shape_speeds.end(),
                                                           [&](double s) { return s == speeds[0]; });
  const int more = one_speed ? beyond_over_meshes : beyond_over_speeds;
  const Layout layout = plan(context, Sharing::speeds);
  system::RotorSystem system(layout.space, system::train_of(context.machine), speeds.front());
  Walker walker(system);
  auto& results = context.results;
  auto& summary = results.summary();
  auto& group = results.group();
  std::size_t ready = 0, wanted = 0;
  int rounds = 0;
  Pieces pieces(results, context.resume);
  MissedModes missed;
  std::optional<double> too_few;          // a speed
  std::map<double, ModeSearch> searches;  // by speed
  const auto modes_at = [&](const std::vector<double>& list) {
    wanted += list.size();
    const auto compute = [&](std::size_t i) {
      ModeSearch here;
      auto found = shaft_modes(system, walker.at(list[i]), options.count, more, limit, here, options.condition);
      ready += static_cast<std::size_t>(layout.count);
      results.progress(
          fmt::format("{}: {} of {} speeds{}, {:.1f} {}, {:.1f} s", summary.name, std::min(ready, wanted), wanted,
                      results.left(static_cast<double>(std::min(ready, wanted)) / static_cast<double>(wanted)),
                      deck::from_si(list[i], unit), unit, results.seconds()));
      return FoundModes(std::move(found), std::move(here));
    };
    auto found_at = distribute(layout, list.size(), compute, pieces,
                               rounds == 0 ? "speed" : fmt::format("between {}", rounds), walker.trail());
    ++rounds;
    std::vector<Station> out;
    for (std::size_t i = 0; i < found_at.size(); ++i) {
      auto& [modes, search] = found_at[i];
      const bool asked = std::find(speeds.begin(), speeds.end(), list[i]) != speeds.end();
      out.push_back({list[i], asked, std::move(modes)});
      out.back().listed = static_cast<std::size_t>(search.listed);
      out.back().overdamped = search.overdamped;
      missed.add(static_cast<int>(search.missed));
      if (search.gave_up > 0 && out.back().modes.size() < count) too_few = list[i];
      searches[list[i]] = std::move(search);
    }
    return out;
  };

  std::vector<double> all = speeds;
  all.insert(all.end(), shape_speeds.begin(), shape_speeds.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  if (options.range)
    for (const double row :
         tabled_speeds(context.machine, all.front(), all.back(), speeds.size(), system.size(), summary, unit))
      put_between(all, row);
  std::vector<Station> stations = modes_at(all);
  // Modes are followed over a range; single speeds far apart have only their own.
  if (options.range) {
    follow(stations, count, modes_at);
  } else {
    for (Station& s : stations)
      for (std::size_t k = 0; k < s.modes.size(); ++k) s.modes[k].id = static_cast<int>(k) + 1;
  }
  const auto station_at = [&](double speed) -> const Station& {
    return *std::find_if(stations.begin(), stations.end(), [&](const Station& s) { return s.speed == speed; });
  };

  std::vector<SampledModes> sampled;
  for (const std::size_t i : few_of(stations.size(), most_with_bars)) {
    sampled.push_back({stations[i].speed, {}, points_of(stations[i].modes), stations[i].listed});
    for (const ShaftMode& m : stations[i].modes) sampled.back().ids.push_back(m.id);
  }
  const ModeBars bars(context, layout, pieces, sampled, [&](system::RotorSystem& on, Vec x) {
    ModeSearch of_other_mesh;
    return points_of(shaft_modes(on, x, options.count, more, limit, of_other_mesh));
  });
  std::set<int> shown;
  for (const double speed : speeds)
    for (std::size_t k = 0; k < station_at(speed).listed; ++k)
      if (const ShaftMode& m = station_at(speed).modes[k]; !bars.of_elements(m.lambda)) shown.insert(m.id);
  bars.tell(summary, context.machine.rotor, shown);
  ModeReduction reduction(system, walker, sampled);
  ModeTables tables(rotor::node_positions(system.train().rotor), rotor::node_masses(system.train().rotor),
                    options.condition);
  std::vector<double> speed_column, frequency, real, decrement, ratio, factor;
  std::vector<std::int64_t> id_column;
  std::vector<std::string> stability_column;
  for (const double speed : speeds) {
    const Station& station = station_at(speed);
    for (std::size_t k = 0; k < station.listed; ++k) {
      const ShaftMode& m = station.modes[k];
      speed_column.push_back(speed);
      id_column.push_back(m.id);
      frequency.push_back(m.lambda.imag());
      real.push_back(m.lambda.real());
      decrement.push_back(m.undamped ? 0 : spectral::log_decrement(m.lambda));
      ratio.push_back(spectral::damping_ratio(m.lambda));
      factor.push_back(spectral::stability_factor(m.lambda));
      const char* const stability = stability_of(m, speed, bars);
      stability_column.emplace_back(stability);
      summary.modes.push_back({deck::from_si(speed, unit),
                               m.lambda.real(),
                               m.lambda.imag(),
                               decrement.back(),
                               {},
                               unit,
                               bars.named(m.id, speed),
                               stability});
      summary.modes.back().more["mode"] = m.id;
      summary.modes.back().more["damping_ratio"] = ratio.back();
      tables.add(m, summary.modes.back());
      reduction.put(summary, speed, k);
    }
  }
  // Modes of a frequency that may be above those asked for.
  const auto modes_about = [&](const ShaftMode& mode, double speed, ModeSearch& search) {
    return shaft_modes(system, walker.at(speed), options.count, beyond_to_find, 1.5 * mode.lambda.imag(), search);
  };
  // Damped frequency meets the speed of the shaft between two speeds, or a mode begins or ceases to grow.
  std::vector<Crossing> crossings;
  if (options.range) {
    // A mode that begins or ceases to grow outside the list is looked up where it does not grow.
    const std::vector<LostMode> lost =
        lost_modes(stations, [&](const ShaftMode& m, double speed) { return surely_grows(m, speed, bars); });
    const auto look_up = [&](std::size_t i) {
      ModeSearch search;
      return modes_about(lost[i].guide, stations[lost[i].station].speed, search);
    };
    const auto found = distribute(layout, lost.size(), look_up, pieces, "onset", walker.trail());
    for (std::size_t i = 0; i < lost.size(); ++i) put_back(lost[i], found[i], stations);
    crossings = crossings_of(stations);
  }
  const auto refine = [&](std::size_t i) {
    // Other ranks and resumed runs see what is returned, and nothing else.
    std::pair<CrossingPoint, std::vector<double>> found;
    found.first = locate(crossings[i], [&](double speed) {
      ModeSearch search;
      auto there = crossings[i].outside ? modes_about(crossings[i].guide, speed, search)
                                        : shaft_modes(system, walker.at(speed), options.count, more, limit, search);
      found.second.push_back(search.missed);
      return there;
    });
    return found;
  };
  const auto refined = distribute(layout, crossings.size(), refine, pieces, "critical", walker.trail());
  struct Critical {
    double speed, decrement;
    int id;
    double error, decrement_error;
    bool excited;  // by unbalance
  };
  std::vector<Critical> criticals;
  std::vector<CrossingPoint> points;
  std::vector<double> errors;  // of the speeds
  for (const auto& [point, missed_on_the_way] : refined) {
    points.push_back(point);
    for (const double each : missed_on_the_way) missed.add(static_cast<int>(each));
  }
  std::vector<LostCrossings> may_be_missing;
  if (options.range) may_be_missing = lost_crossings(stations);
  const std::vector<bool> twice = found_twice(stations, crossings, points, may_be_missing);
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    const Crossing& c = crossings[i];
    const auto bar = bars.at(c.guide.id, points[i].speed);
    const bool critical = c.border == Border::critical;
    errors.push_back(points[i].left + bar[critical ? 1 : 0] * std::abs((c.s1 - c.s0) / (c.f1 - c.f0)));
    if (!points[i].followed)
      summary.warnings.push_back(
          fmt::format("mode {} {} between {:.6g} and {:.6g} {}. Its shape could not be followed to that speed; more "
                      "'points' locate it",
                      c.guide.id, critical ? "has a critical speed" : "becomes stable or unstable",
                      deck::from_si(c.s0, unit), deck::from_si(c.s1, unit), unit));
    if (critical && !twice[i])
      criticals.push_back({points[i].speed, spectral::log_decrement(points[i].lambda), c.guide.id, errors[i], bar[2],
                           !spectral::turns_backward(points[i].shape)});
  }

  auto& spectrum = group.child("spectrum");
  spectrum.put("speed", speed_column, "rad/s", "shaft speed");
  spectrum.put("mode", id_column, "mode followed by its shape");
  spectrum.put("frequency", frequency, "rad/s", "damped frequency, imaginary part of the eigenvalue");
  spectrum.put("damping_real", real, "1/s", "real part of the eigenvalue");
  spectrum.put("log_decrement", decrement, "1", "-2 pi Re/|Im|");
  spectrum.put("damping_ratio", ratio, "1", "-Re/|lambda|, negative where the mode grows");
  bars.put(spectrum, id_column, speed_column);
  spectrum.put("stability_factor", factor, "1", "10^-log_decrement, unstable above 1");
  tables.put_spectrum(spectrum);
  spectrum.put(
      "stability", stability_column,
      "stable, unstable, diverges (it grows without oscillation), undetermined (the bar of the real part contains "
      "zero), not resolved (a vibration of the elements of the shaft, which decides on nothing), or undamped: the real "
      "part is rounding, shown as zero");
  tables.put_map(group.child("whirl_map"));
  tables.warn(summary, searches);
  group.set("speed_unit", unit);
  put_searches(group, summary, speeds, searches);

  for (const LostCrossings& lost : may_be_missing)
    summary.warnings.push_back(fmt::format(
        "between {:.6g} and {:.6g} {} critical speeds may be missing: {} of the modes could not be followed across the "
        "speed. More points show them",
        deck::from_si(lost.from, unit), deck::from_si(lost.to, unit), unit, lost.count));

  std::sort(criticals.begin(), criticals.end(), [](const Critical& a, const Critical& b) { return a.speed < b.speed; });
  const auto operating = operating_range(options.operating, {}, context.machine.service_speed);
  for (std::size_t k = 0; k < criticals.size(); ++k) {
    summary.set(fmt::format("critical.{}.speed", k + 1), deck::from_si(criticals[k].speed, unit), unit,
                bars.as_bar(deck::from_si(criticals[k].error, unit)));
    summary.set(fmt::format("critical.{}.log_decrement", k + 1), criticals[k].decrement, "1",
                bars.as_bar(criticals[k].decrement_error));
    summary.set(fmt::format("critical.{}.mode", k + 1), criticals[k].id, "1");
    if (!criticals[k].excited) summary.set(fmt::format("critical.{}.excited", k + 1), 0, "1");
    put_margins(summary, fmt::format("critical.{}.", k + 1), criticals[k].speed, criticals[k].error,
                criticals[k].decrement, criticals[k].decrement_error, operating);
  }
  warn_of_amplification(summary);
  put_criticals(group.child("critical"), summary);
  if (operating && options.range) put_operating_range(summary, *operating, *options.range);

  put_bearings(group, context.machine);
  std::vector<std::span<const ShaftMode>> shaped;
  for (const double speed : shape_speeds) {
    const Station& s = station_at(speed);
    shaped.emplace_back(s.modes.data(), s.listed);
  }
  tables.put_shapes(group.child("shapes"), shape_speeds, shaped);
  const ModeValues values(unit, tables, bars);
  if (options.range)
    values.put_ranges(group, summary, stations, unstable_ranges(stations, crossings, points), errors);
  else
    values.put_speeds(summary, stations);
  values.put_overdamped(group.child("overdamped"), summary, stations);
  missed.warn(summary);
  MeshWaves waves;
  for (const double speed : speeds) waves.add(deck::from_si(speed, unit), searches[speed].mesh_waves);
  waves.warn(summary, unit);
  if (too_few)
    summary.warnings.push_back(fmt::format(
        "at {:.6g} {} the search gave up before it had {} modes in which the machine takes part: 'max_frequency' "
        "sets how far it looks",
        deck::from_si(*too_few, unit), unit, options.count));
  summary.points = static_cast<long>(speeds.size());
  return results.finish("completed", true);
}

}  // namespace whirl::study
