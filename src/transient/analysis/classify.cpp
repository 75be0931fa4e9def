#include "whirl/transient/analysis/classify.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace whirl::transient {
namespace {

enum class Sign { negative, zero, positive };

Sign sign_of(const Evidence& e, std::size_t k) {
  if (e.exponents[k] > e.uncertainties[k]) return Sign::positive;
  return e.exponents[k] < -e.uncertainties[k] ? Sign::negative : Sign::zero;
}

// Too few revolutions leave an exponent without an uncertainty, and it says nothing then.
bool known(const Evidence& e) {
  return !e.exponents.empty() && std::isfinite(e.uncertainties[0]);
}

std::string largest(const Evidence& e) {
  // Within their bars they need not be in order.
  const auto at = static_cast<std::size_t>(std::ranges::max_element(e.exponents) - e.exponents.begin());
  const double value = e.exponents[at], bar = e.uncertainties[at];
  constexpr int most = 9;
  const int places = bar > 0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(bar))), 0, most) : most;
  return fmt::format("largest exponent {:.{}f} +- {:.{}f} 1/s", value, places, bar, places);
}

// A multiplier near -1 lets a motion of period one look like one of period two for long. Null if the return lasts.
std::optional<Verdict> passing(const Evidence& e, int period, const char* turns) {
  constexpr double lasting = 0.95;
  for (int k = 1; k < period && static_cast<std::size_t>(k) <= e.fading.size(); ++k)
    if (const double left = e.fading[static_cast<std::size_t>(k - 1)]; left < lasting)
      return Verdict{
          MotionKind::unsettled, 0, "unsettled",
          fmt::format(
              "returns after {} {}, but its distance after {} dies out, by a factor of {:.2g} over half the record",
              period, turns, k, left)};
  return {};
}

// How far points move at the end of the record over how far at its beginning, by a straight line through the
// logarithms.
struct Trend {
  double change = 0, uncertainty = std::numeric_limits<double>::infinity();  // of the logarithm
  [[nodiscard]] std::string text() const {
    constexpr double linear = 0.2;
    if (!std::isfinite(uncertainty)) return "too few points to tell a drift";
    const double ratio = std::exp(change);
    const double bar = std::max(ratio * uncertainty, 1e-9);
    const int places = std::max(0, 1 - static_cast<int>(std::floor(std::log10(bar))));
    return (uncertainty < linear ? fmt::format("it moves {:.{}f} +- {:.{}f} times", ratio, places, bar, places)
                                 : fmt::format("it moves about {:.2g} times", ratio)) +
           " as far at the end of the record as at its beginning";
  }
};

Trend trend(const Evidence& e) {
  constexpr double sure = 5;  // standard errors; of six freedoms, these leave one record of 400 to chance
  const auto n = static_cast<double>(e.course.size());
  if (n < 4 || !std::ranges::all_of(e.course, [](double c) { return c > 0; })) return {};
  double mean = 0, slope = 0, rest = 0;
  for (double c : e.course) mean += std::log(c) / n;
  const double spread = (n * n * n - n) / 12;  // sum of (k - middle)^2
  for (std::size_t k = 0; k < e.course.size(); ++k)
    slope += (static_cast<double>(k) - (n - 1) / 2) * std::log(e.course[k]) / spread;
  for (std::size_t k = 0; k < e.course.size(); ++k)
    rest += std::pow(std::log(e.course[k]) - mean - slope * (static_cast<double>(k) - (n - 1) / 2), 2);
  return {slope * (n - 1), sure * (n - 1) * std::sqrt(rest / (n - 2) / spread)};
}

// What does not repeat itself may be on its way to something else. Null if the record has no direction.
std::optional<Verdict> drifting(const Evidence& e) {
  constexpr double least = 0.01;
  const Trend t = trend(e);
  if (!(std::abs(t.change) > std::max(least, t.uncertainty))) return std::nullopt;
  return Verdict{MotionKind::unsettled, 0, "unsettled", t.text()};
}

std::string distance(const Evidence& e, int period) {
  return fmt::format("returns within {:.1e} of its size{}", e.returns[static_cast<std::size_t>(period - 1)],
                     known(e) ? ", " + largest(e) : "");
}

std::string without_bars(const Evidence& e) {
  return e.exponents.empty() ? "no Lyapunov exponents were computed" : "no Lyapunov exponent has an error bar";
}

Verdict forced(const Evidence& e, int period) {
  const Sign first = known(e) ? sign_of(e, 0) : Sign::negative;
  if (const auto verdict = passing(e, period, "revolutions")) return *verdict;
  if (period > 0) {
    if (first == Sign::positive)
      return {MotionKind::unsettled, 0, "unsettled", "repeats itself although deviations grow: " + largest(e)};
    return {MotionKind::periodic, period, fmt::format("period-{}", period), distance(e, period)};
  }
  if (const auto verdict = drifting(e)) return *verdict;
  const std::string none = fmt::format("no return within {} revolutions", e.returns.size());
  if (!known(e)) return {MotionKind::unsettled, 0, "unsettled", none + ", " + without_bars(e)};
  if (first == Sign::positive) return {MotionKind::chaotic, 0, "chaotic", none + ", " + largest(e)};
  if (first == Sign::zero)
    return {MotionKind::quasi_periodic, 0, "quasi_periodic", none + ", " + largest(e) + ", " + trend(e).text()};
  return {MotionKind::unsettled, 0, "unsettled", none + " although deviations die out: " + largest(e)};
}

