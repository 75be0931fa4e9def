// One description line per option: reading, defaults, checks, errors with places, writing, schema, reference.

#include "whirl/deck/description.hpp"

#include <gtest/gtest.h>

#include "fuzz/tasks.hpp"
#include "whirl/deck/load.hpp"
#include "whirl/deck/output.hpp"

namespace {

using namespace whirl;

enum class Shape { arc, lemon };
std::span<const deck::Name<Shape>> names(Shape) {
  static constexpr deck::Name<Shape> table[] = {{Shape::arc, "partial_arc", "one pad"},
                                                {Shape::lemon, "lemon_bore", "two pads"}};
  return table;
}

struct Geometry {
  Shape type = Shape::arc;
  double clearance = 0;
  double preload = 0.25;
  std::array<int, 2> cells{60, 16};
};
void describe(deck::Description<Geometry>& d) {
  d.add("type", &Geometry::type, "shape of the bore");
  d.add("clearance", &Geometry::clearance, "m", deck::positive, "radial clearance").required().continuable();
  d.add("preload", &Geometry::preload, deck::in(0, 1), "1 - c_b/c_p").only(&Geometry::type, {Shape::lemon});
  d.add("cells", &Geometry::cells, deck::positive, "cells around and along");
  d.check([](const Geometry& g, const deck::Report& r) {
    if (g.type == Shape::lemon && g.cells[0] < 10) r.fail("cells.1", "a lemon bore needs ten cells");
  });
}

struct Stand {
  double radius = 1;
  std::array<double, 2> mass{1, 2};
  std::array<double, 4> damping{1, 2, 3, 4};
};
void describe(deck::Description<Stand>& d) {
  d.add("radius", &Stand::radius, "m", deck::positive, "radius of the foot", "004 table 1")
      .alias("diameter", 2)
      .alias("half_width");
  d.add("mass", &Stand::mass, "kg", deck::non_negative, "mass in x and y").isotropic();
  d.add("damping", &Stand::damping, "N s/m", deck::any, "coefficients xx, xy, yx, yy").isotropic();
}

struct Oil {
  double viscosity = 0;
};
void describe(deck::Description<Oil>& d) {
  d.add("viscosity", &Oil::viscosity, "Pa s", deck::positive, "dynamic viscosity").required().continuable();
}

struct Point {
  double temperature = 293.15;
  double modulus = 0;
};

struct Machine {
  std::string title = "nothing";
  std::vector<Geometry> list;
  std::map<std::string, Geometry> bearings;
  std::optional<double> speed;
  deck::Range range{100, 200, "rpm"};
  std::variant<std::string, Oil> oil;
  std::vector<Point> modulus;
  std::vector<deck::Quantity> speeds;
  std::vector<std::string> words;
  std::vector<std::unique_ptr<fuzz::Task>> tasks;
  bool flag = true;
};
void describe(deck::Description<Machine>& d) {
  d.add("title", &Machine::title, "what it is about");
  d.add("list", &Machine::list, "a list of structs");
  d.add("bearings", &Machine::bearings, "the bearings");
  d.add("speed", &Machine::speed, "rad/s", deck::positive, "shaft speed").continuable();
  d.add("range", &Machine::range, "rad/s", deck::positive, "speeds to cover");
  d.add("oil", &Machine::oil, "name or own oil");
  d.table_or_scalar(
      "modulus", &Machine::modulus, "modulus",
      [](deck::Description<Point>& row) {
        row.add("temperature", &Point::temperature, "K", deck::positive, "temperature").required();
        row.add("modulus", &Point::modulus, "Pa", deck::positive, "Young's modulus").required();
      },
      "over temperature");
  d.add("speeds", &Machine::speeds, "rad/s", deck::positive, "single speeds");
  d.add("words", &Machine::words, "any words");
  d.choices("tasks", &Machine::tasks, fuzz::kinds_of_tasks(), "what to do");
  d.add("flag", &Machine::flag, "yes or no");
}

const deck::Files files(MPI_COMM_SELF);

Machine read(const std::string& text) {
  deck::Problems problems;
  auto m = deck::read<Machine>(deck::parse_yaml(text, "d.yaml"), files, problems);
  problems.raise();
  return m;
}

std::string refusal(const std::string& text) {
  try {
    (void)read(text);
  } catch (const core::InputError& e) {
    return e.what();
  }
  return "accepted";
}

const std::string everything = R"(title: "3"
list: [{clearance: 1 mm}]
bearings:
  B1: {clearance: 110 um}
  B2: {type: lemon_bore, clearance: 0.4 mm, preload: 0.5, cells: [30, 8]}
speed: 3600 rpm
range: {from: 1000 rpm, to: 6000 rpm}
oil: {viscosity: 20 cP}
modulus: 210 GPa
speeds: [600 rpm, 10 rev/s]
words: [yes, "null", 'with: colon']
tasks:
  - wait: {time: 2 min}
  - wait:
flag: false
)";

}  // namespace

