#include "study/lost_points.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <utility>

namespace whirl::study {

std::string first_words(const std::vector<std::string>& words, const std::string& between, std::size_t most) {
  const std::vector<std::string> first(words.begin(),
                                       words.begin() + static_cast<std::ptrdiff_t>(std::min(most, words.size())));
  return fmt::format("{}{}", fmt::join(first, between),
                     words.size() > most ? fmt::format("{}and {} more", between, words.size() - most) : "");
}

void warn_of_lost_points(io::StudySummary& summary, const std::string& head, const std::vector<std::string>& reasons,
                         const std::function<std::string(std::size_t)>& words) {
  std::vector<std::pair<std::string, std::vector<std::string>>> kinds;  // each reason and the points that have it
  std::map<std::string, std::size_t> known;
  for (std::size_t k = 0; k < reasons.size(); ++k) {
    if (reasons[k].empty()) continue;
    const auto [at, is_new] = known.try_emplace(reasons[k], kinds.size());
    if (is_new) kinds.push_back({reasons[k], {}});
    kinds[at->second].second.push_back(words(k));
  }
  for (const auto& [reason, points] : kinds)
    summary.warnings.push_back(fmt::format("{} {}: {}", head, first_words(points), reason));
}

std::string status_of(std::size_t lost, std::size_t asked, const std::string& points, const std::string& result) {
  return lost == 0 ? "completed" : fmt::format("{} of {} {} have no {}", lost, asked, points, result);
}

}  // namespace whirl::study
