// Changes of a tree: paths with wildcards, plain values, factors, offsets, things appended.
#include "whirl/deck/edit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <span>

#include "known.hpp"
#include "paths.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/printable.hpp"
#include "whirl/deck/description.hpp"
#include "whirl/deck/load.hpp"
#include "whirl/deck/output.hpp"

namespace whirl::deck {
namespace {

using core::InputError;

// An error that knows its place already.
struct Placed {
  std::string text;
};

// Every value below gets the edit's place.
void relocate(Node& n, const Place& place) {
  n.place = n.key_place = place;
  for (Node& i : n.items) relocate(i, place);
}

// What a scalar asks for beyond replacing: nothing, a factor, or a sum.
struct Relative {
  double factor = 1;
  std::string offset;  // empty if it is a factor
};
std::optional<Relative> relative_of(std::string_view text, bool append) {
  const Written written = written_as(text);
  if (append && written.as != Written::As::change) return Relative{1, std::string(written.rest)};
  if (written.as == Written::As::value) return std::nullopt;
  const Split s = split_quantity(written.rest);
  if (written.as == Written::As::factor) {
    if (!s.unit.empty()) throw InputError(fmt::format("a factor is a bare number, not '{}'", text));
    return Relative{s.number, {}};
  }
  if (s.unit == "%") return Relative{1 + s.number / 100, {}};
  return Relative{1, std::string(written.rest)};
}

std::string_view without_spaces(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  return text;
}

// A number of this value that is not zero, as it is written; empty if there is none.
std::string not_zero(const Node& n) {
  for (const Node& i : n.items)
    if (std::string text = not_zero(i); !text.empty()) return text;
  if (n.kind != Node::Kind::scalar) return {};
  try {
    return split_quantity(n.text).number == 0 ? std::string() : n.text;
  } catch (const InputError&) {
    return {};
  }
}

// A length with a sign used to be added to the value. For one version it is refused where the two readings differ, so
// that no deck or command of before silently runs another machine.
void refuse_two_readings(std::string_view text, const Node& now, const Spec& spec) {
  text = without_spaces(text);
  if (text.empty() || (text[0] != '+' && text[0] != '-')) return;
  const Split s = split_quantity(text);
  if (spec.unit != "m" && (spec.unit != "*" || !same_kind(s.unit, "m"))) return;
  if (const std::string base = not_zero(now); !base.empty())
    throw InputError(fmt::format(
        "'{}' could be a change of the value here, {}, or the value itself: write 'by {}' to change it, '={}' for the "
        "value itself",
        text, base, text, text));
}

// `text` after the factor or the offset, in the unit that it had.
std::string changed(const std::string& text, const Relative& r, const Spec& spec) {
  const std::string& unit = spec.unit;
  if (!spec.letter.empty()) {
    if (!r.offset.empty())
      throw InputError(
          fmt::format("'{}' takes a factor (x2, +20 %) or a new value, not the offset '{}'", text, r.offset));
    if (!text.starts_with(spec.letter))
      throw InputError(fmt::format("'{}' has no '{}' before its number", text, spec.letter));
    return spec.letter + scaled(text.substr(spec.letter.size()), r.factor);
  }
  if (r.offset.empty()) return scaled(text, r.factor);
  const Split now = split_quantity(text);
  double sum = 0;
  if (unit == "*") {  // the study knows what it is; here it is of the kind in which it was written
    const Split more = split_quantity(r.offset);
    if (!same_kind(now.unit, more.unit))
      throw InputError(fmt::format("'{}' and '{}' are not of the same kind", text, r.offset));
    sum = number_to_si(now.number, now.unit) + number_to_si(more.number, more.unit);
  } else {
    sum = to_si(text, unit) + to_si(r.offset, unit == "K" ? "delta K" : unit);
  }
  return write_rounded(now.unit.empty() ? sum : from_si(sum, now.unit, unit)) +
         (now.unit.empty() ? "" : " " + now.unit);
}

class Application {
public:
  Application(const Edit& e, const Structure& s, const Files& f) : edit_(e), structure_(s), files_(f) {}

