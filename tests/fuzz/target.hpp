#pragma once
// What the fuzzer tries on a deck, a table and edits, with the answers that must hold whatever they are.

#include <string_view>

namespace whirl::fuzz {

/// `input` is a deck, a table and edits (one a line), with lines `---8<---` between them; what stands behind the first
/// may be missing. Reads the table into the deck, applies the edits, reads the options, writes them, and reads what was
/// written. Text that is refused (core::InputError) is right; the process aborts where a tree does not survive being
/// written and read, or where a message is not fit for a terminal.
void try_deck(std::string_view input);

}  // namespace whirl::fuzz
