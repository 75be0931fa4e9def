#pragma once
// Speeds of a response at which the machine has none: undamped resonances, and where it has no equilibrium.

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "study/linear/resonances.hpp"
#include "study/linear/response_record.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// Speeds [rad/s] and why they have no response.
using LostSpeeds = std::map<double, std::string>;

/// Whether a response is but rounding because it stands at an undamped resonance: one of the spectrum at its speed is
/// no farther away than at_pole, and beside it, where `at` gives the response, the motion is less than a tenth.
[[nodiscard]] bool stands_on_pole(const ResponseAtSpeed& here, const Spectra& spectra, const ResonanceSearch& search,
                                  const std::function<std::vector<ResponseAtSpeed>(const std::vector<double>&)>& at);

/// Makes the `lost` speeds of a curve rows without numbers and warns of them.
void put_lost(std::vector<ResponseAtSpeed>& curve, const LostSpeeds& lost, io::StudySummary& summary,
              const std::string& unit);

}  // namespace whirl::study
