#include "study/linear/mode_stations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "study/linear/dip.hpp"
#include "whirl/spectral/whirl.hpp"

namespace whirl::study {
namespace {

constexpr int most_refinements = 4;             // of the way between two speeds asked for
constexpr std::size_t most_for_crossings = 24;  // speeds

// Of a damping ratio of 0.2, an amplification factor of 2.5, on, it is no critical speed (API 684).
bool may_be_critical(const ShaftMode& m) {
  return spectral::vibrates(m.lambda) && spectral::damping_ratio(m.lambda) < 0.2;
}

const ShaftMode* mode_with(int id, const Station& station) {
  const auto at =
      std::find_if(station.modes.begin(), station.modes.end(), [id](const ShaftMode& m) { return m.id == id; });
  return at == station.modes.end() ? nullptr : &*at;
}

}  // namespace

std::vector<spectral::ModePoint> points_of(const std::vector<ShaftMode>& modes) {
  std::vector<spectral::ModePoint> points;
  for (const ShaftMode& m : modes) points.push_back({m.lambda, m.both()});
  return points;
}

double beyond(Border border, std::complex<double> lambda, double speed) {
  return border == Border::critical ? lambda.imag() - speed : lambda.real();
}

namespace {

// Speeds in the middle of stations whose modes cannot be told apart, further apart than `least`.
std::vector<double> where_modes_mix(const std::vector<Station>& stations, std::size_t count, double least) {
  std::vector<double> between;
  for (std::size_t i = 1; i < stations.size(); ++i) {
    const Station &left = stations[i - 1], &right = stations[i];
    if (right.speed - left.speed > least &&
        !spectral::match_modes(points_of(left.modes), points_of(right.modes), count).sure)
      between.push_back((left.speed + right.speed) / 2);
  }
  return between;
}

// Gives each track a number from one on, in the order in which they begin.
void identify(std::vector<Station>& stations, std::size_t count) {
  int next = 1;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    auto& now = stations[i].modes;
    for (ShaftMode& m : now) m.id = -1;
    if (i > 0) {
      const auto& last = stations[i - 1].modes;
      const spectral::ModeMatching pairs = spectral::match_modes(points_of(last), points_of(now), count);
      for (std::size_t k = 0; k < now.size(); ++k)
        if (pairs.before[k] >= 0) now[k].id = last[static_cast<std::size_t>(pairs.before[k])].id;
    }
    for (ShaftMode& m : now)
      if (m.id < 0) m.id = next++;
  }
}

// Modes of `s` on one side of the speed that `other` does not have, and that may have a critical speed.
int alone(const Station& s, const Station& other, bool below) {
  return static_cast<int>(std::ranges::count_if(s.modes, [&](const ShaftMode& m) {
    return may_be_critical(m) && !mode_with(m.id, other) && (beyond(Border::critical, m.lambda, s.speed) < 0) == below;
  }));
}

// Whether a crossing may hide between two stations: tracks above the speed end at the first, and some below it begin at
// the second; or more begin below it than end there. If the modes of the first end below the speed, others follow that
// are not known.
bool hides_crossing(const Station& first, const Station& second) {
  const int begin = alone(second, first, true);
  const bool reaches = std::ranges::any_of(
      first.modes, [&](const ShaftMode& m) { return beyond(Border::critical, m.lambda, first.speed) > 0; });
  return (begin > 0 && alone(first, second, false) > 0) || (reaches && begin > alone(first, second, true));
}

// Speeds at which borders may be crossed unseen: between two stations, and where a track nears a border and leaves it
// again.
std::vector<double> where_crossings_hide(const std::vector<Station>& stations) {
  std::vector<double> out;
  for (std::size_t i = 1; i < stations.size(); ++i)
    if (hides_crossing(stations[i - 1], stations[i])) out.push_back((stations[i - 1].speed + stations[i].speed) / 2);
  for (std::size_t i = 1; i + 1 < stations.size(); ++i) {
    const Station &before = stations[i - 1], &here = stations[i], &after = stations[i + 1];
    for (const ShaftMode& m : here.modes) {
      const ShaftMode *a = mode_with(m.id, before), *b = mode_with(m.id, after);
      if (!a || !b || m.undamped) continue;
      for (const Border border : {Border::critical, Border::stability}) {
        if (border == Border::critical && !may_be_critical(m)) continue;
        const auto dip = dip_of({before.speed, here.speed, after.speed},
                                {beyond(border, a->lambda, before.speed), beyond(border, m.lambda, here.speed),
                                 beyond(border, b->lambda, after.speed)});
        if (dip) out.push_back(*dip);
      }
    }
  }
  constexpr double nearest = 1e-3;  // of the speed
  std::ranges::sort(out);
  std::vector<double> apart;
  for (const double at : out)
    if ((apart.empty() || at - apart.back() > nearest * at) &&
        std::ranges::none_of(stations, [&](const Station& s) { return std::abs(s.speed - at) <= nearest * at; }))
      apart.push_back(at);
  return apart;
}

}  // namespace

