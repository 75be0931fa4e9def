#pragma once
// Trees and descriptions as text: YAML, JSON, reference.

#include <string>
#include <string_view>

#include "whirl/deck/description.hpp"
#include "whirl/deck/node.hpp"

namespace whirl::deck {

/// `node` as YAML text that reads back to the same tree.
[[nodiscard]] std::string to_yaml(const Node& node);
/// `node` on one line, between brackets where it has parts.
[[nodiscard]] std::string to_line(const Node& node);
/// `node` as indented JSON; scalars that are not quoted become numbers and booleans where they are ones.
[[nodiscard]] std::string to_json(const Node& node);

/// JSON Schema (draft 2020-12) of decks described by `structure`.
[[nodiscard]] std::string schema_text(const Structure& structure, std::string_view title);

/// Reference of all options below the option `path` (all if empty): key, value, default, bounds, meaning, source.
/// Throws core::InputError with the nearest key if there is no such option.
[[nodiscard]] std::string reference_text(const Structure& structure, std::string_view path);

/// Paths of options that lack a text, for the test that every option is documented.
[[nodiscard]] std::vector<std::string> undocumented(const Structure& structure);

}  // namespace whirl::deck
