// Bending of shafts: closed forms of moments, and the deck of the pump against statics.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "rigid_rotor/run_deck.hpp"
#include "rotor/shafts.hpp"
#include "source_dir.hpp"
#include "study/common.hpp"
#include "study/linear/synchronous.hpp"
#include "study/stress/bending.hpp"
#include "whirl/film/contract/linear.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::study {
namespace {

using std::numbers::pi;

constexpr double length = 1.2, diameter = 0.06, bore = 0.03, young = 2.1e11, g = 9.81;
constexpr double modulus =
                     pi * (diameter * diameter * diameter * diameter - bore * bore * bore * bore) / (32 * diameter),
                 bending = young * modulus * diameter / 2;

// A hollow shaft between two bearings at its ends, with a disc and its unbalance in the middle.
system::Train shaft(double density, double disc, double unbalance, std::array<double, 2> spring) {
  system::Train train;
  train.gravity = g;
  train.rotor = test::uniform_shaft(length, diameter, 10, young, density, bore);
  train.rotor.element = rotor::BeamElement::rayleigh;
  train.rotor.discs.push_back({.node = 6, .mass = disc});
  for (const int node : {1, 11}) {
    system::Support s;
    s.name = "B" + std::to_string(node);
    s.node = node;
    film::Linear film;
    film.stiffness = {spring[0], 0, 0, spring[1]};
    s.film = film;
    train.supports.push_back(s);
  }
  train.unbalance.push_back({.node = 6, .amount = unbalance});
  return train;
}

// Ends of segments, left and right of the middle at [9] and [10].
std::vector<BendingAt> bent(const system::Train& train, double speed) {
  system::RotorSystem system(PETSC_COMM_WORLD, train, speed);
  Walker walker(system);
  Vec x = walker.at(speed);
  solve::FrequencyResolvent solver(system);
  const auto state = synchronous_response(system, solver, x, speed);
  return bending_of(train.rotor, system.shaft(x, 0, true), {0, -train.gravity},
                    {system.shaft(state[0].data(), 0, false), system.shaft(state[1].data(), 0, false)}, speed);
}

TEST(Stress, OfALoadInTheMiddleAndOfItsOwnWeight) {
  constexpr double density = 7850, disc = 40;
  const double q = density * pi / 4 * (diameter * diameter - bore * bore) * g,
               moment = disc * g * length / 4 + q * length * length / 8;
  const std::vector<BendingAt> ends = bent(shaft(density, disc, 0, {1e9, 1e9}), 10);
  ASSERT_EQ(ends.size(), 20U);
  for (const std::size_t k : {9U, 10U}) {
    EXPECT_EQ(ends[k].node, 6);
    EXPECT_NEAR(ends[k].still.imag(), moment, 1e-6 * moment) << "sagging is positive";
    EXPECT_NEAR(std::abs(ends[k].still.real()), 0, 1e-6 * moment);
    EXPECT_NEAR(ends[k].alternating(), moment / modulus, 1e-6 * moment / modulus);
    EXPECT_NEAR(ends[k].mean(), 0, 1e-9 * moment / modulus);
  }
  EXPECT_NEAR(ends.front().shear.imag(), (disc * g + q * length) / 2, 1e-6 * disc * g);
  EXPECT_NEAR(ends[9].shear.imag(), disc * g / 2, 1e-6 * disc * g);
  EXPECT_NEAR(ends[10].shear.imag(), -disc * g / 2, 1e-6 * disc * g);
  EXPECT_NEAR(ends.front().still.imag(), 0, 1e-6 * moment);
}

// Without mass the shaft is a spring of 48 E I/L^3 between those of the bearings: in each plane the force of the disc
// is U w^2/(1 - w^2 m/k). Springs that differ make part of the motion go backward.
TEST(Stress, OfUnbalanceInBearingsThatDiffer) {
  constexpr double disc = 40, unbalance = 4e-3, speed = 120;
  const std::array<double, 2> spring{4e6, 9e5};
  std::array<double, 2> moment{};
  for (std::size_t d = 0; d < 2; ++d) {
    const double k = 1 / (length * length * length / (48 * bending) + 1 / (2 * spring[d]));
    moment[d] = unbalance * speed * speed / (1 - disc * speed * speed / k) * length / 4;
  }
  const double still = disc * g * length / 4, forward = std::abs(moment[0] + moment[1]) / 2,
               backward = std::abs(moment[0] - moment[1]) / 2;
  ASSERT_GT(backward, 0.1 * forward);
  const BendingAt at = bent(shaft(1e-3, disc, unbalance, spring), speed)[9];
  EXPECT_NEAR(at.mean(), forward / modulus, 1e-5 * forward / modulus);
  EXPECT_NEAR(at.alternating(), (still + backward) / modulus, 1e-5 * still / modulus);
  // x = X cos, y = Y sin: the weight pulls along y.
  double most = 0;
  for (int k = 0; k < 3600; ++k) {
    const double t = 2 * pi * k / 3600;
    most = std::max(most, std::hypot(moment[0] * std::cos(t), still + moment[1] * std::sin(t)));
  }
  EXPECT_NEAR(at.largest(), most / modulus, 3e-5 * most / modulus);
}

// Forward whirl of a shaft with mass on bearings that hardly give way, E I w'''' - rho I W^2 w'' = rho A W^2 w: the
// moment under a force F in the middle is F/(a^2 + b^2) (a tanh(a L/2) + b tan(b L/2))/2, with a^2 and b^2 the roots of
// s^4 - rho I W^2/(E I) s^2 - rho A W^2/(E I) = 0, s = a and s = i b.
TEST(Stress, OfAWhirlingShaftWithMass) {
  constexpr double density = 7850, unbalance = 4e-3, speed = 350;
  const double area = pi / 4 * (diameter * diameter - bore * bore), inertia = bending / young,
               p = density * inertia * speed * speed / bending, q = density * area * speed * speed / bending,
               root = std::sqrt(p * p / 4 + q), a = std::sqrt(root + p / 2), b = std::sqrt(root - p / 2),
               force = unbalance * speed * speed,
               moment = force / (a * a + b * b) * (a * std::tanh(a * length / 2) + b * std::tan(b * length / 2)) / 2;
  const std::vector<BendingAt> ends = bent(shaft(density, 1e-9, unbalance, {1e13, 1e13}), speed);
  for (const std::size_t k : {9U, 10U})
    EXPECT_NEAR(ends[k].mean(), std::abs(moment) / modulus, 1e-4 * std::abs(moment) / modulus);
  // Moments balance at each node.
  for (std::size_t k = 1; k + 1 < ends.size(); k += 2)
    EXPECT_NEAR(std::abs(ends[k].forward - ends[k + 1].forward), 0, 1e-7 * std::abs(moment)) << ends[k].node;
}

// Weights, loads and reactions of a shaft on two bearings give its moments without any elasticity.
TEST(Stress, OfThePumpIsThatOfStatics) {
  const std::string path = std::string(WHIRL_SOURCE_DIR) + "/inputs/pump/stress.yaml";
  Deck deck = load(MPI_COMM_WORLD, path, {"bars=none"});
  const rotor::Options& r = deck.machine.rotor;
  const std::vector<double> z = rotor::node_positions(r);
  const auto at = [&](int node) { return z[static_cast<std::size_t>(node - 1)]; };
  struct Force {
    double z, x, y;
  };
  std::vector<Force> forces;
  for (std::size_t e = 0; e < r.segments.size(); ++e) {
    const double d = r.segments[e].outer_mass_diameter, l = r.segments[e].length;
    forces.push_back({z[e] + l / 2, 0, -g * r.material.density * pi / 4 * d * d * l});
  }
  for (const rotor::Disc& d : r.discs) forces.push_back({at(d.node), 0, -g * d.mass});
  for (const system::StaticLoad& l : deck.machine.loads) forces.push_back({at(l.node), l.force[0], l.force[1]});
  const double first = at(4), second = at(10);
  Force on_first{first, 0, 0}, on_second{second, 0, 0};
  for (const Force& f : forces) {
    const double share = (f.z - first) / (second - first);
    on_second.x -= share * f.x, on_second.y -= share * f.y;
    on_first.x -= (1 - share) * f.x, on_first.y -= (1 - share) * f.y;
  }
  forces.push_back(on_first), forces.push_back(on_second);
  const auto moment_at = [&](double place) {
    double x = 0, y = 0;
    for (const Force& f : forces)
      if (f.z < place) x += f.x * (place - f.z), y += f.y * (place - f.z);
    return std::hypot(x, y);
  };
  const auto studies = test::run_deck(deck, "stress");
  ASSERT_EQ(studies.size(), 2U);
  const auto values = test::values_of(studies[0]);
  int section = 0;
  for (std::size_t e = 0; e < r.segments.size();) {
    const double d = r.segments[e].outer_mass_diameter;
    double most = 0;
    for (; e < r.segments.size() && r.segments[e].outer_mass_diameter == d; ++e)
      most = std::max({most, moment_at(z[e]), moment_at(z[e + 1])});
    const double stress = most * 32 / (pi * d * d * d);
    const std::string head = "section." + std::to_string(++section) + ".";
    EXPECT_NEAR(values.at(head + "largest"), stress, 1e-5 * stress) << head;
    EXPECT_EQ(values.at(head + "alternating"), values.at(head + "largest")) << head;
  }
  EXPECT_EQ(section, 7);
  // What stands still is the same beside unbalance, and the margin is Goodman's.
  const auto both = test::values_of(studies[1]);
  for (int k = 1; k <= section; ++k) {
    const std::string head = "section." + std::to_string(k) + ".";
    EXPECT_GT(both.at(head + "mean"), 0) << head;
    EXPECT_NEAR(1 / both.at(head + "margin"), both.at(head + "alternating") / 100e6 + both.at(head + "mean") / 800e6,
                1e-12)
        << head;
  }
}

}  // namespace
}  // namespace whirl::study
