#pragma once
// How messages call a value.

#include <fmt/core.h>

#include <string>

#include "whirl/deck/node.hpp"

namespace whirl::deck {

/// Its key in quotes; `this value` where it has none.
[[nodiscard]] inline std::string name_of_value(const Node& n) {
  return n.key.empty() ? "this value" : fmt::format("'{}'", n.key);
}

}  // namespace whirl::deck
