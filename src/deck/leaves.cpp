// Codecs of values without parts: numbers, quantities, flags, text, choices, ranges.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <limits>

#include "known.hpp"
#include "name_of_value.hpp"
#include "plausible.hpp"
#include "schema.hpp"
#include "synonyms.hpp"
#include "whirl/core/printable.hpp"
#include "whirl/deck/description.hpp"

namespace whirl::deck {
namespace {

using core::InputError;

// True if `node` is a scalar; otherwise says what was wanted.
bool is_scalar(const Node& node, const std::string& wanted, Reading& r) {
  if (node.kind == Node::Kind::scalar) return true;
  if (node.kind == Node::Kind::none)
    r.problems.add(node.place, fmt::format("{} has no value: expected {}", name_of_value(node), wanted));
  else
    r.problems.add(node.place, fmt::format("{} is a {}: expected {}", name_of_value(node),
                                           node.kind == Node::Kind::list ? "list" : "map", wanted));
  return false;
}

std::string unit_words(const std::string& unit) {
  return unit == "1" ? "number" : unit == "*" ? "quantity with the unit of the parameter" : "quantity in " + unit;
}

// The end of a range that was meant.
std::string end_hint(const std::string& word) {
  for (const Synonym& meant : synonyms(word))
    if (meant.key == "from" || meant.key == "to") return fmt::format(" (did you mean '{}'?)", meant.key);
  return did_you_mean(word, {"from", "to"});
}

// The unit behind a number in messages.
std::string_view plain_unit(std::string_view unit) {
  return unit == "1" || unit == "*" ? "" : coherent(unit);
}

// Reads the quantity `node` for `spec`; false if a problem was added. `unit` is the unit as written.
bool read_real(const Node& node, const Spec& spec, Reading& r, double& value, std::string* unit = nullptr) {
  if (!is_scalar(node, "a " + unit_words(spec.unit), r)) return false;
  try {
    const Split split = split_quantity(node.text);
    if (node.table_row && split.unit.empty() && spec.unit != "1" && spec.unit != "*") {
      r.problems.add(node.key_place,
                     fmt::format("column '{}' has no unit: write `{} [{}]`", node.key, node.key, spec.unit));
      return false;
    }
    const double si = to_si(node.text, spec.unit);
    if (!spec.check.holds(si)) {
      const bool scaled =
          spec.unit != "1" && spec.unit != "*" && spec.check.text() != "positive" && spec.check.text() != "at least 0";
      r.problems.add(node.place, fmt::format("{} must be {}{}, not {}", name_of_value(node), spec.check.text(),
                                             scaled ? " " + spec.unit : "", node.text));
      return false;
    }
    if (const Magnitude size = plausible(spec.unit); !size.holds(si)) {
      r.problems.add(node.place,
                     fmt::format("{} cannot be as {} as {}: 0, or {} in size", name_of_value(node),
                                 std::abs(si) < 1 ? "small" : "large", node.text, size.text(plain_unit(spec.unit))));
      return false;
    }
    value = si;
    if (unit) *unit = split.unit;
    return true;
  } catch (const InputError& e) {
    r.problems.add(node.place, fmt::format("{}: {}", name_of_value(node), e.what()));
    return false;
  }
}

Node quantity_schema(const Spec& spec) {
  Node n = Node::map();
  if (spec.unit == "1") {
    n.set("type", Node::scalar("number", true));
    if (std::isfinite(spec.check.min))
      n.set(spec.check.min_open ? "exclusiveMinimum" : "minimum", Node::scalar(write_number(spec.check.min)));
    if (std::isfinite(spec.check.max))
      n.set(spec.check.max_open ? "exclusiveMaximum" : "maximum", Node::scalar(write_number(spec.check.max)));
    return n;
  }
  Node& type = n.set("type", Node::scalar("string", true));
  if (spec.unit == "*") {
    type = Node::list();
    type.key = "type";
    type.push(Node::scalar("string", true));
    type.push(Node::scalar("number", true));
  }
  n.set("pattern", Node::scalar("^[-+]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][-+]?[0-9]+)?( *[^0-9 ].*| +1/.+)$", true));
  return n;
}

class RealCodec : public Codec, public Knows {
public:
  explicit RealCodec(Spec s) : spec_(std::move(s)) {}
  void read(const Node& node, void* value, Reading& r) const override {
    (void)read_real(node, spec_, r, *static_cast<double*>(value));
  }
  Node write(const void* value) const override {
    const double v = *static_cast<const double*>(value);
    if (spec_.unit == "1" || spec_.unit == "*") return Node::scalar(write_number(v));
    return Node::scalar(write_quantity(v, coherent(spec_.unit)), true);
  }
  Node schema(bool) const override { return quantity_schema(spec_); }
  std::string type() const override { return with_bounds(unit_words(spec_.unit), spec_.check); }
  const Spec* spec() const override { return &spec_; }
  Access find(void* value, std::span<const std::string> path) const override {
    if (!path.empty()) return {};
    return {static_cast<double*>(value), spec_.unit, false, spec_.check};
  }

private:
  Spec spec_;
};

class QuantityCodec : public Codec, public Knows {
public:
  explicit QuantityCodec(Spec s) : spec_(std::move(s)) {}
  void read(const Node& node, void* value, Reading& r) const override {
    auto& q = *static_cast<Quantity*>(value);
    (void)read_real(node, spec_, r, q.value, &q.unit);
  }
  Node write(const void* value) const override {
    const auto& q = *static_cast<const Quantity*>(value);
    const std::string unit(q.unit.empty() && spec_.unit != "*" ? coherent(spec_.unit) : q.unit);
    return Node::scalar(write_quantity(q.value, unit, spec_.unit), !unit.empty() && unit != "1");
  }
  Node schema(bool) const override { return quantity_schema(spec_); }
  std::string type() const override { return with_bounds(unit_words(spec_.unit), spec_.check); }
  const Spec* spec() const override { return &spec_; }

private:
  Spec spec_;
};

class RangeCodec : public Codec, public Knows {
public:
  explicit RangeCodec(Spec s) : spec_(std::move(s)) {}
  void read(const Node& node, void* value, Reading& r) const override {
    auto& range = *static_cast<Range*>(value);
    const std::string wanted = fmt::format("{} is written {{from: ..., to: ...}}", name_of_value(node));
    if (node.kind != Node::Kind::map) return r.problems.add(node.place, wanted);
    for (const Node& i : node.items)
      if (i.key != "from" && i.key != "to")
        r.problems.add(i.key_place, fmt::format("unknown key '{}'{}", i.key, end_hint(i.key)));
    const Node* from = node.find("from");
    const Node* to = node.find("to");
    if (!from || !to) return r.problems.add(node.place, wanted);
    std::string to_unit;
    if (!read_real(*from, spec_, r, range.from, &range.unit) || !read_real(*to, spec_, r, range.to, &to_unit)) return;
    if (spec_.unit == "*" && !same_kind(range.unit, to_unit))
      return r.problems.add(to->place, fmt::format("'{}' and '{}' are not of the same kind", from->text, to->text));
    if (range.unit.empty()) range.unit = "1";
    // Results divide by the unit of the range and take steps in it, which a unit that has its zero elsewhere does not
    // let.
    if (range.unit == "degC") range.unit = "K";
    if (range.from == range.to) r.problems.add(to->place, fmt::format("{} is empty", name_of_value(node)));
  }
  Node write(const void* value) const override {
    const auto& range = *static_cast<const Range*>(value);
    const std::string unit(range.unit.empty() && spec_.unit != "*" ? coherent(spec_.unit) : range.unit);
    const bool text = !unit.empty() && unit != "1";
    Node n = Node::map();
    n.set("from", Node::scalar(write_quantity(range.from, unit, spec_.unit), text));
    n.set("to", Node::scalar(write_quantity(range.to, unit, spec_.unit), text));
    return n;
  }
  Node schema(bool whole) const override {
    Node n = object_schema();
    Node& p = *n.find("properties");
    p.set("from", quantity_schema(spec_));
    p.set("to", quantity_schema(spec_));
    Node required = Node::list();
    required.push(Node::scalar("from", true));
    required.push(Node::scalar("to", true));
    if (whole) n.set("required", std::move(required));
    return n;
  }
  std::string type() const override {
    return with_bounds(fmt::format("range {{from, to}}, each a {}", unit_words(spec_.unit)), spec_.check);
  }
  const Spec* spec() const override { return &spec_; }
  Leaf leaf(const void* preset, std::span<const std::string> path, const Node*) const override {
    if (path.size() > 1 || (path[0] != "from" && path[0] != "to"))
      throw InputError(fmt::format("a range has no '{}'{}", path[0], end_hint(path[0])));
    return {&spec_, preset ? *write(preset).find(path[0]) : Node{}};
  }

private:
  Spec spec_;
};

class IntegerCodec : public Codec, public Knows {
public:
  explicit IntegerCodec(Spec s) : spec_(std::move(s)) {}
  void read(const Node& node, void* value, Reading& r) const override {
    if (!is_scalar(node, "a whole number", r)) return;
    double v = 0;  // 1e6 is a whole number, too
    const char* first = node.text.data();
    const char* last = first + node.text.size();
    const auto [end, code] = std::from_chars(first, last, v);
    if (code != std::errc() || end != last || v != std::trunc(v))
      return r.problems.add(node.place,
                            fmt::format("{} must be a whole number, not {}", name_of_value(node), node.text));
    constexpr double most = std::numeric_limits<int>::max();
    if (!spec_.check.holds(v) || std::abs(v) > most)
      return r.problems.add(
          node.place,
          fmt::format("{} must be {}, not {}", name_of_value(node),
                      spec_.check.holds(v) ? "between -2147483647 and 2147483647" : spec_.check.text(), node.text));
    *static_cast<int*>(value) = static_cast<int>(v);
  }
  Node write(const void* value) const override {
    return Node::scalar(fmt::format("{}", *static_cast<const int*>(value)));
  }
  Node schema(bool) const override {
    Node n = quantity_schema({"1", spec_.check});
    *n.find("type") = Node::scalar("integer", true);
    n.items.front().key = "type";
    return n;
  }
  std::string type() const override { return with_bounds("whole number", spec_.check); }
  const Spec* spec() const override { return &spec_; }

private:
  Spec spec_;
};

class FlagCodec : public Codec {
public:
  void read(const Node& node, void* value, Reading& r) const override {
    if (!is_scalar(node, "true or false", r)) return;
    if (node.text != "true" && node.text != "false")
      return r.problems.add(node.place,
                            fmt::format("{} must be true or false, not {}", name_of_value(node), node.text));
    *static_cast<bool*>(value) = node.text == "true";
  }
  Node write(const void* value) const override {
    return Node::scalar(*static_cast<const bool*>(value) ? "true" : "false");
  }
  Node schema(bool) const override { return typed_schema("boolean"); }
  std::string type() const override { return "true or false"; }
};

class TextCodec : public Codec {
public:
  void read(const Node& node, void* value, Reading& r) const override {
    if (!is_scalar(node, "text", r)) return;
    for (std::size_t i = 0; i < node.text.size(); ++i)
      if (core::begins_with_control(std::string_view(node.text).substr(i)))
        return r.problems.add(node.place, fmt::format("{} holds control characters", name_of_value(node)));
    *static_cast<std::string*>(value) = node.text;
  }
  Node write(const void* value) const override { return Node::scalar(*static_cast<const std::string*>(value), true); }
  Node schema(bool) const override { return typed_schema("string"); }
  std::string type() const override { return "text"; }
};

class ChoiceCodec : public Codec, public Knows {
public:
  ChoiceCodec(std::vector<Choice> c, std::function<std::size_t(const void*)> get,
              std::function<void(void*, std::size_t)> set)
      : choices_(std::move(c)), get_(std::move(get)), set_(std::move(set)) {}
  void read(const Node& node, void* value, Reading& r) const override {
    if (!is_scalar(node, type(), r)) return;
    std::vector<std::string> valid;
    for (const Choice& c : choices_) {
      if (c.name == node.text) return set_(value, valid.size());
      valid.push_back(c.name);
    }
    const std::string hint = did_you_mean(node.text, valid);
    r.problems.add(node.place, fmt::format("{} cannot be '{}'{}", name_of_value(node), node.text,
                                           hint.empty() ? fmt::format("; {}", type()) : hint));
  }
  Node write(const void* value) const override { return Node::scalar(choices_[get_(value)].name, true); }
  Node schema(bool) const override {
    Node n = Node::map();
    Node list = Node::list();
    for (const Choice& c : choices_) list.push(Node::scalar(c.name, true));
    n.set("enum", std::move(list));
    return n;
  }
  std::string type() const override {
    std::vector<std::string> valid;
    for (const Choice& c : choices_) valid.push_back(c.name);
    return fmt::format("one of {}", fmt::join(valid, ", "));
  }
  std::vector<Choice> choices() const override { return choices_; }

private:
  std::vector<Choice> choices_;
  std::function<std::size_t(const void*)> get_;
  std::function<void(void*, std::size_t)> set_;
};

}  // namespace

CodecPtr real_codec(Spec s) {
  return std::make_shared<RealCodec>(std::move(s));
}
CodecPtr quantity_codec(Spec s) {
  return std::make_shared<QuantityCodec>(std::move(s));
}
CodecPtr range_codec(Spec s) {
  return std::make_shared<RangeCodec>(std::move(s));
}
CodecPtr integer_codec(Spec s) {
  return std::make_shared<IntegerCodec>(std::move(s));
}
CodecPtr flag_codec() {
  return std::make_shared<FlagCodec>();
}
CodecPtr text_codec() {
  return std::make_shared<TextCodec>();
}
CodecPtr choice_codec(std::vector<Choice> choices, std::function<std::size_t(const void*)> get,
                      std::function<void(void*, std::size_t)> set) {
  return std::make_shared<ChoiceCodec>(std::move(choices), std::move(get), std::move(set));
}

}  // namespace whirl::deck
