#include "whirl/deck/description.hpp"

#include <gtest/gtest.h>

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
}

struct Machine {
  std::string title = "nothing";
  std::map<std::string, Geometry> bearings;
  std::optional<double> speed;
  deck::Range range{100, 200, "rpm"};
};
void describe(deck::Description<Machine>& d) {
  d.add("title", &Machine::title, "what it is");
  d.add("bearings", &Machine::bearings, "the bearings");
  d.add("speed", &Machine::speed, "rad/s", deck::positive, "shaft speed");
  d.add("range", &Machine::range, "rad/s", deck::positive, "speeds to cover");
}

Machine read_text(const std::string& text) {
  deck::Problems problems;
  auto m = deck::read<Machine>(deck::parse_yaml(text, "t.yaml"), deck::Files(MPI_COMM_SELF), problems);
  problems.raise();
  return m;
}

}  // namespace

TEST(Description, ReadsAndWritesBack) {
  const Machine m = read_text(
      "bearings:\n  B1: {clearance: 110 um}\n  B2: {type: lemon_bore, clearance: 0.4 mm, preload: 0.5, cells: [30, "
      "8]}\n"
      "speed: 3600 rpm\nrange: {from: 1000 rpm, to: 6000 rpm}\n");
  EXPECT_EQ(m.bearings.at("B1").clearance, 1.1e-4);
  EXPECT_EQ(m.bearings.at("B2").cells[1], 8);
  EXPECT_NEAR(*m.speed, 376.99111843, 1e-8);
  const std::string resolved = deck::to_yaml(deck::write(m));
  EXPECT_EQ(deck::to_yaml(deck::write(read_text(resolved))), resolved);
}
