#pragma once
// Columns of tables whose rows are structs.

#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

namespace whirl::study {

/// A member of each of `rows`, or a function of it, in the type that tables hold: numbers, 64-bit counts, texts.
template <class Rows, class Value>
[[nodiscard]] auto column(const Rows& rows, const Value& value) {
  using Found = std::remove_cvref_t<decltype(std::invoke(value, *std::begin(rows)))>;
  using Held = std::conditional_t<std::is_integral_v<Found>, std::int64_t,
                                  std::conditional_t<std::is_floating_point_v<Found>, double, std::string>>;
  std::vector<Held> out;
  for (const auto& row : rows) out.emplace_back(std::invoke(value, row));
  return out;
}

}  // namespace whirl::study
