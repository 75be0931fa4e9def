#pragma once
// A bearing known by its coefficients alone.

#include <array>

#include "whirl/film/bore.hpp"
#include "whirl/film/facts.hpp"

namespace whirl::deck {
template <class S>
class Description;
}

namespace whirl::film {

/// force = -K (x, y) - C (x', y').
struct Linear {
  static constexpr std::string_view key = "linear", text = "constant stiffness and damping";
  std::array<double, 4> stiffness{};  // N/m, xx xy yx yy
  std::array<double, 4> damping{};    // N s/m, xx xy yx yy
  friend bool operator==(const Linear&, const Linear&) = default;
};

void describe(deck::Description<Linear>& d);
[[nodiscard]] Facts facts_of(const Linear& options, const Geometry& geometry);
[[nodiscard]] std::unique_ptr<Film> make(const Geometry& geometry, const Linear& options, const Lubricant& lubricant);

}  // namespace whirl::film
