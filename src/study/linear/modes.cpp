#include "whirl/study/linear/modes.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include "study/bars/verdict.hpp"
#include "study/common.hpp"
#include "study/layout.hpp"
#include "study/linear/line_modes.hpp"
#include "study/linear/mode_bars.hpp"
#include "study/linear/mode_margins.hpp"
#include "study/linear/mode_reduction.hpp"
#include "study/linear/mode_tables.hpp"
#include "study/linear/shaft_modes.hpp"
#include "study/pieces.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/table.hpp"
#include "whirl/rotor/frequencies.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/spectral/follow.hpp"
#include "whirl/spectral/whirl.hpp"

namespace whirl::study {
namespace {

// The modes at one speed, those of lowest frequency first.
struct Station {
  double speed = 0;
  bool reported = false;  // asked for; others only help to follow the modes
  std::vector<ShaftMode> modes;
};

// Modes above those asked for: some come down between two speeds, and a coarse mesh may have one in another place.
constexpr int beyond_over_speeds = 8, beyond_over_meshes = 2;
constexpr int most_refinements = 4;  // of the way between two speeds asked for

std::vector<spectral::ModePoint> points_of(const std::vector<ShaftMode>& modes) {
  std::vector<spectral::ModePoint> points;
  for (const ShaftMode& m : modes) points.push_back({m.lambda, m.both()});
  return points;
}

// Puts stations between those whose modes cannot be told apart, and then gives each mode an identity. As many speeds
// are added at most as were asked for.
void follow(std::vector<Station>& stations, std::size_t count,
            const std::function<std::vector<std::vector<ShaftMode>>(const std::vector<double>&)>& modes_at) {
  const std::size_t most = 2 * stations.size();
  std::vector<double> widths;
  for (std::size_t i = 1; i < stations.size(); ++i) widths.push_back(stations[i].speed - stations[i - 1].speed);
  const double least =
      widths.empty() ? 0 : *std::max_element(widths.begin(), widths.end()) / std::pow(2.0, most_refinements + 0.5);
  for (;;) {
    std::vector<double> between;
    for (std::size_t i = 1; i < stations.size(); ++i) {
      const Station &left = stations[i - 1], &right = stations[i];
      if (right.speed - left.speed > 2 * least && stations.size() + between.size() < most &&
          !spectral::match_modes(points_of(left.modes), points_of(right.modes), count).sure)
        between.push_back((left.speed + right.speed) / 2);
    }
    if (between.empty()) break;
    auto found = modes_at(between);
    for (std::size_t i = 0; i < between.size(); ++i) stations.push_back({between[i], false, std::move(found[i])});
    std::sort(stations.begin(), stations.end(), [](const Station& a, const Station& b) { return a.speed < b.speed; });
  }
  int next = 0;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    auto& now = stations[i].modes;
    if (i > 0) {
      const auto& last = stations[i - 1].modes;
      const spectral::ModeMatching pairs = spectral::match_modes(points_of(last), points_of(now), count);
      for (std::size_t k = 0; k < now.size(); ++k)
        if (pairs.before[k] >= 0) now[k].id = last[static_cast<std::size_t>(pairs.before[k])].id;
    }
    for (ShaftMode& m : now)
      if (m.id < 0) m.id = next++;
  }
  // Numbers from one in the order in which the results show the modes.
  std::map<int, int> number;
  for (Station& s : stations)
    if (s.reported)
      for (std::size_t k = 0; k < std::min(count, s.modes.size()); ++k)
        number.emplace(s.modes[k].id, static_cast<int>(number.size()) + 1);
  for (Station& s : stations)
    for (ShaftMode& m : s.modes) m.id = number.contains(m.id) ? number.at(m.id) : 0;
}

// Supports without films: undamped frequencies of the shaft at rest, the same in both planes.
StudyResult rigid_modes(Context& context, const ModesOptions& options) {
  rotor::Options shaft = context.machine.rotor;
  shaft.reduction = {};
  std::vector<int> pinned;
  if (options.supports == ModesOptions::Supports::pinned)
    for (const auto& b : context.machine.bearings) pinned.push_back(b.node);
  const auto frequencies =
      rotor::natural_frequencies(plan(context, Sharing::machine).space, shaft, pinned, options.count);
  auto& summary = context.results.summary();
  for (std::size_t k = 0; k < frequencies.size(); ++k) {
    summary.set(fmt::format("frequency.{}", k + 1), frequencies[k], "rad/s");
    summary.modes.push_back({0, 0, frequencies[k], 0, "planar", "rad/s", {}, name_of(StabilityClass::undamped)});
  }
  context.results.group()
      .child("spectrum")
      .put("frequency", frequencies, "rad/s", "undamped natural frequencies in one plane");
  summary.points = 1;
  return context.results.finish("completed", true);
}

// The regions of searches by transfer functions, over speed; of one speed in the summary too.
void put_searches(io::Group& group, io::StudySummary& summary, const std::vector<double>& speeds,
                  const std::map<double, ModeSearch>& searches) {
  std::vector<double> at, frequency, decay, counted, missed;
  for (const double speed : speeds) {
    const auto found = searches.find(speed);
    if (found == searches.end() || found->second.frequency == 0) continue;
    at.push_back(speed);
    frequency.push_back(found->second.frequency);
    decay.push_back(found->second.decay);
    counted.push_back(found->second.counted);
    missed.push_back(found->second.missed);
  }
  if (at.empty()) return;
  auto& search = group.child("search");
  search.put("speed", at, "rad/s", "shaft speed");
  search.put("frequency", frequency, "rad/s", "up to which the region of the search reaches, and to the right as far");
  search.put("decay", decay, "1/s", "as far as it reaches to the left");
  search.put("counted", counted, "1", "eigenvalues in the region, both of each pair");
  search.put("missed", missed, "1", "of these not found; -1: the count is not sure");
  if (at.size() > 1) return;
  summary.set("search.frequency", frequency[0], "rad/s");
  summary.set("search.decay", decay[0], "1/s");
  summary.set("search.counted", counted[0], "1");
  summary.set("search.missed", missed[0], "1");
}

}  // namespace

