// Codecs of values with parts: lists, tables, maps, optional values, names or values.
#include <fmt/core.h>

#include <algorithm>
#include <limits>

#include "known.hpp"
#include "name_of_value.hpp"
#include "parts.hpp"
#include "schema.hpp"
#include "whirl/deck/description.hpp"
#include "whirl/deck/load.hpp"
#include "whirl/deck/number_or_list.hpp"
#include "whirl/deck/one_or_more.hpp"

namespace whirl::deck {
namespace {

using core::InputError;

class ListCodec : public Codec, public Knows {
public:
  ListCodec(CodecPtr item, ListAccess a, bool isotropic = false)
      : item_(std::move(item)),
        a_(std::move(a)),
        isotropic_(isotropic),
        single_(a_.fixed == 0 && (item_->spec() || !choices_of(*item_).empty() || item_->type() == "text")) {}
  [[nodiscard]] CodecPtr isotropic() const { return std::make_shared<ListCodec>(item_, a_, true); }
  void read(const Node& node, void* value, Reading& r) const override {
    if (isotropic_ && node.kind == Node::Kind::scalar) return read(spread(node), value, r);
    if (single_ && node.kind == Node::Kind::scalar) return read_one(node, value, r);
    if (node.kind != Node::Kind::list)
      return r.problems.add(node.place, fmt::format("{} must be {}", name_of_value(node), type()));
    if (!a_.resize(value, node.items.size()))
      return r.problems.add(
          node.place, fmt::format("{} must have {} items, not {}", name_of_value(node), a_.fixed, node.items.size()));
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      Node item = node.items[i];
      if (item.key.empty()) item.key = node.key;
      item_->read(item, a_.at(value, i), r);
    }
  }
  Node write(const void* value) const override {
    Node n = Node::list();
    for (std::size_t i = 0; i < a_.size(value); ++i) n.push(item_->write(a_.at(mutable_part(value), i)));
    return n;
  }
  Node schema(bool whole) const override {
    Node n = typed_schema("array");
    n.set("items", item_->schema(whole));
    if (a_.fixed > 0) {
      n.set("minItems", Node::scalar(fmt::format("{}", a_.fixed)));
      n.set("maxItems", Node::scalar(fmt::format("{}", a_.fixed)));
    }
    return isotropic_ || single_ ? either_schema(item_->schema(whole), std::move(n)) : n;
  }
  std::string type() const override {
    if (isotropic_)
      return fmt::format("a {}, or a list of {}", item_->type(), a_.fixed == 4 ? "4: xx, xy, yx, yy" : "2: x, y");
    if (single_) return fmt::format("a {}, or a list of such", item_->type());
    return a_.fixed > 0 ? fmt::format("a list of {}, each a {}", a_.fixed, item_->type())
                        : fmt::format("a list, each item a {}", item_->type());
  }
  const Structure* structure() const override { return item_->structure(); }
  std::string step() const override { return "1"; }
  const Spec* spec() const override { return item_->spec(); }
  std::vector<Choice> choices() const override { return choices_of(*item_); }
  Leaf leaf(const void* preset, std::span<const std::string> path, const Node* given) const override {
    const std::size_t i = index_of(path.front(), std::numeric_limits<std::size_t>::max());
    return leaf_of(*item_, preset && i < a_.size(preset) ? a_.at(mutable_part(preset), i) : nullptr, path.subspan(1),
                   given_part(given, path.front()));
  }
  Access find(void* value, std::span<const std::string> path) const override {
    if (path.empty()) return {};
    return item_->find(a_.at(value, index_of(path.front(), a_.size(value))), path.subspan(1));
  }

private:
  void read_one(const Node& node, void* value, Reading& r) const {
    a_.resize(value, 1);
    item_->read(node, a_.at(value, 0), r);
  }
  // One value is that of x and y; of a matrix xx, xy, yx, yy the diagonal.
  Node spread(const Node& one) const {
    Node n = Node::list();
    n.key = one.key;
    n.key_place = one.key_place;
    n.place = one.place;
    for (std::size_t i = 0; i < a_.fixed; ++i) {
      Node& item = n.push(one);
      if (a_.fixed == 4 && (i == 1 || i == 2)) item.text = spec()->unit == "1" ? "0" : "0 " + spec()->unit;
    }
    return n;
  }
  CodecPtr item_;
  ListAccess a_;
  bool isotropic_ = false, single_ = false;
};

class TableCodec : public Codec, public Knows {
public:
  TableCodec(const Structure& row, ListAccess a, std::string scalar)
      : row_(row), a_(std::move(a)), scalar_(std::move(scalar)) {}
  void read(const Node& node, void* value, Reading& r) const override {
    if (names_table(node)) {
      try {
        read_rows(load_table(node, r.files), value, r);
      } catch (const InputError& e) {
        r.problems.add({}, e.what());
      }
    } else if (node.kind == Node::Kind::list) {
      read_rows(node, value, r);
    } else if (node.kind == Node::Kind::scalar && !scalar_.empty()) {
      a_.resize(value, 1);
      const Option& o = *row_.option(scalar_);
      o.codec->read(node, o.member(a_.at(value, 0)), r);
    } else {
      r.problems.add(node.place, fmt::format("{} must be {}", name_of_value(node), type()));
    }
  }
  Node write(const void* value) const override {
    if (!scalar_.empty() && a_.size(value) == 1) {
      const Option& o = *row_.option(scalar_);
      return o.codec->write(o.member(a_.at(mutable_part(value), 0)));
    }
    if (a_.size(value) == 0) return {};  // no table has no rows
    Node n = Node::list();
    for (std::size_t i = 0; i < a_.size(value); ++i) n.push(row_.write(a_.at(mutable_part(value), i)));
    return n;
  }
  Node schema(bool whole) const override {
    Node file = typed_schema("string");
    file.set("pattern", Node::scalar("\\.csv$", true));
    Node rows = typed_schema("array");
    rows.set("items", row_.schema(whole));
    Node both = either_schema(std::move(file), std::move(rows));
    if (!scalar_.empty()) both.find("anyOf")->push(row_.option(scalar_)->codec->schema(whole));
    return both;
  }
  std::string type() const override {
    const std::string table = "a table (.csv file or list of maps)";
    return scalar_.empty() ? table : fmt::format("a {} or {}", row_.option(scalar_)->codec->type(), table);
  }
  const Structure* structure() const override { return &row_; }
  std::string step() const override { return "1"; }
  const Spec* spec() const override { return scalar_.empty() ? nullptr : row_.option(scalar_)->codec->spec(); }
  Leaf leaf(const void*, std::span<const std::string> path, const Node* given) const override {
    return leaf_of(row_, nullptr, path.subspan(1), given_part(given, path.front()));
  }
  Access find(void*, std::span<const std::string>) const override { return {}; }

private:
  // The rows of one file fail alike, so the first row with a problem speaks for the rest.
  void read_rows(const Node& rows, void* value, Reading& r) const {
    a_.resize(value, rows.items.size());
    const std::size_t before = r.problems.size();
    for (std::size_t i = 0; i < rows.items.size() && r.problems.size() == before; ++i)
      row_.read(rows.items[i], a_.at(value, i), r);
    if (rows.items.empty()) r.problems.add(rows.place, fmt::format("{} has no rows", name_of_value(rows)));
  }
  const Structure& row_;
  ListAccess a_;
  std::string scalar_;
};

// Names appear in paths and in names of results.
bool is_name(const std::string& s) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return !s.empty() && letter(s[0]) &&
         std::all_of(s.begin(), s.end(), [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '-'; });
}

