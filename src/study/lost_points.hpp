#pragma once
// Points of a table that have no answer, in words.

#include <functional>
#include <string>
#include <vector>

#include "whirl/io/summary.hpp"

namespace whirl::study {

/// "a; b; and 3 more": the first `most` of them, with what stands `between`.
[[nodiscard]] std::string first_words(const std::vector<std::string>& words, const std::string& between = "; ",
                                      std::size_t most = 5);

/// A warning for each reason among `reasons` (empty: the point has an answer): "HEAD POINT; POINT; and 3 more: REASON",
/// with `words` of point k.
void warn_of_lost_points(io::StudySummary& summary, const std::string& head, const std::vector<std::string>& reasons,
                         const std::function<std::string(std::size_t)>& words);

/// "completed", or "2 of 27 POINTS have no RESULT".
[[nodiscard]] std::string status_of(std::size_t lost, std::size_t asked, const std::string& points,
                                    const std::string& result);

}  // namespace whirl::study
