#include "whirl/rotor/advice.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {

namespace {

// Segments whose ratio lies on one side of what is advised.
struct Outside {
  std::vector<std::size_t> segments;  // from one
  double lowest = std::numeric_limits<double>::infinity(), highest = 0;

  void add(std::size_t segment, double ratio) {
    segments.push_back(segment);
    lowest = std::min(lowest, ratio);
    highest = std::max(highest, ratio);
  }
  // "1 to 6", "8"
  [[nodiscard]] std::vector<std::string> stretches() const {
    std::vector<std::string> out;
    for (std::size_t from = 0, k = 0; k < segments.size(); ++k) {
      if (k + 1 < segments.size() && segments[k + 1] == segments[k] + 1) continue;
      out.push_back(from == k ? fmt::format("{}", segments[k]) : fmt::format("{} to {}", segments[from], segments[k]));
      from = k + 1;
    }
    return out;
  }
  [[nodiscard]] std::string ratios() const {
    const std::string low = fmt::format("{:.3g}", lowest), high = fmt::format("{:.3g}", highest);
    return low == high ? low : low + " to " + high;
  }
};

}  // namespace

std::vector<std::string> advice(const Options& rotor) {
  constexpr double least = 0.05, most = 0.8, step = 4;
  std::vector<std::string> lines;
  Outside below, above;
  const auto ratio = [](const Segment& s) {
    return s.length /
           (s.outer_stiffness_diameter > 0 ? s.outer_stiffness_diameter : section_at(s, 0.5).outer_mass_diameter);
  };
  for (std::size_t i = 0; i < rotor.segments.size(); ++i) {
    const double r = ratio(rotor.segments[i]);
    const std::string path = fmt::format("rotor.segments.{}", i + 1);
    if (r < least) below.add(i + 1, r);
    if (r > most) above.add(i + 1, r);
    if (i == 0) continue;
    const double before = ratio(rotor.segments[i - 1]), factor = std::max(r / before, before / r);
    // A hundredth of a millionth beyond the limit is rounding of the table.
    if (factor > step * (1 + 1e-8))
      lines.push_back(
          fmt::format("{}: length over stiffness diameter is {:.3g}, {:.3g} in the segment before; they differ by a "
                      "factor of {:.3g}, "
                      "at most {:.0f} is recommended",
                      path, r, before, factor, step));
  }
  for (const Outside* all : {&above, &below})
    if (!all->segments.empty())
      lines.push_back(fmt::format("rotor.segments.{}: length over stiffness diameter is {}, {} to {} is recommended",
                                  fmt::join(all->stretches(), ", "), all->ratios(), least, most));
  return lines;
}

std::vector<std::string> impossible_inertias(const Options& rotor) {
  constexpr double rounded = 1.01;
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < rotor.discs.size(); ++i) {
    const Disc whole = resolved(rotor.discs[i], rotor.material);
    if (whole.polar_inertia <= 2 * rounded * whole.diametral_inertia) continue;
    lines.push_back(
        fmt::format("rotor.discs.{}: a polar inertia of {:.4g} kg m^2 is more than twice the diametral one of {:.4g} "
                    "kg m^2, which no body has (a thin disc has twice): is one of them missing, are they interchanged, "
                    "is a unit wrong?",
                    i + 1, whole.polar_inertia, whole.diametral_inertia));
  }
  return lines;
}

}  // namespace whirl::rotor
