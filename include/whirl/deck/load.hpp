#pragma once
// From files and arguments to one tree: YAML, `base:`, tables, `--set`.

#include <mpi.h>

#include <string>
#include <string_view>
#include <vector>

#include "whirl/deck/edit.hpp"
#include "whirl/deck/node.hpp"

namespace whirl::deck {

/// Reads whole files for one deck and its tables: rank 0 of `comm` reads, all ranks get the same bytes.
class Files {
public:
  explicit Files(MPI_Comm comm) : comm_(comm) {}
  /// Bytes of the file `path`, at most `limit` of them. Collective. Throws core::InputError (agreed, without a place)
  /// if it cannot be read, is no regular file, is larger, is not UTF-8 text, or if all files read so far hold more than
  /// 16 MiB; a byte-order mark is removed.
  [[nodiscard]] std::string read_text(const std::string& path, std::size_t limit = std::size_t{1} << 20) const;

private:
  MPI_Comm comm_;
  mutable std::size_t n_bytes_ = 0;  // read so far, the same on all ranks
};

/// The first and only YAML document in `text`; `source` names it in errors. Refuses duplicate keys, aliases to
/// enclosing values, merge keys, further documents, and more than 300,000 values with all copies that anchors and
/// aliases ask for. Throws core::InputError with its place.
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

/// The deck `path` laid over its bases, then all `overrides` (arguments of `--set`, see edit.hpp); `structure` knows
/// the units and defaults that relative ones need. What they changed goes to `changes` unless null. Collective; the
/// same tree on every rank. Throws core::InputError (agreed).
[[nodiscard]] Node load(const std::string& path, const std::vector<std::string>& overrides, const Files& files,
                        const Structure& structure, std::vector<Change>* changes = nullptr);
/// The same where no option is known, for which factors and offsets are refused.
[[nodiscard]] Node load(const std::string& path, const std::vector<std::string>& overrides, const Files& files);

}  // namespace whirl::deck