  std::vector<Change> run(Node& root) {
    steps_ = steps_of(edit_.path);
    root_ = &root;
    walk(root, nullptr, 0);
    return std::move(changes_);
  }

private:
  [[nodiscard]] std::string walked() const { return fmt::format("{}", fmt::join(path_, ".")); }
  [[nodiscard]] std::string whole_path(const std::string& step) const {
    return walked() + (path_.empty() ? "" : ".") + step;
  }
  // The path that was meant where step i leads to no option.
  [[nodiscard]] std::string hint_at(const std::string& step, std::size_t i) const {
    return meant_path(structure_, *root_, path_, step, std::span(steps_).subspan(i + 1));
  }

  void walk(Node& at, Node* parent, std::size_t i) {
    if (i == steps_.size()) return act(at, *parent);
    if (names_table(at)) {
      Node rows = table(at);
      at = std::move(rows);
    }
    if (at.kind == Node::Kind::none && i > 0) {
      // One item of a list of numbers of which the deck is silent: the others are those of the default.
      Leaf whole = known_leaf();
      if (whole.spec && !whole.preset.items.empty()) {
        whole.preset.key = at.key;
        at = std::move(whole.preset);
        relocate(at, edit_.place);
      }
    }
    if (at.kind == Node::Kind::scalar)
      throw InputError(fmt::format("'{}' is a value and has no '{}'", walked(), steps_[i]));
    for (const std::string& step : alternatives(steps_[i])) {
      if (at.kind != Node::Kind::none) begun_.clear(), new_item_ = false;
      if (step.find('*') != std::string::npos)
        each(at, step, i);
      else if (at.kind == Node::Kind::list)
        enter(at, item(at, step, i), step, i);
      else
        enter(at, entry(at, step, i), step, i);
    }
  }

  void enter(Node& at, std::size_t k, const std::string& step, std::size_t i) {
    path_.push_back(step);
    walk(at.items[k], &at, i + 1);
    path_.pop_back();
  }

  // All that fit a pattern. Those of a map are found by name each time: one that is taken away moves the others.
  void each(Node& at, const std::string& pattern, std::size_t i) {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < at.items.size(); ++k) {
      const std::string name = at.kind == Node::Kind::list ? fmt::format("{}", k + 1) : at.items[k].key;
      if (fits(name, pattern)) names.push_back(name);
    }
    if (names.empty())
      throw InputError(path_.empty() ? fmt::format("no key fits '{}'", pattern)
                                     : fmt::format("nothing in '{}' fits '{}'", walked(), pattern));
    for (const std::string& name : names)
      enter(at, at.kind == Node::Kind::list ? item(at, name, i) : entry(at, name, i), name, i);
  }

  [[nodiscard]] std::size_t item(const Node& at, const std::string& step, std::size_t i) const {
    std::size_t k = 0;
    const char* end = step.data() + step.size();
    const auto [last, code] = std::from_chars(step.data(), end, k);
    if (code != std::errc() || last != end || k < 1 || k > at.items.size())
      throw InputError(
          fmt::format("'{}' has items 1 to {}, not '{}'{}", walked(), at.items.size(), step, hint_at(step, i)));
    return k - 1;
  }

  // Index of a key, which is begun if there is none.
  [[nodiscard]] std::size_t entry(Node& at, const std::string& step, std::size_t i) {
    if (at.kind == Node::Kind::none) at.kind = Node::Kind::map;
    if (const Node* found = at.find(step)) return static_cast<std::size_t>(found - at.items.data());
    if (Node* found = other_word(at, step)) return static_cast<std::size_t>(found - at.items.data());
    // A part of something new beside something of nearly this name is a slip where all are of a kind: a bearing is
    // not begun by its clearance.
    const bool of_a_kind =
        std::all_of(at.items.begin(), at.items.end(), [](const Node& n) { return n.kind == Node::Kind::map; });
    std::vector<std::string> names;
    for (const Node& n : at.items) names.push_back(n.key);
    if (i + 1 < steps_.size() && of_a_kind) {
      if (const std::string hint = did_you_mean(step, names); !hint.empty())
        throw InputError(fmt::format("there is no '{}'{}; a new one is given whole: --set {}={{...}}", step, hint,
                                     whole_path(step)));
    }
    if (const std::string hint = hint_at(step, i); !hint.empty())
      throw InputError(fmt::format("there is no '{}'{}", whole_path(step), hint));
    require_key(step);
    if (i + 1 < steps_.size()) {
      const bool item = of_a_kind && path_.size() == 1;
      if (begun_.empty())
        begun_ = fmt::format("'{}'{}", whole_path(step), item ? did_you_mean_one_of(step, names) : std::string());
      new_item_ = new_item_ || item;
    }
    Node& next = at.set(step, Node{});
    next.place = next.key_place = edit_.place;
    return at.items.size() - 1;
  }

