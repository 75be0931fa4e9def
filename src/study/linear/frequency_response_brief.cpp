// What a reader of `frequency_response` wants to know first: where each transfer function is largest, and what films
// as coefficients change.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "study/linear/frequency_response.hpp"
#include "study/linear/linear_brief.hpp"
#include "study/linear/passed_over.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {
namespace {

// "node.7.x.from.node.7.slope_x" as words.
std::string response_words(std::string name) {
  std::ranges::replace(name, '.', ' ');
  std::ranges::replace(name, '_', ' ');
  return name;
}

// How the films were taken, by the names of the values.
std::string way_words(const std::string& way, const FrequencyResponseOptions& options) {
  if (way == "coefficients") return "their coefficients at each frequency";
  if (way == "given") return "the coefficients given";
  for (std::size_t k = 0; k < options.constant_at.size(); ++k)
    if (way == fmt::format("constant.{}", k + 1)) {
      const auto& at = options.constant_at[k];
      return "their coefficients at " +
             io::reading({deck::from_si(at.value, at.unit, deck::frequency), at.unit == "1" ? "" : at.unit});
    }
  return way;
}

}  // namespace

io::Brief FrequencyResponse::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const Values v(result.summary);
  const std::vector<std::string> names = v.between("", ".largest");
  if (!result.delivered || names.empty()) return {};
  const std::string at_unit = v[names.front() + ".largest_at"].unit;
  io::BriefTable largest{"Largest responses",
                         {{"output from input"}, {"0-peak over 0-peak"}, {"at", at_unit}, {"mesh error", "%"}},
                         {},
                         "mesh error: the largest part of the amplitude, at the frequencies where it was estimated"};
  io::Brief out;
  std::map<std::string, std::string> most;  // by unit: the response with the largest value
  std::map<double, int> endless;            // by frequency
  std::vector<std::string> units;
  for (const std::string& name : names) {
    const io::Quantity q = v[name + ".largest"], at = v[name + ".largest_at"], error = v[name + ".relative_error"];
    const bool limit = !std::isinf(q.value);
    largest.rows.push_back({response_words(name), limit ? io::BriefCell(in_micro(q)) : io::BriefCell("without limit"),
                            at, to_digits(scaled(error, 100, "%"), 2)});
    if (!limit) {
      ++endless[at.value];
    } else if (std::isfinite(q.value) && q.value > 0) {
      const auto [known, added] = most.emplace(q.unit, name);
      if (added) units.push_back(q.unit);
      if (q.value > v[known->second + ".largest"].value) known->second = name;
    }
  }
  for (const auto& [at, count] : endless)
    out.sentences.push_back(
        fmt::format("undamped resonance at {}: {} of {} transfer functions grow without limit there",
                    io::reading({at, at_unit}), count, names.size()));
  for (const std::string& unit : units)
    out.sentences.push_back(fmt::format("largest response {}: {}, at {}",
                                        io::reading(in_micro(v[most[unit] + ".largest"])), response_words(most[unit]),
                                        io::reading(v[most[unit] + ".largest_at"])));
  io::BriefTable ways{"With films by coefficients, against the films as they are",
                      {{"films by"}, {"difference", "%"}, {"at", at_unit}},
                      {},
                      "difference: of the matrix of all transfer functions, relative to it, where it is largest"};
  for (const std::string& way : v.between("", ".difference"))
    ways.rows.push_back(
        {way_words(way, options), to_digits(scaled(v[way + ".difference"], 100, "%"), 3), v[way + ".difference_at"]});
  out.tables = {std::move(ways), std::move(largest)};
  return out;
}

}  // namespace whirl::study
