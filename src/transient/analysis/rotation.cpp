#include "whirl/transient/analysis/rotation.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace whirl::transient {
namespace {

constexpr std::size_t fewest = 24;
constexpr double most_disorder = 0.01, accident = 0.01;
constexpr double flattest = 1e-6;  // width over length, below which points are on a line

// In [0, 1).
double fraction(double x) {
  const double f = x - std::floor(x);
  return f < 1 ? f : 0;
}

// Angles about the middle of the box around the points, in turns.
std::vector<double> angles(const std::vector<std::array<double, 2>>& points) {
  std::array<double, 2> low = points[0], high = points[0];
  for (const auto& p : points)
    for (std::size_t d = 0; d < 2; ++d) {
      low[d] = std::min(low[d], p[d]);
      high[d] = std::max(high[d], p[d]);
    }
  // Axes of the box for those of the curve: a flat ellipse is seen as a circle, a line stays one.
  std::array<double, 2> width{high[0] - low[0], high[1] - low[1]};
  const double widest = std::max({width[0], width[1], std::numeric_limits<double>::min()});
  for (double& w : width)
    if (w < flattest * widest) w = widest;
  std::vector<double> out;
  for (const auto& p : points) {
    std::array<double, 2> z{};
    for (std::size_t d = 0; d < 2; ++d) z[d] = (p[d] - (low[d] + high[d]) / 2) / width[d];
    out.push_back(fraction(std::atan2(z[1], z[0]) / (2 * std::numbers::pi)));
  }
  return out;
}

// By the moments of the points about their mean.
bool on_a_line(const std::vector<std::array<double, 2>>& points) {
  const auto n = static_cast<double>(points.size());
  double mx = 0, my = 0, xx = 0, xy = 0, yy = 0;
  for (const auto& [x, y] : points) {
    mx += x / n;
    my += y / n;
  }
  for (const auto& [x, y] : points) {
    xx += (x - mx) * (x - mx);
    xy += (x - mx) * (y - my);
    yy += (y - my) * (y - my);
  }
  // The roots of l^2 - (xx + yy) l + xx yy - xy^2, squares of length and width.
  const double length = (xx + yy + std::hypot(xx - yy, 2 * xy)) / 2, width = (xx * yy - xy * xy) / length;
  return !(width > flattest * flattest * length);
}

// Advance from each point to the next, in one branch: those of a map of the circle leave a gap, at which they are cut.
std::vector<double> advances(const std::vector<double>& angle) {
  std::vector<double> out;
  for (std::size_t i = 0; i + 1 < angle.size(); ++i) out.push_back(fraction(angle[i + 1] - angle[i]));
  std::vector<double> sorted = out;
  std::sort(sorted.begin(), sorted.end());
  double widest = sorted.front() + 1 - sorted.back(), cut = sorted.front();
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (sorted[i] - sorted[i - 1] > widest) {
      widest = sorted[i] - sorted[i - 1];
      cut = sorted[i];
    }
  for (double& a : out)
    if (a < cut) a += 1;
  return out;
}

// Share of neighbours whose images, with their advance, come in another order.
double disorder_of(const std::vector<double>& angle, const std::vector<double>& advance) {
  std::vector<std::size_t> order(advance.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::size_t l, std::size_t r) { return angle[l] < angle[r]; });
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t here = order[i], next = order[(i + 1) % order.size()];
    const double turn = i + 1 == order.size() ? 1 : 0;
    wrong += angle[next] + turn + advance[next] < angle[here] + advance[here] - 1e-12;
  }
  return static_cast<double>(wrong) / static_cast<double>(order.size());
}

}  // namespace

double smooth_mean(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  double sum = 0, weight = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double s = (static_cast<double>(i) + 0.5) / n, w = std::exp(-1 / (s * (1 - s)));
    sum += w * values[i];
    weight += w;
  }
  return sum / weight;
}