  // The entry of `at` under another word for the option `step`, which it has from here on, and its value with it: a
  // radius of 0.1 m becomes a diameter of 0.2 m. Null if there is none.
  [[nodiscard]] Node* other_word(Node& at, const std::string& step) const {
    std::vector<std::string> path = path_;
    path.push_back(step);
    const std::vector<Alias> words = leaf_at(path).words;
    const auto meant = std::find_if(words.begin(), words.end(), [&](const Alias& a) { return a.key == step; });
    for (const Alias& word : words) {
      Node* found = at.find(word.key);
      if (!found) continue;
      const double factor = meant->factor / word.factor;
      if (factor != 1 && found->kind == Node::Kind::scalar) {
        try {
          found->text = scaled(found->text, factor);
        } catch (const InputError& e) {
          throw InputError(fmt::format("'{}': {}", word.key, e.what()));
        }
      }
      found->key = step;
      return found;
    }
    return nullptr;
  }

  // The value at the end of the path.
  void act(Node& at, Node& parent) {
    const bool scalar = edit_.value.kind == Node::Kind::scalar;
    const Leaf leaf = known_leaf();
    Node now = at.kind == Node::Kind::none ? leaf.preset : at;
    // Where the path leads into what the deck does not have, the value is not what is missing.
    // Defaults stand for an option; an item with a name of its own, as a bearing, has none.
    if (scalar && !edit_.append && !begun_.empty() && (new_item_ || now.kind == Node::Kind::none) &&
        written_as(edit_.value.text).as != Written::As::value)
      throw InputError(
          fmt::format("there is no {}: '{}' changes a value, and there is none", begun_, edit_.value.text));
    Change change{walked(), to_line(now), {}};
    Node after = edit_.value;
    if (edit_.value.kind == Node::Kind::none && parent.kind == Node::Kind::map && !edit_.append) {
      const std::string key = at.key;
      std::erase_if(parent.items, [&](const Node& n) { return n.key == key; });
      changes_.push_back(std::move(change));
      return;
    }
    const bool add_number = edit_.append && scalar && now.kind != Node::Kind::list && leaf.spec && !names_table(now);
    if (scalar && (add_number || !edit_.append) && leaf.spec && !names_table(edit_.value)) {
      if (const auto r = relative_of(edit_.value.text, add_number)) {
        after = std::move(now);
        shift(after, *r, *leaf.spec);
      } else {
        refuse_two_readings(after.text, now, *leaf.spec);
      }
    } else if (edit_.append) {
      after = joined(std::move(now));
    }
    if (!edit_.append && after.kind == Node::Kind::scalar) {
      if (after.text.starts_with("=")) after.text.erase(0, 1);
      if (leaf.spec && after.text.starts_with("+")) after.text.erase(0, 1);  // 5 and +5 alike, of whole numbers too
    }
    after.key = at.key;
    after.key_place = edit_.place;
    change.after = to_line(after);
    at = std::move(after);
    changes_.push_back(std::move(change));
  }

  // What the description says; nothing for what it does not know, of which the reader will complain.
  [[nodiscard]] Leaf known_leaf() const { return leaf_at(path_); }
  [[nodiscard]] Leaf leaf_at(const std::vector<std::string>& path) const {
    try {
      return leaf_of(structure_, nullptr, path, root_);
    } catch (const InputError&) {
      return {};
    }
  }

  void shift(Node& n, const Relative& r, const Spec& spec) const {
    if (n.kind == Node::Kind::none || (n.kind == Node::Kind::list && n.items.empty()))
      throw InputError(fmt::format("'{}' has no value to start from: the deck does not give it{}", walked(),
                                   r.offset.empty() ? "" : fmt::format(" ('{}' is the value itself)", r.offset)));
    if (names_table(n))
      throw InputError(
          fmt::format("'{}' is the table {}: name its rows and the column, {}.*.COLUMN", walked(), n.text, walked()));
    if (n.kind == Node::Kind::map) throw InputError(fmt::format("'{}' is a map: name the part that changes", walked()));
    for (Node& i : n.items) shift(i, r, spec);
    if (n.kind != Node::Kind::scalar) return;
    try {
      n.text = changed(n.text, r, spec);
    } catch (const InputError& e) {
      throw InputError(fmt::format("'{}': {}", walked(), e.what()));
    }
    n.quoted = n.table_row = false;
    n.place = n.key_place = edit_.place;
  }

