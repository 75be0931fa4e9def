#include "outcome.hpp"

#include <fmt/core.h>

#include <cmath>

#include "highlights.hpp"

namespace whirl::app {
namespace {

std::string text_of(const io::StudySummary& s) {
  std::string text = fmt::format("{}: {} ({}, {} {}, {:.3g} s)\n", s.name, s.status, s.kind, s.points,
                                 s.points == 1 ? "point" : "points", s.wall_seconds);
  if (!s.layout.empty()) text += fmt::format("  {}\n", s.layout);
  if (!s.stability.empty()) text += fmt::format("  {}\n", s.stability);
  for (const std::string& w : s.warnings) text += fmt::format("  note: {}\n", w);
  for (const io::Bifurcation& b : s.bifurcations) {
    const auto others = b.more.find("others_unstable");
    const bool beyond = others != b.more.end() && others->second > 0;
    text += fmt::format("  {} at {} {}{}{}{}{}\n", io::name_of(b.type), b.parameter,
                        with_uncertainty(b.value, b.uncertainty, b.unit), b.criticality.empty() ? "" : ", ",
                        b.criticality, beyond ? fmt::format(", {:.0f} others unstable", others->second) : "",
                        meaning(b).empty() ? "" : ": " + meaning(b));
    if (const auto error = b.more.find("reduction_error"); error != b.more.end() && std::isfinite(error->second))
      text += fmt::format("    estimated error of the shaft's reduction: {:+.2g} {}\n", error->second, b.unit);
  }
  for (const io::CodimensionTwo& c : s.codimension_two) {
    const auto bar = c.more.find("value_uncertainty");
    text +=
        fmt::format("  {}{} at {} {}, {} {}\n", c.more.contains("end_of_curve") ? "ends at " : "", c.type, c.parameter,
                    with_uncertainty(c.value.value, bar == c.more.end() ? io::no_value : bar->second, c.value.unit),
                    c.second_parameter, with_uncertainty(c.second_value.value, c.uncertainty, c.second_value.unit));
  }
  for (const io::Suspicion& x : s.suspected)
    text += fmt::format("  not resolved from {:.7g} to {:.7g} {}: {}\n", x.from, x.to, x.unit, x.reason);
  return text + highlights(s);
}

}  // namespace

std::string outcome_text(const io::Summary& summary) {
  std::string text;
  for (const io::StudySummary& s : summary.studies) text += text_of(s);
  return text;
}

}  // namespace whirl::app
