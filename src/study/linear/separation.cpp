#include "study/linear/separation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "study/brief.hpp"

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
  const Values v(summary);
  std::vector<CriticalSpeed> out;
  for (const std::string& number : v.between("critical.", ".speed")) {
    const std::string head = "critical." + number + ".";
    CriticalSpeed c{number, v[head + "speed"], v[head + "mode"]};
    c.log_decrement = v[head + "log_decrement"];
    c.amplification_factor = v[head + "amplification_factor"];
    c.separation_margin = v[head + "separation_margin"];
    c.required_margin = v[head + "required_margin"];
    const double decrement = c.log_decrement.value;
    if (std::isfinite(decrement)) c.stability = decrement > 0 ? "stable" : decrement < 0 ? "unstable" : "undamped";
    io::Quantity factor = c.amplification_factor;
    if (factor.unit.empty() && !c.separation_margin.unit.empty())
      factor = {std::numeric_limits<double>::infinity(), "1"};
    c.verdict = margin_verdict(factor, c.separation_margin, c.required_margin);
    const io::ModeEntry* nearest = nullptr;
    for (const io::ModeEntry& m : summary.modes) {
      const auto mode = m.more.find("mode");
      if (mode == m.more.end() || mode->second != c.mode.value) continue;
      if (!nearest || std::abs(m.speed - c.speed.value) < std::abs(nearest->speed - c.speed.value)) nearest = &m;
    }
    if (nearest) c.whirl = nearest->whirl;
    const bool excited = !v.get(head + "excited");
    if (!excited && c.whirl == "backward" && (c.verdict == "too near" || c.verdict == "undetermined"))
      c.verdict = not_excited;
    out.push_back(std::move(c));
  }
  return out;
}

void put_margins(io::StudySummary& summary, const std::string& head, double speed, double speed_error, double decrement,
                 double decrement_error, const std::optional<deck::Range>& operating) {
  if (!(decrement >= 0)) return;  // it grows
  const auto bar = [](double x) {
    return std::isfinite(x) ? std::map<std::string, double>{{"uncertainty", x}} : std::map<std::string, double>{};
  };
  // Both ends of the decrement's bar; where that contains zero nothing bounds the factor.
  const double none = std::numeric_limits<double>::quiet_NaN(), factor = std::numbers::pi / decrement,
               most = decrement > decrement_error ? std::numbers::pi / (decrement - decrement_error) : none,
               least = std::numbers::pi / (decrement + decrement_error);
  const bool exact = !std::isfinite(decrement_error);  // no mesh
  // Without damping there is no bound of it.
  if (decrement > 0)
    summary.set(head + "amplification_factor", factor, "1",
                bar(exact ? none : std::max(most - factor, factor - least)));
  if (!operating) return;
  const auto margin = [&](double s, double af) { return separation(s, af, operating->from, operating->to); };
  const Separation here = margin(speed, factor);
  const auto doubt = [&](double Separation::*which, double s, double af) {
    return std::abs(margin(s, af).*which - here.*which);
  };
  const double moved = std::max(doubt(&Separation::actual, speed - speed_error, factor),
                                doubt(&Separation::actual, speed + speed_error, factor));
  summary.set(head + "separation_margin", here.actual, "1", bar(std::isfinite(speed_error) ? moved : none));
  const double required =
      std::max(doubt(&Separation::required, speed, most), doubt(&Separation::required, speed, least));
  summary.set(head + "required_margin", here.required, "1", bar(exact || !std::isfinite(most) ? none : required));
}

void put_criticals(io::Group& table, const io::StudySummary& summary) {
  const std::vector<CriticalSpeed> all = critical_speeds_of(summary);
  std::string order;
  const auto named = [&](const std::string& name) {
    order += (order.empty() ? "" : " ") + name;
    return name;
  };
  const auto put = [&](const std::string& name, io::Quantity CriticalSpeed::*member, const std::string& unit,
                       const std::string& text) {
    std::vector<double> values, bars;
    for (const CriticalSpeed& c : all) {
      const io::Quantity& q = c.*member;
      const auto bar = q.more.find("uncertainty");
      const double size = bar == q.more.end() ? io::no_value : bar->second;
      values.push_back(unit == "rad/s" ? deck::number_to_si(q.value, q.unit) : q.value);
      bars.push_back(unit == "rad/s" ? deck::number_to_si(size, q.unit) : size);
    }
    table.put(named(name), values, unit, text);
    table.put(named(name + "_uncertainty"), bars, unit, "of the column before");
  };
  const auto put_words = [&](const std::string& name, std::string CriticalSpeed::*member, const std::string& text) {
    std::vector<std::string> words;
    for (const CriticalSpeed& c : all) words.push_back(c.*member);
    table.put(named(name), words, text);
  };
  put("speed", &CriticalSpeed::speed, "rad/s", "speed equal to the damped frequency");
  std::vector<std::int64_t> modes;
  for (const CriticalSpeed& c : all) modes.push_back(static_cast<std::int64_t>(c.mode.value));
  table.put(named("mode"), modes, "mode followed by its shape");
  put_words("whirl", &CriticalSpeed::whirl,
            "of the mode at the nearest computed speed; unbalance does not excite backward whirl where bearings are "
            "alike in both directions");
  put("log_decrement", &CriticalSpeed::log_decrement, "1", "delta of the mode there, at fixed speed");
  put("amplification_factor", &CriticalSpeed::amplification_factor, "1", "pi/delta = 1/(2 zeta), at fixed speed");
  put("separation_margin", &CriticalSpeed::separation_margin, "1",
      "distance from the operating speeds, of their border");
  put("required_margin", &CriticalSpeed::required_margin, "1", "by API 617");
  put_words("stability", &CriticalSpeed::stability, "of the mode there: stable, undamped, unstable");
  put_words("verdict", &CriticalSpeed::verdict, "whether it keeps its distance from the operating speeds");
  table.set("columns", order);
}

}  // namespace whirl::study
