// Changes of a deck's values: paths with wildcards, factors, offsets, things appended.

#include "whirl/deck/edit.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "whirl/core/error.hpp"
#include "whirl/deck/description.hpp"
#include "whirl/deck/load.hpp"
#include "whirl/deck/output.hpp"

namespace {

using namespace whirl;
namespace fs = std::filesystem;

struct Bore {
  double clearance = 1e-4;
  double radius = 0.1;
  double temperature = 333.15;
  std::array<int, 2> cells{60, 16};
};
void describe(deck::Description<Bore>& d) {
  d.add("clearance", &Bore::clearance, "m", deck::positive, "radial clearance");
  d.add("radius", &Bore::radius, "m", deck::positive, "radius of the journal").alias("diameter", 2).alias("bore", 2);
  d.add("temperature", &Bore::temperature, "K", deck::positive, "temperature of the oil");
  d.add("cells", &Bore::cells, deck::positive, "cells around and along");
}
struct Support {
  Bore geometry;
  double elevation = 0;
  std::array<double, 2> stiffness{1e9, 1.5e9};
  std::optional<double> mass;
};
void describe(deck::Description<Support>& d) {
  d.add("geometry", &Support::geometry, "shape of the bore");
  d.add("elevation", &Support::elevation, "m", deck::any, "height of the centre");
  d.add("stiffness", &Support::stiffness, "N/m", deck::positive, "stiffness in x and in y");
  d.add("mass", &Support::mass, "kg", deck::positive, "mass that moves");
}
struct Row {
  double length = 0;
  double outer = 0;
};
void describe(deck::Description<Row>& d) {
  d.add("length", &Row::length, "m", deck::positive, "length").required();
  d.add("outer", &Row::outer, "m", deck::positive, "outer diameter").required().alias("diameter");
}
struct Machine {
  std::string title = "nothing";
  std::map<std::string, Support> bearings;
  std::vector<Row> segments;
  std::vector<deck::Quantity> speeds;
  deck::Range range{100, 200, "rpm"};
  double tolerance = 1e-6;
};
void describe(deck::Description<Machine>& d) {
  d.add("title", &Machine::title, "what it is about");
  d.add("bearings", &Machine::bearings, "the bearings");
  d.table("segments", &Machine::segments, "the shaft");
  d.add("speeds", &Machine::speeds, "rad/s", deck::positive, "single speeds");
  d.add("range", &Machine::range, "*", deck::any, "what to cover");
  d.add("tolerance", &Machine::tolerance, deck::positive, "of Newton's method");
}

const deck::Files files(MPI_COMM_SELF);

const std::string text = R"(bearings:
  B1: {geometry: {clearance: 180 um, temperature: 60 degC}}
  B2: {geometry: {clearance: 0.4 mm}, elevation: -20 um}
  B3: {stiffness: [2e9 N/m, 3e9 N/m]}
segments: [{length: 1 m, outer: 200 mm}, {length: 2 m, outer: 300 mm}]
speeds: [600 rpm]
)";

deck::Node root_of(const std::string& argument, std::vector<deck::Change>* changes = nullptr) {
  deck::Node root = deck::parse_yaml(text, "d.yaml");
  const auto done = deck::apply(deck::parse_edit(argument), root, deck::structure_of<Machine>(), files);
  if (changes) *changes = done;
  return root;
}

Machine after(const std::string& argument) {
  deck::Problems problems;
  auto m = deck::read<Machine>(root_of(argument), files, problems);
  problems.raise();
  return m;
}

std::string refusal(const std::string& argument) {
  try {
    (void)after(argument);
  } catch (const core::InputError& e) {
    return e.what();
  }
  return "accepted";
}

}  // namespace

TEST(Edit, ReplacesWhatThePathNames) {
  EXPECT_EQ(after("bearings.B1.geometry.clearance=200 um").bearings["B1"].geometry.clearance, 2e-4);
  EXPECT_EQ(after("bearings.B3.geometry.clearance=200 um").bearings["B3"].geometry.clearance, 2e-4);
  EXPECT_EQ(after("segments.2.outer=0.5 m").segments[1].outer, 0.5);
  EXPECT_EQ(after("bearings.B2.elevation=").bearings["B2"].elevation, 0) << "an empty value brings the default back";
  EXPECT_EQ(after("bearings.B2.elevation==-30 um").bearings["B2"].elevation, -3e-5);
  EXPECT_EQ(after("title=x1.2").title, "x1.2") << "text is text";
}

