#include "study/linear/open_ends.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "study/bars/unresolved.hpp"
#include "study/linear/response_peaks.hpp"
#include "study/lost_points.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {

bool ends_on_flank(const ResponseCurve& curve, bool last) {
  constexpr double rising = 4, falling = 1.5, near = 0.1;
  const std::size_t n = curve.speed.size();
  if (n < 3) return false;
  const auto at = [&](std::size_t k) { return last ? n - 1 - k : k; };
  const double s0 = curve.speed[at(0)], s1 = curve.speed[at(1)], s2 = curve.speed[at(2)];
  const double f0 = curve.height[at(0)], f1 = curve.height[at(1)], f2 = curve.height[at(2)];
  if (!(f0 > f1) || !(f1 > 0) || !(f2 > 0) || !(s0 > 0) || !(s1 > 0)) return false;
  const double slope = std::abs(std::log(f0 / f1) / std::log(s0 / s1));
  if (slope >= (last ? rising : falling)) return true;
  // The foot of the parabola of g = 1/f^2, seen from the end.
  const double g0 = 1 / (f0 * f0), g1 = 1 / (f1 * f1), g2 = 1 / (f2 * f2);
  const double d01 = (g0 - g1) / (s0 - s1), d12 = (g1 - g2) / (s1 - s2), bend = (d01 - d12) / (s0 - s2);
  if (!(bend > 0)) return false;
  const double foot = s0 - (d01 + bend * (s0 - s1)) / (2 * bend);
  const double beyond = last ? foot - s0 : s0 - foot;
  return beyond > 0 && beyond < near * s0;
}

namespace {

bool has_peak_near(const std::vector<ResponseAtSpeed>& curve, const std::vector<ResponsePlace>& places, double speed,
                   double apart) {
  return std::ranges::any_of(places, [&](const ResponsePlace& place) {
    const ResponseCurve of = curve_at(curve, place.of, place.at);
    return std::ranges::any_of(of.tops(), [&](std::size_t k) { return std::abs(of.speed[k] - speed) < apart; });
  });
}

}  // namespace

std::vector<std::string> open_ends(const std::vector<ResponseAtSpeed>& curve, const std::vector<ResponsePlace>& places,
                                   const Spectra& spectra, const std::string& unit) {
  constexpr double this_side = 0.1, beyond = 0.5;
  std::vector<std::string> out;
  for (const bool last : {false, true}) {
    const double end = last ? curve.back().speed : curve.front().speed;
    const auto known = spectra.find(end);
    if (known == spectra.end()) continue;
    // Damping and the bend of the modulus put a peak beyond a resonance, unless it is listed already.
    const double here = has_peak_near(curve, places, end, 2 * this_side * end) ? 0 : this_side;
    if (!resonance_near(known->second, end, last ? here : beyond, last ? beyond : here)) continue;
    std::vector<std::string> where;
    for (const ResponsePlace& place : places)
      if (ends_on_flank(curve_at(curve, place.of, place.at), last)) where.push_back(place.label);
    if (where.empty()) continue;
    out.push_back(fmt::format("the amplitude {} at the {} of the range, {:.6g} {} ({}): a peak may lie {} it",
                              last ? "is still rising" : "is falling already", last ? "end" : "beginning",
                              deck::from_si(end, unit), unit, fmt::join(where, "; "), last ? "beyond" : "below"));
  }
  return out;
}

std::vector<std::string> beyond_beams(const rotor::Options& rotor, double last, const std::string& unit) {
  std::vector<std::string> out;
  const double half_wave = half_wave_limit(rotor), cut_off = shear_cut_off(rotor);
  if (half_wave < std::min(cut_off, last))
    out.push_back(fmt::format(
        "above {:.6g} {} the mesh of the shaft is too coarse for the response (half a wave fits into one element): cut "
        "the segments shorter, or end the range there",
        deck::from_si(half_wave, unit), unit));
  if (cut_off < last)
    out.push_back(fmt::format(
        "above {:.6g} {} the response is not that of the shaft (its sections shear against one another, and beam "
        "theory ends): end the range there",
        deck::from_si(cut_off, unit), unit));
  return out;
}

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
  warn_of_lost_points(summary, "no response at", reasons, [&](std::size_t k) { return words[k]; });
}

}  // namespace whirl::study
