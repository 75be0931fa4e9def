#pragma once
// Results and checkpoints in memory: a tree of groups with attributes and typed, unit-bearing datasets.

#include <mpi.h>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace whirl::io {

using Attribute = std::variant<std::string, double, std::int64_t>;
using Shape = std::vector<std::size_t>;
using Values = std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::string>>;

/// Which rows a rank holds of an array that several ranks share: [begin, begin + shape[0]) of `total` along the first
/// axis. The other ranks hold the other ones, each once.
struct RowRange {
  std::size_t begin = 0, total = 0;
  bool operator==(const RowRange&) const = default;
};

/// An array of rank shape.size() in row-major order; an empty shape is one scalar.
struct Dataset {
  Shape shape;  ///< of the rows here, if it is shared
  Values values;
  std::string unit;                 ///< UDUNITS text, "1" if dimensionless, empty for names and counts
  std::string description;          ///< what a reader of the file should know
  std::optional<RowRange> share{};  ///< numbers only; none: all is here
  /// Names of the places along the second axis, the third axis, ...: each as long as its axis, or empty.
  std::vector<std::vector<std::string>> labels{};

  /// Shape of the whole array.
  [[nodiscard]] Shape whole_shape() const;
  [[nodiscard]] std::size_t size() const;  ///< number of values
  bool operator==(const Dataset&) const = default;
};

/// A node of the tree: attributes, datasets and subgroups, each under a unique name (no '/', not empty).
///
/// Setting a name twice replaces its value; a name is either a dataset or a subgroup. Misuse raises core::Bug; a
/// missing or mistyped entry raises core::Error with its name, because the tree may come from a file. Ranks that write
/// a tree together hold the same one, but for the rows of datasets that they share.
class Group {
public:
  // Attributes.
  void set(const std::string& name, std::string value);
  void set(const std::string& name, const char* value) { set(name, std::string(value)); }
  void set(const std::string& name, double value);
  void set(const std::string& name, std::int64_t value);
  void set(const std::string& name, int value) { set(name, std::int64_t{value}); }
  [[nodiscard]] const std::string& text(const std::string& name) const;
  [[nodiscard]] double real(const std::string& name) const;
  [[nodiscard]] std::int64_t integer(const std::string& name) const;
  [[nodiscard]] bool has_attribute(const std::string& name) const { return attributes_.contains(name); }

  // Datasets; the shorter forms store one axis.
  void put(const std::string& name, Dataset data);
  void put(const std::string& name, std::vector<double> values, std::string unit, std::string description);
  void put(const std::string& name, Shape shape, std::vector<double> values, std::string unit, std::string description);
  void put(const std::string& name, std::vector<std::int64_t> values, std::string description);
  void put(const std::string& name, std::vector<std::string> values, std::string description);
  /// Names the places along the second axis and those after it of a dataset that is there.
  void label(const std::string& name, std::vector<std::vector<std::string>> labels);
  /// Does so for all datasets with that many axes beside the first, so that they must have the same places.
  void label_each(const std::vector<std::vector<std::string>>& labels);
  [[nodiscard]] bool has_dataset(const std::string& name) const { return datasets_.contains(name); }
  [[nodiscard]] const Dataset& dataset(const std::string& name) const;
  /// The values of a dataset that is not shared; core::Error if it is.
  [[nodiscard]] const std::vector<double>& reals(const std::string& name) const;
  [[nodiscard]] const std::vector<std::int64_t>& integers(const std::string& name) const;
  [[nodiscard]] const std::vector<std::string>& strings(const std::string& name) const;

  // Subgroups: `child` makes what is missing, `group` does not.
  Group& child(const std::string& name);
  [[nodiscard]] bool has_group(const std::string& name) const { return groups_.contains(name); }
  [[nodiscard]] const Group& group(const std::string& name) const;
  void erase_group(const std::string& name) { groups_.erase(name); }

  [[nodiscard]] const std::map<std::string, Attribute>& attributes() const { return attributes_; }
  [[nodiscard]] const std::map<std::string, Dataset>& datasets() const { return datasets_; }
  [[nodiscard]] const std::map<std::string, Group>& groups() const { return groups_; }
  bool operator==(const Group&) const = default;

private:
  std::map<std::string, Attribute> attributes_;
  std::map<std::string, Dataset> datasets_;
  std::map<std::string, Group> groups_;
};

/// Labels of places that are numbers or nodes: `2.5`, `order 2.5` with a word before, `node 12`.
[[nodiscard]] std::vector<std::string> labels_of(const std::vector<double>& values, const std::string& word = {});
[[nodiscard]] std::vector<std::string> node_labels(const std::vector<int>& nodes);
/// `WORD 1` to `WORD count`.
[[nodiscard]] std::vector<std::string> numbered(std::size_t count, const std::string& word);

/// Name in a file for any text of a user: '/' becomes '_', an empty name or "." becomes "_".
[[nodiscard]] std::string safe_name(const std::string& text);

/// Name of a file for any text of a user, as plots and tables have it: runs of anything but letters, digits and "+-."
/// become one '_', without those and '.' at its ends; "study" if nothing is left.
[[nodiscard]] std::string plain_name(const std::string& text);

/// Calls visit(path, dataset) for every shared dataset of the tree, in the same order on all ranks.
void each_shared(const Group& group, const std::function<void(const std::string& path, const Dataset&)>& visit);
/// Whether there is any.
[[nodiscard]] bool is_shared(const Group& group);

/// 64-bit FNV-1a hash of all names, shapes, units and values of the tree (descriptions too); equal trees have equal
/// hashes. Of a shared dataset the sum over its numbers of hash(place, bits) stands for the values: it does not depend
/// on who holds which rows.
[[nodiscard]] std::uint64_t checksum(const Group& group);
/// The same of a tree that the ranks of `comm` share, on all of them. Collective if is_shared(group).
[[nodiscard]] std::uint64_t checksum(const Group& group, MPI_Comm comm);

/// Marks `root` as a results file: attributes title, version, format, and in words the frames, signs and units.
void describe_results(Group& root, const std::string& title, const std::string& version);

}  // namespace whirl::io
