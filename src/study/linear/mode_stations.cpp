#include "study/linear/mode_stations.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "whirl/spectral/whirl.hpp"

namespace whirl::study {
namespace {

constexpr int most_refinements = 4;  // of the way between two speeds asked for

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

void follow(std::vector<Station>& stations, std::size_t count,
            const std::function<std::vector<Station>(const std::vector<double>&)>& modes_at) {
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
    for (Station& s : modes_at(between)) stations.push_back(std::move(s));
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
  std::map<int, int> number;
  for (const Station& s : stations)
    if (s.reported)
      for (std::size_t k = 0; k < s.listed; ++k) number.emplace(s.modes[k].id, static_cast<int>(number.size()) + 1);
  for (Station& s : stations)
    for (ShaftMode& m : s.modes) m.id = number.contains(m.id) ? number.at(m.id) : 0;
}

double beyond(Border border, std::complex<double> lambda, double speed) {
  return border == Border::critical ? lambda.imag() - speed : lambda.real();
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
          out.push_back({border, before.speed, stations[i].speed, f0, f1, m, i, b->put_back || m.put_back});
      }
    }
  return out;
}

std::vector<LostCrossings> lost_crossings(const std::vector<Station>& stations) {
  constexpr double critical = 0.2;  // damping ratio of an amplification factor of 2.5: others are no critical speeds
  // Modes of `s` on one side of the speed that `other` does not have. Those that results do not show have no identity.
  const auto alone = [](const Station& s, const Station& other, bool below) {
    return static_cast<int>(std::ranges::count_if(s.modes, [&](const ShaftMode& m) {
      return m.id > 0 && !mode_with(m.id, other) && spectral::vibrates(m.lambda) &&
             spectral::damping_ratio(m.lambda) < critical && (beyond(Border::critical, m.lambda, s.speed) < 0) == below;
    }));
  };
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

CrossingPoint locate(Crossing c, const std::function<std::vector<ShaftMode>(double)>& modes_at) {
  for (int k = 0; k < 6 && std::abs(c.s1 - c.s0) > 1e-6 * c.s1; ++k) {
    const double s = c.s1 - c.f1 * (c.s1 - c.s0) / (c.f1 - c.f0);
    const auto there = modes_at(s);
    const auto pairs = spectral::match_modes({{c.guide.lambda, c.guide.both()}}, points_of(there), 0);
    const auto found = std::find(pairs.before.begin(), pairs.before.end(), 0);
    if (found == pairs.before.end()) break;
    const ShaftMode& m = there[static_cast<std::size_t>(found - pairs.before.begin())];
    const double f = beyond(c.border, m.lambda, s);
    if (f * c.f1 < 0) c.s0 = c.s1, c.f0 = c.f1;
    c.s1 = s;
    c.f1 = f;
    c.guide.lambda = m.lambda;
    if (std::abs(f) < 1e-7 * (c.border == Border::critical ? s : 1e-3 * std::abs(m.lambda))) break;
  }
  return {c.s1, c.guide.lambda};
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
