#include "outcome.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace whirl::app {
namespace {

// "5021.4 +- 6.9 rpm": two digits of the uncertainty, seven of the value at most; the unit 1 is not written.
std::string with_uncertainty(double value, double uncertainty, const std::string& unit) {
  const std::string tail = unit.empty() || unit == "1" ? "" : " " + unit;
  if (!std::isfinite(value)) return "unknown";
  const auto places = [](double x) { return -static_cast<int>(std::floor(std::log10(std::abs(x)))); };
  const int most = value == 0 ? 6 : 6 + places(value);
  if (!std::isfinite(uncertainty) || !(uncertainty > 0)) return fmt::format("{:.7g}{}", value, tail);
  const int wanted = 1 + places(uncertainty);
  if (wanted > most) return fmt::format("{:.7g} +- {:.1g}{}", value, uncertainty, tail);
  const int decimals = std::max(0, wanted);
  return fmt::format("{:.{}f} +- {:.{}f}{}", value, decimals, uncertainty, decimals, tail);
}

std::string text_of(const io::StudySummary& s) {
  std::string text = fmt::format("{}: {} ({}, {} {}, {:.3g} s)\n", s.name, s.status, s.kind, s.points,
                                 s.points == 1 ? "point" : "points", s.wall_seconds);
  if (!s.stability.empty()) text += fmt::format("  {}\n", s.stability);
  for (const std::string& w : s.warnings) text += fmt::format("  note: {}\n", w);
  for (const io::Bifurcation& b : s.bifurcations) {
    const auto others = b.more.find("others_unstable");
    const bool beyond = others != b.more.end() && others->second > 0;
    text += fmt::format("  {} at {} {}{}{}{}\n", io::name_of(b.type), b.parameter,
                        with_uncertainty(b.value, b.uncertainty, b.unit), b.criticality.empty() ? "" : ", ",
                        b.criticality, beyond ? fmt::format(", {:.0f} others unstable", others->second) : "");
  }
  for (const io::CodimensionTwo& c : s.codimension_two)
    text += fmt::format("  {} at {} {}, {} {}\n", c.type, c.parameter,
                        with_uncertainty(c.value.value, io::no_value, c.value.unit), c.second_parameter,
                        with_uncertainty(c.second_value.value, c.uncertainty, c.second_value.unit));
  for (const io::Suspicion& x : s.suspected)
    text += fmt::format("  not resolved from {:.7g} to {:.7g} {}: {}\n", x.from, x.to, x.unit, x.reason);
  return text;
}

}  // namespace

std::string outcome_text(const io::Summary& summary) {
  std::string text;
  for (const io::StudySummary& s : summary.studies) text += text_of(s);
  return text;
}

}  // namespace whirl::app
