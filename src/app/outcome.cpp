#include "outcome.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <cmath>
#include <vector>

#include "highlights.hpp"

namespace whirl::app {

namespace {

// ": stable 600 to 4471 rpm, unstable to 5200 rpm"; nothing of a single stretch.
std::string in_words(const std::vector<io::StabilityRange>& ranges) {
  constexpr std::size_t most = 9;
  std::string text;
  for (std::size_t k = 0; ranges.size() > 1 && k < ranges.size(); ++k) {
    const auto& r = ranges[k];
    if (k == most) return text + fmt::format(", and {} more stretches in summary.json", ranges.size() - most);
    const bool joined = k > 0 && ranges[k - 1].to == r.from;
    text += fmt::format("{}{} {}{:.6g}", k == 0 ? ": " : ", ", r.stability,
                        joined ? "to " : fmt::format("{:.6g} to ", r.from), r.to);
  }
  return ranges.size() > 1 && ranges[0].unit != "1" ? text + " " + ranges[0].unit : text;
}

std::string brief_text(const io::Brief& brief) {
  std::string text;
  for (const std::string& sentence : brief.sentences) text += in_lines(sentence, 2);
  for (const io::BriefTable& t : brief.tables) {
    std::vector<std::string> heads;
    for (const io::BriefColumn& c : t.columns) heads.push_back(c.name + (c.shown.empty() ? "" : " [" + c.shown + "]"));
    Grid grid(std::move(heads));
    for (const auto& row : t.rows) {
      std::vector<std::string> cells;
      for (const io::BriefCell& c : row) cells.push_back(c.text.empty() ? "-" : c.text);
      grid.add(std::move(cells));
    }
    text += in_lines(t.caption, 2) + grid.text();
    if (!t.note.empty()) text += in_lines(t.note, 4);
  }
  return text;
}

}  // namespace

std::string headline_text(const io::StudySummary& s) {
  std::string text = fmt::format("{}: {} ({}, {} {}, {:.3g} s)\n", s.name, s.status, s.kind, s.points,
                                 s.points == 1 ? "point" : "points", s.wall_seconds);
  if (!s.layout.empty()) text += fmt::format("  {}\n", s.layout);
  if (!s.stability.empty()) text += fmt::format("  {}{}\n", s.stability, in_words(s.ranges));
  for (const std::string& w : s.warnings) text += fmt::format("  note: {}\n", w);
  return text;
}

std::string answer_text(const io::StudySummary& s, std::span<const io::StudySummary> before) {
  std::string text;
  for (const io::Bifurcation& b : s.bifurcations) {
    text += fmt::format("  {} at {} {}{}{}{}\n", io::name_of(b.type), b.parameter,
                        with_uncertainty(b.value, b.uncertainty, b.unit), b.criticality.empty() ? "" : ", ",
                        b.criticality, b.sentence.empty() ? "" : ": " + b.sentence);
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
  return text + brief_text(s.brief) + highlights(s, before);
}

std::string service_text(const io::Service& service) {
  if (service.speed.unit.empty()) return {};
  std::string text = fmt::format("at the service speed, {:.6g} {}:\n", service.speed.value, service.speed.unit);
  for (const io::ServiceFact& f : service.facts) {
    std::vector<std::string> words;
    if (std::isfinite(f.value.value))
      words.push_back(
          io::reading(f.value.unit == "K" ? io::Quantity{f.value.value - 273.15, "degC", f.value.more} : f.value));
    if (!f.place.empty()) words.push_back("at " + f.place);
    std::string line = fmt::format("{}", fmt::join(words, " "));
    if (!f.mark.empty()) line += (line.empty() ? "" : ", ") + f.mark;
    text += fmt::format("  {}: {}{}\n", f.what, line, f.study.empty() ? "" : " (" + f.study + ")");
  }
  return text;
}

}  // namespace whirl::app