TEST(Description, ReadsEveryType) {
  const Machine m = read(everything);
  EXPECT_EQ(m.title, "3");
  EXPECT_EQ(m.list.at(0).clearance, 1e-3);
  EXPECT_EQ(m.bearings.at("B1").clearance, 1.1e-4);
  EXPECT_EQ(m.bearings.at("B1").cells[0], 60);
  EXPECT_EQ(m.bearings.at("B2").type, Shape::lemon);
  EXPECT_EQ(m.bearings.at("B2").cells[1], 8);
  EXPECT_NEAR(*m.speed, 376.991118430775, 1e-11);
  EXPECT_EQ(m.range.unit, "rpm");
  EXPECT_NEAR(m.range.to, 628.318530717959, 1e-11);
  EXPECT_EQ(std::get<Oil>(m.oil).viscosity, 0.02);
  ASSERT_EQ(m.modulus.size(), 1U);
  EXPECT_EQ(m.modulus[0].modulus, 210e9);
  EXPECT_EQ(m.speeds[1].unit, "rev/s");
  EXPECT_EQ(m.words[2], "with: colon");
  ASSERT_EQ(m.tasks.size(), 2U);
  EXPECT_EQ(dynamic_cast<fuzz::Wait&>(*m.tasks[0]).options.time, 120);
  EXPECT_EQ(dynamic_cast<fuzz::Wait&>(*m.tasks[1]).options.time, 1);
  EXPECT_FALSE(m.flag);
}

