#include "whirl/deck/output.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <nlohmann/json.hpp>
#include <set>

#include "known.hpp"
#include "schema.hpp"

namespace whirl::deck {
namespace {

using Json = nlohmann::ordered_json;

// A number as YAML 1.1 reads one: digits on both sides of the point and a sign in the exponent, 1.0e-5. Readers of
// that version (PyYAML) take 1e-5 for text.
std::string yaml_number(const std::string& text) {
  double value = 0;
  const char* last = text.data() + text.size();
  const std::size_t sign = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  if (text.size() == sign || text[sign] < '0' || text[sign] > '9') return text;
  if (const auto [end, code] = std::from_chars(text.data() + (text[0] == '+' ? 1 : 0), last, value);
      code != std::errc() || end != last)
    return text;
  const std::size_t e = text.find_first_of("eE");
  if (e == std::string::npos) return text;
  std::string mantissa = text.substr(0, e), exponent = text.substr(e + 1);
  if (mantissa.find('.') == std::string::npos) mantissa += ".0";
  if (exponent[0] != '-' && exponent[0] != '+') exponent.insert(0, "+");
  return mantissa + "e" + exponent;
}

// True if a reader of YAML 1.1 or 1.2 may take the plain scalar `s` for something else than text: numbers in all their
// forms, dates and times begin with a digit, a sign or a point and hold no letters of words; some words are flags.
bool may_be_no_text(const std::string& s) {
  static const std::set<std::string, std::less<>> words{"yes", "no", "on", "off", "true", "false", "null", "~"};
  std::string small = s;
  for (char& c : small)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (words.contains(small)) return true;
  return small.find_first_not_of("0123456789abcdefox_.:+-tz ") == std::string::npos &&
         small.find_first_of("0123456789") != std::string::npos &&
         (small.find_first_of("0123456789") < 2 || small[0] == '.');
}

// True if `s` reads back as the same string without quotes, also between flow brackets.
bool is_plain(const std::string& s) {
  const auto alnum = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '/' ||
           c == '.';
  };
  if (s.empty() || s.back() == ' ' || s == "null" || s == "Null" || s == "NULL" || s == "~") return false;
  if (!alnum(s[0]) && !((s[0] == '-' || s[0] == '+') && s.size() > 1 && alnum(s[1]))) return false;
  return std::all_of(s.begin(), s.end(), [&](char c) {
    return alnum(c) || c == ' ' || c == '-' || c == '+' || c == '^' || c == '*' || c == '(' || c == ')' || c == '%';
  });
}

// Text that could be read as a number stands in quotes, except quantities, whose units have letters.
std::string scalar_text(const Node& n) {
  if (n.kind == Node::Kind::none) return "null";
  if (!n.quoted && is_plain(n.text)) return yaml_number(n.text);
  return is_plain(n.text) && !may_be_no_text(n.text) ? n.text : Json(n.text).dump();
}

// Keys may be paths with wildcards.
std::string key_text(const std::string& key) {
  return is_plain(key) && !may_be_no_text(key) ? key : Json(key).dump();
}

bool is_leaf(const Node& n) {
  return n.kind == Node::Kind::scalar || n.kind == Node::Kind::none;
}

bool all_leaves(const Node& n) {
  return std::all_of(n.items.begin(), n.items.end(), is_leaf);
}

std::string flow(const Node& n) {
  if (is_leaf(n)) return scalar_text(n);
  const bool map = n.kind == Node::Kind::map;
  std::string s = map ? "{" : "[";
  for (const Node& i : n.items) {
    if (s.size() > 1) s += ", ";
    if (map) s += key_text(i.key) + ": ";
    s += flow(i);
  }
  return s + (map ? "}" : "]");
}

// Lists of leaves, small maps of leaves, and rows stay on one line.
bool on_one_line(const Node& n, bool in_list) {
  if (is_leaf(n) || n.items.empty()) return true;
  return all_leaves(n) && (n.kind == Node::Kind::list || in_list || n.items.size() <= 4);
}

void block(const Node& n, const std::string& indent, std::string& out) {
  for (const Node& i : n.items) {
    const bool in_list = n.kind == Node::Kind::list;
    out += indent + (in_list ? "-" : key_text(i.key) + ":");
    if (on_one_line(i, in_list)) {
      out += " " + flow(i) + "\n";
      continue;
    }
    std::string inner;
    block(i, indent + "  ", inner);
    if (in_list)
      out += " " + inner.substr(indent.size() + 2);  // the first entry stands behind the dash
    else
      out += "\n" + inner;
  }
}

Json json_of(const Node& n) {
  switch (n.kind) {
    case Node::Kind::none:
      return nullptr;
    case Node::Kind::list: {
      Json j = Json::array();
      for (const Node& i : n.items) j.push_back(json_of(i));
      return j;
    }
    case Node::Kind::map: {
      Json j = Json::object();
      for (const Node& i : n.items) j[i.key] = json_of(i);
      return j;
    }
    case Node::Kind::scalar:
      break;
  }
  if (n.quoted) return n.text;
  if (n.text == "true" || n.text == "false") return n.text == "true";
  const char* last = n.text.data() + n.text.size();
  long long whole = 0;
  if (const auto [end, code] = std::from_chars(n.text.data(), last, whole); code == std::errc() && end == last)
    return whole;
  double real = 0;
  if (const auto [end, code] = std::from_chars(n.text.data(), last, real); code == std::errc() && end == last)
    return real;
  return n.text;
}

std::string join_path(const std::string& a, const std::string& b) {
  return a.empty() ? b : b.empty() ? a : a + "." + b;
}

std::string default_text(const Option& o) {
  if (o.required) return "required";
  const Node value = o.codec->write(o.preset);
  if (value.kind == Node::Kind::none) return "optional";
  if (o.codec->structure() && o.codec->step().empty()) return {};
  if (!is_leaf(value) && value.items.empty()) return {};
  if (value.kind == Node::Kind::scalar && value.text.empty()) return {};
  return "default " + flow(value);
}

// Calls `visit(path, option)` for every option below, depth first.
template <class Visit>
void walk(const Structure& s, const std::string& path, const Visit& visit) {
  for (const Option& o : s.options) {
    const std::string here = join_path(path, o.key);
    visit(here, o);
    const std::string inside = join_path(here, o.codec->step());
    if (o.codec->structure()) walk(*o.codec->structure(), inside, visit);
    for (const auto& [kind, options] : o.codec->kinds()) walk(*options, join_path(inside, kind), visit);
  }
}

// True if `path` names `key` or something above it; steps such as NAME and 1 may be left out, and with `any_name` be
// any word.
bool is_below(const std::string& key, std::string_view path, bool any_name) {
  const std::vector<std::string> k = split_path(key), p = split_path(path);
  std::size_t j = 0;
  for (std::size_t i = 0; i < k.size() && j < p.size(); ++i) {
    if (k[i] == p[j])
      ++j;
    else if (k[i] != "NAME" && k[i] != "1")
      return false;
    else if (any_name && i + 1 < k.size() && p[j] != k[i + 1])
      ++j;
  }
  return j == p.size();
}

}  // namespace

