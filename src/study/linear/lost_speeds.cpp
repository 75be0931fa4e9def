#include "study/linear/lost_speeds.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "study/linear/response_peaks.hpp"
#include "study/lost_points.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {

bool stands_on_pole(const ResponseAtSpeed& here, const Spectra& spectra, const ResonanceSearch& search,
                    const std::function<std::vector<ResponseAtSpeed>(const std::vector<double>&)>& at) {
  constexpr double smaller = 0.1;
  const auto known = spectra.find(here.speed);
  if (known == spectra.end() ||
      undamped_resonances(known->second, here.speed * (1 - at_pole), here.speed * (1 + at_pole), search).empty())
    return false;
  const std::vector<ResponseAtSpeed> beside = at({here.speed * (1 + least_step)});
  return !beside.empty() && beside.front().largest < smaller * here.largest;
}

void put_lost(std::vector<ResponseAtSpeed>& curve, const LostSpeeds& lost, io::StudySummary& summary,
              const std::string& unit) {
  std::vector<std::string> words, reasons;
  for (const auto& [speed, why] : lost) {
    const auto at = std::ranges::lower_bound(curve, speed, {}, &ResponseAtSpeed::speed);
    const ResponseAtSpeed none =
        ResponseAtSpeed::without_answer(speed, curve.front().nodes.size(), curve.front().bearings.size());
    if (at != curve.end() && at->speed == speed)
      *at = none;
    else
      curve.insert(at, none);
    words.push_back(fmt::format("{:.6g} {}", deck::from_si(speed, unit), unit));
    reasons.push_back(why);
  }
  for (std::string& line : lost_points("no response at", reasons, [&](std::size_t k) { return words[k]; }))
    summary.warnings.push_back(std::move(line));
}

}  // namespace whirl::study
