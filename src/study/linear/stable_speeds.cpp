#include "study/linear/stable_speeds.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "study/columns.hpp"
#include "study/evenly.hpp"
#include "study/growth.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {

std::vector<double> few_speeds(const std::vector<double>& speeds) {
  constexpr std::size_t most = 13;
  return column(few_of(speeds.size(), most), [&](std::size_t k) { return speeds[k]; });
}

StableSpeeds::StableSpeeds(std::vector<double> speeds, const std::vector<double>& first, const Count& count)
    : speeds_(std::move(speeds)) {
  const std::size_t n = speeds_.size();
  std::map<std::size_t, int> counted;  // by place
  std::set<std::size_t> at_first;
  for (const double speed : first)
    if (const auto at = std::lower_bound(speeds_.begin(), speeds_.end(), speed); at != speeds_.end() && *at == speed)
      at_first.insert(static_cast<std::size_t>(at - speeds_.begin()));
  if (n > 0) at_first.insert({0, n - 1});
  std::vector<std::size_t> next(at_first.begin(), at_first.end());
  while (!next.empty()) {
    std::vector<double> at;
    for (const std::size_t k : next) at.push_back(speeds_[k]);
    const std::vector<int> found = count(at);
    for (std::size_t i = 0; i < next.size(); ++i) counted[next[i]] = found[i];
    next.clear();
    for (auto a = counted.begin(), b = std::next(a); b != counted.end(); ++a, ++b)
      if (a->second != b->second && b->first - a->first > 1) next.push_back((a->first + b->first) / 2);
  }
  counted_ = counted.size();
  for (std::size_t k = 0; k < n; ++k) numbers_.push_back(std::prev(counted.upper_bound(k))->second);
}

int StableSpeeds::at(double speed) const {
  const auto found = std::lower_bound(speeds_.begin(), speeds_.end(), speed);
  if (found == speeds_.end() || *found != speed) return unknown;
  return numbers_[static_cast<std::size_t>(found - speeds_.begin())];
}

const char* StableSpeeds::word(int number) {
  return number > 0 ? "unstable" : number == 0 ? "stable" : "undetermined";
}

std::vector<StableSpeeds::Stretch> StableSpeeds::stretches() const {
  std::vector<Stretch> out;
  for (std::size_t k = 0; k < speeds_.size(); ++k) {
    if (out.empty() || out.back().stability != word(numbers_[k])) out.push_back({speeds_[k], 0, word(numbers_[k])});
    out.back().to = speeds_[k];
  }
  return out;
}

void put_verdict(io::StudySummary& summary, const StableSpeeds& stable, const std::string& unit,
                 const std::string& consequence) {
  const auto stretches = stable.stretches();
  if (stretches.empty()) return;
  const std::string counted = fmt::format("the {} speeds counted", stable.counted());
  std::string verdict;
  std::vector<std::string> unstable, open;
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    const StableSpeeds::Stretch& s = stretches[k];
    if (s.stability == "stable") continue;
    const auto shown = [&](double speed) { return fmt::format("{:.6g}", deck::from_si(speed, unit)); };
    std::string where = s.from == s.to ? "at " + shown(s.from) : "from " + shown(s.from) + " to " + shown(s.to);
    where += " " + unit;
    if (k > 0 && s.stability == "unstable" && stretches[k - 1].stability == "stable")
      where += fmt::format(" (stable at {})", shown(stretches[k - 1].to));
    verdict += (verdict.empty() ? "" : ", ") + s.stability + " " + where;
    (s.stability == "unstable" ? unstable : open).push_back(where);
  }
  // Once each, wherever it is.
  if (!open.empty())
    warn_first(summary, fmt::format("whether the equilibrium is stable {} is not known: eigenvalues may be missing",
                                    fmt::join(open, ", ")));
  if (!unstable.empty())
    warn_first(summary, fmt::format("the equilibrium is unstable {}: {}", fmt::join(unstable, ", "), consequence));
  summary.stability =
      stretches.size() == 1 ? stretches.front().stability + " at " + counted : verdict + ", by " + counted;
}

}  // namespace whirl::study
