// One of several structs, chosen by an option: reading, errors, defaults, edits, paths, writing, schema, reference.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "whirl/core/error.hpp"
#include "whirl/deck/description.hpp"
#include "whirl/deck/edit.hpp"
#include "whirl/deck/load.hpp"
#include "whirl/deck/output.hpp"

namespace {

using namespace whirl;

struct Plate {
  static constexpr std::string_view key = "plate", text = "a flat plate";
  double thickness = 1e-3;
  std::array<int, 2> cells{60, 16};
  bool tilt = false;
};
void describe(deck::Description<Plate>& d) {
  d.add("thickness", &Plate::thickness, "m", deck::positive, "of the plate").continuable();
  d.add("cells", &Plate::cells, deck::positive, "cells along x and y");
  d.add("tilt", &Plate::tilt, "may it tilt?");
  d.check([](const Plate& p, const deck::Report& r) {
    if (p.cells[0] < p.cells[1]) r.fail("cells", "a plate is longer than it is wide");
  });
}

struct Spring {
  static constexpr std::string_view key = "spring", text = "a spring";
  double stiffness = 0;
};
void describe(deck::Description<Spring>& d) {
  d.add("stiffness", &Spring::stiffness, "N/m", deck::positive, "of the spring").required();
}

// Two kinds with the options of one base, and a mesh of their own.
struct Solid {
  double density = 7850;
  std::array<int, 3> cells{8, 6, 4};
};
void describe(deck::Description<Solid>& d) {
  d.add("density", &Solid::density, "kg/m^3", deck::positive, "of the solid").continuable().alias("rho");
  d.add("cells", &Solid::cells, deck::positive, "cells along x, y and z");
}
struct Brick : Solid {
  static constexpr std::string_view key = "brick", text = "a brick";
  bool tilt = false;
};
void describe(deck::Description<Brick>& d) {
  d.add("tilt", &Brick::tilt, "may it tilt?");
  d.inherit<Solid>();
}
struct Ball : Solid {
  static constexpr std::string_view key = "ball", text = "a ball";
  double radius = 0.5;
};
void describe(deck::Description<Ball>& d) {
  d.inherit<Solid>();
  d.add("radius", &Ball::radius, "m", deck::positive, "of the ball");
}

struct Body {
  std::variant<Plate, Spring, Brick, Ball> kind;
  std::string colour = "red";
};
void describe(deck::Description<Body>& d) {
  d.kinds("type", &Body::kind, "what it is");
  d.add("colour", &Body::colour, "that it has");
}
struct World {
  std::map<std::string, Body> bodies;
  std::vector<Body> list;
};
void describe(deck::Description<World>& d) {
  d.add("bodies", &World::bodies, "bodies by name");
  d.add("list", &World::list, "bodies in a row");
}

const deck::Files files(MPI_COMM_SELF);

World read(const deck::Node& root) {
  deck::Problems problems;
  auto w = deck::read<World>(root, files, problems);
  problems.raise();
  return w;
}
World read(const std::string& text) {
  return read(deck::parse_yaml(text, "d.yaml"));
}
std::string refusal(const std::string& body) {
  try {
    (void)read("bodies: {A: {" + body + "}}");
  } catch (const core::InputError& e) {
    return e.what();
  }
  return "accepted";
}

// Body A after the edits.
Body edited(const std::string& body, const std::vector<std::string>& edits) {
  deck::Node root = deck::parse_yaml("bodies: {A: {" + body + "}}", "d.yaml");
  for (const std::string& e : edits) (void)deck::apply(deck::parse_edit(e), root, deck::structure_of<World>(), files);
  return read(root).bodies.at("A");
}

const std::string all_kinds = R"(bodies:
  A: {}
  B: {type: spring, stiffness: 5 N/mm, colour: blue}
  C: {type: brick, cells: [1, 2, 3]}
  D: {rho: 1000 kg/m^3, type: ball}
)";

}  // namespace