Ratio ratio_within(double value, double bar) {
  if (!std::isfinite(value) || !(bar >= 0)) return {};
  const double whole = std::floor(value), x = value - whole;
  // Between l and h, neighbours in the tree.
  long lp = 0, lq = 1, hp = 1, hq = 1;
  constexpr long largest = 1000;
  const auto found = [&](long p, long q) -> Ratio {
    const double expected = 2 * bar * 3 * static_cast<double>(q * q) / (std::numbers::pi * std::numbers::pi);
    if (expected > accident) return {};
    return {static_cast<int>(p + static_cast<long>(whole) * q), static_cast<int>(q)};
  };
  if (x <= bar) return found(0, 1);
  if (1 - x <= bar) return found(1, 1);
  while (lq + hq <= largest) {
    const long p = lp + hp, q = lq + hq;
    const double at = static_cast<double>(p) / static_cast<double>(q);
    if (std::abs(at - x) <= bar) return found(p, q);
    (at < x ? lp : hp) = p;
    (at < x ? lq : hq) = q;
  }
  return {};
}

RotationNumber rotation_number(const std::vector<std::array<double, 2>>& points) {
  RotationNumber r;
  r.value = r.uncertainty = std::numeric_limits<double>::quiet_NaN();
  if (points.size() < fewest) {
    r.reason = fmt::format("{} points are too few", points.size());
    return r;
  }
  const std::vector<double> angle = angles(points), advance = advances(angle);
  r.disorder = disorder_of(angle, advance);
  if (r.disorder > most_disorder) {
    r.reason = fmt::format("{:.0f} % of the points change their order round the middle: they draw no circle about it",
                           100 * r.disorder);
    return r;
  }
  const std::span<const double> all(advance);
  const std::size_t half = all.size() / 2;
  const double mean = smooth_mean(all), first = smooth_mean(all.first(half)), last = smooth_mean(all.last(half));
  r.value = fraction(mean);
  r.uncertainty = std::max({std::abs(first - last), std::abs(first - mean), std::abs(last - mean), 1e-14});
  r.locked = ratio_within(r.value, r.uncertainty);
  return r;
}

RotationNumber locked_rotation(const std::vector<std::array<double, 2>>& points, int period) {
  RotationNumber r;
  const auto q = static_cast<std::size_t>(period);
  if (period < 1 || points.size() < q + 1) {
    r.value = r.uncertainty = std::numeric_limits<double>::quiet_NaN();
    r.reason = "too few points";
    return r;
  }
  const std::vector<std::array<double, 2>> once(points.begin(), points.begin() + period);
  // Two points have one order on every circle through them; of three or more on a line the order is rounding's.
  if (q > 2 && on_a_line(once)) {
    r.value = r.uncertainty = std::numeric_limits<double>::quiet_NaN();
    r.reason = "the points are on a line, which has no sense of turning";
    return r;
  }
  // The map keeps the order of q points on a circle: it moves each by the same number of places.
  const std::vector<double> angle = angles(once);
  std::vector<std::size_t> order(q), place(q);
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::size_t l, std::size_t r2) { return angle[l] < angle[r2]; });
  for (std::size_t i = 0; i < q; ++i) place[order[i]] = i;
  const std::size_t moved = (place[1 % q] + q - place[0]) % q;
  for (std::size_t i = 0; i < q; ++i)
    if ((place[(i + 1) % q] + q - place[i]) % q != moved) r.disorder += 1.0 / static_cast<double>(q);
  if (r.disorder > 0) {
    r.value = r.uncertainty = std::numeric_limits<double>::quiet_NaN();
    r.reason = "the points change their order round the middle: they are on no circle about it";
    return r;
  }
  r.value = static_cast<double>(moved) / static_cast<double>(q);
  const auto common = std::gcd(moved, q);
  r.locked = {static_cast<int>(moved / common), static_cast<int>(q / common)};
  return r;
}

}  // namespace whirl::transient
