#pragma once
// What a description knows of a value whatever the deck gives there: for edits, and for help.

#include <span>
#include <string>

#include "whirl/deck/description.hpp"

namespace whirl::deck {

/// What a description says about the value at a path.
struct Leaf {
  const Spec* spec = nullptr;  ///< of a number, or of the numbers of a list or a range; null for all else
  Node preset{};               ///< the value if the deck is silent, kind none if there is none
  /// The words for the option at the path, its key first; empty where the path leads to an item or into nothing known.
  /// The factors are those to the value of the key.
  std::vector<Alias> words{};
  const Structure* map = nullptr;  ///< the options below the path, where it leads to a map of options
};

/// A codec that tells what it knows; a codec that does not derive from it is a value without parts.
class Knows {
public:
  Knows() = default;
  Knows(const Knows&) = delete;
  Knows& operator=(const Knows&) = delete;
  virtual ~Knows() = default;
  /// Values of a choice, or of the items of a list of choices; empty for all else.
  [[nodiscard]] virtual std::vector<Choice> choices() const { return {}; }
  /// What is known at the rest of a path that is not empty; `preset` is the default at the start of it, null if
  /// unknown, and `given` what the deck gives there, null if nothing: options may depend on the kind that it chooses.
  /// Throws core::InputError (without a place) if there is no such option.
  [[nodiscard]] virtual Leaf leaf(const void* preset, std::span<const std::string> path, const Node* given) const;
};

/// Entry or item `step` of what the deck gives; null if there is none.
[[nodiscard]] const Node* given_part(const Node* given, const std::string& step);
/// What is known at `path` below a value of `codec`.
[[nodiscard]] Leaf leaf_of(const Codec& codec, const void* preset, std::span<const std::string> path,
                           const Node* given);
/// The same below a struct, whose own defaults hold where `preset` is null.
[[nodiscard]] Leaf leaf_of(const Structure& structure, const void* preset, std::span<const std::string> path,
                           const Node* given);
/// Values of a choice, or of the items of a list of choices; empty for all else.
[[nodiscard]] std::vector<Choice> choices_of(const Codec& codec);

}  // namespace whirl::deck
