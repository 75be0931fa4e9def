#include "study/linear/separation.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace whirl::study {
namespace {

constexpr double damped = 2.5;

}  // namespace

Separation separation(double speed, double amplification, double from, double to) {
  const bool above = speed > to || (speed >= from && to - speed < speed - from);
  Separation s;
  if (speed < from) s.actual = (from - speed) / from;
  if (speed > to) s.actual = (speed - to) / to;
  if (std::isnan(amplification))
    s.required = std::numeric_limits<double>::quiet_NaN();
  else if (amplification >= damped)
    s.required = (above ? 0.10 : 0.0) + 0.17 * (1 - 1 / (amplification - 1.5));
  return s;
}

std::string margin_verdict(const io::Quantity& amplification_factor, const io::Quantity& actual,
                           const io::Quantity& required) {
  const double factor = amplification_factor.value, bar = amplification_factor.bar();
  if (std::isnan(factor)) return {};
  if (factor + bar < damped) return "damped, not critical";
  if (factor - bar < damped) return "undetermined";
  if (required.unit.empty() || !std::isfinite(required.value)) return {};
  const double missing = required.value - actual.value, bars = required.bar() + actual.bar();
  if (missing != 0 && std::abs(missing) <= bars) return "undetermined";
  return missing > 0 ? "too near" : "far enough";
}

std::vector<CriticalSpeed> critical_speeds_of(const io::StudySummary& summary) {
  constexpr std::string_view head = "critical.", tail = ".speed";
  std::vector<CriticalSpeed> out;
  for (const auto& [name, speed] : summary.values) {
    if (!name.starts_with(head) || !name.ends_with(tail)) continue;
    CriticalSpeed c{name.substr(head.size(), name.size() - head.size() - tail.size()), speed};
    for (const auto& [value, member] : {std::pair{"mode", &CriticalSpeed::mode},
                                        {"log_decrement", &CriticalSpeed::log_decrement},
                                        {"amplification_factor", &CriticalSpeed::amplification_factor},
                                        {"separation_margin", &CriticalSpeed::separation_margin},
                                        {"required_margin", &CriticalSpeed::required_margin}}) {
      const std::string full = fmt::format("{}{}.{}", head, c.number, value);
      const auto at = std::ranges::find(summary.values, full, [](const auto& v) { return v.first; });
      if (at != summary.values.end()) c.*member = at->second;
    }
    const double decrement = c.log_decrement.value;
    if (std::isfinite(decrement)) c.stability = decrement > 0 ? "stable" : decrement < 0 ? "unstable" : "undamped";
    io::Quantity factor = c.amplification_factor;
    if (factor.unit.empty() && !c.separation_margin.unit.empty())
      factor = {std::numeric_limits<double>::infinity(), "1"};
    c.verdict = margin_verdict(factor, c.separation_margin, c.required_margin);
    const io::ModeEntry* nearest = nullptr;
    for (const io::ModeEntry& m : summary.modes) {
      const auto number = m.more.find("mode");
      if (number == m.more.end() || number->second != c.mode.value) continue;
      if (!nearest || std::abs(m.speed - speed.value) < std::abs(nearest->speed - speed.value)) nearest = &m;
    }
    if (nearest) c.whirl = nearest->whirl;
    const bool excited = std::ranges::find(summary.values, fmt::format("{}{}.excited", head, c.number),
                                           [](const auto& v) { return v.first; }) == summary.values.end();
    if (!excited && c.whirl == "backward" && (c.verdict == "too near" || c.verdict == "undetermined"))
      c.verdict = not_excited;
    out.push_back(std::move(c));
  }
  return out;
}

}  // namespace whirl::study
