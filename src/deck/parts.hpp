#pragma once
// How codecs reach the parts of a value.

#include <fmt/core.h>

#include <charconv>
#include <cstddef>
#include <string>

#include "whirl/core/error.hpp"

namespace whirl::deck {

/// Item `step` (1-based) of a list of n; core::InputError if there is none.
[[nodiscard]] inline std::size_t index_of(const std::string& step, std::size_t n) {
  std::size_t k = 0;
  const auto [end, code] = std::from_chars(step.data(), step.data() + step.size(), k);
  if (code != std::errc() || end != step.data() + step.size() || k < 1 || k > n)
    throw core::InputError(fmt::format("the list has items 1 to {}, not '{}'", n, step));
  return k - 1;
}

[[nodiscard]] inline void* mutable_part(const void* value) {
  return const_cast<void*>(value);
}

}  // namespace whirl::deck