void follow(std::vector<Station>& stations, std::size_t count,
            const std::function<std::vector<Station>(const std::vector<double>&)>& modes_at) {
  const auto insert = [&](const std::vector<double>& speeds) {
    for (Station& s : modes_at(speeds)) stations.push_back(std::move(s));
    std::ranges::sort(stations, {}, &Station::speed);
  };
  double widest = 0;
  for (std::size_t i = 1; i < stations.size(); ++i)
    widest = std::max(widest, stations[i].speed - stations[i - 1].speed);
  const double least = 2 * widest / std::pow(2.0, most_refinements + 0.5);
  std::size_t left = stations.size();
  for (;;) {
    std::vector<double> ask = where_modes_mix(stations, count, least);
    ask.resize(std::min(ask.size(), left));
    if (ask.empty()) break;
    left -= ask.size();
    insert(ask);
  }
  for (left += most_for_crossings;;) {
    identify(stations, count);
    std::vector<double> ask = where_crossings_hide(stations);
    ask.resize(std::min(ask.size(), left));
    if (ask.empty()) break;
    left -= ask.size();
    insert(ask);
  }
  std::map<int, int> number;
  const auto give = [&](int id) { number.emplace(id, static_cast<int>(number.size()) + 1); };
  for (const Station& s : stations)
    if (s.reported)
      for (std::size_t k = 0; k < s.listed; ++k) give(s.modes[k].id);
  for (const Crossing& c : crossings_of(stations))
    if (c.border == Border::stability || may_be_critical(c.guide)) give(c.guide.id);
  for (Station& s : stations)
    for (ShaftMode& m : s.modes) m.id = number.contains(m.id) ? number.at(m.id) : -m.id;
}

std::vector<Crossing> crossings_of(const std::vector<Station>& stations) {
  std::vector<Crossing> out;
  for (std::size_t i = 1; i < stations.size(); ++i)
    for (const ShaftMode& m : stations[i].modes) {
      if (m.id <= 0) continue;
      const Station& before = stations[i - 1];
      const ShaftMode* b = mode_with(m.id, before);
      if (!b) continue;
      for (const Border border : {Border::critical, Border::stability}) {
        const double f0 = beyond(border, b->lambda, before.speed), f1 = beyond(border, m.lambda, stations[i].speed);
        if (f0 * f1 < 0)
          out.push_back({border, before.speed, stations[i].speed, f0, f1, m, i, b->put_back || m.put_back, *b});
      }
    }
  return out;
}

std::vector<LostCrossings> lost_crossings(const std::vector<Station>& stations) {
  std::vector<LostCrossings> out;
  for (std::size_t k = 1; k < stations.size(); ++k) {
    const Station &before = stations[k - 1], &here = stations[k];
    const int count = std::min(alone(before, here, false), alone(here, before, true));
    if (count > 0) out.push_back({before.speed, here.speed, count});
  }
  return out;
}

std::vector<LostMode> lost_modes(const std::vector<Station>& stations,
                                 const std::function<bool(const ShaftMode&, double)>& grows) {
  std::vector<LostMode> out;
  for (std::size_t i = 0; i < stations.size(); ++i)
    for (const ShaftMode& m : stations[i].modes) {
      if (m.id <= 0 || !m.grows() || !grows(m, stations[i].speed)) continue;
      if (i > 0 && !mode_with(m.id, stations[i - 1])) out.push_back({m, i - 1});
      if (i + 1 < stations.size() && !mode_with(m.id, stations[i + 1])) out.push_back({m, i + 1});
    }
  return out;
}

