#include "target.hpp"

#include <cstdio>
#include <cstdlib>

#include "tasks.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/printable.hpp"
#include "whirl/deck/description.hpp"
#include "whirl/deck/edit.hpp"
#include "whirl/deck/load.hpp"
#include "whirl/deck/output.hpp"

namespace whirl::fuzz {

// A description with an option of every type.
enum class Shape { arc, lemon };
std::span<const deck::Name<Shape>> names(Shape) {
  static constexpr deck::Name<Shape> table[] = {{Shape::arc, "arc", "one pad"}, {Shape::lemon, "lemon", "two pads"}};
  return table;
}
struct Geometry {
  Shape type = Shape::arc;
  double radius = 0.1, clearance = 1e-4, preload = 0.25;
  std::array<int, 2> cells{60, 16};
  std::array<double, 2> mass{1, 2};
  std::array<double, 4> damping{1, 2, 3, 4};
};
void describe(deck::Description<Geometry>& d) {
  d.add("type", &Geometry::type, "shape of the bore");
  d.add("radius", &Geometry::radius, "m", deck::positive, "radius").alias("diameter", 2);
  d.add("clearance", &Geometry::clearance, "m", deck::positive, "radial clearance").continuable();
  d.add("preload", &Geometry::preload, deck::in(0, 1), "preload").only(&Geometry::type, {Shape::lemon});
  d.add("cells", &Geometry::cells, deck::in(1, 1000), "cells");
  d.add("mass", &Geometry::mass, "kg", deck::non_negative, "mass").isotropic();
  d.add("damping", &Geometry::damping, "N s/m", deck::any, "damping").isotropic();
}
struct Oil {
  double viscosity = 1;
};
void describe(deck::Description<Oil>& d) {
  d.add("viscosity", &Oil::viscosity, "Pa s", deck::positive, "viscosity");
}
struct Row {
  std::string name;
  double length = 1, temperature = 300;
};
void describe(deck::Description<Row>& d) {
  d.add("name", &Row::name, "name of the row");
  d.add("length", &Row::length, "m", deck::positive, "length");
  d.add("temperature", &Row::temperature, "K", deck::positive, "temperature");
}
struct Machine {
  std::string title;
  std::map<std::string, Geometry> bearings;
  std::optional<double> speed;
  deck::Range range{100, 200, "rad/s"};
  std::variant<std::string, Oil> oil;
  std::vector<Row> rows;
  std::vector<Row> modulus;
  std::vector<deck::Quantity> speeds;
  std::vector<std::string> words;
  std::vector<std::unique_ptr<Task>> tasks;
  bool flag = true;
};
void describe(deck::Description<Machine>& d) {
  d.add("title", &Machine::title, "what it is about");
  d.add("bearings", &Machine::bearings, "the bearings");
  d.add("speed", &Machine::speed, "rad/s", deck::positive, "speed");
  d.add("range", &Machine::range, "*", deck::any, "what to cover");
  d.add("oil", &Machine::oil, "name or own oil");
  d.table("rows", &Machine::rows, "a table");
  d.table_or_scalar(
      "modulus", &Machine::modulus, "length", [](deck::Description<Row>& row) { describe(row); }, "table or scalar");
  d.add("speeds", &Machine::speeds, "*", deck::any, "speeds");
  d.add("words", &Machine::words, "any words");
  d.choices("tasks", &Machine::tasks, kinds_of_tasks(), "what to do");
  d.add("flag", &Machine::flag, "yes or no");
}

namespace {

void must(bool holds, const char* what, std::string_view text) {
  if (holds) return;
  (void)std::fprintf(stderr, "%s:\n%.*s\n", what, static_cast<int>(text.size()), text.data());
  std::abort();
}

// The part before the next separator, which is taken away.
std::string_view part(std::string_view& rest) {
  constexpr std::string_view separator = "---8<---\n";
  const std::size_t at = rest.find(separator);
  const std::string_view one = rest.substr(0, at);
  rest = at == std::string_view::npos ? std::string_view() : rest.substr(at + separator.size());
  return one;
}

void survives_writing(const deck::Node& tree) {
  const std::string once = deck::to_yaml(tree);
  const deck::Node again = deck::parse_yaml(once, "written");
  must(deck::to_yaml(again) == once, "a tree changes when it is written and read", once);
  must(deck::to_json(again).size() > 0, "no JSON", once);
}

void try_parts(std::string_view input) {
  static const deck::Files files(MPI_COMM_SELF);
  const auto& structure = deck::structure_of<Machine>();
  deck::Node root = deck::parse_yaml(part(input), "deck");
  if (const std::string_view table = part(input); !table.empty() && root.kind == deck::Node::Kind::map) {
    deck::Node over = deck::Node::map();
    over.set("rows", deck::parse_table(table, "table"));
    root = deck::merge(std::move(root), std::move(over));
  }
  survives_writing(root);
  while (!input.empty()) {
    const std::size_t end = input.find('\n');
    (void)deck::apply(deck::parse_edit(std::string(input.substr(0, end))), root, structure, files);
    input = end == std::string_view::npos ? std::string_view() : input.substr(end + 1);
  }
  deck::Problems problems;
  const auto machine = deck::read<Machine>(root, files, problems);
  problems.raise();
  const std::string resolved = deck::to_yaml(deck::write(machine));
  const auto again = deck::read<Machine>(deck::parse_yaml(resolved, "resolved"), files, problems);
  problems.raise();
  must(deck::to_yaml(deck::write(again)) == resolved, "a resolved deck reads as another one", resolved);
}

}  // namespace

void try_deck(std::string_view input) {
  // Other bytes never reach the deck room: files and arguments are checked as they come in.
  for (std::string_view rest = input; !rest.empty(); rest.remove_prefix(core::utf8_length(rest)))
    if (core::utf8_length(rest) == 0 || (core::begins_with_control(rest) && rest[0] >= 0 && rest[0] < 0x20)) return;
  try {
    try_parts(input);
  } catch (const core::InputError& e) {
    const std::string message = core::printable(e.what());
    must(core::printable(message) == message || message.size() > 200, "a message is not printable", message);
    must(std::string_view(e.what()).find("resolved:") != 0 && std::string_view(e.what()).find("written:") != 0,
         "what was written is refused", e.what());
  }
}

}  // namespace whirl::fuzz
