#pragma once
// A bearing known by its coefficients alone.

#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "whirl/film/contract/bore.hpp"
#include "whirl/film/contract/facts.hpp"

namespace whirl::deck {
template <class S>
class Description;
}

namespace whirl::film {

/// Stiffness [N/m] and damping [N s/m] at one speed [rad/s]: force = -k d - c d', first letter the force's.
struct LinearAt {
  double speed = 0;
  double k_xx = 0, k_xy = 0, k_yx = 0, k_yy = 0;
  double c_xx = 0, c_xy = 0, c_yx = 0, c_yy = 0;
  friend bool operator==(const LinearAt&, const LinearAt&) = default;
};

/// force = -K (x, y) - C (x', y'), constant or over the speed.
struct Linear {
  /// Beyond the speeds of the table: no answer, or the coefficients of its nearest end.
  enum class Beyond { none, hold };
  static constexpr std::string_view key = "linear", text = "stiffness and damping, constant or over the speed";
  std::array<double, 4> stiffness{};  // N/m, xx xy yx yy
  std::array<double, 4> damping{};    // N s/m, xx xy yx yy
  std::vector<LinearAt> table = {};   // by rising speed, added to both
  Beyond extrapolate = Beyond::none;
  friend bool operator==(const Linear&, const Linear&) = default;
};

void describe(deck::Description<LinearAt>& d);
void describe(deck::Description<Linear>& d);
[[nodiscard]] Facts facts_of(const Linear& options, const Geometry& geometry);
[[nodiscard]] std::unique_ptr<Film> make(const Geometry& geometry, const Linear& options, const Lubricant& lubricant);

}  // namespace whirl::film
