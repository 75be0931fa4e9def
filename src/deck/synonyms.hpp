#pragma once
// Words of the field for options that have another name in a deck.

#include <string>
#include <string_view>
#include <vector>

namespace whirl::deck {

/// The key that a word may mean. Where the two are not the same quantity, `change` says how one becomes the other.
struct Synonym {
  std::string_view key, change{};
};

/// The keys that `word` may mean, in any letter case, with `_`, `-` or nothing between its parts.
[[nodiscard]] std::vector<Synonym> synonyms(std::string_view word);

}  // namespace whirl::deck
