#pragma once
// Paths to values: their steps, wildcards, and the path that was meant.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "whirl/deck/node.hpp"

namespace whirl::deck {

class Structure;

/// `path` split at the dots outside braces. Throws core::InputError (without a place) where braces do not match, there
/// are more than eight, or a step is empty.
[[nodiscard]] std::vector<std::string> steps_of(std::string_view path);

/// The words that a step stands for: those between its braces, each with what stands around them. Throws
/// core::InputError (without a place).
[[nodiscard]] std::vector<std::string> alternatives(const std::string& step);

/// Whether `word` fits `pattern`, in which `*` stands for any run of characters.
[[nodiscard]] bool fits(std::string_view word, std::string_view pattern);

/// Where the value at `before` of the tree `root` has no option `step`: ` (did you mean 'PATH'?)` with the first path
/// that leads to one over at most three steps that the tree has below `before` (`studies.1.range` for
/// `studies.1.modes.range`), followed by the steps `after`. Below a value with one entry alone, the kind of a study, a
/// key that is nearly `step` serves as well. Nothing where there is such an option, one of nearly that name, or no
/// path.
[[nodiscard]] std::string meant_path(const Structure& structure, const Node& root, std::span<const std::string> before,
                                     const std::string& step, std::span<const std::string> after);

/// The same for the first step of `path` that leads to no option.
[[nodiscard]] std::string meant_path(const Structure& structure, const Node& root, std::span<const std::string> path);

}  // namespace whirl::deck
