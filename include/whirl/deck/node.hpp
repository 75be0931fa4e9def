#pragma once
// A deck as a tree in which every value knows where it was written.

#include <memory>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace whirl::deck {

/// Where a value was written: a position in a file (1-based), or an argument of the command line (line 0).
struct Place {
  std::shared_ptr<const std::string> source;  ///< file name or argument; shared by all values of the file
  int line = 0;
  int column = 0;

  /// `file:line:column`, or the argument itself; empty for values that nobody wrote (defaults).
  [[nodiscard]] std::string text() const;
  /// Directory that relative file names in this source start from; "." for arguments.
  [[nodiscard]] std::string directory() const;
};

/// One value of a deck: nothing, a scalar (its text), a list, or a map in the order of the deck.
struct Node {
  enum class Kind { none, scalar, list, map };

  Kind kind = Kind::none;
  std::string text;         ///< of a scalar
  bool quoted = false;      ///< the scalar stood in quotes
  bool table_row = false;   ///< a row of a table, or a cell of one
  std::string key;          ///< if this is an entry of a map
  Place key_place;          ///< if this is an entry of a map
  Place place;              ///< of the value
  std::vector<Node> items;  ///< entries of a list or a map

  [[nodiscard]] static Node scalar(std::string text, bool quoted = false);
  [[nodiscard]] static Node list();
  [[nodiscard]] static Node map();

  /// Entry `name` of a map, null if there is none.
  [[nodiscard]] const Node* find(std::string_view name) const;
  [[nodiscard]] Node* find(std::string_view name);
  /// Appends entry `name` to a map and returns it.
  Node& set(std::string name, Node value);
  /// Appends an item to a list and returns it.
  Node& push(Node value);
};

/// What is wrong with a deck, in the order found. The first 20 are kept, the others counted.
class Problems {
public:
  /// `place: message`, one line, made printable.
  void add(const Place& place, const std::string& message);
  [[nodiscard]] std::size_t size() const noexcept { return seen_.size(); }
  [[nodiscard]] bool empty() const noexcept { return seen_.empty(); }
  /// True if further problems are only counted, so that a hint is lost work.
  [[nodiscard]] bool full() const noexcept { return lines_.size() >= most; }
  /// Throws one core::InputError with a line per problem, if there is any.
  void raise() const;

private:
  static constexpr std::size_t most = 20;
  std::vector<std::string> lines_;
  std::unordered_set<std::string> seen_;
};

/// Reports problems of a value that was read already, by the path of the offending key below `root`.
class Report {
public:
  Report(const Node& root, Problems& problems) : root_(&root), problems_(&problems) {}
  /// Adds a problem at `path` (`bearings.B1.node`, list items 1-based); where the deck does not have the path, at the
  /// nearest enclosing value. An empty path is the root.
  void fail(std::string_view path, const std::string& message) const;
  [[nodiscard]] Place place(std::string_view path) const;
  /// The same problems, with paths that start at `path`.
  [[nodiscard]] Report below(std::string_view path) const;

private:
  const Node* root_;
  Problems* problems_;
  std::string prefix_;
};

/// The candidate closest to `word` by edit distance; empty if none is near enough, or if it is another quantity (k_xx
/// for c_xx, inner for outer). Looks at the first 5000 candidates, and at no word above 60 characters.
[[nodiscard]] std::string nearest(std::string_view word, const std::vector<std::string>& candidates);
/// ` (did you mean 'x'?)`, or nothing.
[[nodiscard]] std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

/// The same for names of the deck: where none is near, `; there are a, b`, the first ten of them.
[[nodiscard]] std::string did_you_mean_one_of(std::string_view word, const std::vector<std::string>& names);

/// Throws core::InputError, without a place, if `key` cannot stand in a deck as it is written: the merge key `<<`, or
/// more than 200 bytes (YAML ends a key after 1024 characters, and a byte takes up to four).
void require_key(std::string_view key);

/// `path` split at its dots.
[[nodiscard]] std::vector<std::string> split_path(std::string_view path);

}  // namespace whirl::deck