TEST(Kinds, TheOneThatIsChosenIsRead) {
  const World w = read(all_kinds);
  EXPECT_EQ(std::get<Plate>(w.bodies.at("A").kind).cells[0], 60) << "the first where none is chosen";
  EXPECT_EQ(std::get<Spring>(w.bodies.at("B").kind).stiffness, 5000);
  EXPECT_EQ(w.bodies.at("B").colour, "blue");
  EXPECT_EQ(std::get<Brick>(w.bodies.at("C").kind).cells, (std::array<int, 3>{1, 2, 3}));
  EXPECT_EQ(std::get<Brick>(w.bodies.at("C").kind).density, 7850);
  EXPECT_EQ(std::get<Ball>(w.bodies.at("D").kind).density, 1000) << "the order of the deck does not matter";
}

TEST(Kinds, WhatDoesNotFitTheKindIsAnError) {
  EXPECT_EQ(refusal("type: sprng"), "d.yaml:1:20: 'type' cannot be 'sprng' (did you mean 'spring'?)");
  EXPECT_EQ(refusal("type: spring"), "d.yaml:1:13: 'A': 'stiffness' is missing (of the spring)");
  EXPECT_EQ(refusal("type: ball, stiffness: 1 N/m"), "d.yaml:1:26: 'stiffness' does not apply where type is ball");
  EXPECT_EQ(refusal("density: 1 kg/m^3"), "d.yaml:1:14: 'density' does not apply where type is plate");
  EXPECT_EQ(refusal("type: spring, stiffness: 1 N/m, cells: [1, 2]"),
            "d.yaml:1:46: 'cells' does not apply where type is spring");
  EXPECT_EQ(refusal("type: brick, cells: [1, 2]"), "d.yaml:1:34: 'cells' must have 3 items, not 2");
  EXPECT_EQ(refusal("type: brick, densty: 1 kg/m^3"), "d.yaml:1:27: unknown key 'densty' (did you mean 'density'?)");
  EXPECT_EQ(refusal("zzz: 1"),
            "d.yaml:1:14: unknown key 'zzz'; valid keys are type, thickness, cells, tilt, stiffness, density, radius, "
            "colour");
  EXPECT_EQ(refusal("cells: [2, 3]"), "d.yaml:1:21: a plate is longer than it is wide");
  EXPECT_EQ(refusal("type: brick, cells: [2, 3, 3]"), "accepted") << "what a plate minds";
}

TEST(Kinds, ResolvedDecksHoldTheOptionsOfTheKindInItsOrder) {
  const std::string resolved = deck::to_yaml(deck::write(read(all_kinds)));
  for (const char* line :
       {"  A:\n    type: plate\n    thickness: 0.001 m\n    cells: [60, 16]\n    tilt: false\n    colour: red\n",
        "  B: {type: spring, stiffness: 5000 N/m, colour: blue}\n",
        "  C:\n    type: brick\n    tilt: false\n    density: 7850 kg/m^3\n    cells: [1, 2, 3]\n    colour: red\n",
        "  D:\n    type: ball\n    density: 1000 kg/m^3\n    cells: [8, 6, 4]\n    radius: 0.5 m\n    colour: red\n"})
    EXPECT_NE(resolved.find(line), std::string::npos) << resolved << line;
  EXPECT_EQ(deck::to_yaml(deck::write(read(resolved))), resolved);
}

TEST(Kinds, OptionsAreFoundByTheirPath) {
  World w = read(all_kinds);
  const deck::Access a = deck::find_option(w, "bodies.D.density");
  EXPECT_EQ(*a.value, 1000);
  EXPECT_TRUE(a.continuable);
  *a.value = 2000;
  EXPECT_EQ(std::get<Ball>(w.bodies.at("D").kind).density, 2000);
  EXPECT_EQ(deck::find_option(w, "bodies.B.stiffness").unit, "N/m");
  for (const char* path : {"bodies.A.density", "bodies.B.radius", "bodies.A.type", "bodies.C.thickness"})
    EXPECT_THROW((void)deck::find_option(w, path), core::InputError) << path;
}

