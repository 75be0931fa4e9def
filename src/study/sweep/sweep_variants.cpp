// From the text of a sweep to the decks of its variants.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "whirl/core/error.hpp"
#include "whirl/deck/edit.hpp"
#include "whirl/deck/load.hpp"
#include "whirl/deck/output.hpp"
#include "whirl/study/deck.hpp"
#include "whirl/study/sweep/sweep.hpp"

namespace whirl::study {
namespace {

using core::InputError;
using deck::Node;

constexpr std::size_t most_variants = 1000;

[[noreturn]] void fail(const deck::Place& place, const std::string& message) {
  throw InputError(place.text() + ": " + message);
}

// A bare number.
std::optional<double> number(const Node& n) {
  double value = 0;
  const char* end = n.text.data() + n.text.size();
  const auto [last, code] = std::from_chars(n.text.data(), end, value);
  if (n.kind != Node::Kind::scalar || code != std::errc() || last != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

// What one variant changes along one axis of the sweep.
struct Setting {
  std::string name;
  std::vector<deck::Edit> edits;
  std::optional<double> at;
};
struct SweepAxis {
  std::string quantity;  // the path of a grid; empty for named variants
  std::vector<Setting> settings;
};

SweepAxis named(const Node& variants) {
  SweepAxis axis;
  for (const Node& v : variants.items) {
    Setting s{v.key, {}, {}};
    if (v.kind != Node::Kind::map && v.kind != Node::Kind::none)
      fail(v.place, fmt::format("variant '{}' is a map PATH: VALUE", v.key));
    for (const Node& change : v.items) {
      if (change.key == "at") {
        s.at = number(change);
        if (!s.at) fail(change.place, "'at' is a bare number: the place of the variant on the axis of trends");
      } else {
        s.edits.push_back(deck::make_edit(change.key, change));
      }
    }
    axis.settings.push_back(std::move(s));
  }
  return axis;
}

// A value of a range: how it is written, and what stands behind its number.
struct End {
  deck::Written::As as = deck::Written::As::value;
  double number = 0;
  std::string unit;
};
End end_of(const Node& range, const char* which) {
  const Node* n = range.find(which);
  if (!n || n->kind != Node::Kind::scalar) fail(range.place, fmt::format("a range has '{}'", which));
  const deck::Written written = deck::written_as(n->text);
  try {
    const deck::Split s = deck::split_quantity(written.rest.starts_with("=") ? written.rest.substr(1) : written.rest);
    return {written.as, s.number, s.unit};
  } catch (const InputError& wrong) {
    fail(n->place, wrong.what());
  }
}

bool has_sign(const Node& n) {
  return n.kind == Node::Kind::scalar && (n.text.starts_with("+") || n.text.starts_with("-"));
}

// Values among which some have no sign are all values: 0 um beside -20 um says how -20 um is meant. `=` says so to the
// edit, which refuses a length with a sign alone.
void mark_values(std::vector<Node>& all) {
  const auto is_value = [](const Node& n) {
    return n.kind == Node::Kind::scalar && deck::written_as(n.text).as == deck::Written::As::value;
  };
  if (std::none_of(all.begin(), all.end(), [&](const Node& n) { return is_value(n) && !has_sign(n); })) return;
  for (Node& n : all)
    if (is_value(n) && has_sign(n)) n.text.insert(0, "=");
}

std::vector<Node> values_of(const Node& n) {
  if (n.kind == Node::Kind::list) return n.items;
  if (n.kind != Node::Kind::map)
    fail(n.place, fmt::format("values of '{}' are a list, or a map with from, to and points", n.key));
  for (const Node& i : n.items)
    if (i.key != "from" && i.key != "to" && i.key != "points" && i.key != "spacing")
      fail(i.key_place, fmt::format("a range has from, to, points and spacing, not '{}'", i.key));
  const End from = end_of(n, "from"), to = end_of(n, "to");
  if (from.as != to.as || !deck::same_kind(from.unit, to.unit))
    fail(n.place, "both ends of a range are factors, or changes, or values, of the same kind");
  using As = deck::Written::As;
  const bool part = from.as == As::change && from.unit == "%";  // of the value: +20 %
  const bool both_signed = from.as == As::value && has_sign(*n.find("from")) && has_sign(*n.find("to"));
  const std::string before = from.as == As::factor ? "x" : from.as == As::change && !part ? "by " : "";
  const Node* count = n.find("points");
  const auto points = count ? number(*count) : std::nullopt;
  if (!points || *points < 2 || *points != std::floor(*points) || *points > most_variants)
    fail(n.place, fmt::format("'points' of a range is a whole number from 2 to {}", most_variants));
  const Node* spacing = n.find("spacing");
  const bool log = spacing && spacing->text == "log";
  if (spacing && !log && spacing->text != "linear") fail(spacing->place, "'spacing' is linear or log");
  const double a = from.number,
               b = deck::from_si(deck::number_to_si(to.number, to.unit), from.unit.empty() ? "1" : from.unit);
  if (log && !(a * b > 0)) fail(n.place, "a range with logarithmic spacing has ends of the same sign, not zero");
  std::vector<Node> all;
  for (int k = 0; k < static_cast<int>(*points); ++k) {
    const double s = k / (*points - 1);
    const double value = k == 0 ? a : s == 1 ? b : log ? a * std::pow(b / a, s) : a + s * (b - a);
    const std::string number =
        from.as == As::change || both_signed ? fmt::format("{:+.12g}", value) : fmt::format("{:.12g}", value);
    Node v = Node::scalar(fmt::format("{}{}{}{}", before, number, from.unit.empty() ? "" : " ", from.unit));
    v.place = n.place;
    all.push_back(std::move(v));
  }
  return all;
}

SweepAxis gridded(const Node& values) {
  SweepAxis axis{values.key, {}};
  const std::string last = values.key.substr(values.key.rfind('.') + 1);
  const std::vector<Node> written = values_of(values);
  std::vector<Node> meant = written;
  mark_values(meant);
  for (std::size_t k = 0; k < written.size(); ++k) {
    Node shown = written[k];
    if (shown.kind == Node::Kind::scalar && shown.text.starts_with("=")) shown.text.erase(0, 1);
    axis.settings.push_back(
        {fmt::format("{} {}", last, deck::to_line(shown)), {deck::make_edit(values.key, meant[k])}, {}});
  }
  if (axis.settings.empty()) fail(values.place, fmt::format("there are no values of '{}'", values.key));
  return axis;
}

// The numbers that a value holds, each with its unit; that of a balance grade is a speed, G2.5 is 2.5 mm/s.
void leaves(const Node& n, std::vector<deck::Split>& out) {
  for (const Node& i : n.items) leaves(i, out);
  if (n.kind != Node::Kind::scalar) return;
  const bool grade = n.text.size() > 1 && n.text[0] == 'G' && n.text[1] >= '0' && n.text[1] <= '9';
  out.push_back(deck::split_quantity(grade ? n.text.substr(1) + " mm/s" : n.text));
}

// One number for what an edit did: the new value if all are alike, else the common ratio, else the common difference.
std::optional<Coordinate> coordinate(const std::string& quantity, const std::vector<deck::Change>& changes) {
  std::vector<deck::Split> before, after;
  try {
    for (const deck::Change& c : changes) {
      leaves(deck::parse_yaml(c.before, "value"), before);
      leaves(deck::parse_yaml(c.after, "value"), after);
    }
    if (after.empty() || before.size() > after.size()) return std::nullopt;
    const std::string unit = after.front().unit;
    for (const deck::Split& s : after)
      if (!deck::same_kind(s.unit, unit)) return std::nullopt;
    const auto in_unit = [&](const deck::Split& s) {
      return deck::from_si(deck::number_to_si(s.number, s.unit), unit.empty() ? "1" : unit);
    };
    const auto alike = [](double a, double b) { return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b)); };
    const bool known = before.size() == after.size();
    bool same = true, ratio = known, difference = known;
    const double a0 = in_unit(after[0]), b0 = known ? in_unit(before[0]) : std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < after.size(); ++i) {
      const double a = in_unit(after[i]), b = known ? in_unit(before[i]) : b0;
      same = same && alike(a, a0) && (!known || alike(b, b0));
      ratio = ratio && b != 0 && b0 != 0 && alike(a / b, a0 / b0);
      difference = difference && std::abs((a - b) - (a0 - b0)) <= 1e-9 * std::max(std::abs(a), std::abs(b));
    }
    if (same) return Coordinate{quantity, a0, b0, unit.empty() ? "1" : unit};
    if (ratio) return Coordinate{quantity, a0 / b0, 1, "1"};
    if (difference) return Coordinate{quantity, a0 - b0, 0, unit.empty() ? "1" : unit};
  } catch (const InputError&) {  // names, tables, choices
  }
  return std::nullopt;
}

// A value as a table of results shows it.
std::string cut_to_line(const Node& value, const std::string& text) {
  const bool rows = value.kind == Node::Kind::list && !value.items.empty() && value.items[0].kind == Node::Kind::map;
  return rows ? fmt::format("a table of {} rows", value.items.size()) : text;
}

// Leaves of the list of studies only those numbered in `kept`.
void keep_studies(Node& root, const std::vector<std::size_t>& kept) {
  Node* studies = root.find("studies");
  std::vector<Node> items;
  for (const std::size_t k : kept) items.push_back(studies->items[k]);
  studies->items = std::move(items);
}

// The studies that `sweep` repeats, by their number among those before it, and what these start from.
std::vector<std::size_t> repeated(const Sweep& sweep, std::span<const std::unique_ptr<Study>> before) {
  std::vector<bool> wanted(before.size());
  for (std::size_t i = before.size(); i-- > 0;) {
    const Study& s = *before[i];
    if (s.kind() == Sweep::key) continue;
    wanted[i] = sweep.repeats(s.name());
    for (std::size_t later = i + 1; later < before.size() && !wanted[i]; ++later) {
      wanted[i] = wanted[later] && before[later]->goes_on_from(s);
    }
  }
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < before.size(); ++i)
    if (wanted[i]) all.push_back(i);
  return all;
}

}  // namespace

