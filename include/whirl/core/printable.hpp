#pragma once
// Text of others made fit for a terminal.

#include <string>
#include <string_view>

namespace whirl::core {

/// `text` with everything that a terminal would act upon (escapes, controls, marks that turn the direction of writing)
/// and every byte that is not UTF-8 written as `\xNN`, words above 200 bytes and lines above 2000 bytes shortened in
/// their middle. Line ends stay. Decks, tables and arguments are echoed in errors through this.
[[nodiscard]] std::string printable(std::string_view text);

/// Bytes of the UTF-8 character that `text` begins with, 0 if it begins with none. Overlong forms and surrogates count
/// as none.
[[nodiscard]] std::size_t utf8_length(std::string_view text) noexcept;

/// True if the character (UTF-8) that `text` begins with is a control character other than tab and line end, or turns
/// the direction of writing.
[[nodiscard]] bool begins_with_control(std::string_view text) noexcept;

}  // namespace whirl::core