// The defaults and the number of cells are those of the kind that the deck chooses.
TEST(Kinds, EditsKnowTheKind) {
  EXPECT_EQ(std::get<Plate>(edited("", {"bodies.A.cells=x2"}).kind).cells, (std::array<int, 2>{120, 32}));
  EXPECT_EQ(std::get<Brick>(edited("type: brick", {"bodies.A.cells=x2"}).kind).cells, (std::array<int, 3>{16, 12, 8}));
  EXPECT_EQ(std::get<Brick>(edited("type: brick", {"bodies.A.cells.3=x2"}).kind).cells, (std::array<int, 3>{8, 6, 8}));
  EXPECT_EQ(std::get<Ball>(edited("", {"bodies.A.type=ball", "bodies.A.rho=+10 %", "bodies.*.radius=x3"}).kind).density,
            8635);
  EXPECT_EQ(std::get<Ball>(edited("type: ball, density: 2000 kg/m^3", {"bodies.A.rho=x2"}).kind).density, 4000);
  deck::Node root = deck::parse_yaml("list: [{}, {type: brick}]", "d.yaml");
  (void)deck::apply(deck::parse_edit("list.*.cells=x2"), root, deck::structure_of<World>(), files);
  EXPECT_EQ(std::get<Plate>(read(root).list[0].kind).cells[1], 32);
  EXPECT_EQ(std::get<Brick>(read(root).list[1].kind).cells[1], 12);
}

TEST(Kinds, TheSchemaOffersEachKindItsOptions) {
  const auto read = [](bool whole) {
    return nlohmann::json::parse(deck::to_json(deck::structure_of<Body>().schema(whole)));
  };
  const auto schema = read(true), part = read(false);
  ASSERT_EQ(schema["oneOf"].size(), 4U);
  const auto& plate = schema["oneOf"][0];
  const auto& brick = schema["oneOf"][2];
  EXPECT_EQ(plate["properties"]["type"]["const"], "plate");
  EXPECT_FALSE(plate.contains("required")) << "the default kind need not be chosen";
  EXPECT_EQ(brick["required"], nlohmann::json({"type"}));
  EXPECT_EQ(schema["oneOf"][1]["required"], nlohmann::json({"type", "stiffness"}));
  EXPECT_EQ(plate["properties"]["cells"]["maxItems"], 2);
  EXPECT_EQ(brick["properties"]["cells"]["maxItems"], 3);
  EXPECT_FALSE(plate["properties"].contains("density"));
  EXPECT_EQ(part["anyOf"][0]["properties"]["density"], nlohmann::json({{"type", "null"}}))
      << "of another kind: to take away what a base says";
  EXPECT_TRUE(brick["properties"].contains("colour"));
  EXPECT_EQ(brick["properties"]["density"]["default"], "7850 kg/m^3");
}

// A line that kinds share is one entry; lines that differ are entries of their own.
TEST(Kinds, TheReferenceNamesTheKinds) {
  const std::string help = deck::reference_text(deck::structure_of<World>(), "bodies");
  for (const char* entry :
       {"bodies.NAME.type\n    one of plate, spring, brick, ball; default plate\n    what it is\n      plate   a flat "
        "plate\n",
        "cells along x and y\n    applies where type is plate\n",
        "cells along x, y and z\n    applies where type is brick or ball\n",
        "default 7850 kg/m^3\n    of the solid\n    may be written 'rho'\n    "
        "applies "
        "where type is brick or ball\n    studies may vary it\n",
        "quantity in N/m, positive; required"})
    EXPECT_NE(help.find(entry), std::string::npos) << help << entry;
  EXPECT_TRUE(deck::undocumented(deck::structure_of<Plate>()).empty());
}
