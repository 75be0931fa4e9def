#pragma once
// From files and arguments to one tree: YAML, `base:`, tables, `--set`.

#include <mpi.h>

#include <string>
#include <string_view>
#include <vector>

#include "whirl/deck/node.hpp"

namespace whirl::deck {

/// Reads whole files for decks and tables: rank 0 of `comm` reads, all ranks get the same bytes.
class Files {
public:
  explicit Files(MPI_Comm comm) : comm_(comm) {}
  /// Bytes of the file `path`, at most `limit` of them. Collective. Throws core::InputError (agreed, without a place)
  /// if it cannot be read, is larger, or is not UTF-8 text; a byte-order mark is removed.
  [[nodiscard]] std::string read_text(const std::string& path, std::size_t limit = std::size_t{1} << 20) const;

private:
  MPI_Comm comm_;
};

/// The first and only YAML document in `text`; `source` names it in errors. Refuses duplicate keys, aliases to
/// enclosing values, merge keys and further documents. Throws core::InputError with its place.
[[nodiscard]] Node parse_yaml(std::string_view text, const std::string& source);

/// Rows of a CSV table as a list of maps: header cells `key [unit]` give the keys, the unit is appended to the numbers
/// of its column; empty cells are left out. Accepts CRLF and a byte-order mark, quoted cells.
[[nodiscard]] Node parse_table(std::string_view text, const std::string& source);

/// The table that `node` (a scalar ending in .csv) names, relative to the deck in which the name stands. Collective.
[[nodiscard]] Node load_table(const Node& node, const Files& files);
/// True if `node` is a scalar that names a table file.
[[nodiscard]] bool names_table(const Node& node);

/// `over` laid over `base`: maps merge, everything else is replaced, an empty value removes the key. Every value keeps
/// its own place.
[[nodiscard]] Node merge(Node base, Node over);

/// Sets what `argument` (`PATH=VALUE`; list items are 1-based) says; VALUE is YAML, an empty one removes the key.
/// Tables on the path are read first.
/// Errors cite the argument. Collective.
void override_value(Node& root, const std::string& argument, const Files& files);

/// The deck `path` laid over its bases, then all `overrides`. Collective; the same tree on every rank.
/// Throws core::InputError (agreed).
[[nodiscard]] Node load(const std::string& path, const std::vector<std::string>& overrides, const Files& files);

}  // namespace whirl::deck