  [[nodiscard]] Node joined(Node now) const {
    if (names_table(now)) now = table(now);
    if (now.kind == Node::Kind::none) now = Node::list();
    if (now.kind == Node::Kind::map && edit_.value.kind == Node::Kind::map) return merge(std::move(now), edit_.value);
    if (now.kind != Node::Kind::list)
      throw InputError(fmt::format("nothing can be appended to '{}', which is no list", walked()));
    if (edit_.value.kind == Node::Kind::list)
      now.items.insert(now.items.end(), edit_.value.items.begin(), edit_.value.items.end());
    else
      now.push(edit_.value);
    return now;
  }

  [[nodiscard]] Node table(const Node& name) const {
    try {
      return load_table(name, files_);
    } catch (const InputError& e) {
      throw Placed{e.what()};
    }
  }

  const Edit& edit_;
  const Structure& structure_;
  const Files& files_;
  const Node* root_ = nullptr;
  std::vector<std::string> steps_;
  std::vector<std::string> path_;  // up to here, without wildcards
  std::string begun_;              // the first key on the way that the deck does not have, with what it has beside it
  bool new_item_ = false;          // that is an item of a list of names: a bearing, an element
  std::vector<Change> changes_;
};

}  // namespace

Written written_as(std::string_view text) {
  text = without_spaces(text);
  if (text.starts_with("x")) return {Written::As::factor, text.substr(1)};
  if (text.starts_with("by ") || text.starts_with("by+") || text.starts_with("by-"))
    return {Written::As::change, without_spaces(text.substr(2))};
  const bool has_sign = text.starts_with("+") || text.starts_with("-");
  if (has_sign && text.ends_with("%")) return {Written::As::change, text};
  return {Written::As::value, text};
}

Edit make_edit(std::string path, Node value) {
  const Place place = value.place;
  value.key.clear();
  return {std::move(path), false, std::move(value), place};
}

Edit parse_edit(const std::string& argument, std::string_view cited) {
  const Place place{std::make_shared<const std::string>(fmt::format("{} {}", cited, argument)), 0, 0};
  auto fail = [&](const std::string& m) { throw InputError(place.text() + ": " + m); };
  for (std::string_view rest = argument; !rest.empty(); rest.remove_prefix(core::utf8_length(rest)))
    if (core::utf8_length(rest) == 0) fail("the argument is not UTF-8 text");
  const std::size_t equals = argument.find('=');
  if (equals == std::string::npos || equals == 0) fail("expected PATH=VALUE");
  const bool append = argument[equals - 1] == '+';
  Edit edit{argument.substr(0, equals - (append ? 1 : 0)), append, {}, place};
  if (edit.path.empty()) fail("expected PATH+=VALUE");
  // What other programs take for a factor, YAML takes for a name; /2024/seal.csv is one.
  const std::string_view text = without_spaces(std::string_view(argument).substr(equals + 1));
  double number = 0;
  const char* end = text.data() + text.size();
  if (text.size() > 1 && (text[0] == '*' || text[0] == '/') && std::from_chars(text.data() + 1, end, number).ptr == end)
    fail(fmt::format("'{}' is no value: a factor is written x2, x0.5 or +20 %", text));
  try {
    edit.value = parse_yaml(std::string_view(argument).substr(equals + 1), "value");
  } catch (const InputError& e) {
    const std::string_view what = e.what();
    fail(std::string(what.substr(what.find(": ") + 2)));
  }
  relocate(edit.value, place);
  return edit;
}

std::vector<Change> apply(const Edit& edit, Node& root, const Structure& structure, const Files& files) {
  try {
    return Application(edit, structure, files).run(root);
  } catch (const Placed& e) {
    throw InputError(e.text);
  } catch (const InputError& e) {
    throw InputError(edit.place.text() + ": " + e.what());
  }
}

}  // namespace whirl::deck
