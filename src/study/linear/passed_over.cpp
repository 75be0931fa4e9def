#include "study/linear/passed_over.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "study/brief.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {

io::Quantity in_micro(io::Quantity q) {
  constexpr double large = 1e-2;
  if (!(std::abs(q.value) < large)) return q;
  if (q.unit.starts_with("m/")) return scaled(q, 1e6, "u" + q.unit);
  if (q.unit.starts_with("1/")) return scaled(q, 1e6, "urad" + q.unit.substr(1));
  return q;
}

void warn_of_passed_over(io::StudySummary& summary, const std::vector<Resonance>& resonances,
                         const std::vector<Transfer>& at_resonances, const std::vector<double>& frequencies,
                         const std::vector<std::vector<std::complex<double>>>& found,
                         const std::vector<ResponseName>& names, const std::string& unit) {
  constexpr double as_large = 1.1;  // less than a tenth more is no news beside the answers computed
  constexpr std::size_t shown = 5;
  std::vector<std::string> all;
  for (std::size_t k = 0; k < resonances.size(); ++k) {
    const Transfer& there = at_resonances[k];
    const auto next =
        static_cast<std::size_t>(std::ranges::lower_bound(frequencies, resonances[k].speed) - frequencies.begin());
    double most = as_large;
    std::string words;
    for (std::size_t e = 0; e < there.values.size(); ++e) {
      const double here = std::abs(there.values[e]),
                   beside = std::max(std::abs(found[next - 1][e]), std::abs(found[next][e]));
      const double ratio = here / std::max(beside, there.rounding[e]);
      if (!(ratio > most)) continue;
      most = ratio;
      std::string name = names[e].name;
      std::ranges::replace_if(
          name, [](char c) { return c == '.' || c == '_'; }, ' ');
      const io::Quantity low = in_micro({beside, names[e].unit});
      const double top = low.unit == names[e].unit ? here : 1e6 * here;  // both in one unit
      words = fmt::format("{:.6g} {} ({} reaches {:.3g} {} there, {:.3g} {} at the frequencies beside it)",
                          deck::from_si(resonances[k].speed, unit, deck::frequency), unit, name, top, low.unit,
                          low.value, low.unit);
    }
    if (!words.empty()) all.push_back(words);
  }
  if (all.empty()) return;
  const std::size_t n = std::min(shown, all.size());
  summary.warnings.push_back(fmt::format(
      "the frequencies step over narrow resonances: {}{}. The largest responses are those at the frequencies computed: "
      "more points, or a range about a resonance, show its peak",
      fmt::join(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(n), ", "),
      all.size() > n ? fmt::format(", and {} more", all.size() - n) : ""));
}

}  // namespace whirl::study
