#include "study/linear/response_peaks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace whirl::study {
namespace {

// Where the parabola of 1/f^2 through the speeds about a top has its foot: exactly the top of a single resonance. Not a
// number if that lies beyond its neighbours. Speeds closer to the top than a few tolerances, which other places may
// have asked for, say nothing of its curvature.
double foot_of(const ResponseCurve& curve, std::size_t top) {
  const double s1 = curve.speed[top], apart = 4 * peak_tolerance * s1;
  std::size_t low = top - 1, high = top + 1;
  while (low > 0 && s1 - curve.speed[low] < apart) --low;
  while (high + 1 < curve.speed.size() && curve.speed[high] - s1 < apart) ++high;
  const auto g = [&](std::size_t k) { return 1 / std::pow(curve.height[k], 2); };
  const double s0 = curve.speed[low], s2 = curve.speed[high], g0 = g(low), g1 = g(top), g2 = g(high);
  const double u = (s1 - s0) * (s1 - s0) * (g1 - g2), v = (s1 - s2) * (s1 - s2) * (g1 - g0),
               w = (s1 - s0) * (g1 - g2) - (s1 - s2) * (g1 - g0);
  const double foot = w != 0 ? s1 - 0.5 * (u - v) / w : s1;
  return foot > s0 && foot < s2 ? foot : std::numeric_limits<double>::quiet_NaN();
}

// Where the curve falls to 0.707 of a peak's height on either side of it (API 684): between two speeds of the curve.
// There 1/f^2 is a straight line over (N - N_top)^2, as it is of a single resonance f = f_top/sqrt(1 + (2 Q (N/N_top -
// 1))^2). Nothing where the curve ends first, or rises above the peak.
struct Side {
  double inner = 0, outer = 0, crossing = 0;
};
std::array<std::optional<Side>, 2> sides_of(const ResponseCurve& curve, std::size_t top,
                                            std::string* reason = nullptr) {
  const auto value = [&](std::size_t k) { return curve.height[k]; };
  const double level = value(top) / std::sqrt(2.0), middle = curve.speed[top],
               higher = value(top) * (1 + height_tolerance);
  std::array<std::optional<Side>, 2> sides;
  for (std::size_t s = 0; s < 2; ++s) {
    std::size_t outer = top;
    while ((s == 0 ? outer > 0 : outer + 1 < curve.speed.size()) && value(outer) > level && value(outer) <= higher)
      s == 0 ? --outer : ++outer;
    if (!(value(outer) <= level)) {
      if (reason && reason->empty())
        *reason =
            fmt::format("{} the peak the response does not fall to 0.707 of it before {}", s == 0 ? "below" : "above",
                        value(outer) > higher      ? "a higher peak rises"
                        : std::isnan(value(outer)) ? "the answers end"
                        : s == 0                   ? "the range begins"
                                                   : "the range ends");
      continue;
    }
    const std::size_t inner = s == 0 ? outer + 1 : outer - 1;
    const auto g = [](double f) { return 1 / (f * f); };
    const auto apart = [&](std::size_t k) { return (curve.speed[k] - middle) * (curve.speed[k] - middle); };
    const double w = (g(level) - g(value(inner))) / (g(value(outer)) - g(value(inner)));
    const double distance = std::sqrt(apart(inner) + w * (apart(outer) - apart(inner)));
    sides[s] = {curve.speed[inner], curve.speed[outer], middle + (s == 0 ? -distance : distance)};
  }
  return sides;
}

// N/(N2 - N1), or why there is none.
double amplification(const ResponseCurve& curve, std::size_t top, std::string& reason) {
  const auto sides = sides_of(curve, top, &reason);
  if (!sides[0] || !sides[1]) return std::numeric_limits<double>::quiet_NaN();
  return curve.speed[top] / (sides[1]->crossing - sides[0]->crossing);
}

// What is left of a width: its crossings may be off by their distance from the nearer one of their neighbours, relative
// to the width; nothing if one of them is missing.
std::array<double, 2> left_of_width(const std::array<std::optional<Side>, 2>& sides) {
  const double width = sides[1]->crossing - sides[0]->crossing;
  std::array<double, 2> left{};
  for (std::size_t k = 0; k < 2; ++k)
    left[k] = std::min(std::abs(sides[k]->crossing - sides[k]->inner), std::abs(sides[k]->crossing - sides[k]->outer)) /
              width;
  return left;
}

// A top that is off by a part d of its speed is too low by (2 Q d)^2/2 of its height. Where a resonance is narrower
// than that it has no height that could be told.
constexpr double narrow = 0.5;

}  // namespace

std::vector<std::size_t> ResponseCurve::tops() const {
  // Whether the curve falls far enough on a side of k, before it rises above. Of equal samples the first one counts.
  const auto falls = [&](std::size_t k, bool to_the_left) {
    const double enough = height[k] * (1 - height_tolerance);
    for (std::size_t i = k; to_the_left ? i-- > 0 : ++i < height.size();) {
      if (height[i] < enough) return true;
      if (std::isnan(height[i])) return false;
      if (to_the_left ? height[i] >= height[k] : height[i] > height[k]) return false;
    }
    return false;
  };
  std::vector<std::size_t> found;
  for (std::size_t k = 1; k + 1 < height.size(); ++k) {
    if (!(height[k] > height[k - 1] && height[k] >= height[k + 1]) || !falls(k, true) || !falls(k, false)) continue;
    if (!found.empty() && speed[k] - speed[found.back()] < 2 * peak_tolerance * speed[k]) {
      if (height[k] > height[found.back()]) found.back() = k;
      continue;
    }
    found.push_back(k);
  }
  return found;
}

