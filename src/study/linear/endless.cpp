#include "study/linear/endless.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "whirl/deck/units.hpp"
#include "whirl/io/rounded.hpp"

namespace whirl::study {

std::array<double, 2> beside_pole(const Resonance& resonance) {
  const double near = around(resonance)[1];
  return {near, 2 * near - resonance.speed};
}

std::vector<Endless> endless_of(const std::vector<Resonance>& resonances, std::span<const Transfer> beside) {
  constexpr double of_pole = 1.5;
  std::vector<Endless> out;
  for (std::size_t k = 0; k < resonances.size(); ++k) {
    const Transfer &near = beside[2 * k], &far = beside[2 * k + 1];
    Endless one{resonances[k].speed, {}};
    for (std::size_t e = 0; e < std::min(near.values.size(), far.values.size()); ++e)
      one.responses.push_back(std::abs(near.values[e]) > of_pole * std::max(std::abs(far.values[e]), far.rounding[e]));
    if (std::ranges::find(one.responses, true) != one.responses.end()) out.push_back(std::move(one));
  }
  return out;
}

double nearest_to(double frequency, const std::vector<std::complex<double>>& eigenvalues) {
  double found = io::no_value;
  for (const std::complex<double> v : eigenvalues)
    if (v.imag() > 0 && !(std::abs(std::abs(v) - frequency) >= std::abs(found - frequency))) found = std::abs(v);
  return found;
}

void warn_of_endless(io::StudySummary& summary, const std::vector<Endless>& endless, const std::vector<double>& bars,
                     const std::vector<ResponseName>& names, const std::string& unit) {
  constexpr std::size_t shown = 5;
  std::vector<std::string> all;
  for (std::size_t k = 0; k < endless.size(); ++k) {
    std::vector<std::string> of;
    for (std::size_t e = 0; e < names.size(); ++e)
      if (endless[k].responses[e]) of.push_back(names[e].name);
    const double bar = bars.empty() ? io::no_value : bars[k];
    all.push_back(fmt::format(
        "{} ({}{})", io::with_uncertainty(deck::from_si(endless[k].frequency, unit), deck::from_si(bar, unit), unit),
        of.front(), of.size() > 1 ? fmt::format(" and {} more", of.size() - 1) : ""));
  }
  if (all.empty()) return;
  const std::size_t n = std::min(shown, all.size());
  summary.warnings.push_back(fmt::format(
      "undamped resonances: {}{}. The answers grow without limit as the frequency comes nearer, and have no largest "
      "value; what is computed beside them hangs on the distance alone",
      fmt::join(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(n), ", "),
      all.size() > n ? fmt::format(", and {} more", all.size() - n) : ""));
}

}  // namespace whirl::study
