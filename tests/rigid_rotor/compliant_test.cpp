// Located bifurcations of synchronous cycles of a rigid rotor in compliant bearings at a* = 0.2, through the decks,
// with the film mesh of the source (N = 50, Simpson, upwind). Reference values: an independent computation (Radau IIA,
// its time-mesh error 0.005 to 0.02 where the force has kinks) of the cases of van de Vrande (2001), sec. 5.3.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include "rigid_rotor/run_deck.hpp"
#include "source_dir.hpp"

namespace {

using namespace whirl;
using Type = io::BifurcationType;

struct Point {
  Type type;
  double speed;      // Omega*
  double tolerance;  // relative
};
struct Case {
  std::string name, deck;
  double scale, compliance, from, to;  // Omega_0 [rad/s]; B; Omega*
  int intervals;
  std::vector<Point> points;
};

class CompliantLocated : public ::testing::TestWithParam<Case> {};

TEST_P(CompliantLocated, AgreesWithTheReference) {
  const Case& c = GetParam();
  const std::string film = "bearings.half.film.", branch = "studies.2.cycle_branch.";
  const bool bars = c.name == "short_b01";  // one of them is enough
  study::Deck deck = study::load(
      MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/compliant_rotor/" + c.deck,
      {bars ? "bars=meshes" : "bars=none", fmt::format("{}compliance={}", film, c.compliance), film + "cells=[50, 4]",
       film + "quadrature=simpson", film + "differences=upwind",
       fmt::format("{}range={{from: {:.17g} rad/s, to: {:.17g} rad/s}}", branch, c.from * c.scale, c.to * c.scale),
       fmt::format("{}intervals={}", branch, c.intervals)});
  deck.studies.erase(deck.studies.begin());
  const io::StudySummary s = test::run_deck(deck, "compliant_" + c.name).at(0);
  EXPECT_EQ(s.status, "completed");
  ASSERT_EQ(s.bifurcations.size(), c.points.size());
  for (std::size_t k = 0; k < c.points.size(); ++k) {
    EXPECT_EQ(s.bifurcations[k].type, c.points[k].type);
    EXPECT_NEAR(s.bifurcations[k].value / c.scale, c.points[k].speed, c.points[k].tolerance * c.points[k].speed);
    EXPECT_EQ(s.bifurcations[k].uncertainty >= 0, bars);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Cases, CompliantLocated,
    ::testing::Values(
        Case{"short_b001",
             "short.yaml",
             160,
             0.01,
             2.5,
             6.2,
             80,
             {{Type::flip, 2.9855, 1e-3}, {Type::flip, 5.86, 2e-3}}},
        Case{"short_b01", "short.yaml", 160, 0.1, 3, 6.4, 40, {{Type::flip, 4.286, 2e-3}, {Type::flip, 5.963, 1e-3}}},
        Case{"short_b1", "short.yaml", 160, 1, 1.9, 3.4, 40, {{Type::flip, 2.366, 1e-3}, {Type::flip, 3.080, 1e-3}}},
        Case{"long_b001", "long.yaml", 320, 0.01, 0.36, 0.48, 40, {{Type::neimark_sacker, 0.4198, 2e-3}}},
        Case{"long_b01", "long.yaml", 320, 0.1, 0.36, 0.56, 40, {{Type::neimark_sacker, 0.5070, 1e-3}}},
        Case{"long_b1", "long.yaml", 320, 1, 0.9, 1.25, 40, {{Type::neimark_sacker, 1.1602, 1e-3}}}),
    [](const auto& which) { return which.param.name; });

// A resonance that bends to higher speeds: the folds of figure_5_13.yaml, whose 120 cells these values come from; none
// where the liner does not stiffen.
TEST(RubberLiner, BendsTheResonance) {
  const std::string film = "bearings.rubber.film.";
  const auto run = [&](const std::string& rubber, const std::string& to, const std::string& name) {
    study::Deck deck =
        study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/compliant_rotor/figure_5_13.yaml",
                    {"bars=none", film + "cells=[60, 4]", film + "rubber_thickness=" + rubber,
                     "studies.1.cycle_branch.intervals=16", "studies.1.cycle_branch.step.max=16 rad/s",
                     "studies.1.cycle_branch.range={from: 300 rad/s, to: " + to + "}"});
    return test::run_deck(deck, name).at(0);
  };
  const io::StudySummary bent = run("0.2 mm", "556 rad/s", "rubber_bent");
  EXPECT_EQ(bent.status, "completed");
  ASSERT_EQ(bent.bifurcations.size(), 2U);
  for (const auto& [k, speed] : {std::pair{0U, 544.26}, {1U, 540.27}}) {
    EXPECT_EQ(bent.bifurcations[k].type, Type::cyclic_fold);
    EXPECT_NEAR(bent.bifurcations[k].value, speed, 0.4);
  }
  const io::StudySummary straight = run("", "480 rad/s", "rubber_straight");
  EXPECT_EQ(straight.status, "completed");
  EXPECT_TRUE(straight.bifurcations.empty());
}

// The whirl of figure_5_7.yaml touches at 458.8 rad/s and ends there, or at 501.1 rad/s in a coarse film of finite
// length; with asperities that carry it goes on.
TEST(Contact, ABranchGoesOnWhereItTouched) {
  const auto run = [](const std::string& to, std::vector<std::string> film, bool contact, const std::string& name) {
    film.emplace_back("bars=none");
    film.push_back("studies.2.cycle_branch.range={from: 240 rad/s, to: " + to + "}");
    film.emplace_back("studies.2.cycle_branch.intervals=16");
    film.emplace_back("studies.2.cycle_branch.step.max=16 rad/s");
    if (contact) film.emplace_back("bearings.half.film.contact={roughness: 0.5 um, pressure: 1 MPa}");
    study::Deck deck =
        study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/compliant_rotor/figure_5_7.yaml", film);
    deck.studies.erase(deck.studies.begin());
    return test::run_deck(deck, name).at(0).status;
  };
  const std::vector<std::string> finite = {"bearings.half.film.type=compliant_finite",
                                           "bearings.half.film.cells=[16, 4]",
                                           "bearings.half.film.quadrature=sub_cell"};
  EXPECT_EQ(run("470 rad/s", {}, true, "contact"), "completed");
  EXPECT_EQ(run("510 rad/s", finite, true, "finite_contact"), "completed");
  EXPECT_NE(run("510 rad/s", finite, false, "finite_touches").find("touches"), std::string::npos);
}

// Films of finite length on a rigid bore: the limit of fine meshes is 2.5262, and 2.5265 that of compliant films as B
// vanishes (meshes 40 x 8 and 60 x 12 with B = 0.03 and 0.01, extrapolated).
TEST(ClosedFilm, HopfPointOfARigidRotor) {
  const std::string film = "={type: reynolds, cavitation: half_sommerfeld, cells: [60, 12]}";
  study::Deck deck = study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/rigid_rotor/short_f1.yaml",
                                 {"bearings.left.film" + film, "bearings.right.film" + film,
                                  "studies.1.equilibrium_branch.range={from: 320 rad/s, to: 480 rad/s}"});
  deck.studies.resize(1);
  const io::StudySummary s = test::run_deck(deck, "closed_film").at(0);
  ASSERT_EQ(s.bifurcations.size(), 1U);
  EXPECT_EQ(s.bifurcations[0].type, Type::hopf);
  EXPECT_NEAR(s.bifurcations[0].value / 160, 2.5262, 2e-3);
}

}  // namespace
