#include "study/linear/mode_margins.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "study/linear/separation.hpp"

namespace whirl::study {

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