TEST(Edit, FactorsMultiplyTheValueOrItsDefault) {
  EXPECT_EQ(after("bearings.B1.geometry.clearance=x1.2").bearings["B1"].geometry.clearance, 216e-6);
  EXPECT_EQ(after("bearings.B3.geometry.clearance=x1.2").bearings["B3"].geometry.clearance, 1.2e-4);
  EXPECT_EQ(after("bearings.B1.geometry.clearance=+20 %").bearings["B1"].geometry.clearance, 216e-6);
  EXPECT_EQ(after("bearings.B1.geometry.clearance=-20 %").bearings["B1"].geometry.clearance, 144e-6);
  EXPECT_EQ(after("tolerance=x0.1").tolerance, 1e-7);
  const Machine lists = after("bearings.{B1,B3}.stiffness=x0.1");
  EXPECT_EQ(lists.bearings.at("B3").stiffness, (std::array<double, 2>{2e8, 3e8}));
  EXPECT_EQ(lists.bearings.at("B1").stiffness, (std::array<double, 2>{1e8, 1.5e8})) << "each item of the default";
  EXPECT_EQ(after("bearings.B1.geometry.cells.1=x1.1").bearings["B1"].geometry.cells[0], 66) << "not 66.00000000000001";
  EXPECT_NEAR(after("range.to=x2").range.to, 400, 1e-10);
}

// Both words at once would be an error of the reader.
TEST(Edit, AnotherWordForAnOptionIsThatOption) {
  const auto radius = [](const std::vector<std::string>& edits) {
    deck::Node root = deck::parse_yaml(
        "bearings:\n  B1: {geometry: {clearance: 1 um}}\nsegments: [{length: 1 m, outer: 1 m}]\n", "d.yaml");
    for (const std::string& e : edits)
      (void)deck::apply(deck::parse_edit(e), root, deck::structure_of<Machine>(), files);
    deck::Problems problems;
    const auto m = deck::read<Machine>(root, files, problems);
    problems.raise();
    return m.bearings.at("B1").geometry.radius;
  };
  const std::string g = "bearings.B1.geometry.";
  EXPECT_NEAR(radius({g + "radius=200 mm", g + "diameter=x1.1"}), 0.22, 1e-15);
  EXPECT_NEAR(radius({g + "diameter=500 mm", g + "radius=x1.1"}), 0.275, 1e-15);
  EXPECT_NEAR(radius({g + "diameter=500 mm", g + "bore=by +10 mm"}), 0.255, 1e-15);
  EXPECT_NEAR(radius({g + "diameter=x1.1"}), 0.11, 1e-15) << "from the default, of which it is twice the value";
  EXPECT_EQ(radius({g + "radius=200 mm", g + "diameter=300 mm"}), 0.15);
  EXPECT_EQ(radius({g + "radius=200 mm", g + "diameter="}), 0.1) << "taken away";
  const Machine m = after("segments.*.diameter=x2");
  EXPECT_EQ(m.segments[0].outer, 0.4);
  EXPECT_EQ(m.segments[1].outer, 0.6);
  EXPECT_NE(refusal(g + "diametre=x2").find("did you mean"), std::string::npos);
  EXPECT_NE(refusal(g + "diameter=x2 mm").find("a factor is a bare number"), std::string::npos);
}

TEST(Edit, OffsetsAreInAnyUnitOfTheKind) {
  EXPECT_EQ(after("bearings.B1.geometry.clearance=by +500 um").bearings["B1"].geometry.clearance, 680e-6);
  EXPECT_EQ(after("bearings.B1.geometry.clearance=by 500 um").bearings["B1"].geometry.clearance, 680e-6);
  EXPECT_EQ(after("bearings.B1.geometry.clearance=by -0.02 mm").bearings["B1"].geometry.clearance, 160e-6);
  EXPECT_EQ(after("bearings.B2.elevation=by +500 um").bearings["B2"].elevation, 480e-6);
  EXPECT_EQ(after("bearings.B2.elevation=by -20 um").bearings["B2"].elevation, -4e-5);
  EXPECT_EQ(after("bearings.B1.elevation+=5 um").bearings["B1"].elevation, 5e-6) << "what += is for a number";
  EXPECT_NEAR(after("bearings.B1.geometry.temperature=by +20 K").bearings["B1"].geometry.temperature, 353.15, 1e-12);
  EXPECT_NEAR(after("speeds.1=by +10 rev/s").speeds[0].value, 40 * std::numbers::pi, 1e-12);
  EXPECT_EQ(after("speeds.1=by +10 rev/s").speeds[0].unit, "rpm") << "the value keeps its unit";
}