Verdict autonomous(const Evidence& e, int period) {
  if (const auto verdict = passing(e, period, "crossings of the section")) return *verdict;
  if (period > 0) {
    if (known(e) && sign_of(e, 0) == Sign::positive)
      return {MotionKind::unsettled, 0, "unsettled", "repeats itself although deviations grow: " + largest(e)};
    return {MotionKind::limit_cycle, period, "limit_cycle",
            fmt::format("period-{} on its section: {}", period, distance(e, period))};
  }
  if (const auto verdict = drifting(e)) return *verdict;
  const std::string none =
      e.returns.empty() ? "" : fmt::format("no return within {} crossings of the section, ", e.returns.size());
  const std::string seldom = none.empty() ? "fewer than two crossings of the section, " : none;
  if (!known(e)) return {MotionKind::unsettled, 0, "unsettled", seldom + without_bars(e)};
  if (sign_of(e, 0) == Sign::positive) return {MotionKind::chaotic, 0, "chaotic", none + largest(e)};
  int zeros = 0;
  for (std::size_t k = 0; k < e.exponents.size(); ++k) zeros += sign_of(e, k) == Sign::zero;
  const std::string count = fmt::format("{}{} zero exponent{}, {}", none, zeros, zeros == 1 ? "" : "s", largest(e));
  if (zeros == 1 && !e.returns.empty()) return {MotionKind::unsettled, 0, "unsettled", count};
  if (zeros == 1) return {MotionKind::limit_cycle, 0, "limit_cycle", count};
  if (zeros > 1)
    return {MotionKind::quasi_periodic, 0, "quasi_periodic", count + (e.course.empty() ? "" : ", " + trend(e).text())};
  return {MotionKind::unsettled, 0, "unsettled", none + "moves although all deviations die out: " + largest(e)};
}

}  // namespace

std::vector<double> return_distances(const std::vector<std::vector<double>>& points, int longest, double size,
                                     MPI_Comm comm) {
  std::vector<double> out;
  for (std::size_t k = 1; k <= static_cast<std::size_t>(longest) && k < points.size(); ++k) {
    double sum = 0;
    for (std::size_t i = 0; i + k < points.size(); ++i)
      for (std::size_t j = 0; j < points[i].size(); ++j) sum += std::pow(points[i + k][j] - points[i][j], 2);
    out.push_back(sum);
  }
  MPI_Allreduce(MPI_IN_PLACE, out.data(), static_cast<int>(out.size()), MPI_DOUBLE, MPI_SUM, comm);
  for (std::size_t k = 1; k <= out.size(); ++k)
    out[k - 1] = std::sqrt(out[k - 1] / static_cast<double>(points.size() - k)) / size;
  return out;
}

std::vector<double> fading_of_returns(const std::vector<std::vector<double>>& points, int longest, MPI_Comm comm) {
  const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
  const auto early = return_distances({points.begin(), middle}, longest, 1, comm),
             late = return_distances({middle, points.end()}, longest, 1, comm);
  std::vector<double> out;
  for (std::size_t k = 0; k < std::min(early.size(), late.size()); ++k)
    out.push_back(early[k] > 0 ? late[k] / early[k] : 1);
  return out;
}

std::vector<double> course_of_returns(const std::vector<std::vector<double>>& points, MPI_Comm comm) {
  constexpr std::size_t pieces = 8, fewest = 2;
  const std::size_t of_each = points.empty() ? 0 : (points.size() - 1) / pieces;
  if (of_each < fewest) return {};
  std::vector<double> out(pieces, 0.0);
  for (std::size_t i = 0; i < pieces * of_each; ++i)
    for (std::size_t j = 0; j < points[i].size(); ++j) out[i / of_each] += std::pow(points[i + 1][j] - points[i][j], 2);
  MPI_Allreduce(MPI_IN_PLACE, out.data(), static_cast<int>(pieces), MPI_DOUBLE, MPI_SUM, comm);
  for (double& d : out) d = std::sqrt(d / static_cast<double>(of_each));
  return out;
}

Verdict classify(const Evidence& e) {
  if (e.driven)
    return {MotionKind::driven, 0, "driven",
            "external forces act that do not follow the shaft's angle: returns at that angle say nothing" +
                (known(e) ? ", " + largest(e) : "")};
  if (e.size < e.rest) {
    if (!e.exponents.empty() && sign_of(e, 0) == Sign::positive)
      return {MotionKind::unsettled, 0, "unsettled", "at rest, but a disturbance grows: " + largest(e)};
    if (!e.grows.empty())
      return {MotionKind::unsettled, 0, "unsettled",
              fmt::format("at rest at an unstable equilibrium, where a disturbance grows: {}", e.grows)};
    return {MotionKind::fixed_point, 0, "fixed_point",
            known(e) ? largest(e) : fmt::format("moves by {:.1e} in the scales of its states", e.size)};
  }
  const auto back = std::find_if(e.returns.begin(), e.returns.end(), [&](double d) { return d < e.return_tolerance; });
  const int period = back == e.returns.end() ? 0 : static_cast<int>(back - e.returns.begin()) + 1;
  Verdict verdict = e.forced ? forced(e, period) : autonomous(e, period);
  if (verdict.kind == MotionKind::unsettled && !e.grows.empty())
    verdict.reason += "; about the equilibrium a disturbance grows: " + e.grows;
  return verdict;
}

}  // namespace whirl::transient
