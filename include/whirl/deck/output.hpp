#pragma once
// Trees and descriptions as text: YAML, JSON, reference.

#include <span>
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

/// A short mark of a source, such as "004", and its full reference.
struct Citation {
  std::string_view mark;
  std::string_view text;
};

/// Reference of all options below the option `path` (all if empty): key, value, default, bounds, meaning, source, what
/// each value of a choice means; at the end the full references of the sources named, from `citations`. A value of a
/// choice finds its option. Throws core::InputError with the nearest key if there is no such option.
[[nodiscard]] std::string reference_text(const Structure& structure, std::string_view path,
                                         std::span<const Citation> citations = {});

/// Paths of options that lack a text, for the test that every option is documented.
[[nodiscard]] std::vector<std::string> undocumented(const Structure& structure);

}  // namespace whirl::deck
