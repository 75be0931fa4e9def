// Every solver of periodic solutions through the decks: the same cycles, multipliers and bifurcations within their own
// discretisation errors, which fall with the order of their schemes.
#include <fmt/core.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rigid_rotor/run_deck.hpp"
#include "source_dir.hpp"

namespace {

using namespace whirl;
using Words = std::vector<std::string>;
using Type = io::BifurcationType;

Words operator+(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// A branch of cycles of a deck's machine, instead of the deck's own studies.
std::vector<io::StudySummary> follow(const std::string& name, const std::string& deck_name, const Words& machine,
                                     const Words& words) {
  Words overrides = machine;
  overrides.push_back(fmt::format("studies=[{{cycle_branch: {{name: branch, {}}}}}]", fmt::join(words, ", ")));
  study::Deck deck = study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/" + deck_name, overrides);
  return test::run_deck(deck, "methods_" + name);
}

Words steps(const std::string& method, const std::string& scheme, int intervals, int per_interval) {
  Words out{"method: " + method, "scheme: " + scheme};
  if (method != "shooting") out.push_back(fmt::format("intervals: {}", intervals));
  if (method != "finite_difference") out.push_back(fmt::format("steps: {}", per_interval));
  return out;
}

const Words fine{"intervals: 60", "degree: 5", "points: gauss", "adapt_mesh: false"};

}  // namespace

// Omega* = 2.2, a* = 0.1, F0* = 1: the leading multiplier against collocation, by steps of two lengths.
TEST(Methods, MultipliersConvergeWithTheOrderOfTheScheme) {
  const Words range{"unbalance: [a]", "range: {from: 352 rad/s, to: 353 rad/s}",
                    "step: {initial: 1 rad/s, min: 0.1 rad/s, max: 1 rad/s}", "at: [352 rad/s]", "tolerance: 1e-12"};
  const std::string deck = "rigid_rotor/short_f1.yaml";
  const auto value = [&](const std::string& name, const Words& words) {
    const auto s = follow(name, deck, {"bars=none"}, range + words).at(0);
    EXPECT_EQ(s.status, "completed") << name;
    std::pair<double, double> out;
    for (const auto& [k, q] : s.values) {
      if (k.ends_with("multiplier.modulus")) out.first = q.value;
      if (k.ends_with("peak_to_peak.left.x")) out.second = q.value;
    }
    return out;
  };
  const auto exact = value("reference", fine);
  ASSERT_GT(exact.first, 0.1);
  struct Case {
    std::string method, scheme;
    int order, intervals, steps;
    bool by_intervals;  // which of the two is doubled
  };
  for (const Case& c :
       {Case{"shooting", "radau_iia_2", 3, 1, 32, false}, Case{"multiple_shooting", "radau_iia_3", 5, 4, 3, false},
        Case{"multiple_shooting", "sdirk_4", 4, 4, 8, false}, Case{"finite_difference", "third_order", 3, 64, 1, true},
        Case{"finite_difference", "improved_euler", 2, 96, 1, true}, Case{"newton_picard", "sdirk_2", 2, 1, 48, false},
        Case{"newton_picard", "classical", 4, 48, 1, true}}) {
    const auto at = [&](int k) {
      return value(c.method + "_" + c.scheme, steps(c.method, c.scheme, c.by_intervals ? c.intervals * k : c.intervals,
                                                    c.by_intervals ? c.steps : c.steps * k));
    };
    const auto coarse = at(1), halved = at(2);
    const double first = std::abs(coarse.first - exact.first), second = std::abs(halved.first - exact.first);
    EXPECT_GT(std::log2(first / second), c.order - 0.25) << c.method << " " << c.scheme << " " << first;
    EXPECT_LT(std::log2(first / second), c.order + 1) << c.method << " " << c.scheme << " " << first;
    EXPECT_NEAR(halved.second, exact.second, 2e-3 * exact.second) << c.method << " " << c.scheme;
  }
}

// Both flips of a* = 0.1, subcritical: what a method finds lies within the uncertainty that it states.
TEST(Methods, FlipsLieWithinTheStatedUncertainty) {
  const Words range{"unbalance: [a]", "range: {from: 384 rad/s, to: 560 rad/s}",
                    "step: {initial: 4 rad/s, min: 0.001 rad/s, max: 16 rad/s}"};
  for (const auto& [name, words] : {std::pair<std::string, Words>{"shooting", steps("shooting", "radau_iia_3", 1, 40)},
                                    {"multiple_shooting", steps("multiple_shooting", "sdirk_4", 6, 10)},
                                    {"finite_difference", steps("finite_difference", "classical", 80, 0)},
                                    {"newton_picard", steps("newton_picard", "classical", 80, 1)}}) {
    SCOPED_TRACE(name);
    const auto s = follow("flips_" + name, "rigid_rotor/short_f1.yaml", {}, range + words).at(0);
    EXPECT_EQ(s.status, "completed");
    ASSERT_EQ(s.bifurcations.size(), 2U);
    const double reference[] = {2.468901, 3.412566};
    for (std::size_t k = 0; k < 2; ++k) {
      const auto& b = s.bifurcations[k];
      EXPECT_EQ(b.type, Type::flip);
      EXPECT_NEAR(b.value / 160, reference[k], 2e-3);
      EXPECT_LE(std::abs(b.value / 160 - reference[k]), b.uncertainty / 160 + 2e-6);
      EXPECT_EQ(b.criticality, "subcritical") << b.criticality_by;
    }
  }
}

// The branch of twice the period born at the subcritical flip turns at a fold.
TEST(Methods, PeriodDoublingByFiniteDifferences) {
  const auto all = follow("doubling", "rigid_rotor/short_f1.yaml", {"bars=none"},
                          Words{"unbalance: [a]", "range: {from: 384 rad/s, to: 400 rad/s}", "follow_flips: true",
                                "step: {initial: 1 rad/s, min: 0.001 rad/s, max: 4 rad/s}", "max_points: 30"} +
                              steps("finite_difference", "classical", 100, 0));
  ASSERT_EQ(all.size(), 2U);
  ASSERT_FALSE(all[1].bifurcations.empty());
  EXPECT_EQ(all[1].bifurcations[0].type, Type::cyclic_fold);
  EXPECT_NEAR(all[1].bifurcations[0].value / 160, 2.461408, 1e-3);
}

// Self-excited whirl at Omega* = 2.69, on the branch born at the subcritical Hopf point 2.735263.
TEST(Methods, SelfExcitedWhirl) {
  const Words range{"origin: hopf", "range: {from: 424 rad/s, to: 480 rad/s}", "at: [430 rad/s]",
                    "step: {initial: 1 rad/s, min: 0.001 rad/s, max: 2 rad/s}", "max_points: 20"};
  const auto run = [&](const std::string& name, const Words& words) {
    const auto s = follow("hopf_" + name, "rigid_rotor/short_f1.yaml", {}, range + words).at(0);
    const auto values = test::values_of(s);
    EXPECT_NEAR(values.at("hopf") / 160, 2.73526314, 1e-6);
    EXPECT_EQ(s.bifurcations.at(0).criticality, "subcritical") << name << ": " << s.bifurcations.at(0).criticality_by;
    std::map<std::string, double> out;
    for (const auto& [k, v] : values)
      if (k.starts_with("at.")) out[k.substr(k.rfind('.'))] = v;
    EXPECT_TRUE(out.contains(".period")) << name << ": " << s.status;
    return out;
  };
  auto exact = run("reference", fine);
  for (const auto& [name, words, tolerance] :
       {std::tuple<std::string, Words, double>{"shooting", steps("shooting", "radau_iia_3", 1, 60), 1e-5},
        {"multiple_shooting", steps("multiple_shooting", "radau_iia_3", 8, 8), 1e-5},
        {"finite_difference", steps("finite_difference", "classical", 120, 0), 1e-5},
        {"newton_picard_shooting", steps("newton_picard", "sdirk_2", 1, 30), 5e-3},
        {"newton_picard_differences", steps("newton_picard", "classical", 120, 1), 1e-5}}) {
    auto found = run(name, words);
    EXPECT_NEAR(found[".period"], exact[".period"], tolerance * exact[".period"]) << name;
    EXPECT_NEAR(found[".modulus"], exact[".modulus"], 10 * tolerance) << name;
    EXPECT_NEAR(found[".x"], exact[".x"], 10 * tolerance * exact[".x"]) << name;
  }
}

// The compliant short film with N = 50 at B = 0.1, a* = 0.2, Omega* = 2: 54 states, of which a few multipliers matter.
TEST(Methods, CompliantFilm) {
  const Words film{"bars=none", "bearings.half.film.cells=[50, 4]", "bearings.half.film.quadrature=simpson",
                   "bearings.half.film.differences=upwind"},
      range{"unbalance: [a]", "range: {from: 320 rad/s, to: 322 rad/s}",
            "step: {initial: 2 rad/s, min: 0.1 rad/s, max: 2 rad/s}", "at: [320 rad/s]"};
  const auto run = [&](const std::string& name, const Words& words) {
    const auto s = follow("compliant_" + name, "compliant_rotor/short.yaml", film, range + words).at(0);
    EXPECT_EQ(s.status, "completed") << name;
    std::map<std::string, double> out;
    for (const auto& [k, v] : test::values_of(s))
      if (k.starts_with("at.")) out[k.substr(k.rfind('.'))] = v;
    return out;
  };
  auto exact = run("reference", {"intervals: 40", "degree: 3", "adapt_mesh: false"});
  for (const auto& [name, words, tolerance] :
       {std::tuple<std::string, Words, double>{"shooting", steps("shooting", "improved_euler", 1, 100), 1e-2},
        {"multiple_shooting", steps("multiple_shooting", "radau_iia_2", 10, 4), 1e-3},
        {"finite_difference", steps("finite_difference", "improved_euler", 100, 0), 1e-2},
        {"newton_picard_shooting", steps("newton_picard", "sdirk_2", 1, 60), 1e-2},
        {"newton_picard_differences", steps("newton_picard", "classical", 100, 1), 1e-3}}) {
    auto found = run(name, words);
    EXPECT_NEAR(found[".modulus"], exact[".modulus"], tolerance) << name;
    EXPECT_NEAR(found[".x"], exact[".x"], tolerance * exact[".x"]) << name;
    EXPECT_NEAR(found[".y"], exact[".y"], tolerance * exact[".y"]) << name;
  }
}