class MapCodec : public Codec, public Knows {
public:
  MapCodec(CodecPtr item, MapAccess a) : item_(std::move(item)), a_(std::move(a)) {}
  void read(const Node& node, void* value, Reading& r) const override {
    if (node.kind != Node::Kind::map)
      return r.problems.add(node.place, fmt::format("{} must be {}", name_of_value(node), type()));
    a_.clear(value);
    for (const Node& i : node.items) {
      if (!is_name(i.key))
        r.problems.add(i.key_place,
                       fmt::format("'{}' is not a name: letters, digits, _ and -, starting with a letter", i.key));
      else
        item_->read(i, a_.insert(value, i.key), r);
    }
  }
  Node write(const void* value) const override {
    Node n = Node::map();
    for (const auto& [name, v] : a_.entries(mutable_part(value))) n.set(name, item_->write(v));
    return n;
  }
  Node schema(bool whole) const override {
    Node n = typed_schema("object");
    n.set("additionalProperties", item_->schema(whole));
    return n;
  }
  std::string type() const override { return fmt::format("a map NAME: {}", item_->type()); }
  const Structure* structure() const override { return item_->structure(); }
  std::string step() const override { return "NAME"; }
  Leaf leaf(const void*, std::span<const std::string> path, const Node* given) const override {
    return leaf_of(*item_, nullptr, path.subspan(1), given_part(given, path.front()));
  }
  Access find(void* value, std::span<const std::string> path) const override {
    if (path.empty()) return {};
    std::vector<std::string> names;
    for (const auto& [name, v] : a_.entries(value)) {
      if (name == path.front()) return item_->find(v, path.subspan(1));
      names.push_back(name);
    }
    throw InputError(fmt::format("there is no '{}'{}", path.front(), did_you_mean(path.front(), names)));
  }

private:
  CodecPtr item_;
  MapAccess a_;
};

