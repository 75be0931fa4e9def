#include "whirl/rotor/advice.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {

std::vector<std::string> advice(const Options& rotor) {
  constexpr double least = 0.05, most = 0.8, step = 4;
  std::vector<std::string> lines;
  const auto ratio = [](const Segment& s) {
    return s.length /
           (s.outer_stiffness_diameter > 0 ? s.outer_stiffness_diameter : section_at(s, 0.5).outer_mass_diameter);
  };
  for (std::size_t i = 0; i < rotor.segments.size(); ++i) {
    const double r = ratio(rotor.segments[i]);
    const std::string path = fmt::format("rotor.segments.{}", i + 1);
    if (r < least || r > most)
      lines.push_back(
          fmt::format("{}: length over stiffness diameter is {:.3g}, advised are {} to {}", path, r, least, most));
    if (i == 0) continue;
    const double before = ratio(rotor.segments[i - 1]), factor = std::max(r / before, before / r);
    // A hundredth of a millionth beyond the limit is rounding of the table.
    if (factor > step * (1 + 1e-8))
      lines.push_back(
          fmt::format("{}: length over stiffness diameter is {:.3g}, {:.3g} in the segment before; they differ by a "
                      "factor of {:.3g}, "
                      "advised are at most {:.0f}",
                      path, r, before, factor, step));
  }
  return lines;
}

}  // namespace whirl::rotor
