#include "whirl/deck/node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <numeric>
#include <utility>

#include "whirl/core/error.hpp"
#include "whirl/core/printable.hpp"

namespace whirl::deck {

std::string Place::text() const {
  if (!source) return {};
  return line > 0 ? fmt::format("{}:{}:{}", *source, line, column) : *source;
}

std::string Place::directory() const {
  if (!source || line <= 0) return ".";
  const std::string parent = std::filesystem::path(*source).parent_path().string();
  return parent.empty() ? "." : parent;
}

Node Node::scalar(std::string text, bool quoted) {
  Node n;
  n.kind = Kind::scalar;
  n.text = std::move(text);
  n.quoted = quoted;
  return n;
}

Node Node::list() {
  Node n;
  n.kind = Kind::list;
  return n;
}

Node Node::map() {
  Node n;
  n.kind = Kind::map;
  return n;
}

const Node* Node::find(std::string_view name) const {
  if (kind != Kind::map) return nullptr;
  const auto it = std::find_if(items.begin(), items.end(), [&](const Node& n) { return n.key == name; });
  return it == items.end() ? nullptr : &*it;
}

Node* Node::find(std::string_view name) {
  return const_cast<Node*>(std::as_const(*this).find(name));
}

Node& Node::set(std::string name, Node value) {
  value.key = std::move(name);
  return items.emplace_back(std::move(value));
}

Node& Node::push(Node value) {
  return items.emplace_back(std::move(value));
}

void Problems::add(const Place& place, const std::string& message) {
  const std::string where = place.text();
  std::string line = core::printable(where.empty() ? message : where + ": " + message);
  if (!seen_.insert(line).second) return;
  if (!full()) lines_.push_back(std::move(line));
}

void Problems::raise() const {
  if (lines_.empty()) return;
  std::string all;
  for (std::size_t i = 0; i < lines_.size(); ++i) all += (i ? "\n" : "") + lines_[i];
  if (size() > lines_.size()) all += fmt::format("\nand {} more", size() - lines_.size());
  throw core::InputError(all);
}

Place Report::place(std::string_view path) const {
  const Node* node = root_;
  Place best = root_->place;
  for (const std::string& step : split_path(prefix_ + std::string(path))) {
    const Node* next = nullptr;
    if (node->kind == Node::Kind::list) {
      std::size_t i = 0;
      const auto [end, code] = std::from_chars(step.data(), step.data() + step.size(), i);
      if (code == std::errc() && i >= 1 && i <= node->items.size()) next = &node->items[i - 1];
    } else {
      next = node->find(step);
    }
    if (!next) break;
    node = next;
    if (node->place.source) best = node->place;
  }
  return best;
}

Report Report::below(std::string_view path) const {
  Report r = *this;
  r.prefix_ += std::string(path) + ".";
  return r;
}

void Report::fail(std::string_view path, const std::string& message) const {
  // Finding the place takes a walk through the tree, which only those that will be shown are worth.
  if (problems_->full())
    problems_->add({}, prefix_ + std::string(path) + message);
  else
    problems_->add(place(path), message);
}

void require_key(std::string_view key) {
  constexpr std::size_t longest = 200;
  if (key == "<<") throw core::InputError("merge keys ('<<') are not supported; use `base:` or repeat the values");
  if (key.size() > longest)
    throw core::InputError(fmt::format("a key of {} bytes; it has {} at most", key.size(), longest));
}

std::vector<std::string> split_path(std::string_view path) {
  std::vector<std::string> steps;
  while (!path.empty()) {
    const std::size_t dot = path.find('.');
    steps.emplace_back(path.substr(0, dot));
    path = dot == std::string_view::npos ? std::string_view() : path.substr(dot + 1);
  }
  return steps;
}

namespace {

// Optimal string alignment: insertions, deletions, changes and swaps of neighbours each cost one.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before = last;
    last = row;
  }
  return last[b.size()];
}

std::string lower(std::string_view s) {
  std::string t(s);
  for (char& c : t)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return t;
}

