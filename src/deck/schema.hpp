#pragma once
// Small pieces of JSON Schema as trees.

#include <string>

#include "whirl/deck/description.hpp"

namespace whirl::deck {

/// {"type": type}
[[nodiscard]] Node typed_schema(const std::string& type);
/// An object that takes only the `properties` to be added.
[[nodiscard]] Node object_schema();
/// {"anyOf": [a, b]}
[[nodiscard]] Node either_schema(Node a, Node b);
/// `words, bounds`
[[nodiscard]] std::string with_bounds(const std::string& words, const Check& check);

}  // namespace whirl::deck