TEST(Description, OtherWordsAndOneValueForAll) {
  const auto stand = [](const std::string& text) {
    deck::Problems problems;
    auto s = deck::read<Stand>(deck::parse_yaml(text, "d.yaml"), files, problems);
    problems.raise();
    return s;
  };
  const auto wrong = [&](const std::string& text) -> std::string {
    try {
      (void)stand(text);
    } catch (const core::InputError& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_EQ(stand("diameter: 180 mm").radius, 0.09);
  EXPECT_EQ(stand("half_width: 180 mm").radius, 0.18);
  EXPECT_EQ(stand("mass: 3 t").mass, (std::array<double, 2>{3000, 3000}));
  EXPECT_EQ(stand("mass: [3 kg, 4 kg]").mass, (std::array<double, 2>{3, 4}));
  EXPECT_EQ(stand("damping: 5 N s/m").damping, (std::array<double, 4>{5, 0, 0, 5}));
  EXPECT_EQ(wrong("diameter: 1 m\nradius: 2 m"),
            "d.yaml:1:1: 'diameter' says the same as 'radius', which d.yaml:2:1 gives: keep one of them");
  EXPECT_EQ(wrong("diametre: 1 m"), "d.yaml:1:1: unknown key 'diametre' (did you mean 'diameter'?)")
      << "not the radius, which is half of it";
  EXPECT_EQ(wrong("radiu: 1 kg").find("did you mean"), std::string::npos) << "a mass is no radius";
  EXPECT_EQ(wrong("diameter: -1 m"), "d.yaml:1:11: 'diameter' must be positive, not -0.5 m");
  EXPECT_NE(wrong("mass: [1 kg]").find("'mass' must have 2 items, not 1"), std::string::npos);
  EXPECT_EQ(wrong("mass: 1e-300 kg"),
            "d.yaml:1:7: 'mass' cannot be as small as 1e-300 kg: 0, or 1e-12 to 1e10 kg in size");
  const std::string help = deck::reference_text(deck::structure_of<Stand>(), "diameter", {{{"004", "the thesis"}}});
  EXPECT_NE(help.find("radius\n"), std::string::npos) << help;
  EXPECT_NE(help.find("may be given as 'diameter', 2 times the value"), std::string::npos) << help;
  EXPECT_NE(help.find("[004] the thesis"), std::string::npos) << help;
}

TEST(Description, HelpSaysWhatEachValueOfAChoiceMeans) {
  const std::string help = deck::reference_text(deck::structure_of<Machine>(), "bearings.type");
  EXPECT_NE(help.find("      partial_arc  one pad\n      lemon_bore   two pads\n"), std::string::npos) << help;
  EXPECT_NE(deck::reference_text(deck::structure_of<Machine>(), "lemon_bore").find("bearings.NAME.type"),
            std::string::npos);
}

TEST(Description, ResolvedDecksAreReadAlikeByYaml11) {
  Machine m;
  m.title = "0x1F";
  m.words = {"on", "2001-01-01", "1e5", "12:30:45", "plain", "1_000", ".5", "60 um"};
  m.speeds = {{1e-5, "1"}};
  const std::string text = deck::to_yaml(deck::write(m));
  EXPECT_NE(text.find(R"(words: ["on", "2001-01-01", "1e5", "12:30:45", plain, "1_000", ".5", 60 um])"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find(R"(title: "0x1F")"), std::string::npos) << text;
  EXPECT_NE(text.find("speeds: [1.0e-5]"), std::string::npos) << text;
  EXPECT_NE(deck::to_yaml(deck::parse_yaml("a: 1e9\nb: -2.5e-7\n", "d")).find("a: 1.0e+9\nb: -2.5e-7"),
            std::string::npos);
}

TEST(Description, ResolvedDeckReadsBackIdentically) {
  const std::string resolved = deck::to_yaml(deck::write(read(everything)));
  EXPECT_EQ(deck::to_yaml(deck::write(read(resolved))), resolved);
  EXPECT_NE(resolved.find("range: {from: 1000 rpm, to: 6000 rpm}"), std::string::npos) << resolved;
  EXPECT_NE(resolved.find("B1: {type: partial_arc, clearance: 0.00011 m, cells"), 0U);
  EXPECT_EQ(resolved.find("preload: 0.25"), std::string::npos) << "options that do not apply are left out";
  const std::string defaults = deck::to_yaml(deck::write(Machine{}));
  EXPECT_NE(defaults.find("title: nothing"), std::string::npos);
  EXPECT_EQ(defaults.find("speed: "), std::string::npos) << "optional values have no default";
}

TEST(Description, ErrorsHaveAPlaceAndAHint) {
  EXPECT_EQ(refusal("titel: x\n"), "d.yaml:1:1: unknown key 'titel' (did you mean 'title'?)");
  EXPECT_EQ(refusal("bearings: {B1: {}}\n"), "d.yaml:1:16: 'B1': 'clearance' is missing (radial clearance)");
  EXPECT_EQ(refusal("list: [{clearance: 1 mm}, {clearance: 0 mm}]\n"),
            "d.yaml:1:39: 'clearance' must be positive, not 0 mm");
  EXPECT_EQ(refusal("list: {}\n"), "d.yaml:1:7: 'list' must be a list, each item a map");
  EXPECT_EQ(refusal("title: [1]\n"), "d.yaml:1:8: 'title' is a list: expected text");
  EXPECT_EQ(refusal("title:\n").find("d.yaml:"), 0U);
  EXPECT_EQ(refusal("flag: on\n"), "d.yaml:1:7: 'flag' must be true or false, not on");
  EXPECT_EQ(refusal("bearings: {'1.2': {clearance: 1 m}}\n"),
            "d.yaml:1:12: '1.2' is not a name: letters, digits, _ and -, starting with a letter");
  EXPECT_EQ(refusal("range: {from: 1 rpm, to: 2 rpm, by: 1}\n"), "d.yaml:1:33: unknown key 'by'");
  EXPECT_EQ(refusal("range: 3 rpm\n"), "d.yaml:1:8: 'range' is written {from: ..., to: ...}");
  EXPECT_EQ(refusal("tasks: [{wiat: {}}]\n"), "d.yaml:1:10: unknown kind 'wiat' (did you mean 'wait'?)");
  EXPECT_EQ(refusal("bearings: {B: {clearance: 1 m, type: lemon_bore, cells: [8, 8]}}\n"),
            "d.yaml:1:58: a lemon bore needs ten cells");
}

TEST(Description, AllProblemsAreToldInOrder) {
  EXPECT_EQ(
      refusal("titel: x\nspeed: 60 Hz\nflag: 1\n"),
      "d.yaml:1:1: unknown key 'titel' (did you mean 'title'?)\n"
      "d.yaml:2:8: 'speed': 'Hz' does not fit: expected a speed such as 3600 rpm or 377 rad/s (a frequency is not a "
      "speed: 1 Hz is 60 rpm)\n"
      "d.yaml:3:7: 'flag' must be true or false, not 1");
}

TEST(Description, OptionsAreFoundByTheirPath) {
  Machine m = read(everything);
  const deck::Access a = deck::find_option(m, "bearings.B2.clearance");
  EXPECT_EQ(*a.value, 4e-4);
  EXPECT_EQ(a.unit, "m");
  EXPECT_TRUE(a.continuable);
  *a.value = 5e-4;
  EXPECT_EQ(m.bearings.at("B2").clearance, 5e-4);
  EXPECT_FALSE(deck::find_option(m, "bearings.B2.preload").continuable);
  EXPECT_EQ(*deck::find_option(m, "list.1.clearance").value, 1e-3);
  EXPECT_EQ(*deck::find_option(m, "oil.viscosity").value, 0.02);
  EXPECT_TRUE(deck::find_option(m, "speed").continuable);
  for (const char* path : {"title", "bearings", "bearings.B2.cells", "bearings.B2.cells.1", "bearings.B3.clearance",
                           "bearings.B1.preload", "list.2.clearance", "spede", "modulus.1.modulus", ""})
    EXPECT_THROW((void)deck::find_option(m, path), core::InputError) << path;
}

TEST(Description, ReferenceExplainsEveryOption) {
  const std::string all = deck::reference_text(deck::structure_of<Machine>(), "");
  EXPECT_NE(all.find("bearings.NAME.clearance\n    quantity in m, positive; required\n   "
                     " radial clearance\n"
                     "    studies may vary it\n"),
            std::string::npos)
      << all;
  EXPECT_NE(all.find("tasks.1.wait.time\n    quantity in s, positive; default 1 s\n"), std::string::npos) << all;
  const std::string one = deck::reference_text(deck::structure_of<Machine>(), "bearings.B7.preload");
  EXPECT_EQ(one.find("bearings.NAME.preload\n"), 0U);
  EXPECT_EQ(deck::reference_text(deck::structure_of<Machine>(), "bearings.preload"), one) << "the name left out";
  EXPECT_NE(one.find("applies where type is lemon_bore"), std::string::npos);
  EXPECT_EQ(deck::reference_text(deck::structure_of<Machine>(), "preload"),
            deck::reference_text(deck::structure_of<Machine>(), "list.1.preload") + one);
  EXPECT_THROW((void)deck::reference_text(deck::structure_of<Machine>(), "bearings.B1.clearence"), core::InputError);
}