std::vector<double> worth_asking(std::vector<double> speeds, const std::vector<double>& known) {
  std::sort(speeds.begin(), speeds.end());
  std::vector<double> out;
  for (const double s : speeds) {
    const double least = least_step * s;
    const auto next = std::lower_bound(known.begin(), known.end(), s);
    const bool near = (next != known.end() && *next - s < least) ||
                      (next != known.begin() && s - *(next - 1) < least) || (!out.empty() && s - out.back() < least);
    if (!near) out.push_back(s);
  }
  return out;
}

void ask_for_top(const ResponseCurve& curve, std::size_t top, int pass, std::vector<double>& speeds) {
  const double here = curve.speed[top], before = curve.speed[top - 1], after = curve.speed[top + 1];
  const double foot = foot_of(curve, top), off = std::abs(foot - here);
  if (off <= peak_tolerance * here) return;
  if (std::isnan(foot)) {  // no parabola with a foot between them: halves
    speeds.insert(speeds.end(), {(before + here) / 2, (here + after) / 2});
    return;
  }
  speeds.push_back(foot);
  // A neighbour that stays far away spoils the parabola: nearer ones on either side, which shrink with the move.
  if (pass < 2) return;
  for (const double beside : {foot - 5 * off, foot + 5 * off})
    if (beside > before && beside < after) speeds.push_back(beside);
}

void ask_for_width(const ResponseCurve& curve, std::size_t top, std::vector<double>& speeds) {
  const auto sides = sides_of(curve, top);
  if (!sides[0] || !sides[1]) return;
  const auto left = left_of_width(sides);
  for (std::size_t k = 0; k < 2; ++k)
    if (left[k] > width_tolerance) speeds.push_back(sides[k]->crossing);
}

void ask_for_flanks(const ResponseCurve& curve, std::size_t top, std::vector<double>& speeds) {
  // Of a flank f = 1/d a line between two distances of this ratio leaves 4 %.
  constexpr double ratio = 1.8, least = 0.5, most = 20;
  const Peak peak = peak_at(curve, top);
  const double here = peak.speed;
  double half = here / (2 * peak.amplification);
  if (peak.too_narrow()) half = 1e-3 * here;
  if (!(half > 0)) return;
  const std::vector<double> asked = speeds;
  for (const double side : {-1.0, 1.0}) {
    std::vector<double> distances;
    for (const auto* all : {&curve.speed, &asked})
      for (const double s : *all)
        if (const double d = side * (s - here); d > least * half / ratio) distances.push_back(d);
    if (distances.empty()) continue;
    std::ranges::sort(distances);
    if (distances.front() > ratio * least * half) {
      distances.insert(distances.begin(), least * half);
      speeds.push_back(here + side * distances.front());
    }
    for (std::size_t k = 0; k + 1 < distances.size() && distances[k] < most * half; ++k) {
      const int parts = static_cast<int>(std::ceil(std::log(distances[k + 1] / distances[k]) / std::log(ratio)));
      for (int i = 1; i < parts; ++i) {
        const double d = distances[k] * std::pow(distances[k + 1] / distances[k], static_cast<double>(i) / parts);
        if (d < most * half) speeds.push_back(here + side * d);
      }
    }
  }
}

Peak peak_at(const ResponseCurve& curve, std::size_t top) {
  Peak p{curve.speed[top], curve.height[top], 0, {}};
  p.amplification = amplification(curve, top, p.no_factor);
  const double off = std::abs(foot_of(curve, top) - p.speed) / p.speed;
  p.errors.speed = off <= peak_tolerance ? peak_tolerance : PeakErrors::unknown;
  const double share = 2 * p.amplification * peak_tolerance;
  if (share > narrow) {
    p.height = p.amplification = std::numeric_limits<double>::infinity();
    return p;
  }
  p.errors.height = p.errors.speed + (std::isfinite(share) ? share * share / 2 : 0);
  if (!std::isfinite(p.amplification)) return p;
  const auto left = left_of_width(sides_of(curve, top));
  p.errors.factor =
      std::max(left[0], left[1]) <= width_tolerance ? width_tolerance + p.errors.height : PeakErrors::unknown;
  return p;
}

std::vector<double> saddles_of(const ResponseCurve& curve, std::size_t top) {
  std::vector<std::size_t> lowest{top, top};
  for (std::size_t k = top; k-- > 0 && curve.height[k] <= curve.height[top];)
    if (curve.height[k] < curve.height[lowest[0]]) lowest[0] = k;
  for (std::size_t k = top + 1; k < curve.height.size() && curve.height[k] <= curve.height[top]; ++k)
    if (curve.height[k] < curve.height[lowest[1]]) lowest[1] = k;
  const std::vector<double> saddles{curve.speed[lowest[0]], curve.speed[lowest[1]]};
  return saddle_height(curve, saddles) < (1 - little_prominence) * curve.height[top] ? std::vector<double>{} : saddles;
}

double saddle_height(const ResponseCurve& curve, const std::vector<double>& saddles) {
  double higher = 0;
  for (std::size_t k = 0; k < curve.speed.size(); ++k)
    if (std::ranges::find(saddles, curve.speed[k]) != saddles.end()) higher = std::max(higher, curve.height[k]);
  return higher;
}

}  // namespace whirl::study
