#include "study/linear/mode_values.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "study/bars/error_bar.hpp"
#include "study/bars/unresolved.hpp"
#include "study/bars/verdict.hpp"
#include "study/columns.hpp"
#include "study/common.hpp"
#include "study/growth.hpp"
#include "study/linear/linear_brief.hpp"
#include "study/lost_points.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/spectral/whirl.hpp"

namespace whirl::study {
namespace {

constexpr std::size_t most_named = 5;  // in one warning

}  // namespace

bool surely_grows(const ShaftMode& mode, double speed, const ModeBars& bars) {
  if (!mode.grows() || bars.of_elements(mode.lambda)) return false;
  const double bar = bars.at(mode.id, speed)[0];
  return std::isfinite(bar) ? mode.lambda.real() > bar : !(mode.extra && bars.any());
}

const char* stability_of(const ShaftMode& mode, double speed, const ModeBars& bars) {
  if (mode.undamped) return name_of(StabilityClass::undamped);
  if (bars.of_elements(mode.lambda)) return not_resolved;
  const double bar = bars.at(mode.id, speed)[0];
  if (std::isfinite(bar) && !decided(mode.lambda.real(), bar)) return "undetermined";
  if (!mode.grows()) return name_of(StabilityClass::stable);
  if (!surely_grows(mode, speed, bars)) return "undetermined";
  return spectral::vibrates(mode.lambda) ? name_of(StabilityClass::unstable) : "diverges";
}

std::string ModeValues::words_of(const ShaftMode& mode, std::complex<double> lambda) const {
  if (!spectral::vibrates(lambda)) return fmt::format("mode {} diverges (s = +{:.4g} 1/s)", mode.id, lambda.real());
  const spectral::Sense sense = tables_.sense_of(mode);
  const std::string whirl =
      sense == spectral::Sense::either ? "whirl either way" : fmt::format("{} whirl", spectral::name_of(sense));
  return fmt::format("mode {}, {} at {:.4g} Hz", mode.id, whirl, lambda.imag() / (2 * std::numbers::pi));
}

void ModeValues::put_speeds(io::StudySummary& summary, const std::vector<Station>& stations) const {
  std::vector<std::string> speeds, last;  // at which the machine is unstable, and what grows at the last of them
  for (const Station& station : stations) {
    if (!station.reported) continue;
    std::vector<std::string> growing = put_speed(summary, station);
    if (growing.empty()) continue;
    speeds.push_back(number_text(station.speed, unit_));
    last = std::move(growing);
  }
  if (speeds.size() == 1)
    warn_first(summary, fmt::format("at {} {} the machine is unstable: {}", speeds[0], unit_, first_words(last)));
  if (speeds.size() > 1)
    warn_first(summary, fmt::format("at {} the machine is unstable; at {} {}: {}", in_words(speeds, most_named, unit_),
                                    speeds.back(), unit_, first_words(last)));
}

std::vector<std::string> ModeValues::put_speed(io::StudySummary& summary, const Station& station) const {
  const std::string head = "at." + number_text(station.speed, unit_) + ".";
  const auto put = [&](const std::string& name, const ShaftMode* m) {
    if (!m) return;
    const auto bar = bars_.at(m->id, station.speed);
    summary.set(head + name + ".frequency", m->lambda.imag(), "rad/s", bars_.as_bar(bar[1]));
    summary.set(head + name + ".log_decrement", m->undamped ? 0 : spectral::log_decrement(m->lambda), "1",
                bars_.as_bar(bar[2]));
    summary.set(head + name + ".damping_ratio", spectral::damping_ratio(m->lambda), "1");
  };
  const ShaftMode *forward = nullptr, *least = nullptr;
  int unresolved = 0;
  std::vector<std::string> growing;
  for (std::size_t k = 0; k < station.listed; ++k) {
    const ShaftMode& m = station.modes[k];
    const bool moves = spectral::vibrates(m.lambda);
    if (stability_of(m, station.speed, bars_) == std::string_view(not_resolved)) {
      ++unresolved;
      continue;
    }
    if (!forward && moves && tables_.sense_of(m) == spectral::Sense::forward) forward = &m;
    const bool grows = surely_grows(m, station.speed, bars_);
    if ((grows || !m.grows()) && (!least || spectral::damping_ratio(m.lambda) < spectral::damping_ratio(least->lambda)))
      least = &m;
    if (!grows) continue;
    growing.push_back(words_of(m, m.lambda));
    if (moves) growing.back() += fmt::format(" grows (log decrement {:.3g})", spectral::log_decrement(m.lambda));
  }
  put("first_forward", forward);
  put("least_damped", least);
  summary.set(head + "unstable", static_cast<double>(growing.size()), "1");
  if (unresolved > 0) summary.set(head + "not_resolved", unresolved, "1");
  return growing;
}

// The modes that grow for sure, counted over the speed as a branch counts its eigenvalues.
void ModeValues::put_stability(io::StudySummary& summary, const std::vector<Station>& stations,
                               const std::vector<UnstableRange>& sure, const std::vector<double>& errors) const {
  struct Limit {
    double speed;
    bool begins;
    std::optional<std::size_t> crossing;
  };
  std::vector<Limit> events;
  for (const UnstableRange& r : sure) {
    if (r.begins) events.push_back({r.from, true, r.begin_crossing});
    if (r.ends) events.push_back({r.to, false, r.end_crossing});
  }
  std::ranges::stable_sort(events, {}, &Limit::speed);
  BranchVerdict verdict;
  std::vector<BranchChange> changes;
  auto next = events.begin();
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const Station& s = stations[i];
    int count = 0;
    bool undamped = false, doubtful = false;
    for (std::size_t k = 0; k < s.listed; ++k) {
      const ShaftMode& m = s.modes[k];
      const bool counts = m.grows() && std::ranges::any_of(sure, [&](const UnstableRange& r) {
                            return r.id == m.id && r.from <= s.speed && s.speed <= r.to;
                          });
      count += counts;
      undamped |= m.undamped;
      doubtful |= !counts && (m.grows() ? !bars_.of_elements(m.lambda)
                                        : stability_of(m, s.speed, bars_) == std::string_view("undetermined"));
    }
    verdict.add(deck::from_si(s.speed, unit_),
                count > 0  ? StabilityClass::unstable
                : undamped ? StabilityClass::undamped
                           : StabilityClass::stable,
                count);
    if (doubtful && count == 0) verdict.doubt(static_cast<int>(i));  // one that grows for sure decides
    // An undamped mode begins to grow at its station, and ceases to at the next.
    for (; i + 1 < stations.size() && next != events.end(); ++next) {
      const double end = stations[i + 1].speed;
      if (next->begins ? next->speed >= end : next->speed > end) break;
      changes.push_back({static_cast<int>(i), deck::from_si(next->speed, unit_), count, count + (next->begins ? 1 : -1),
                         1, false, static_cast<int>(next - events.begin())});
      count = changes.back().behind;
    }
  }
  for (const BranchChange& c : changes) verdict.add(c);
  summary.ranges = verdict.ranges(unit_);
  // Between the speeds nobody looked.
  const std::string computed = fmt::format("the {} speeds computed", stations.size());
  constexpr std::string_view whole = " throughout";
  summary.stability = verdict.text();
  if (summary.stability.ends_with(whole))
    summary.stability.replace(summary.stability.size() - whole.size(), whole.size(), " at " + computed);
  else if (!summary.stability.empty())
    summary.stability += ", by " + computed;
  if (const int at = threshold_among(verdict.limits()); at >= 0) {
    const BranchChange& c = changes[static_cast<std::size_t>(at)];
    const auto& crossing = events[static_cast<std::size_t>(c.bifurcation)].crossing;
    summary.set("threshold", c.parameter, unit_,
                crossing ? bars_.as_bar(deck::from_si(errors[*crossing], unit_)) : std::map<std::string, double>{});
  }
}