// A sign is part of the value; for one version a length with a sign is refused where it was a change before.
TEST(Edit, ASignIsPartOfTheValue) {
  EXPECT_EQ(after("bearings.B1.elevation=-20 um").bearings["B1"].elevation, -2e-5);
  EXPECT_EQ(after("bearings.B1.elevation=+20 um").bearings["B1"].elevation, 2e-5);
  EXPECT_EQ(after("bearings.B2.elevation==+30 um").bearings["B2"].elevation, 3e-5);
  EXPECT_EQ(after("speeds.1=+10 rev/s").speeds[0].value, 20 * std::numbers::pi);
  EXPECT_EQ(after("range.from=-10 rpm").range.from, -after("range.from=10 rpm").range.from);
  EXPECT_EQ(after("bearings.B1.geometry.cells.1=+66").bearings["B1"].geometry.cells[0], 66);
  for (const std::string sign : {"-", "+"})
    EXPECT_EQ(refusal("bearings.B1.geometry.clearance=" + sign + "20 um"),
              "--set bearings.B1.geometry.clearance=" + sign + "20 um: '" + sign +
                  "20 um' could be a change of the value here, 180 um, or the value itself: write 'by " + sign +
                  "20 um' to change it, '=" + sign + "20 um' for the value itself");
  EXPECT_NE(refusal("bearings.B3.geometry.clearance=+20 um").find("the value here, 0.0001 m"), std::string::npos)
      << "the default counts";
}

TEST(Edit, WildcardsNameSeveralEachByItsOwnValue) {
  std::vector<deck::Change> changes;
  const deck::Node root = root_of("bearings.*.geometry.clearance=x2", &changes);
  ASSERT_EQ(changes.size(), 3U);
  EXPECT_EQ(changes[0].path, "bearings.B1.geometry.clearance");
  EXPECT_EQ(changes[0].before, "180 um");
  EXPECT_EQ(changes[0].after, "360 um");
  EXPECT_EQ(changes[1].after, "0.8 mm");
  EXPECT_EQ(changes[2].before, "0.0001 m");
  EXPECT_EQ(after("bearings.{B1, B3}.elevation=+1 mm").bearings["B2"].elevation, -2e-5);
  EXPECT_EQ(after("segments.*.outer=x2").segments[0].outer, 0.4);
  EXPECT_EQ(after("segments.{2}.outer=x2").segments[0].outer, 0.2);
  EXPECT_EQ(after("b*.B{1,2}.geometry={clearance: 7 um}").bearings["B2"].geometry.clearance, 7e-6);
  EXPECT_EQ(after("b*r*g*.*1.geo*.cl*=1 um").bearings["B1"].geometry.clearance, 1e-6);
  EXPECT_NE(refusal("b*" + std::string(40, '*') + "*x*y*bearingsbearings*z=1").find("no key fits"), std::string::npos);
  EXPECT_EQ(root_of("bearings.*=").find("bearings")->items.size(), 0U) << "all are taken away";
}

TEST(Edit, ListsGrow) {
  EXPECT_EQ(after("segments+={length: 3 m, outer: 1 m}").segments.at(2).length, 3);
  EXPECT_EQ(after("speeds+=[700 rpm, 800 rpm]").speeds.size(), 3U);
  EXPECT_EQ(after("speeds+=700 rpm").speeds.at(1).unit, "rpm");
  EXPECT_EQ(after("bearings+={B9: {elevation: 1 um}}").bearings.size(), 4U);
  EXPECT_EQ(refusal("title+=more"), "--set title+=more: nothing can be appended to 'title', which is no list");
}

