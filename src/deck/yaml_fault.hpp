#pragma once
// Why the text of a deck is no YAML.

#include <string>
#include <string_view>

namespace whirl::deck {

/// Where a fault is, counted from 1, and what is likely wrong.
struct YamlFault {
  int line, column;
  std::string message;
};

/// The fault behind a complaint of the parser, which stops where it cannot go on: often a line below the fault.
/// `line` and `column` count from 0. Where the text does not tell more, the complaint itself at its own place.
[[nodiscard]] YamlFault yaml_fault(std::string_view text, int line, int column, const std::string& complaint);

/// The word behind `*` or `&` at a place, counted from 0; empty if there is none.
[[nodiscard]] std::string anchor_at(std::string_view text, int line, int column);

}  // namespace whirl::deck
