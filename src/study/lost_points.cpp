#include "study/lost_points.hpp"

#include <fmt/core.h>

#include <map>
#include <utility>

namespace whirl::study {

std::vector<std::string> lost_points(const std::string& head, const std::vector<std::string>& reasons,
                                     const std::function<std::string(std::size_t)>& words) {
  std::vector<std::pair<std::string, std::vector<std::string>>> kinds;  // each reason and the points that have it
  std::map<std::string, std::size_t> known;
  for (std::size_t k = 0; k < reasons.size(); ++k) {
    if (reasons[k].empty()) continue;
    const auto [at, is_new] = known.try_emplace(reasons[k], kinds.size());
    if (is_new) kinds.push_back({reasons[k], {}});
    kinds[at->second].second.push_back(words(k));
  }
  constexpr std::size_t most = 5;
  std::vector<std::string> out;
  for (const auto& [reason, points] : kinds) {
    std::string all;
    for (std::size_t k = 0; k < points.size() && k < most; ++k) all += (k == 0 ? "" : "; ") + points[k];
    if (points.size() > most) all += fmt::format("; and {} more", points.size() - most);
    out.push_back(fmt::format("{} {}: {}", head, all, reason));
  }
  return out;
}

std::string status_of(std::size_t lost, std::size_t asked, const std::string& points, const std::string& result) {
  return lost == 0 ? "completed" : fmt::format("{} of {} {} have no {}", lost, asked, points, result);
}

}  // namespace whirl::study
