#pragma once
// The places at which a linear response is shown, and the peaks that they have.

#include <string>
#include <vector>

#include "study/linear/resonances.hpp"
#include "study/linear/response_record.hpp"

namespace whirl::study {

/// A shaft node, or the journal of a bearing.
struct ResponsePlace {
  std::string label, head;  ///< in the list of peaks, and of its values
  Places of;
  std::size_t at;
};
[[nodiscard]] std::vector<ResponsePlace> places_of(const std::vector<int>& nodes,
                                                   const std::vector<std::string>& bearings);

/// The peaks of a curve by falling height; those without a height are the highest.
[[nodiscard]] std::vector<std::size_t> tops_of(const ResponseCurve& curve);

/// Adds the speeds of the peaks of all places, of one resonance one; where `settled` only those whose place is.
void add_tops(std::vector<double>& speeds, const std::vector<ResponseAtSpeed>& curve,
              const std::vector<ResponsePlace>& places, bool settled);

/// Why the numbers of a peak are not settled; empty if they are, and of one that is too narrow for a height, which says
/// so itself. `refined`: speeds were added.
[[nodiscard]] std::string unsettled(const ResponseCurve& curve, std::size_t top, const Peak& peak, bool refined,
                                    const std::string& unit);

/// In words the resonances of `hidden` at which the response has a peak at one of `more` speeds, with the height that
/// it has there if it is damped.
[[nodiscard]] std::vector<std::string> shown_by(std::vector<ResponseAtSpeed> curve,
                                                const std::vector<ResponseAtSpeed>& more,
                                                const std::vector<Resonance>& hidden,
                                                const std::vector<ResponsePlace>& places, const std::string& unit);

}  // namespace whirl::study
