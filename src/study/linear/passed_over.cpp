#include "study/linear/passed_over.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "study/brief.hpp"
#include "study/growth.hpp"
#include "study/lost_points.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/rounded.hpp"
#include "whirl/solve/newton/frequency_resolvent.hpp"

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
  summary.warnings.push_back(fmt::format(
      "the frequencies step over narrow resonances: {}. The largest responses are those at the frequencies computed: "
      "more points, or a range about a resonance, show its peak",
      first_words(all, ", ")));
}

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

ResonancesBetween between(const std::vector<double>& frequencies, const std::vector<std::complex<double>>& eigenvalues,
                          const ResonanceSearch& search,
                          const std::function<std::vector<Transfer>(const std::vector<double>&)>& at) {
  ResonancesBetween out{narrow_resonances(eigenvalues, frequencies, search), {}, {}};
  std::erase_if(out.narrow, [](const Resonance& r) { return r.undamped; });
  const std::vector<Resonance> undamped =
      undamped_resonances(eigenvalues, frequencies.front() * (1 - at_pole), frequencies.back() * (1 + at_pole), search);
  std::vector<double> beside;
  for (const Resonance& r : out.narrow) beside.push_back(around(r)[1]);
  for (const Resonance& r : undamped)
    for (const double frequency : beside_pole(r)) beside.push_back(frequency);
  out.at_narrow = at(beside);
  out.endless = endless_of(undamped, std::span(out.at_narrow).subspan(out.narrow.size()));
  out.at_narrow.resize(out.narrow.size());
  return out;
}

std::vector<std::string> leave_out_poles(const std::vector<double>& frequencies, std::vector<std::string> reasons,
                                         const std::vector<Endless>& endless,
                                         std::vector<std::vector<std::complex<double>>>& found) {
  for (std::size_t k = 0; k < frequencies.size(); ++k)
    for (const Endless& pole : endless) {
      if (std::abs(frequencies[k] - pole.frequency) > at_pole * pole.frequency) continue;
      std::ranges::fill(found[k], io::no_value);
      if (reasons[k].empty()) reasons[k] = solve::singular_at_frequency;
    }
  return reasons;
}

double nearest_to(double frequency, const std::vector<std::complex<double>>& eigenvalues) {
  double found = io::no_value;
  for (const std::complex<double> v : eigenvalues)
    if (v.imag() > 0 && !(std::abs(std::abs(v) - frequency) >= std::abs(found - frequency))) found = std::abs(v);
  return found;
}

bool put_endless(io::StudySummary& summary, const ResponseName& name, std::size_t response,
                 const std::vector<Endless>& endless, const std::vector<double>& bars, const std::string& unit) {
  for (std::size_t k = 0; k < endless.size(); ++k) {
    if (!endless[k].responses[response]) continue;
    std::map<std::string, double> bar;
    if (!bars.empty()) bar["uncertainty"] = deck::from_si(bars[k], unit, deck::frequency);
    summary.set(name.name + ".largest", std::numeric_limits<double>::infinity(), name.unit);
    summary.set(name.name + ".largest_at", deck::from_si(endless[k].frequency, unit, deck::frequency), unit, bar);
    return true;
  }
  return false;
}

void warn_of_endless(io::StudySummary& summary, const std::vector<Endless>& endless, const std::vector<double>& bars,
                     const std::vector<ResponseName>& names, const std::string& unit) {
  std::vector<std::string> all;
  for (std::size_t k = 0; k < endless.size(); ++k) {
    std::vector<std::string> of;
    for (std::size_t e = 0; e < names.size(); ++e)
      if (endless[k].responses[e]) of.push_back(names[e].name);
    const double bar = bars.empty() ? io::no_value : bars[k];
    all.push_back(fmt::format("{} ({}{})",
                              io::with_uncertainty(deck::from_si(endless[k].frequency, unit, deck::frequency),
                                                   deck::from_si(bar, unit, deck::frequency), unit),
                              of.front(), of.size() > 1 ? fmt::format(" and {} more", of.size() - 1) : ""));
  }
  if (all.empty()) return;
  summary.warnings.push_back(fmt::format(
      "undamped resonances: {}. The answers grow without limit as the frequency comes nearer, and have no largest "
      "value; what is computed beside them hangs on the distance alone",
      first_words(all, ", ")));
}

}  // namespace whirl::study
