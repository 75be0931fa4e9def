#include "whirl/study/linear/separation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

std::string margin_verdict_of(const io::StudySummary& summary, const std::string& head) {
  const auto value = [&](const std::string& name) {
    const auto at = std::ranges::find(summary.values, head + name, [](const auto& v) { return v.first; });
    return at == summary.values.end() ? io::Quantity{} : at->second;
  };
  const io::Quantity actual = value("separation_margin");
  io::Quantity factor = value("amplification_factor");
  // Without damping there is none.
  if (factor.unit.empty() && !actual.unit.empty()) factor = {std::numeric_limits<double>::infinity(), "1"};
  return margin_verdict(factor, actual, value("required_margin"));
}

std::string whirl_of_critical(const io::StudySummary& summary, const std::string& k) {
  const auto value = [&](const std::string& name) {
    const auto at =
        std::ranges::find(summary.values, "critical." + k + "." + name, [](const auto& v) { return v.first; });
    return at == summary.values.end() ? std::numeric_limits<double>::quiet_NaN() : at->second.value;
  };
  const double speed = value("speed"), id = value("mode");
  const io::ModeEntry* nearest = nullptr;
  for (const io::ModeEntry& m : summary.modes) {
    const auto number = m.more.find("mode");
    if (number == m.more.end() || number->second != id) continue;
    if (!nearest || std::abs(m.speed - speed) < std::abs(nearest->speed - speed)) nearest = &m;
  }
  return nearest ? nearest->whirl : std::string();
}

}  // namespace whirl::study