StudyResult Modes::run(Context& context) {
  if (options.motion != ModesOptions::Motion::bending) return line_modes(context, options);
  if (options.supports != ModesOptions::Supports::films) return rigid_modes(context, options);
  const std::vector<double> speeds = options.all_speeds();
  const std::vector<double> shape_speeds = options.all_shape_speeds();
  const std::string unit = options.unit();
  const double limit = options.max_frequency.value_or(std::numeric_limits<double>::infinity());
  const auto count = static_cast<std::size_t>(options.count);
  const bool one_speed = speeds.size() == 1 && std::all_of(shape_speeds.begin(), shape_speeds.end(),
                                                           [&](double s) { return s == speeds[0]; });
  const int sought = options.count + (one_speed ? beyond_over_meshes : beyond_over_speeds);
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
      const auto found = shaft_modes(system, walker.at(list[i]), sought, limit, here, options.condition);
      auto modes = pack(found, here);
      ready += static_cast<std::size_t>(layout.count);
      results.progress(fmt::format("{}: {} of {} speeds, {:.1f} {}, {:.1f} s", summary.name, std::min(ready, wanted),
                                   wanted, deck::from_si(list[i], unit), unit, results.seconds()));
      return modes;
    };
    const auto packed = distribute(layout, list.size(), compute, pieces,
                                   rounds == 0 ? "speed" : fmt::format("between {}", rounds), walker.trail());
    ++rounds;
    std::vector<std::vector<ShaftMode>> out;
    for (std::size_t i = 0; i < packed.size(); ++i) {
      ModeSearch& search = searches[list[i]];
      out.push_back(unpack(packed[i], search));
      missed.add(static_cast<int>(search.missed));
      if (search.gave_up > 0 && out.back().size() < count) too_few = list[i];
    }
    return out;
  };

  std::vector<double> all = speeds;
  all.insert(all.end(), shape_speeds.begin(), shape_speeds.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  std::vector<Station> stations;
  auto first = modes_at(all);
  for (std::size_t i = 0; i < all.size(); ++i)
    stations.push_back({all[i], std::find(speeds.begin(), speeds.end(), all[i]) != speeds.end(), std::move(first[i])});
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
  for (const std::size_t i : few_of(stations.size())) {
    sampled.push_back({stations[i].speed, {}, points_of(stations[i].modes)});
    for (const ShaftMode& m : stations[i].modes) sampled.back().ids.push_back(m.id);
  }
  const ModeBars bars(context, layout, pieces, sampled, [&](system::RotorSystem& on, Vec x) {
    ModeSearch of_other_mesh;
    return points_of(shaft_modes(on, x, sought, limit, of_other_mesh));
  });
  ModeReduction reduction(system, walker, sampled);
  ModeTables tables(rotor::node_positions(system.train().rotor), rotor::node_masses(system.train().rotor),
                    options.condition);
  std::vector<double> speed_column, frequency, real, decrement, factor;
  std::vector<std::int64_t> id_column;
  std::vector<std::string> stability_column;
  for (const double speed : speeds) {
    const auto& modes = station_at(speed).modes;
    for (std::size_t k = 0; k < std::min(count, modes.size()); ++k) {
      const ShaftMode& m = modes[k];
      speed_column.push_back(speed);
      id_column.push_back(m.id);
      frequency.push_back(m.lambda.imag());
      real.push_back(m.lambda.real());
      decrement.push_back(m.undamped ? 0 : spectral::log_decrement(m.lambda));
      factor.push_back(spectral::stability_factor(m.lambda));
      const char* const stability = name_of(m.undamped            ? StabilityClass::undamped
                                            : m.lambda.real() > 0 ? StabilityClass::unstable
                                                                  : StabilityClass::stable);
      stability_column.emplace_back(stability);
      summary.modes.push_back({deck::from_si(speed, unit),
                               m.lambda.real(),
                               m.lambda.imag(),
                               decrement.back(),
                               {},
                               unit,
                               bars.named(m.id, speed),
                               stability});
      tables.add(m, summary.modes.back());
      reduction.put(summary, speed, k);
    }
  }
  // Damped frequency meets the speed of the shaft between two speeds.
  struct Crossing {
    double s0, s1, f0, f1;
    ShaftMode guide;
  };
  std::vector<Crossing> crossings;
  for (std::size_t i = 1; options.range && i < stations.size(); ++i)
    for (const ShaftMode& m : stations[i].modes)
      for (const ShaftMode& b : stations[i - 1].modes) {
        const double f0 = b.lambda.imag() - stations[i - 1].speed, f1 = m.lambda.imag() - stations[i].speed;
        if (m.id == b.id && m.id > 0 && f0 * f1 < 0)
          crossings.push_back({stations[i - 1].speed, stations[i].speed, f0, f1, m});
      }
  // Where the chords cross, refined by solving there and following the mode.
  const auto refine = [&](std::size_t i) {
    Crossing c = crossings[i];
    std::vector<int> missed_on_the_way;
    for (int k = 0; k < 6 && std::abs(c.s1 - c.s0) > 1e-6 * c.s1; ++k) {
      const double s = c.s1 - c.f1 * (c.s1 - c.s0) / (c.f1 - c.f0);
      ModeSearch search;
      const auto there = shaft_modes(system, walker.at(s), sought, limit, search);
      missed_on_the_way.push_back(static_cast<int>(search.missed));
      const auto pairs = spectral::match_modes({{c.guide.lambda, c.guide.both()}}, points_of(there), 0);
      const auto found = std::find(pairs.before.begin(), pairs.before.end(), 0);
      if (found == pairs.before.end()) break;
      const ShaftMode& m = there[static_cast<std::size_t>(found - pairs.before.begin())];
      const double f = m.lambda.imag() - s;
      if (f * c.f1 < 0) c.s0 = c.s1, c.f0 = c.f1;
      c.s1 = s;
      c.f1 = f;
      c.guide.lambda = m.lambda;
      if (std::abs(f) < 1e-7 * s) break;
    }
    // Other ranks and resumed runs see what is returned, and nothing else.
    std::vector<double> out{c.s1, c.guide.lambda.real(), c.guide.lambda.imag()};
    out.insert(out.end(), missed_on_the_way.begin(), missed_on_the_way.end());
    return out;
  };
  const auto refined = distribute(layout, crossings.size(), refine, pieces, "critical", walker.trail());
  struct Critical {
    double speed, decrement;
    int id;
    double error, decrement_error;
  };
  std::vector<Critical> criticals;
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    const Crossing& c = crossings[i];
    for (std::size_t k = 3; k < refined[i].size(); ++k) missed.add(static_cast<int>(refined[i][k]));
    const auto bar = bars.at(c.guide.id, refined[i][0]);
    criticals.push_back({refined[i][0], spectral::log_decrement({refined[i][1], refined[i][2]}), c.guide.id,
                         bar[1] * std::abs((c.s1 - c.s0) / (c.f1 - c.f0)), bar[2]});
  }

  auto& spectrum = group.child("spectrum");
  spectrum.put("speed", speed_column, "rad/s", "shaft speed");
  spectrum.put("mode", id_column, "mode followed by its shape");
  spectrum.put("frequency", frequency, "rad/s", "damped frequency, imaginary part of the eigenvalue");
  spectrum.put("damping_real", real, "1/s", "real part of the eigenvalue");
  spectrum.put("log_decrement", decrement, "1", "-2 pi Re/|Im|");
  bars.put(spectrum, id_column, speed_column);
  spectrum.put("stability_factor", factor, "1", "10^-log_decrement, unstable above 1");
  tables.put_spectrum(spectrum);
  spectrum.put("stability", stability_column,
               "stable, unstable, or undamped: the real part is rounding, shown as zero");
  tables.put_map(group.child("whirl_map"));
  tables.warn(summary, searches);
  group.set("speed_unit", unit);
  put_searches(group, summary, speeds, searches);

  std::sort(criticals.begin(), criticals.end(), [](const Critical& a, const Critical& b) { return a.speed < b.speed; });
  std::vector<double> critical_speed, critical_decrement;
  std::vector<std::int64_t> critical_mode;
  for (std::size_t k = 0; k < criticals.size(); ++k) {
    summary.set(fmt::format("critical.{}.speed", k + 1), deck::from_si(criticals[k].speed, unit), unit,
                bars.as_bar(deck::from_si(criticals[k].error, unit)));
    summary.set(fmt::format("critical.{}.log_decrement", k + 1), criticals[k].decrement, "1",
                bars.as_bar(criticals[k].decrement_error));
    put_margins(summary, fmt::format("critical.{}.", k + 1), criticals[k].speed, criticals[k].error,
                criticals[k].decrement, criticals[k].decrement_error, options.operating);
    critical_speed.push_back(criticals[k].speed);
    critical_decrement.push_back(criticals[k].decrement);
    critical_mode.push_back(criticals[k].id);
  }
  group.child("critical").put("speed", critical_speed, "rad/s", "speed equal to the damped frequency");
  group.child("critical").put("log_decrement", critical_decrement, "1", "of the mode there");
  group.child("critical").put("mode", critical_mode, "mode followed by its shape");

  put_bearings(group, context.machine);
  std::vector<const std::vector<ShaftMode>*> shaped;
  for (const double speed : shape_speeds) shaped.push_back(&station_at(speed).modes);
  tables.put_shapes(group.child("shapes"), shape_speeds, shaped, count);
  missed.warn(summary);
  if (too_few)
    summary.warnings.push_back(fmt::format(
        "at {:.6g} {} the search gave up before it had {} modes in which the machine takes part: 'max_frequency' "
        "sets how far it looks",
        deck::from_si(*too_few, unit), unit, options.count));
  summary.points = static_cast<long>(speeds.size());
  return results.finish("completed", true);
}

}  // namespace whirl::study