std::string to_yaml(const Node& node) {
  if (is_leaf(node) || node.items.empty()) return flow(node) + "\n";
  std::string out;
  block(node, "", out);
  return out;
}

std::string to_line(const Node& node) {
  return node.kind == Node::Kind::none ? std::string() : flow(node);
}

std::string to_json(const Node& node) {
  return json_of(node).dump(2) + "\n";
}

std::string schema_text(const Structure& structure, std::string_view title) {
  Node n = Node::map();
  n.set("$schema", Node::scalar("https://json-schema.org/draft/2020-12/schema", true));
  n.set("title", Node::scalar(std::string(title), true));
  // A deck with a base gives only what differs, so that nothing is required of it.
  Node asks = Node::map();
  asks.set("required", Node::list()).push(Node::scalar("base", true));
  n.set("if", std::move(asks));
  Node part = structure.schema(false);
  Node base = typed_schema("string");
  base.set("description", Node::scalar("deck to start from; maps merge, lists replace", true));
  // Several alternatives where a choice at the top decides which keys there are.
  if (Node* alternatives = part.find("anyOf"))
    for (Node& one : alternatives->items) one.find("properties")->set("base", base);
  else
    part.find("properties")->set("base", std::move(base));
  n.set("then", std::move(part));
  n.set("else", structure.schema(true));
  return to_json(n);
}