void put_back(const LostMode& lost, const std::vector<ShaftMode>& found, std::vector<Station>& stations) {
  const auto pairs = spectral::match_modes({{lost.guide.lambda, lost.guide.both()}}, points_of(found), 0);
  const auto at = std::find(pairs.before.begin(), pairs.before.end(), 0);
  if (at == pairs.before.end()) return;
  ShaftMode m = found[static_cast<std::size_t>(at - pairs.before.begin())];
  m.id = lost.guide.id;
  m.put_back = true;
  stations[lost.station].modes.push_back(std::move(m));
}

namespace {

// The same, by the mode that is known at the speed `known`; nothing where it could not be followed to the border.
std::optional<CrossingPoint> located_by(ShaftMode guide, double known, const Crossing& c,
                                        const std::function<std::vector<ShaftMode>(double)>& modes_at) {
  constexpr int most = 24, most_lost = 4;  // speeds; in a row at which the mode is not found
  constexpr int smooth = 6;                // speeds within which secants find the zero of what does not jump
  const bool may_jump = c.border == Border::stability;
  std::array<double, 2> s{c.s0, c.s1}, f{c.f0, c.f1};
  int lost = 0;
  std::size_t moved = 2;
  double at = 0, before = c.f1;  // what the last look found
  const double slope = std::abs((c.f1 - c.f0) / (c.s1 - c.s0));
  for (int k = 0; k < most && lost <= most_lost; ++k) {
    // Where the mode is not found, the next look is half as far from where it was.
    at = lost > 0                  ? (at + known) / 2
         : may_jump && k >= smooth ? (s[0] + s[1]) / 2
                                   : s[1] - f[1] * (s[1] - s[0]) / (f[1] - f[0]);
    const auto there = modes_at(at);
    const auto pairs = spectral::match_modes({{guide.lambda, guide.both()}}, points_of(there), 0);
    const auto found = std::ranges::find(pairs.before, 0);
    lost = found == pairs.before.end() ? lost + 1 : 0;
    if (lost > 0) continue;
    guide = there[static_cast<std::size_t>(found - pairs.before.begin())];
    const double step = std::abs(at - known);
    known = at;
    const double here = beyond(c.border, guide.lambda, at);
    const double scale = c.border == Border::critical ? at : std::abs(guide.lambda);
    if (std::abs(here) < (c.border == Border::critical ? 1e-7 : 1e-10) * scale)
      return CrossingPoint{at, guide.lambda, guide.both()};
    // Equilibria are known to a tolerance, which may leave more than that.
    if (!may_jump && step < 1e-6 * at && std::abs(here) < 1e-4 * scale)
      return CrossingPoint{at, guide.lambda, guide.both(), std::max(std::abs(here), std::abs(before)) / slope};
    before = here;
    // An end that stays is halved (Illinois).
    const std::size_t moves = here * c.f0 > 0 ? 0 : 1;
    if (moves == moved) f[1 - moves] /= 2;
    moved = moves;
    s[moves] = at;
    f[moves] = here;
    // A real part may jump across the border, as that of hysteresis does where the shaft turns as fast as it whirls. A
    // frequency does not: there the mode was taken for another one.
    if (may_jump && std::abs(s[1] - s[0]) < 1e-5 * at)
      return CrossingPoint{at, guide.lambda, guide.both(), std::abs(s[1] - s[0])};
  }
  return {};
}

}  // namespace

CrossingPoint locate(const Crossing& c, const std::function<std::vector<ShaftMode>(double)>& modes_at) {
  if (const auto found = located_by(c.guide, c.s1, c, modes_at)) return *found;
  if (const auto found = located_by(c.before, c.s0, c, modes_at)) return *found;
  return {(c.s0 + c.s1) / 2, c.guide.lambda, c.guide.both(), std::abs(c.s1 - c.s0) / 2, false};
}

