#pragma once
// Names and units of the entries of stiffness and damping matrices of two shifts and two slopes.

#include <array>
#include <string>

namespace whirl::study {

/// xx, xy, ..., and with slopes x.slope_x, ...; what stands `between` only there.
inline constexpr std::array<const char*, 4> port_words = {"x", "y", "slope_x", "slope_y"};
[[nodiscard]] constexpr std::size_t slopes_in(std::size_t i, std::size_t j) {
  return (i > 1 ? 1U : 0U) + (j > 1 ? 1U : 0U);
}
[[nodiscard]] inline std::string pair_name(std::size_t i, std::size_t j, const char* between) {
  return std::string(port_words[i]) + (slopes_in(i, j) == 0 ? "" : between) + port_words[j];
}
/// By the number of slopes in a pair.
inline constexpr std::array<const char*, 3> stiffness_units = {"N/m", "N", "N m"},
                                            damping_units = {"N s/m", "N s", "N m s"};

}  // namespace whirl::study
