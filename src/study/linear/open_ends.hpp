#pragma once
// What a range of speeds leaves open: speeds without a response, ends on the flank of a peak, and where beams end.

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "study/linear/resonances.hpp"
#include "study/linear/response_record.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// Whether a curve ends (at its last speed, or at its first one) on the flank of a peak beyond: it rises towards there
/// like s^4 or faster, or falls from there like 1/s^1.5 or faster, or the parabola of 1/f^2 through its last three
/// speeds has its foot within a tenth of the speed beyond. Far below a resonance a response rises like s^2 and far
/// above it is level: neither is a flank. What rises steeply from a dip is one by this rule, with no peak behind it.
[[nodiscard]] bool ends_on_flank(const ResponseCurve& curve, bool last);

/// A sentence for each end of the range at which places are on a flank, and the machine has a resonance to which that
/// may belong: among the eigenvalues there, up to half of the speed beyond, or up to a tenth on this side if no peak is
/// known within a fifth. Nothing where these are not known.
[[nodiscard]] std::vector<std::string> open_ends(const std::vector<ResponseAtSpeed>& curve,
                                                 const std::vector<ResponsePlace>& places, const Spectra& spectra,
                                                 const std::string& unit);

/// What the beams of a shaft cannot do in a response up to `last` [rad/s], a line each: their mesh is too coarse, or
/// beam theory ends.
[[nodiscard]] std::vector<std::string> beyond_beams(const rotor::Options& rotor, double last, const std::string& unit);

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