std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words(1);
  for (const char c : lower(name)) {
    if (c != '_' && c != '.' && c != ' ' && c != '-')
      words.back() += c;
    else if (!words.back().empty())
      words.emplace_back();
  }
  // One and several are the same word.
  for (std::string& w : words)
    if (w.size() > 3 && w.back() == 's') w.pop_back();
  return words;
}

// The letters of a symbol such as k_xx, Kxx or c_y: a quantity and axes; empty for all else.
std::string symbol(std::string_view name) {
  std::string s;
  for (const char c : lower(name))
    if (c != '_') s += c;
  const bool axes = s.size() >= 2 && s.size() <= 3 && s.find_first_not_of("xyz", 1) == std::string::npos;
  return axes && s[0] >= 'a' && s[0] <= 'w' ? s : std::string();
}

// Names of quantities and what tells one of a pair from the other; as words_of() has them.
bool is_a_quantity(const std::string& word) {
  static const std::unordered_set<std::string> known{
      "acceleration", "amplitude", "angle",     "arc",    "area",     "axial",     "clearance",    "compliance",
      "conductivity", "damping",   "density",   "depth",  "diameter", "direct",    "eccentricity", "elevation",
      "force",        "fraction",  "frequency", "from",   "height",   "inertia",   "inner",        "left",
      "length",       "load",      "maximum",   "max",    "mas",      "minimum",   "min",          "modulu",
      "moment",       "offset",    "outer",     "period", "phase",    "polar",     "power",        "preload",
      "pressure",     "radiu",     "ratio",     "right",  "slope",    "speed",     "stiffnes",     "temperature",
      "thicknes",     "tilt",      "to",        "torque", "velocity", "viscosity", "volume",       "width"};
  return known.contains(word);
}

// Whether a hint would put another quantity in the place of one that is spelled right: damping for stiffness, an outer
// for an inner diameter, k_xx for c_xx. A hint mends spelling only.
bool crosses_quantities(std::string_view word, std::string_view candidate) {
  const std::string a = symbol(word), b = symbol(candidate);
  if (!a.empty() || !b.empty()) return a != b;
  const std::vector<std::string> have = words_of(word), want = words_of(candidate);
  const auto in = [](const std::string& w, const std::vector<std::string>& all) {
    return std::find(all.begin(), all.end(), w) != all.end();
  };
  const bool lacks = std::any_of(want.begin(), want.end(), [&](const auto& w) { return !in(w, have); });
  return lacks &&
         std::any_of(have.begin(), have.end(), [&](const auto& w) { return !in(w, want) && is_a_quantity(w); });
}

}  // namespace

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  if (word.size() > 60) return best;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  const std::string wanted = lower(word);
  for (std::size_t k = 0; k < std::min<std::size_t>(candidates.size(), 5000); ++k) {
    const std::string& c = candidates[k];
    const bool part = word.size() >= 4 && c.size() > word.size() && c.compare(0, word.size(), word) == 0;
    const std::size_t apart = c.size() > word.size() ? c.size() - word.size() : word.size() - c.size();
    if (!part && apart >= least) continue;
    const std::size_t d = part ? 1 : distance(wanted, lower(c));
    if (d < least && d < word.size() && !crosses_quantities(word, c)) {
      least = d;
      best = c;
    }
  }
  return best;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
  const std::string n = nearest(word, candidates);
  return n.empty() ? std::string() : fmt::format(" (did you mean '{}'?)", n);
}

std::string did_you_mean_one_of(std::string_view word, const std::vector<std::string>& names) {
  if (names.empty()) return "; there is none";
  std::string hint = did_you_mean(word, names);
  if (!hint.empty()) return hint;
  constexpr std::size_t most = 10;
  const std::size_t n = std::min(most, names.size());
  return fmt::format("; there {} {}{}", names.size() == 1 ? "is" : "are",
                     fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(n), ", "),
                     names.size() > n ? fmt::format(" and {} more", names.size() - n) : "");
}

}  // namespace whirl::deck
