#include "outcome.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "cells.hpp"

namespace whirl::app {

namespace {

// ": stable 600 to 4471 rpm, unstable to 5200 rpm"; nothing of a single stretch.
std::string in_words(const std::vector<io::StabilityRange>& ranges) {
  constexpr std::size_t most = 9;
  // Below, these places have bars.
  const auto place = [](double at) {
    return std::abs(at) < 1000 ? fmt::format("{:.4g}", at) : fmt::format("{:.0f}", at);
  };
  std::string text;
  for (std::size_t k = 0; ranges.size() > 1 && k < ranges.size(); ++k) {
    const auto& r = ranges[k];
    if (k == most) return text + fmt::format(", and {} more stretches in summary.json", ranges.size() - most);
    const bool joined = k > 0 && ranges[k - 1].to == r.from;
    text += fmt::format("{}{} {}{}", k == 0 ? ": " : ", ", r.stability, joined ? "to " : place(r.from) + " to ",
                        place(r.to));
  }
  return ranges.size() > 1 && ranges[0].unit != "1" ? text + " " + ranges[0].unit : text;
}

constexpr std::size_t widest_words = 45;

std::string brief_text(const io::Brief& brief) {
  std::string text;
  for (const std::string& sentence : brief.sentences) text += in_lines(sentence, 2);
  for (const io::BriefTable& t : brief.tables) {
    // Sentences in the last column stand below their rows.
    const bool remarks = t.columns.size() > 1 && std::ranges::any_of(t.rows, [](const auto& row) {
                           return row.back().text.size() > widest_words;
                         });
    const std::size_t count = t.columns.size() - (remarks ? 1 : 0);
    std::vector<std::string> heads;
    for (std::size_t k = 0; k < count; ++k) {
      const io::BriefColumn& c = t.columns[k];
      heads.push_back(c.name + (c.shown.empty() ? "" : " [" + c.shown + "]"));
    }
    CellTable grid(std::move(heads));
    for (const auto& row : t.rows) {
      std::vector<std::string> cells;
      for (std::size_t k = 0; k < count; ++k) cells.push_back(row[k].text.empty() ? "-" : row[k].text);
      grid.add(std::move(cells), remarks ? row.back().text : "");
    }
    text += in_lines(t.caption, 2) + grid.text();
    if (!t.note.empty()) text += in_lines(t.note, 4);
  }
  return text;
}

}  // namespace

std::string headline_text(const io::StudySummary& s) {
  std::string text = paragraph(fmt::format("{}: {} ({}, {} {}, {:.3g} s)", s.name, s.status, s.kind, s.points,
                                           s.points == 1 ? "point" : "points", s.wall_seconds),
                               0);
  if (!s.layout.empty()) text += paragraph(s.layout, 2);
  if (!s.ways.empty()) text += paragraph("ways: " + s.ways, 2);
  if (!s.stability.empty() && !s.brief.tells_stability) text += paragraph(s.stability + in_words(s.ranges), 2);
  for (const std::string& w : s.warnings) text += paragraph("warning: " + w, 2);
  return text;
}

std::string answer_text(const io::StudySummary& s) {
  return brief_text(s.brief);
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
    text += paragraph(fmt::format("{}: {}{}", f.what, line, f.study.empty() ? "" : " (" + f.study + ")"), 2);
  }
  return text;
}

}  // namespace whirl::app
