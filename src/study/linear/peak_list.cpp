#include "study/linear/peak_list.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "study/linear/linear_brief.hpp"
#include "study/linear/separation.hpp"

namespace whirl::study {

std::optional<deck::Range> operating_range(const std::optional<deck::Range>& range,
                                           const std::optional<deck::Quantity>& speed,
                                           const std::optional<deck::Quantity>& service) {
  if (range) return range;
  const auto& one = speed ? speed : service;
  if (!one) return std::nullopt;
  return deck::Range{one->value, one->value, one->unit};
}

const std::vector<PeakValue>& peak_values() {
  static const std::vector<PeakValue> all{{"speed", &io::PeakEntry::speed},
                                          {"semi_major", &io::PeakEntry::semi_major},
                                          {"amplification_factor", &io::PeakEntry::amplification_factor},
                                          {"separation_margin", &io::PeakEntry::separation_margin},
                                          {"required_margin", &io::PeakEntry::required_margin}};
  return all;
}

io::PeakEntry entry_of(const std::string& place, const Peak& peak, const std::string& unit,
                       const std::optional<deck::Range>& operating) {
  io::PeakEntry out;
  out.place = place;
  out.speed = {deck::from_si(peak.speed, unit), unit};
  out.semi_major = {peak.height, "m"};
  out.amplification_factor = {peak.amplification, "1"};
  if (!peak.no_factor.empty()) out.notes.push_back("no amplification factor: " + peak.no_factor);
  if (!operating) return out;
  const Separation margin = separation(peak.speed, peak.amplification, operating->from, operating->to);
  out.separation_margin = {margin.actual, "1"};
  out.required_margin = {margin.required, "1"};
  return out;
}

std::string narrow_words(bool endless) {
  if (endless)
    return fmt::format(
        "{}: its amplitude grows without limit as the speed comes nearer, and it has no height and no amplification "
        "factor",
        undamped);
  return fmt::format("narrower than {:g} of its speed: its height and its amplification factor are not known",
                     peak_tolerance);
}

void put_operating_range(io::StudySummary& summary, const deck::Range& operating, const deck::Range& range) {
  const std::string& unit = range.unit;
  const auto [first, last] = std::minmax(range.from, range.to);
  const double low = deck::from_si(operating.from, unit), high = deck::from_si(operating.to, unit);
  constexpr double rounding = 1e-9;
  const auto below = [](double a, double b) { return a < b * (1 - rounding); };
  const auto warn = [&](const char* does, double end, const char* place, const char* beyond) {
    summary.warnings.push_back(fmt::format(
        "the range {} at {:.6g} {}, {} the operating speed{} ({:.6g}{} {}): margins of what lies {} {:.6g} {} are not "
        "judged",
        does, deck::from_si(end, unit), unit, place, low == high ? "" : "s", low,
        low == high ? "" : fmt::format(" to {:.6g}", high), unit, beyond, deck::from_si(end, unit), unit));
  };
  if (below(last, operating.to)) warn("ends", last, below(last, operating.from) ? "below" : "within", "above");
  if (below(operating.from, first)) warn("begins", first, below(operating.to, first) ? "above" : "within", "below");
  if (low == high) return summary.set("operating_speed", low, unit);
  summary.set("operating_range.from", low, unit);
  summary.set("operating_range.to", high, unit);
}

void warn_of_amplification(io::StudySummary& summary) {
  struct High {
    double factor, speed;
    std::string words;
  };
  std::vector<High> high;  // one of each resonance, which shows at many places
  constexpr double near = 0.01;
  const auto see = [&](const io::Quantity& factor, const io::Quantity& speed, const std::string& where) {
    // A peak too narrow for a factor says so itself.
    if (!std::isfinite(factor.value) || !(factor.value - factor.bar() > high_amplification)) return;
    const High here{factor.value, speed.value,
                    fmt::format("{} at {:.5g} {}{}", factor_words(factor.value), speed.value, speed.unit, where)};
    const auto known = std::ranges::find_if(
        high, [&](const High& h) { return std::abs(h.speed - here.speed) < near * std::abs(here.speed); });
    if (known == high.end())
      high.push_back(here);
    else if (here.factor > known->factor)
      *known = here;
  };
  for (const auto& [name, factor] : summary.values) {
    const std::string tail = "amplification_factor";
    if (!name.starts_with("critical.") || !name.ends_with(tail)) continue;
    const std::string speed = name.substr(0, name.size() - tail.size()) + "speed";
    for (const auto& [other, q] : summary.values)
      if (other == speed) see(factor, q, "");
  }
  for (const io::PeakEntry& p : summary.peaks)
    if (p.stability != "unstable") see(p.amplification_factor, p.speed, " (" + p.place + ")");
  if (high.empty()) return;
  std::vector<std::string> words;
  for (const High& h : high) words.push_back(h.words);
  summary.warnings.push_back(fmt::format(
      "amplification factors above {:g}: {}. So little damping is unusual for a machine that runs through or "
      "near such a speed: look at the damping of the bearings",
      high_amplification, fmt::join(words, ", ")));
}

}  // namespace whirl::study
