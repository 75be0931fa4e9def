// bearing_map against van de Vrande (2001) sec. 4.3 and the thresholds of an independent computation.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>

#include "source_dir.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/io/hdf5.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/study/deck.hpp"

namespace {

using namespace whirl;
using std::numbers::pi;

struct Map {
  std::string status;
  std::map<std::string, double> values;
  io::Group group;
};

// The studies of a deck by name.
std::map<std::string, Map> run_all(const std::string& name, const std::vector<std::string>& overrides,
                                   bool delivered = true) {
  const study::Deck deck = study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/" + name, overrides);
  const std::filesystem::path directory = std::filesystem::temp_directory_path() / "whirl_bearing_map";
  const bool first = core::rank_of(MPI_COMM_WORLD) == 0;
  if (first) {
    std::filesystem::remove_all(directory);
    std::filesystem::create_directories(directory);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_EQ(study::run(MPI_COMM_WORLD, deck, {directory.string(), "test", {}, {}, false}).empty(), delivered);
  MPI_Barrier(MPI_COMM_WORLD);
  std::map<std::string, Map> maps;
  const io::Group root = io::read_hdf5(directory / "results.h5");
  for (const io::StudySummary& s : io::Summary::read(directory / "summary.json").studies) {
    Map& m = maps[s.name];
    m.status = s.status;
    for (const auto& [key, q] : s.values) m.values[key] = q.value;
    m.group = root.group("studies").group(io::safe_name(s.name));
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (first) std::filesystem::remove_all(directory);
  return maps;
}

Map run(const std::vector<std::string>& overrides, bool delivered = true) {
  return run_all("rigid_rotor/bearing_map.yaml", overrides, delivered).at("bearing_map");
}

}  // namespace

// Loads on either side of the map are refused with its bounds; those within it and the map itself are there.
TEST(BearingMap, LoadsBeyondTheMapAreRefused) {
  const Map m = run({"studies.1.bearing_map.sommerfeld=[1e-6, 1, 1e6]"}, false);
  EXPECT_NE(m.status.find("the load 1e-06 of 'sommerfeld' lies beyond the map"), std::string::npos) << m.status;
  EXPECT_NE(m.status.find("the load 1e+06 of 'sommerfeld' lies beyond the map"), std::string::npos) << m.status;
  EXPECT_NE(m.status.find("raise 'max_eccentricity'"), std::string::npos) << m.status;
  EXPECT_EQ(m.values.count("sommerfeld.1.eccentricity"), 1U);
  EXPECT_EQ(m.values.count("sommerfeld.1e-06.eccentricity"), 0U);
  EXPECT_EQ(m.group.group("locus").reals("eccentricity").size(), 95U);
}

TEST(BearingMap, ShortBearing) {
  const Map m = run({});
  EXPECT_NEAR(m.values.at("threshold.nondimensional_speed"), 2.73526314, 1e-8);
  EXPECT_NEAR(m.values.at("threshold.speed"), 160 * 2.73526314, 2e-6);
  EXPECT_NEAR(m.values.at("threshold.eccentricity"), 0.112974, 1e-6);
  const auto& locus = m.group.group("locus");
  const auto &e = locus.reals("eccentricity"), &S = locus.reals("sommerfeld"), &gamma = locus.reals("attitude"),
             &k = locus.reals("k_xx"), &b = locus.reals("c_xy");
  ASSERT_EQ(e.size(), 95U);
  for (std::size_t i = 0; i < e.size(); ++i) {
    const double e2 = e[i] * e[i], q = 1 - e2, n = 16 * e2 + pi * pi * q;
    EXPECT_NEAR(S[i], e[i] * std::sqrt(n) / (2 * q * q), 1e-12 * S[i]);
    EXPECT_NEAR(gamma[i], std::atan(pi * std::sqrt(q) / (4 * e[i])), 1e-12);
    const double kxx = 2 * e[i] * (16 * e2 + pi * pi * (2 - e2)) / (q * q * n);
    EXPECT_NEAR(k[i], kxx, 1e-11 * kxx);
    const double bxy = -4 * e[i] * (pi * pi * (1 + 2 * e2) - 16 * e2) / (q * q * n);
    EXPECT_NEAR(b[i], bxy, 1e-10 * (1 + std::abs(bxy)));
  }
  const auto& map = m.group.group("impedance");
  const auto &radii = map.reals("eccentricity"), &angles = map.reals("angle"), &along = map.reals("W_along"),
             &across = map.reals("W_across");
  ASSERT_EQ(radii.size(), 41U);
  ASSERT_EQ(along.size(), radii.size() * angles.size());
  EXPECT_EQ(radii.front(), 0);
  EXPECT_NEAR(radii.back(), 0.95, 1e-12);
  EXPECT_NEAR(angles.back(), 2 * pi, 1e-12);
  const std::size_t n = angles.size();
  for (const auto& [j, side] : {std::pair{n / 4, 1}, {3 * (n / 4), -1}}) {  // the journal to the left, to the right
    ASSERT_NEAR(std::cos(angles[j]), 0, 1e-15);
    for (std::size_t i = 0; i < radii.size(); ++i) {
      const double q = 1 - radii[i] * radii[i], w = pi / std::pow(q, 1.5), v = side * 4 * radii[i] / (q * q);
      EXPECT_NEAR(along[i * n + j], w, 1e-11 * w);
      EXPECT_NEAR(across[i * n + j], v, 1e-11 * (w + std::abs(v)));
    }
  }
}

TEST(BearingMap, OtherFilms) {
  const std::string left = "bearings.left.film.type=", right = "bearings.right.film.type=";
  const Map two = run({left + "long", right + "long", "rotor.load=2.56 N"});
  EXPECT_NEAR(two.values.at("nondimensional.load"), 2, 1e-12);
  EXPECT_NEAR(two.values.at("threshold.nondimensional_speed"), 1.97398006, 1e-8);
  EXPECT_NEAR(two.values.at("threshold.eccentricity"), 0.10724, 1e-5);
  const Map inlet = run({left + "long_inlet", right + "long_inlet", "rotor.load=2.56 N"});
  EXPECT_NEAR(inlet.values.at("threshold.nondimensional_speed"), 0.403868, 1e-6);
  // Errata B12 at L/D = 1.
  const Map finite = run({left + "finite_approximate", right + "finite_approximate"});
  const auto& locus = finite.group.group("locus");
  const auto &e = locus.reals("eccentricity"), &S = locus.reals("sommerfeld"), &gamma = locus.reals("attitude");
  for (std::size_t i = 0; i < e.size(); ++i) {
    const double e2 = e[i] * e[i], q = 1 - e2, A = 5 - 2 * e2, B = 8 - 5 * e2;
    EXPECT_NEAR(S[i], 3 * e[i] * std::sqrt(4 * B * B * e2 + pi * pi * A * A * q) / (A * B * q), 1e-12 * S[i]);
    EXPECT_NEAR(gamma[i], std::atan(pi * A * std::sqrt(q) / (2 * B * e[i])), 1e-12);
  }
}

// The compliant bearings of figures 4.10 to 4.15 against limits that do not use their own coefficients.
namespace {

const std::string short_deck = "compliant_rotor/figure_4_10.yaml", long_deck = "compliant_rotor/figure_4_13.yaml";

// One study and one bearing of a deck, the middle one (B = 0.1), with another film and other options.
Map one_map(const std::string& deck, const std::string& film, const std::string& options) {
  return run_all(deck, {"bearings.B01.film={" + film + ", differences: central, reference_speed: 160 rad/s}",
                        "studies=[{bearing_map: {bearing: B01, " + options + "}}]"})
      .at("bearing_map");
}

constexpr const char* entries[] = {"xx", "xy", "yx", "yy"};

}  // namespace

// omega -> 0: along the locus the force changes by (0, dS) = -(...) = k (dx, dy), whatever the film does in between.
TEST(BearingMap, SlowStiffnessIsTheSlopeOfTheLocus) {
  for (const bool inlet : {false, true}) {
    const Map m = one_map(inlet ? long_deck : short_deck,
                          inlet ? "type: compliant_long, compliance: 1, cells: [60, 4]"
                                : "type: compliant_short, compliance: 1, cells: [60, 4]",
                          "speed: 160 rad/s, max_eccentricity: 0.6, points: 60, frequencies: [0.001]");
    EXPECT_EQ(m.status, "completed");
    const auto& t = m.group.group("locus");
    const auto &x = t.reals("x"), &y = t.reals("y"), &S = t.reals("sommerfeld");
    const std::vector<double>* k[4];
    for (std::size_t i = 0; i < 4; ++i) k[i] = &t.reals(std::string("k_") + entries[i]);
    for (std::size_t i = 5; i + 1 < x.size(); i += 10) {
      const double dx = x[i + 1] - x[i - 1], dy = y[i + 1] - y[i - 1], dS = S[i + 1] - S[i - 1];
      // The film pushes up by S; more load moves the journal on until k (dx, dy) balances it.
      const double along_x = (*k[0])[i] * dx + (*k[1])[i] * dy, along_y = (*k[2])[i] * dx + (*k[3])[i] * dy;
      EXPECT_NEAR(along_x, 0, 2e-3 * dS) << inlet << " " << i;
      EXPECT_NEAR(along_y, -dS, 2e-3 * dS) << inlet << " " << i;
    }
  }
}

// B -> 0: the closed forms of the rigid films, whatever the frequency.
TEST(BearingMap, StiffLinersGiveTheRigidCoefficients) {
  for (const bool inlet : {false, true}) {
    const std::string range = "speed: 160 rad/s, max_eccentricity: 0.4, points: 8";
    const Map soft = one_map(inlet ? long_deck : short_deck,
                             inlet ? "type: compliant_long, compliance: 1e-4, cells: [400, 4]"
                                   : "type: compliant_short, compliance: 1e-4, cells: [400, 4]",
                             range + ", frequencies: [0.5, 1]"),
              hard =
                  run_all(inlet ? long_deck : short_deck, {"studies=[{bearing_map: {bearing: rigid, " + range + "}}]"})
                      .at("bearing_map");
    const auto &a = hard.group.group("locus"), &b = soft.group.group("locus"), &f = soft.group.group("frequencies");
    ASSERT_EQ(b.reals("sommerfeld").size(), 8U);
    for (std::size_t i = 0; i < 8; ++i) {
      EXPECT_NEAR(b.reals("sommerfeld")[i], a.reals("sommerfeld")[i], 2e-3 * a.reals("sommerfeld")[i]);
      EXPECT_NEAR(b.reals("attitude")[i], a.reals("attitude")[i], 2e-3);
      for (const char letter : {'k', 'c'}) {
        double size = 0;
        for (const char* e : entries) size = std::max(size, std::abs(a.reals(std::string{letter, '_'} + e)[i]));
        for (const char* e : entries) {
          const std::string name = std::string{letter, '_'} + e;
          EXPECT_NEAR(b.reals(name)[i], a.reals(name)[i], 5e-3 * size) << name << inlet << i;
          EXPECT_NEAR(f.reals(name)[2 * i + 1], a.reals(name)[i], 5e-3 * size) << name << inlet << i;
        }
      }
    }
  }
}

// At the speed and the load of a Hopf point the border of stability is that speed. Mesh-free values of an independent
// computation of the rotor with its film (see tests/system); F0* = 1 short, 2 long.
TEST(BearingMap, BorderOfStabilityIsTheHopfPoint) {
  for (const bool inlet : {false, true}) {
    const double hopf = inlet ? 0.498391 : 2.732563, load = (inlet ? 2 : 1) / (2 * hopf), scale = inlet ? 320 : 160;
    const std::string head = fmt::format("sommerfeld.{:.6g}.", load);
    const Map m =
        run_all(inlet ? long_deck : short_deck,
                {fmt::format("bearings.B01.film={{type: compliant_{}, compliance: 0.1, reference_speed: {} "
                             "rad/s, cells: [160, 4], differences: central}}",
                             inlet ? "long" : "short", scale),
                 fmt::format("studies=[{{bearing_map: {{bearing: B01, speed: {:.10g} rad/s, max_eccentricity: "
                             "0.5, points: 10, sommerfeld: [{:.10g}]}}}}]",
                             hopf * scale, load)})
            .at("bearing_map");
    EXPECT_NEAR(m.values.at(head + "speed_limit"), hopf, 3e-4 * hopf);
    EXPECT_NEAR(m.values.at(head + "whirl_ratio"), 0.5, 0.05);
    EXPECT_FALSE(m.values.contains("threshold.speed"));
  }
}

// The decks at fewer places and one frequency: pressure at the asked load carries it, and softer liners of a short
// bearing have lower peaks.
TEST(BearingMap, DecksOfCompliantBearings) {
  for (const auto& [deck, wanted] : {std::pair{short_deck, 2.5}, {long_deck, 5.0}}) {
    std::vector<std::string> words{"bars=none"};
    for (const int k : {2, 3, 4}) {
      words.push_back(fmt::format("studies.{}.bearing_map.points=40", k));
      words.push_back(fmt::format("studies.{}.bearing_map.frequencies=[1]", k));
    }
    const auto maps = run_all(deck, words);
    double peak = 1e9;
    for (const char* name : {"B = 0", "B = 0.01", "B = 0.1", "B = 1"}) {
      const Map& m = maps.at(name);
      const auto& profiles = m.group.group("profiles");
      const auto &theta = profiles.reals("theta"), &p = profiles.reals("pressure");
      ASSERT_EQ(theta.size(), p.size());
      double vertical = 0, horizontal = 0, highest = 0;
      for (std::size_t i = 0; i + 1 < p.size(); ++i) {
        const double step = theta[i + 1] - theta[i];
        for (const std::size_t j : {i, i + 1}) {
          // Of a short bearing the mean along the axis is two thirds of the middle.
          const double mean = std::max(0.0, p[j]) * (deck == short_deck ? 2.0 / 3 : 1);
          vertical -= 1.5 * step * mean * std::sin(theta[j]);
          horizontal -= 1.5 * step * mean * std::cos(theta[j]);
        }
        highest = std::max(highest, p[i]);
      }
      EXPECT_NEAR(vertical, wanted, 5e-3 * wanted) << name;
      EXPECT_NEAR(horizontal, 0, 5e-3 * wanted) << name;
      EXPECT_TRUE(deck != short_deck || highest < peak) << name;
      peak = highest;
    }
  }
}
