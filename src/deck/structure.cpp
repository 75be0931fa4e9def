// Reading and writing of described structs.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "known.hpp"
#include "paths.hpp"
#include "schema.hpp"
#include "synonyms.hpp"
#include "whirl/deck/description.hpp"

namespace whirl::deck {

using core::InputError;

Access Codec::find(void*, std::span<const std::string>) const {
  return {};
}

const Option* Structure::option(std::string_view key) const {
  const auto it = std::find_if(options.begin(), options.end(), [&](const Option& o) { return o.key == key; });
  return it == options.end() ? nullptr : &*it;
}

const Option* Structure::option_of(std::string_view key, const void* object) const {
  const auto it =
      std::find_if(options.begin(), options.end(), [&](const Option& o) { return o.key == key && applies(o, object); });
  return it == options.end() ? option(key) : &*it;
}

const Option* Structure::aliased(std::string_view key, double& factor) const {
  for (const Option& o : options)
    for (const Alias& a : o.aliases)
      if (a.key == key) {
        factor = a.factor;
        return &o;
      }
  return nullptr;
}

std::vector<std::string> Structure::keys() const {
  std::vector<std::string> k;
  for (const Option& o : options)
    if (&o == option(o.key)) k.push_back(o.key);
  return k;
}

bool Structure::applies(const Option& o, const void* object) const {
  if (o.selector.empty()) return true;
  const Option* s = option(o.selector);
  const std::string value = s->codec->write(s->member(const_cast<void*>(object))).text;
  return std::find(o.selected.begin(), o.selected.end(), value) != o.selected.end();
}

namespace {

// Whether the unit that was written with `value` is of another kind than that of `o`: then it was not meant.
bool is_of_another_kind(const Node& value, const Option& o) {
  const Spec* spec = o.codec->spec();
  if (value.kind != Node::Kind::scalar || !spec || spec->unit == "*") return false;
  try {
    const Split s = split_quantity(value.text);
    return !s.unit.empty() && !same_kind(s.unit, spec->unit);
  } catch (const InputError&) {
    return false;
  }
}

// The option that a word of the field means here, where the value does not say that it is another quantity.
std::string synonym_hint(const Structure& s, const std::string& word, const Node& value) {
  for (const Synonym& meant : synonyms(word)) {
    double factor = 1;
    const std::string key(meant.key);
    const Option* o = s.option(key);
    if (!o) o = s.aliased(key, factor);
    if (!o || (meant.change.empty() && is_of_another_kind(value, *o))) continue;
    return meant.change.empty() ? fmt::format(" (did you mean '{}'?)", key)
                                : fmt::format(" (did you mean '{}'? It is {})", key, meant.change);
  }
  return {};
}

// The key and its value where they are one word: the colon is missing, or the space behind it.
std::string parted(const Structure& s, const Node& entry) {
  const std::size_t k = entry.key.find_first_of(" :");
  if (entry.kind != Node::Kind::none || k == std::string::npos) return {};
  const std::string key = entry.key.substr(0, k);
  const std::size_t value = entry.key.find_first_not_of(" :", k);
  double factor = 1;
  if (value == std::string::npos || (!s.option(key) && !s.aliased(key, factor))) return {};
  return fmt::format(" (did you mean '{}: {}'?)", key, entry.key.substr(value));
}

// The key that was meant, where the value does not say that it is another quantity; the word for another quantity, a
// diameter for a radius, by itself.
std::string hint_for(const Structure& s, const Node& entry) {
  if (std::string hint = parted(s, entry); !hint.empty()) return hint;
  if (std::string hint = synonym_hint(s, entry.key, entry); !hint.empty()) return hint;
  std::vector<std::string> words;
  for (const Option& o : s.options) {
    if (is_of_another_kind(entry, o)) continue;
    words.push_back(o.key);
    for (const Alias& a : o.aliases) words.push_back(a.key);
  }
  std::string near = nearest(entry.key, words);
  double factor = 1;
  if (const Option* o = s.aliased(near, factor); o && factor == 1) near = o->key;
  return near.empty() ? std::string() : fmt::format(" (did you mean '{}'?)", near);
}

// The same for the step of a path.
std::string hint_for(const Structure& s, const std::string& step) {
  const std::string hint = synonym_hint(s, step, {});
  return hint.empty() ? did_you_mean(step, s.keys()) : hint;
}

// The entry of `node` for `o`, under its key or another word for it, which goes to `meant`; null if there is none.
const Node* given(const Option& o, const Node& node, Node& meant, Reading& r) {
  const Node* value = node.find(o.key);
  for (const Alias& a : o.aliases) {
    const Node* other = node.find(a.key);
    if (!other) continue;
    if (value) {
      r.problems.add(other->key_place, fmt::format("'{}' says the same as '{}', which {} gives: keep one of them",
                                                   a.key, value->key, value->key_place.text()));
      continue;
    }
    meant = *other;
    if (a.factor != 1 && meant.kind == Node::Kind::scalar) {
      try {
        meant.text = scaled(meant.text, 1 / a.factor);
      } catch (const InputError& e) {
        r.problems.add(other->place, fmt::format("'{}': {}", a.key, e.what()));
      }
    }
    value = &meant;
  }
  return value;
}

}  // namespace

void Structure::read(const Node& node, void* object, Reading& r) const {
  const std::string name = node.key.empty() ? "this value" : fmt::format("'{}'", node.key);
  if (node.kind == Node::Kind::none)
    return r.problems.add(node.place, fmt::format("{} has no value: expected {}", name, fmt::join(keys(), ", ")));
  if (node.kind != Node::Kind::map)
    return r.problems.add(node.place, fmt::format("{} must be a map with the keys {}", name, fmt::join(keys(), ", ")));
  const std::size_t before = r.problems.size();
  for (const Node& entry : node.items) {
    if (double factor = 1; option(entry.key) || aliased(entry.key, factor)) continue;
    if (r.problems.full()) {
      r.problems.add(entry.key_place, entry.key);
      continue;
    }
    const std::string hint = hint_for(*this, entry);
    r.problems.add(entry.key_place,
                   fmt::format("unknown key '{}'{}", entry.key,
                               hint.empty() ? fmt::format("; valid keys are {}", fmt::join(keys(), ", ")) : hint));
  }
  for (const Option& o : options) {
    if (&o != option_of(o.key, object)) continue;
    Node meant;
    const Node* value = given(o, node, meant, r);
    if (!applies(o, object)) {
      if (value)
        r.problems.add(value->key_place,
                       fmt::format("'{}' does not apply where {} is {}", o.key, o.selector,
                                   option(o.selector)->codec->write(option(o.selector)->member(object)).text));
    } else if (value) {
      o.codec->read(*value, o.member(object), r);
    } else if (o.required) {
      r.problems.add(node.place,
                     fmt::format("{}'{}' is missing ({})", node.key.empty() ? "" : name + ": ", o.key, o.text));
    }
  }
  if (r.problems.size() != before) return;
  const Report report(node, r.problems);
  for (const Checker& c : checks) c(object, report);
}

Node Structure::write(const void* object) const {
  Node n = Node::map();
  for (const Option& o : options) {
    if (!applies(o, object)) continue;
    Node value = o.codec->write(o.member(const_cast<void*>(object)));
    if (value.kind != Node::Kind::none) n.set(o.key, std::move(value));
  }
  return n;
}

namespace {

// The schema of one set of options; `selector` has the value `choice` in it.
Node plain_schema(const Structure& s, bool whole, const std::string& selector, const std::string& choice) {
  Node n = object_schema();
  Node required = Node::list();
  Node& properties = *n.find("properties");
  for (const Option& o : s.options) {
    const bool selects = !selector.empty() && o.key == selector;
    if (!selector.empty() && o.selector == selector &&
        std::find(o.selected.begin(), o.selected.end(), choice) == o.selected.end())
      continue;
    Node p = o.codec->schema(whole);
    if (selects) {
      p = Node::map();
      p.set("const", Node::scalar(choice, true));
    }
    p.set("description", Node::scalar(o.text, true));
    const Node value = o.codec->write(o.preset);
    if (!o.required && !selects && value.kind == Node::Kind::scalar) p.set("default", value);
    for (const Alias& a : o.aliases) {
      Node other = o.codec->schema(whole);
      other.set("description", Node::scalar(fmt::format("another word for '{}'", o.key), true));
      properties.set(a.key, std::move(other));
    }
    properties.set(o.key, std::move(p));
    // A choice that is not the default one must be written for its keys to apply.
    const bool written = selects && value.text != choice;
    if ((o.required && o.aliases.empty()) || written) required.push(Node::scalar(o.key, true));
  }
  // Takes away what a base says for another choice.
  for (const Option& o : s.options)
    if (!whole && !properties.find(o.key)) properties.set(o.key, typed_schema("null"));
  if (whole && !required.items.empty()) n.set("required", std::move(required));
  return n;
}

}  // namespace

Node Structure::schema(bool whole) const {
  std::string selector;
  for (const Option& o : options)
    if (selector.empty()) selector = o.selector;
  if (selector.empty()) return plain_schema(*this, whole, {}, {});
  Node n = Node::map();
  Node& one_of = n.set(whole ? "oneOf" : "anyOf", Node::list());
  const Node choices = option(selector)->codec->schema(whole);
  for (const Node& c : choices.find("enum")->items) one_of.push(plain_schema(*this, whole, selector, c.text));
  return n;
}

Access Structure::find(void* object, std::span<const std::string> path) const {
  if (path.empty()) return {};
  const Option* o = option_of(path.front(), object);
  if (!o) throw InputError(fmt::format("there is no option '{}'{}", path.front(), hint_for(*this, path.front())));
  if (!applies(*o, object)) throw InputError(fmt::format("option '{}' does not apply here", path.front()));
  Access a = o->codec->find(o->member(object), path.subspan(1));
  a.continuable = a.continuable || o->continuable;
  return a;
}

std::vector<Choice> choices_of(const Codec& codec) {
  const auto* knows = dynamic_cast<const Knows*>(&codec);
  return knows ? knows->choices() : std::vector<Choice>{};
}

Leaf Knows::leaf(const void*, std::span<const std::string> path, const Node*) const {
  throw InputError(fmt::format("'{}' leads into a value that has no parts", path.front()));
}

const Node* given_part(const Node* given, const std::string& step) {
  if (!given || given->kind != Node::Kind::list) return given ? given->find(step) : nullptr;
  std::size_t k = 0;
  const auto [end, code] = std::from_chars(step.data(), step.data() + step.size(), k);
  const bool item = code == std::errc() && end == step.data() + step.size() && k >= 1 && k <= given->items.size();
  return item ? &given->items[k - 1] : nullptr;
}

Leaf leaf_of(const Codec& codec, const void* preset, std::span<const std::string> path, const Node* given) {
  if (path.empty()) {
    Leaf leaf{codec.spec(), preset ? codec.write(preset) : Node{}};
    if (codec.step().empty()) leaf.map = codec.structure();
    return leaf;
  }
  const auto* knows = dynamic_cast<const Knows*>(&codec);
  if (!knows) throw InputError(fmt::format("'{}' leads into a value that has no parts", path.front()));
  return knows->leaf(preset, path, given);
}

namespace {

// True if `o` is the option of its key where the deck gives `given` and `object` holds what it does not give.
bool applies_in(const Structure& s, const Option& o, const void* object, const Node* given) {
  if (o.selector.empty()) return true;
  const Node* chosen = given ? given->find(o.selector) : nullptr;
  if (!chosen || chosen->kind != Node::Kind::scalar) return s.applies(o, object);
  return std::find(o.selected.begin(), o.selected.end(), chosen->text) != o.selected.end();
}

}  // namespace

Leaf leaf_of(const Structure& s, const void* preset, std::span<const std::string> path, const Node* given) {
  if (path.empty()) return {.map = &s};
  const void* object = preset ? preset : s.defaults.get();
  double factor = 1;
  const Option* o = s.option(path.front());
  if (!o) o = s.aliased(path.front(), factor);
  if (!o) throw InputError(fmt::format("there is no option '{}'{}", path.front(), hint_for(s, path.front())));
  for (const Option& other : s.options)
    if (other.key == o->key && applies_in(s, other, object, given)) o = &other;
  const void* value = o->member(const_cast<void*>(object));
  Leaf leaf = leaf_of(*o->codec, value ? value : o->preset, path.subspan(1), given_part(given, path.front()));
  if (path.size() > 1) return leaf;
  if (leaf.preset.kind == Node::Kind::scalar && factor != 1) leaf.preset.text = scaled(leaf.preset.text, factor);
  leaf.words = {{o->key, 1}};
  leaf.words.insert(leaf.words.end(), o->aliases.begin(), o->aliases.end());
  return leaf;
}

Access find_in(const Structure& structure, void* object, std::string_view path) {
  const std::vector<std::string> steps = split_path(path);
  Access a;
  try {
    a = structure.find(object, steps);
  } catch (const InputError& e) {
    throw InputError(fmt::format("'{}': {}{}", path, e.what(), meant_path(structure, structure.write(object), steps)));
  }
  if (!a.value) throw InputError(fmt::format("'{}' is no real number that could be varied", path));
  return a;
}

namespace {

class StructCodec : public Codec, public Knows {
public:
  explicit StructCodec(const Structure& s) : structure_(s) {}
  void read(const Node& node, void* value, Reading& r) const override { structure_.read(node, value, r); }
  Node write(const void* value) const override { return structure_.write(value); }
  Node schema(bool whole) const override { return structure_.schema(whole); }
  std::string type() const override { return "map"; }
  const Structure* structure() const override { return &structure_; }
  Leaf leaf(const void* preset, std::span<const std::string> path, const Node* given) const override {
    return leaf_of(structure_, preset, path, given);
  }
  Access find(void* value, std::span<const std::string> path) const override { return structure_.find(value, path); }

private:
  const Structure& structure_;
};

}  // namespace

CodecPtr struct_codec(const Structure& structure) {
  return std::make_shared<StructCodec>(structure);
}

}  // namespace whirl::deck
