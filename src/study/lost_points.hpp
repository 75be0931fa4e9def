#pragma once
// Points of a table that have no answer, in words.

#include <functional>
#include <string>
#include <vector>

namespace whirl::study {

/// A line for each reason among `reasons` (empty: the point has an answer): "HEAD POINT; POINT; and 3 more: REASON",
/// with `words` of point k.
[[nodiscard]] std::vector<std::string> lost_points(const std::string& head, const std::vector<std::string>& reasons,
                                                   const std::function<std::string(std::size_t)>& words);

/// "completed", or "2 of 27 POINTS have no RESULT".
[[nodiscard]] std::string status_of(std::size_t lost, std::size_t asked, const std::string& points,
                                    const std::string& result);

}  // namespace whirl::study
