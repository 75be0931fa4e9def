#include "study/linear/response_places.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "whirl/deck/units.hpp"

namespace whirl::study {
namespace {

// Places show one resonance at speeds that differ by parts of this: one of them is counted.
constexpr double one_resonance = 1e-3;

}  // namespace

std::vector<ResponsePlace> places_of(const std::vector<int>& nodes, const std::vector<std::string>& bearings) {
  std::vector<ResponsePlace> out;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    out.push_back({fmt::format("node {}", nodes[k]), fmt::format("node.{}", nodes[k]), &ResponseAtSpeed::nodes, k});
  for (std::size_t b = 0; b < bearings.size(); ++b)
    out.push_back({bearings[b] + ", journal", "bearing." + bearings[b], &ResponseAtSpeed::bearings, b});
  return out;
}

std::vector<std::size_t> tops_of(const ResponseCurve& curve) {
  std::vector<std::size_t> tops = curve.tops();
  std::ranges::stable_sort(tops, std::greater{}, [&](std::size_t k) { return peak_at(curve, k).height; });
  return tops;
}

void add_tops(std::vector<double>& speeds, const std::vector<ResponseAtSpeed>& curve,
              const std::vector<ResponsePlace>& places, bool settled) {
  for (const ResponsePlace& place : places) {
    const ResponseCurve of = curve_at(curve, place.of, place.at);
    for (const std::size_t k : of.tops()) {
      const double top = of.speed[k];
      if (settled && !std::isfinite(peak_at(of, k).errors.speed)) continue;
      if (std::ranges::none_of(speeds, [&](double s) { return std::abs(s - top) < one_resonance * top; }))
        speeds.push_back(top);
    }
  }
}

std::string unsettled(const ResponseCurve& curve, std::size_t top, const Peak& peak, bool refined,
                      const std::string& unit) {
  const bool place = std::isnan(peak.errors.speed),
             width = std::isfinite(peak.amplification) && std::isnan(peak.errors.factor);
  if (!std::isfinite(peak.height) || (!place && !width)) return {};
  return fmt::format("{} not settled: the speeds computed beside it are {:.6g} and {:.6g} {}{}",
                     place ? "its speed is" : "its width is", deck::from_si(curve.speed[top - 1], unit),
                     deck::from_si(curve.speed[top + 1], unit), unit, refined ? "" : " (refine: false)");
}

std::vector<std::string> shown_by(std::vector<ResponseAtSpeed> curve, const std::vector<ResponseAtSpeed>& more,
                                  const std::vector<Resonance>& hidden, const std::vector<ResponsePlace>& places,
                                  const std::string& unit) {
  curve.insert(curve.end(), more.begin(), more.end());
  std::ranges::sort(curve, {}, &ResponseAtSpeed::speed);
  const auto is_more = [&](double speed) {
    return std::ranges::find(more, speed, &ResponseAtSpeed::speed) != more.end();
  };
  std::vector<std::string> words;
  for (const Resonance& r : hidden) {
    double height = 0;
    std::string where;
    for (const ResponsePlace& place : places) {
      const ResponseCurve of = curve_at(curve, place.of, place.at);
      for (const std::size_t k : of.tops())
        if (std::abs(of.speed[k] - r.speed) < 2 * r.width && is_more(of.speed[k]) && of.height[k] > height)
          height = of.height[k], where = place.label;
    }
    if (height > 0)
      words.push_back(fmt::format(
          "{:.6g} {} ({}, {})", deck::from_si(r.speed, unit), unit,
          r.undamped ? std::string("undamped: it has no height") : fmt::format("{:.4g} um at least", 1e6 * height),
          where));
  }
  return words;
}

}  // namespace whirl::study