namespace {

// What help says of one option.
std::string entry_text(const std::string& key, const Option& o) {
  const std::string value = default_text(o);
  std::string out = fmt::format("{}\n    {}{}{}", key, o.codec->type(), value.empty() ? "" : "; ", value);
  out += fmt::format("\n    {}{}\n", o.text, o.source.empty() ? "" : " [" + o.source + "]");
  for (const Alias& a : o.aliases)
    out += a.factor == 1 ? fmt::format("    may be written '{}'\n", a.key)
                         : fmt::format("    may be given as '{}', {} times the value\n", a.key, write_number(a.factor));
  const std::vector<Choice> choices = choices_of(*o.codec);
  std::size_t width = 0;
  for (const Choice& c : choices) width = std::max(width, c.name.size());
  for (const Choice& c : choices) out += fmt::format("      {:<{}}  {}\n", c.name, width, c.text);
  if (!o.selector.empty())
    out += fmt::format("    applies where {} is {}\n", o.selector, fmt::join(o.selected, " or "));
  if (o.continuable) out += "    studies may vary it\n";
  return out;
}

bool has_choice(const Option& o, std::string_view name) {
  const std::vector<Choice> choices = choices_of(*o.codec);
  return std::any_of(choices.begin(), choices.end(), [&](const Choice& c) { return c.name == name; });
}

bool has_alias(const Option& o, std::string_view name) {
  return std::any_of(o.aliases.begin(), o.aliases.end(), [&](const Alias& a) { return a.key == name; });
}

// Whether `text` has the word, or its plural.
bool has_word(std::string_view text, std::string_view word) {
  const auto letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    std::size_t end = at + word.size();
    if (end < text.size() && text[end] == 's') ++end;
    if ((at == 0 || !letter(text[at - 1])) && (end == text.size() || !letter(text[end]))) return true;
  }
  return false;
}

// The sources that `text` names, each with its full reference.
std::string sources_text(const std::string& text, std::span<const Citation> citations) {
  std::string out;
  for (const Citation& c : citations)
    if (text.find("[" + std::string(c.mark)) != std::string::npos)
      out += fmt::format("{}[{}] {}\n", out.empty() ? "\nsources\n" : "", c.mark, c.text);
  return out;
}

}  // namespace

std::string reference_text(const Structure& structure, std::string_view path, std::span<const Citation> citations) {
  std::string out;
  std::vector<std::string> keys;
  std::vector<std::string> words;  // that one may ask for
  walk(structure, {}, [&](const std::string& key, const Option& o) {
    keys.push_back(key);
    words.push_back(split_path(key).back());
    for (const Choice& c : choices_of(*o.codec)) words.push_back(c.name);
  });
  // `bearings.geometry` is an option of every bearing before it is a bearing of that name.
  const bool any_name = std::none_of(keys.begin(), keys.end(), [&](const auto& k) { return is_below(k, path, false); });
  walk(structure, {}, [&](const std::string& key, const Option& o) {
    // A single word finds every option that has it in its path, is written so, or takes it as a value.
    const std::vector<std::string> steps = split_path(key);
    const bool named = std::find(steps.begin(), steps.end(), path) != steps.end();
    if (path.empty() || named || has_alias(o, path) || has_choice(o, path) || is_below(key, path, any_name))
      out += entry_text(key, o);
  });
  // A path that leaves steps out.
  const std::vector<std::string> asked = split_path(path);
  if (out.empty() && asked.size() > 1)
    walk(structure, {}, [&](const std::string& key, const Option& o) {
      auto next = asked.begin();
      for (const std::string& step : split_path(key))
        next += next != asked.end() &&
                (step == *next || (step == "NAME" && next != asked.begin() && next + 1 != asked.end()));
      if (next == asked.end()) out += entry_text(key, o);
    });
  // A word of the explanations.
  if (out.empty() && asked.size() == 1 && path.size() > 2)
    walk(structure, {}, [&](const std::string& key, const Option& o) {
      std::string said = o.text;
      for (const Choice& c : choices_of(*o.codec)) said += " " + c.text;
      if (has_word(said, path)) out += entry_text(key, o);
    });
  if (out.empty()) {
    keys.insert(keys.end(), words.begin(), words.end());
    throw core::InputError(fmt::format("there is no option '{}'{}", path, did_you_mean(path, keys)));
  }
  return out + sources_text(out, citations);
}

std::vector<std::string> undocumented(const Structure& structure) {
  std::vector<std::string> bare;
  walk(structure, {}, [&](const std::string& key, const Option& o) {
    if (o.text.size() < 8) bare.push_back(key);
  });
  return bare;
}

}  // namespace whirl::deck