TEST(Edit, TablesAreReplacedChangedAndExtended) {
  const fs::path folder = fs::temp_directory_path() / ("whirl_edit_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const std::string table = (folder / "t.csv").string();
  std::ofstream(table) << "length [m],outer [mm]\n1,100\n2,200\n3,300\n";
  EXPECT_EQ(after("segments=" + table).segments.size(), 3U);
  std::ofstream(folder / "deck.yaml") << "segments: t.csv\n";
  const auto load = [&](const std::vector<std::string>& edits) {
    deck::Problems problems;
    auto m = deck::read<Machine>(
        deck::load((folder / "deck.yaml").string(), edits, files, deck::structure_of<Machine>()), files, problems);
    problems.raise();
    return m;
  };
  EXPECT_EQ(load({"segments.*.outer=x1.5", "segments.2.length=by +1 m"}).segments[1].outer, 0.3);
  EXPECT_EQ(load({"segments+={length: 4 m, outer: 1 m}"}).segments.size(), 4U);
  fs::remove_all(folder);
}

TEST(Edit, ErrorsCiteTheArgument) {
  EXPECT_EQ(refusal("bearings.B1.geometry.clearance=by -180 um"),
            "--set bearings.B1.geometry.clearance=by -180 um: 'clearance' must be positive, not 0 um");
  EXPECT_EQ(refusal("bearings.B1.mass=x2"),
            "--set bearings.B1.mass=x2: 'bearings.B1.mass' has no value to start from: the deck does not give it");
  // Of what is not there nothing is changed: a new one is not begun by a factor.
  EXPECT_NE(refusal("bearings.Q.mass=x2").find("there is no 'bearings.Q'; there are "), std::string::npos)
      << refusal("bearings.Q.mass=x2");
  EXPECT_NE(refusal("bearings.B1.mass=*2").find("'*2' is no value: a factor is written x2"), std::string::npos);
  for (const std::string text : {"*2", "/2", "/.5", "/1.5e3"})
    EXPECT_NE(refusal("title=" + text).find("is no value: a factor"), std::string::npos) << text;
  for (const std::string path : {"/2024/seal.csv", "/.cache/seal.csv", "/3d.csv"})
    EXPECT_EQ(deck::parse_edit("title=" + path, "--set").value.text, path);
  EXPECT_NE(refusal("bearings.B1.elevation=by 5").find("has no unit: expected a length"), std::string::npos);
  EXPECT_NE(refusal("bearings.B1.elevation=+5 kg").find("expected a length"), std::string::npos);
  EXPECT_NE(refusal("bearings.B1.elevation=x5 um").find("a factor is a bare number"), std::string::npos);
  EXPECT_NE(refusal("bearings.B1.geometry.temperature=x2").find("write it in K"), std::string::npos);
  EXPECT_NE(refusal("bearings.B1.geometry.temperature=by +20 degC").find("temperature difference"), std::string::npos);
  EXPECT_NE(refusal("bearings.B1.geometry.cells.1=x1.01").find("whole number, not 60.6"), std::string::npos);
  EXPECT_EQ(refusal("bearings.C*.elevation=x2"), "--set bearings.C*.elevation=x2: nothing in 'bearings' fits 'C*'");
  EXPECT_EQ(refusal("bearings.{B1,B2.elevation=x2"),
            "--set bearings.{B1,B2.elevation=x2: the braces of the path do not match");
  EXPECT_NE(refusal("bearings.{B1,B22}.elevation=x2").find("there is no 'B22' (did you mean 'B2'?)"),
            std::string::npos);
  EXPECT_NE(refusal("segments.7.outer=x2").find("'segments' has items 1 to 2, not '7'"), std::string::npos);
  EXPECT_NE(refusal("range=x2").find("is a map"), std::string::npos);
  EXPECT_NE(refusal("bearings.B3.stiffness=x1e308").find("not a finite number"), std::string::npos);
}

TEST(Edit, OfADeckKeepsThePlaceInIt) {
  deck::Node root = deck::parse_yaml(text, "d.yaml");
  const deck::Node values = deck::parse_yaml("values: [x2, by +1 um, 5 kg]\n", "sweep.yaml");
  for (const deck::Node& value : values.find("values")->items)
    (void)deck::apply(deck::make_edit("bearings.B1.geometry.clearance", value), root, deck::structure_of<Machine>(),
                      files);
  deck::Problems problems;
  (void)deck::read<Machine>(root, files, problems);
  EXPECT_THROW(
      {
        try {
          problems.raise();
        } catch (const core::InputError& e) {
          EXPECT_EQ(std::string(e.what()).find("sweep.yaml:1:24: 'clearance'"), 0U) << e.what();
          throw;
        }
      },
      core::InputError);
}