std::vector<bool> found_twice(const std::vector<Station>& stations, const std::vector<Crossing>& crossings,
                              const std::vector<CrossingPoint>& points, std::vector<LostCrossings>& lost) {
  constexpr double same = 1e-6, alike = 0.9;
  const auto below = [](const Station& s) {
    return static_cast<int>(std::ranges::count_if(s.modes, [&](const ShaftMode& m) {
      return may_be_critical(m) && beyond(Border::critical, m.lambda, s.speed) < 0;
    }));
  };
  std::vector<bool> out(crossings.size(), false);
  std::map<std::size_t, int> passed;  // by station: modes that come below the speed, less those that leave
  std::set<std::size_t> with_twins;
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    const Crossing& c = crossings[i];
    if (c.border != Border::critical) continue;
    for (std::size_t k = 0; k < i && !out[i]; ++k)
      out[i] = crossings[k].border == Border::critical && crossings[k].station == c.station &&
               std::abs(points[k].lambda - points[i].lambda) <=
                   same * std::abs(points[i].lambda) + points[k].left + points[i].left &&
               spectral::mac(points[k].shape, points[i].shape) > alike;
    if (out[i])
      with_twins.insert(c.station);
    else
      passed[c.station] += c.f0 > 0 ? 1 : -1;
  }
  for (const std::size_t at : with_twins) {
    const int missing = below(stations[at]) - below(stations[at - 1]) - passed[at];
    if (missing > 0) lost.push_back({stations[at - 1].speed, stations[at].speed, missing});
  }
  return out;
}

std::vector<UnstableRange> unstable_ranges(const std::vector<Station>& stations, const std::vector<Crossing>& crossings,
                                           const std::vector<CrossingPoint>& points) {
  // The crossing of a mode before a station, if there is one.
  const auto crossing_at = [&](int id, std::size_t station) -> std::optional<std::size_t> {
    for (std::size_t k = 0; k < crossings.size(); ++k)
      if (crossings[k].border == Border::stability && crossings[k].guide.id == id && crossings[k].station == station)
        return k;
    return std::nullopt;
  };
  std::map<int, UnstableRange> open;
  std::vector<UnstableRange> out;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    for (auto at = open.begin(); at != open.end();) {
      const ShaftMode* m = mode_with(at->first, stations[i]);
      if (m && m->grows()) {
        ++at;
        continue;
      }
      UnstableRange& r = at->second;
      if (const auto end = crossing_at(at->first, i)) {
        r.to = points[*end].speed;
        r.ends = true;
        r.end_crossing = *end;
        if (!r.begins) r.lambda = points[*end].lambda;
      } else if (m) {
        r.to = stations[i].speed;  // undamped there
        r.ends = true;
      }
      out.push_back(r);
      at = open.erase(at);
    }
    for (const ShaftMode& m : stations[i].modes) {
      if (m.id <= 0 || !m.grows()) continue;
      const auto [at, added] = open.try_emplace(m.id);
      UnstableRange& r = at->second;
      r.to = stations[i].speed;
      if (added || m.lambda.real() > r.fastest.lambda.real()) {
        r.fastest = m;
        r.fastest_at = stations[i].speed;
      }
      if (!added) {
        if (!r.begins && m.lambda.real() > r.lambda.real()) r.lambda = m.lambda;
        continue;
      }
      r.id = m.id;
      r.from_start = i == 0;
      r.from = stations[i].speed;
      r.lambda = m.lambda;
      const ShaftMode* before = i > 0 ? mode_with(m.id, stations[i - 1]) : nullptr;
      if (const auto begin = crossing_at(m.id, i)) {
        r.from = points[*begin].speed;
        r.begins = true;
        r.begin_crossing = *begin;
        r.lambda = points[*begin].lambda;
      } else if (before) {
        r.from = stations[i - 1].speed;  // undamped there
        r.begins = true;
      }
    }
  }
  for (auto& [id, r] : open) {
    r.to_end = true;
    out.push_back(r);
  }
  std::stable_sort(out.begin(), out.end(), [](const UnstableRange& a, const UnstableRange& b) {
    return std::pair(a.from, a.id) < std::pair(b.from, b.id);
  });
  return out;
}

}  // namespace whirl::study
