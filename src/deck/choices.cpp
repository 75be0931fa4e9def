// Codec of lists whose items are one of several kinds.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "known.hpp"
#include "name_of_value.hpp"
#include "parts.hpp"
#include "schema.hpp"
#include "whirl/deck/description.hpp"

namespace whirl::deck {
namespace {

using core::InputError;

class ChoicesCodec : public Codec, public Knows {
public:
  ChoicesCodec(std::vector<ChoiceKind> k, ChoiceAccess a) : kinds_(std::move(k)), a_(std::move(a)) {}
  void read(const Node& node, void* value, Reading& r) const override {
    if (node.kind != Node::Kind::list)
      return r.problems.add(node.place, fmt::format("{} must be {}", name_of_value(node), type()));
    a_.clear(value);
    std::vector<std::string> names;
    for (const ChoiceKind& k : kinds_) names.push_back(k.name);
    for (const Node& item : node.items) {
      if (item.kind != Node::Kind::map || item.items.empty()) {
        r.problems.add(item.place, "each item is one `- kind: {...}`; the options stand below the kind");
        continue;
      }
      if (item.items.size() > 1) {
        r.problems.add(item.items[1].key_place,
                       fmt::format("each item is one `- kind: {{...}}`; this one has '{}' beside '{}'",
                                   item.items[1].key, item.items[0].key));
        continue;
      }
      const Node& only = item.items.front();
      const auto at = std::find(names.begin(), names.end(), only.key);
      if (at == names.end()) {
        const std::string hint = did_you_mean(only.key, names);
        r.problems.add(only.key_place,
                       fmt::format("unknown kind '{}'{}", only.key,
                                   hint.empty() ? fmt::format("; there are {}", fmt::join(names, ", ")) : hint));
        continue;
      }
      const auto kind = static_cast<std::size_t>(at - names.begin());
      Node options = only;
      if (options.kind == Node::Kind::none) options.kind = Node::Kind::map;  // `- static:` takes every default
      kinds_[kind].options->read(options, a_.append(value, kind), r);
    }
  }
  Node write(const void* value) const override {
    Node n = Node::list();
    for (std::size_t i = 0; i < a_.size(value); ++i) {
      const ChoiceKind& k = kinds_[a_.kind(value, i)];
      Node item = Node::map();
      item.set(k.name, k.options->write(a_.options(mutable_part(value), i)));
      n.push(std::move(item));
    }
    return n;
  }
  Node schema(bool whole) const override {
    Node n = typed_schema("array");
    Node item = Node::map();
    Node& one_of = item.set("oneOf", Node::list());
    for (const ChoiceKind& k : kinds_) {
      Node o = object_schema();
      Node options = k.options->schema(whole);
      options.set("description", Node::scalar(k.text, true));
      o.find("properties")->set(k.name, std::move(options));
      Node required = Node::list();
      required.push(Node::scalar(k.name, true));
      o.set("required", std::move(required));
      one_of.push(std::move(o));
    }
    n.set("items", std::move(item));
    return n;
  }
  std::string type() const override { return "a list of `- kind: {...}`"; }
  std::vector<std::pair<std::string, const Structure*>> kinds() const override {
    std::vector<std::pair<std::string, const Structure*>> all;
    for (const ChoiceKind& k : kinds_) all.emplace_back(k.name, k.options);
    return all;
  }
  std::string step() const override { return "1"; }
  Leaf leaf(const void*, std::span<const std::string> path, const Node* given) const override {
    if (path.size() < 2) return {};
    std::vector<std::string> names;
    for (const ChoiceKind& k : kinds_) {
      if (path[1] == k.name)
        return leaf_of(*k.options, nullptr, path.subspan(2), given_part(given_part(given, path[0]), k.name));
      names.push_back(k.name);
    }
    throw InputError(fmt::format("there is no kind '{}'{}", path[1], did_you_mean(path[1], names)));
  }
  Access find(void* value, std::span<const std::string> path) const override {
    if (path.size() < 2) return {};
    const std::size_t i = index_of(path.front(), a_.size(value));
    const ChoiceKind& k = kinds_[a_.kind(value, i)];
    if (path[1] != k.name) throw InputError(fmt::format("item {} is of kind '{}'", path.front(), k.name));
    return k.options->find(a_.options(value, i), path.subspan(2));
  }

private:
  std::vector<ChoiceKind> kinds_;
  ChoiceAccess a_;
};

}  // namespace

CodecPtr choices_codec(std::vector<ChoiceKind> kinds, ChoiceAccess access) {
  return std::make_shared<ChoicesCodec>(std::move(kinds), std::move(access));
}

}  // namespace whirl::deck