void ModeValues::put_ranges(io::Group& group, io::StudySummary& summary, const std::vector<Station>& stations,
                            const std::vector<UnstableRange>& all, const std::vector<double>& errors) const {
  std::vector<std::string> words;
  const auto error_of = [&](const std::optional<std::size_t>& crossing) {
    return crossing ? bars_.as_bar(deck::from_si(errors[*crossing], unit_)) : std::map<std::string, double>{};
  };
  std::vector<UnstableRange> ranges;
  std::size_t shown = 0;
  for (const UnstableRange& r : all) {
    if (!surely_grows(r.fastest, r.fastest_at, bars_)) continue;
    ranges.push_back(r);
    // With as many digits as the bar of the border has.
    const auto place_of = [&](double speed, const std::optional<std::size_t>& crossing) {
      const auto bar = error_of(crossing);
      const auto error = bar.find("uncertainty");
      return error == bar.end() ? number_text(speed, unit_) : io::reading(deck::from_si(speed, unit_), error->second);
    };
    const bool throughout = r.from_start && r.to_end;
    words.push_back(fmt::format("{} {}{} to {}{} {}: {}", throughout ? "over the whole range," : "from",
                                throughout || r.begins ? ""
                                : r.from_start         ? "the start of the range, "
                                                       : "the first speed computed at which it grows, ",
                                place_of(r.from, r.begin_crossing),
                                throughout || r.ends ? ""
                                : r.to_end           ? "the end of the range, "
                                                     : "the last speed computed at which it grows, ",
                                place_of(r.to, r.end_crossing), unit_, words_of(r.fastest, r.lambda)));
    if (++shown > most_named) continue;
    const std::string head = fmt::format("unstable.{}.", shown);
    summary.set(head + "from", deck::from_si(r.from, unit_), unit_, error_of(r.begin_crossing));
    summary.set(head + "to", deck::from_si(r.to, unit_), unit_, error_of(r.end_crossing));
    summary.set(head + "mode", r.id, "1");
    summary.set(head + "frequency", r.lambda.imag(), "rad/s");
  }
  summary.set("unstable.count", static_cast<double>(ranges.size()), "1");
  put_stability(summary, stations, ranges, errors);
  auto& table = group.child("unstable");
  using R = UnstableRange;
  const auto whirl = [&](const R& r) {
    return spectral::vibrates(r.lambda) ? spectral::name_of(tables_.sense_of(r.fastest)) : "none";
  };
  table.put("from", column(ranges, &R::from), "rad/s", "speed from which the mode grows");
  table.put("to", column(ranges, &R::to), "rad/s", "speed up to which it grows");
  table.put("mode", column(ranges, &R::id), "mode followed by its shape");
  table.put("whirl", column(ranges, whirl), fmt::format("{}; none: it diverges", whirl_text));
  table.put("frequency", column(ranges, [](const R& r) { return r.lambda.imag(); }), "rad/s",
            "where it begins or ends to grow, else where it grows fastest");
  table.put("damping_real", column(ranges, [](const R& r) { return r.lambda.real(); }), "1/s", "likewise");
  table.put("begins", column(ranges, &R::begins),
            "1: it becomes unstable at `from`; 0: the mode or the range of speeds begins there");
  table.put("ends", column(ranges, &R::ends),
            "1: it becomes stable at `to`; 0: the mode or the range of speeds ends there");
  if (!ranges.empty()) warn_first(summary, "the machine is unstable: " + first_words(words));
}

void ModeValues::put_overdamped(io::Group& table, io::StudySummary& summary,
                                const std::vector<Station>& stations) const {
  std::vector<double> speed, frequency, real;
  for (const Station& s : stations) {
    if (!s.reported) continue;
    for (const std::complex<double>& lambda : s.overdamped) {
      speed.push_back(s.speed);
      frequency.push_back(lambda.imag());
      real.push_back(lambda.real());
    }
    summary.set("overdamped", static_cast<double>(s.overdamped.size()), "1");
  }
  if (speed.empty()) return;
  table.put("speed", speed, "rad/s", "shaft speed");
  table.put("frequency", frequency, "rad/s", "damped frequency; zero of real eigenvalues");
  table.put("damping_real", real, "1/s", "real part of the eigenvalue");
}

}  // namespace whirl::study