class OptionalCodec : public Codec, public Knows {
public:
  OptionalCodec(CodecPtr item, OptionalAccess a) : item_(std::move(item)), a_(std::move(a)) {}
  void read(const Node& node, void* value, Reading& r) const override {
    if (node.kind == Node::Kind::none)
      a_.reset(value);
    else
      item_->read(node, a_.emplace(value), r);
  }
  Node write(const void* value) const override {
    const void* v = a_.get(mutable_part(value));
    return v ? item_->write(v) : Node{};
  }
  Node schema(bool whole) const override { return item_->schema(whole); }
  std::string type() const override { return item_->type(); }
  const Structure* structure() const override { return item_->structure(); }
  std::string step() const override { return item_->step(); }
  const Spec* spec() const override { return item_->spec(); }
  std::vector<Choice> choices() const override { return choices_of(*item_); }
  Leaf leaf(const void* preset, std::span<const std::string> path, const Node* given) const override {
    return leaf_of(*item_, preset ? a_.get(mutable_part(preset)) : nullptr, path, given);
  }
  Access find(void* value, std::span<const std::string> path) const override {
    void* v = a_.get(value);
    if (!v) throw InputError("the deck does not give this option");
    return item_->find(v, path);
  }

private:
  CodecPtr item_;
  OptionalAccess a_;
};

class NameOrCodec : public Codec, public Knows {
public:
  NameOrCodec(CodecPtr value, NameOrAccess a) : value_(std::move(value)), a_(std::move(a)) {}
  void read(const Node& node, void* value, Reading& r) const override {
    if (node.kind == Node::Kind::scalar)
      a_.set_name(value, node.text);
    else
      value_->read(node, a_.set_value(value), r);
  }
  Node write(const void* value) const override {
    if (const std::string* name = a_.name(value)) return Node::scalar(*name, true);
    return value_->write(a_.value(mutable_part(value)));
  }
  Node schema(bool whole) const override { return either_schema(typed_schema("string"), value_->schema(whole)); }
  std::string type() const override { return "a name, or a map"; }
  const Structure* structure() const override { return value_->structure(); }
  Leaf leaf(const void* preset, std::span<const std::string> path, const Node* given) const override {
    return leaf_of(*value_, preset && !a_.name(preset) ? a_.value(mutable_part(preset)) : nullptr, path, given);
  }
  Access find(void* value, std::span<const std::string> path) const override {
    if (const std::string* name = a_.name(value))
      throw InputError(fmt::format("it is the name '{}'; vary what it names", *name));
    return value_->find(a_.value(value), path);
  }

private:
  CodecPtr value_;
  NameOrAccess a_;
};

class NumberOrListCodec : public Codec, public Knows {
public:
  NumberOrListCodec(CodecPtr number, CodecPtr list, NumberOrListAccess a)
      : number_(std::move(number)), list_(std::move(list)), a_(std::move(a)) {}
  void read(const Node& node, void* value, Reading& r) const override {
    if (node.kind == Node::Kind::list)
      list_->read(node, a_.set_list(value), r);
    else
      number_->read(node, a_.set_number(value), r);
  }
  Node write(const void* value) const override {
    if (const void* number = a_.number(mutable_part(value))) return number_->write(number);
    return list_->write(a_.list(mutable_part(value)));
  }
  Node schema(bool whole) const override { return either_schema(number_->schema(whole), list_->schema(whole)); }
  std::string type() const override { return number_->type() + ", or " + list_->type(); }
  const Spec* spec() const override { return number_->spec(); }
  Leaf leaf(const void* preset, std::span<const std::string> path, const Node* given) const override {
    return leaf_of(*list_, preset ? a_.list(mutable_part(preset)) : nullptr, path, given);
  }
  Access find(void* value, std::span<const std::string> path) const override {
    if (void* number = a_.number(value)) {
      if (!path.empty()) throw InputError("the deck gives one number, not a list");
      return number_->find(number, path);
    }
    if (path.empty()) throw InputError("the deck gives a list: name an item, 1 for the first");
    return list_->find(a_.list(value), path);
  }

private:
  CodecPtr number_, list_;
  NumberOrListAccess a_;
};

}  // namespace

CodecPtr list_codec(CodecPtr item, ListAccess access) {
  return std::make_shared<ListCodec>(std::move(item), std::move(access));
}
CodecPtr isotropic_codec(const CodecPtr& list) {
  const auto* codec = dynamic_cast<const ListCodec*>(list.get());
  core::require(codec != nullptr, "only a list of numbers is isotropic");
  return codec->isotropic();
}
CodecPtr table_codec(const Structure& row, ListAccess access, std::string scalar) {
  return std::make_shared<TableCodec>(row, std::move(access), std::move(scalar));
}
CodecPtr map_codec(CodecPtr item, MapAccess access) {
  return std::make_shared<MapCodec>(std::move(item), std::move(access));
}
CodecPtr optional_codec(CodecPtr item, OptionalAccess access) {
  return std::make_shared<OptionalCodec>(std::move(item), std::move(access));
}
CodecPtr number_or_list_codec(CodecPtr number, CodecPtr list, NumberOrListAccess access) {
  return std::make_shared<NumberOrListCodec>(std::move(number), std::move(list), std::move(access));
}
CodecPtr name_or_codec(CodecPtr value, NameOrAccess access) {
  return std::make_shared<NameOrCodec>(std::move(value), std::move(access));
}

}  // namespace whirl::deck