void Sweep::prepare(const Node& root, std::span<const std::unique_ptr<Study>> before, const deck::Files& files,
                    deck::Problems& problems) {
  std::vector<SweepAxis> axes;
  try {
    if (!options.variants.items.empty()) axes.push_back(named(options.variants));
    for (const Node& values : options.grid.items) axes.push_back(gridded(values));
  } catch (const InputError& e) {
    return problems.add({}, e.what());  // it knows its place
  }
  const deck::Place place = axes.front().quantity.empty() ? options.variants.place : options.grid.place;
  std::size_t count = 1;
  for (const SweepAxis& a : axes) count = std::min(count * a.settings.size(), most_variants + 1);
  if (count > most_variants)
    return problems.add(place, fmt::format("the sweep has more than {} variants", most_variants));
  const std::vector<std::size_t> kept = repeated(*this, before);
  std::vector<std::size_t> pick(axes.size(), 0);
  for (std::size_t k = 0; k < count; ++k) {
    Variant v;
    Node tree = root;
    std::vector<std::string> names;
    deck::Place here = place;
    std::string wrong;
    try {
      for (std::size_t a = 0; a < axes.size(); ++a) {
        const Setting& s = axes[a].settings[pick[a]];
        names.push_back(s.name);
        std::optional<Coordinate> where;
        for (const deck::Edit& edit : s.edits) {
          if (a == 0) here = edit.place;
          const auto changes = deck::apply(edit, tree, deck::structure_of<Deck>(), files);
          for (const deck::Change& c : changes) v.changes.emplace_back(c.path, cut_to_line(edit.value, c.after));
          if (!where) where = coordinate(edit.path, changes);
        }
        if (s.at) where = Coordinate{"at", *s.at, options.at.value_or(std::numeric_limits<double>::quiet_NaN()), "1"};
        // What is no number has its own name: "round" and "lemon" are different companions of a line.
        if (!where) where = Coordinate{s.name, std::numeric_limits<double>::quiet_NaN(), 0, ""};
        v.coordinates.push_back(*where);
      }
      keep_studies(tree, kept);
      deck::Problems found;
      v.deck = std::make_shared<Deck>(deck::read<Deck>(tree, files, found));
      found.raise();
    } catch (const InputError& e) {
      wrong = e.what();
    }
    v.name = fmt::format("{}", fmt::join(names, ", "));
    for (std::string_view rest = wrong; !rest.empty();) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      std::string_view line = rest.substr(0, end);
      const std::string known = here.text() + ": ";
      if (line.starts_with(known)) line.remove_prefix(known.size());
      problems.add(here, fmt::format("variant '{}' of '{}': {}", v.name, name(), line));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    for (const Variant& other : variants_)
      if (io::safe_name(other.name) == io::safe_name(v.name))
        problems.add(here, fmt::format("there are two variants '{}'", v.name));
    variants_.push_back(std::move(v));
    for (std::size_t a = axes.size(); a-- > 0;) {
      if (++pick[a] < axes[a].settings.size()) break;
      pick[a] = 0;
    }
  }
}

}  // namespace whirl::study
