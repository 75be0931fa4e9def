// What branches conclude: stability from start to end, where films become too thin, and how folds end them.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>

#include "rigid_rotor/run_deck.hpp"
#include "source_dir.hpp"
#include "whirl/core/error.hpp"

namespace {

using namespace whirl;

std::vector<io::StudySummary> run(const std::string& name, const std::string& path,
                                  const std::vector<std::string>& overrides) {
  study::Deck deck = study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/" + path, overrides);
  return test::run_deck(deck, "verdict_" + name);
}

io::StudySummary balanced(const std::string& from, const std::string& to) {
  return run("balanced", "inputs/rigid_rotor/short_f1.yaml",
             {"studies=[{equilibrium_branch: {range: {from: " + from + ", to: " + to + "}}}]"})
      .at(0);
}

bool has(const io::StudySummary& s, const std::string& name) {
  return test::values_of(s).contains(name);
}

// The short bearing's threshold at F0* = 1 is at Omega* = 2.73..., 440 rad/s.
TEST(Verdict, OfAnEquilibriumBranchSaysWhereItBegins) {
  const auto loses = balanced("160 rad/s", "560 rad/s");
  EXPECT_EQ(loses.stability, "loses stability");
  ASSERT_TRUE(has(loses, "threshold"));
  const double threshold = test::values_of(loses).at("threshold");
  EXPECT_EQ(loses.bifurcations.at(0).more.at("others_unstable"), 0);

  const auto stable = balanced("160 rad/s", "300 rad/s");
  EXPECT_EQ(stable.stability, "stable throughout");
  EXPECT_FALSE(has(stable, "threshold"));

  const auto cut = run("cut", "inputs/rigid_rotor/short_f1.yaml",
                       {"studies=[{equilibrium_branch: {range: {from: 160 rad/s, to: 300 rad/s}, max_points: 3}}]"})
                       .at(0);
  EXPECT_NE(cut.status, "completed");
  EXPECT_EQ(cut.stability, "stable as far as followed");

  const auto unstable = balanced("480 rad/s", "560 rad/s");
  EXPECT_EQ(unstable.stability, "unstable throughout");
  EXPECT_EQ(unstable.status, "completed");
  EXPECT_FALSE(has(unstable, "threshold"));

  const auto back = balanced("560 rad/s", "160 rad/s");
  EXPECT_EQ(back.stability, "unstable from its start");
  EXPECT_NEAR(test::values_of(back).at("threshold"), threshold, 1e-5 * threshold);
}

// Rounding must not decide whether an undamped machine is stable.
TEST(Verdict, UndampedIsAClassOfItsOwn) {
  const auto studies = run("undamped", "tests/app/friswell_591.yaml",
                           {"bearings.A.film.stiffness=[1 MN/m, 0 N/m, 0 N/m, 0.8 MN/m]",
                            "bearings.B.film.stiffness=[1 MN/m, 0 N/m, 0 N/m, 0.8 MN/m]"});
  for (const auto& mode : studies.at(0).modes) {
    EXPECT_EQ(mode.stability, "undamped");
    EXPECT_EQ(mode.real, 0);
    EXPECT_EQ(mode.log_decrement, 0);
  }
  EXPECT_EQ(studies.at(1).stability, "undamped throughout");
  EXPECT_TRUE(studies.at(1).bifurcations.empty());
  // A damping of 1e-7 of the critical one is no rounding.
  const auto damped =
      run("damped", "tests/app/friswell_591.yaml",
          {"bearings.A.film.damping=[1 N s/m, 0 N s/m, 0 N s/m, 1 N s/m]", "rotor.stiffness_damping=1e-12 s",
           "studies.2.equilibrium_branch.range={from: 100 rpm, to: 4000 rpm}"});
  for (const auto& mode : damped.at(0).modes) {
    EXPECT_EQ(mode.stability, "stable");
    EXPECT_LT(mode.real, 0);
  }
  EXPECT_EQ(damped.at(1).stability, "stable throughout");
}

// At rest nothing gyroscopic parts the frequencies of the two planes; slow rotation parts them evenly.
TEST(ModesAtRest, OfLinearBearingsAndOfNone) {
  const std::string path = "tests/app/friswell_591.yaml";
  const auto modes =
      run("rest", path, {"studies=[{modes: {name: at rest, speeds: [0 rpm, 1 rpm], count: 4}}]"}).at(0).modes;
  ASSERT_EQ(modes.size(), 8U);
  for (std::size_t k = 0; k < 4; k += 2) {
    EXPECT_NEAR(modes[k].imag, modes[k + 1].imag, 1e-7 * modes[k].imag);
    EXPECT_NEAR(modes[k].imag, (modes[4 + k].imag + modes[5 + k].imag) / 2, 1e-7 * modes[k].imag);
    EXPECT_GT(modes[5 + k].imag - modes[4 + k].imag, 1e-6 * modes[k].imag);
  }
  const auto free = run("free", path, {"studies=[{modes: {supports: free, count: 4}}]"}).at(0);
  const auto none = run("none", path, {"bearings={}", "studies=[{modes: {supports: free, count: 4}}]"}).at(0);
  ASSERT_EQ(free.modes.size(), none.modes.size());
  ASSERT_GE(none.modes.size(), 1U);
  for (std::size_t k = 0; k < none.modes.size(); ++k) EXPECT_EQ(none.modes[k].imag, free.modes[k].imag);
  EXPECT_THROW((void)study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/" + path, {"bearings={}"}),
               core::InputError);
}

// A load that presses the journal of a short bearing to a given film: W = mu Omega R L^3/(4 c^2) e/(1 - e^2)^2
// sqrt(16 e^2 + pi^2 (1 - e^2)) (Ocvirk), two bearings.
TEST(MinimumFilm, EndsABranchWhereTheLoadSays) {
  const auto load = [](double film) {
    const double e = 1 - film / 25e-6, q = 1 - e * e;
    return 2 * 1e-3 * 400 * 5e-3 * std::pow(10e-3, 3) / (4 * 25e-6 * 25e-6) * e / (q * q) *
           std::sqrt(16 * e * e + std::numbers::pi * std::numbers::pi * q);
  };
  const auto branch = [](double to, const std::vector<std::string>& more) {
    std::vector<std::string> words{fmt::format(
        "studies=[{{equilibrium_branch: {{parameter: rotor.load, range: {{from: 1 N, to: {} N}}, speed: 400 rad/s}}}}]",
        to)};
    words.insert(words.end(), more.begin(), more.end());
    return run("film", "inputs/rigid_rotor/short_f1.yaml", words).at(0);
  };
  struct Case {
    std::vector<std::string> words;
    double film;
    std::string bearing;
  };
  for (const Case& c : {Case{{"minimum_film=2 um"}, 2e-6, "left"},
                        Case{{"minimum_film=2 um", "bearings.right.minimum_film=5 um"}, 5e-6, "right"}}) {
    const auto s = branch(2 * load(c.film), c.words);
    const std::string reason =
        fmt::format("film of bearing {} falls below {:.3g} um (minimum_film)", c.bearing, c.film * 1e6);
    EXPECT_NE(s.status.find(reason), std::string::npos) << s.status;
    const auto values = test::values_of(s);
    ASSERT_TRUE(values.contains("contact"));
    EXPECT_NEAR(values.at("contact"), load(c.film), 1e-5 * load(c.film));
    EXPECT_LE(values.at("contact.uncertainty"), 1e-5 * load(c.film));
  }
  // Static solutions beyond are there, and marked.
  const auto rest = run("static", "inputs/rigid_rotor/short_f1.yaml",
                        {"minimum_film=24 um", "studies=[{static: {speed: 400 rad/s}}]"})
                        .at(0);
  EXPECT_EQ(rest.warnings.size(), 2U);
  EXPECT_EQ(test::values_of(rest).at("bearing.left.minimum_film"), 24e-6);
  const auto usual = run("usual", "inputs/rigid_rotor/short_f1.yaml", {"studies=[{static: {speed: 400 rad/s}}]"}).at(0);
  EXPECT_TRUE(usual.warnings.empty());
  EXPECT_DOUBLE_EQ(test::values_of(usual).at("bearing.left.minimum_film"), 25e-6 / 2000);
}

// The slower the shaft, the thinner the film of its cycle; a slow coast-down meets the same thickness at the same
// speed.
TEST(MinimumFilm, EndsCyclesMotionsAndRunUps) {
  const std::string path = "inputs/rigid_rotor/short_f1.yaml", a = "unbalance.a.planes.1.eccentricity=5 um",
                    film = "minimum_film=18.2 um", range = "range: {from: 400 rad/s, to: 200 rad/s}",
                    reason = "falls below 18.2 um (minimum_film)";
  const auto branch = [&](const char* intervals) {
    return run("cycles", path,
               {a, film,
                "studies=[{cycle_branch: {unbalance: [a], " + range + ", intervals: " + intervals +
                    ", degree: 3, adapt_mesh: false}}]"})
        .at(0);
  };
  const auto cycles = branch("20");
  EXPECT_NE(cycles.status.find(reason), std::string::npos) << cycles.status;
  const double contact = test::values_of(cycles).at("contact");
  EXPECT_GT(contact, 220);
  EXPECT_LT(contact, 300);
  const double bar = test::values_of(cycles).at("contact.uncertainty");
  EXPECT_LT(bar, 0.002 * contact);  // of the mesh in time
  EXPECT_LE(std::abs(test::values_of(branch("60")).at("contact") - contact), bar);
  const auto down =
      run("coast_down", path,
          {a, film,
           "studies=[{run_up: {unbalance: [a], " + range + ", acceleration: 100 rad/s^2, start: {from: cycle}}}]"})
          .at(0);
  ASSERT_NE(down.status.find(reason), std::string::npos) << down.status;
  const double end = std::stod(down.status.substr(std::string("ended at ").size()));
  EXPECT_NEAR(end, contact, 0.02 * contact);
  // Where in time, and how to go on; what was computed before is there, with the thinnest film of whole revolutions.
  const double time = std::stod(down.status.substr(down.status.find("t = ") + 4));
  EXPECT_NEAR(400 - 100 * time, end, 1e-3) << down.status;
  EXPECT_TRUE(down.status.ends_with("With 'minimum_film: 0 um' the motion goes on until the surfaces touch"));
  const auto least = test::values_of(down);
  EXPECT_GT(least.at("bearing.left.thinnest_film"), 18.2e-6);
  EXPECT_LT(least.at("bearing.left.thinnest_film"), 18.5e-6);
  EXPECT_NEAR(least.at("bearing.left.thinnest_film.speed"), end, 0.01 * end);
  // A motion that begins with a film too thin delivers nothing but the reason.
  const auto words = [&](double speed) {
    return std::vector<std::string>{
        a, film,
        fmt::format("studies=[{{motion: {{unbalance: [a], speed: {} rad/s, start: {{from: cycle}}, discard: 1, "
                    "revolutions: 4, exponents: 0}}}}]",
                    speed)};
  };
  EXPECT_EQ(run("motion", path, words(contact + 10)).at(0).status, "completed");
  study::Deck thin = study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/" + path, words(contact - 10));
  const std::filesystem::path directory = std::filesystem::temp_directory_path() / "whirl_verdict_thin";
  if (core::rank_of(MPI_COMM_WORLD) == 0) std::filesystem::create_directories(directory);
  MPI_Barrier(MPI_COMM_WORLD);
  const auto undelivered = study::run(MPI_COMM_WORLD, thin, {directory.string(), "test", {}, {}, false});
  ASSERT_EQ(undelivered.size(), 1U);
  EXPECT_NE(undelivered[0].find(reason), std::string::npos) << undelivered[0];
  MPI_Barrier(MPI_COMM_WORLD);
  if (core::rank_of(MPI_COMM_WORLD) == 0) std::filesystem::remove_all(directory);
}

// Steps of the parameter find what steps of arclength find, up to the first fold: the doubled cycles are born
// subcritically at 395.02 rad/s and turn at 393.825.
TEST(NaturalContinuation, OfDecksEndsAtAFold) {
  const auto rest = run("natural", "inputs/rigid_rotor/short_f1.yaml",
                        {"studies=[{equilibrium_branch: {range: {from: 160 rad/s, to: 560 rad/s}, "
                         "continuation: natural}}]"})
                        .at(0);
  EXPECT_EQ(rest.status, "completed");
  EXPECT_NEAR(test::values_of(rest).at("threshold"), 437.6421, 1e-3);
  const auto cycles =
      run("natural_cycles", "inputs/rigid_rotor/short_f1.yaml",
          {"studies=[{cycle_branch: {name: c, unbalance: [a], range: {from: 390 rad/s, to: 400 rad/s}, "
           "continuation: natural, intervals: 20, degree: 3, adapt_mesh: false, follow_flips: true}}]"});
  ASSERT_EQ(cycles.size(), 2U);
  EXPECT_EQ(cycles[0].status, "completed");
  EXPECT_NE(cycles[1].status.find("turns back at a fold"), std::string::npos) << cycles[1].status;
  ASSERT_EQ(cycles[1].bifurcations.size(), 1U);
  EXPECT_EQ(cycles[1].bifurcations[0].type, io::BifurcationType::cyclic_fold);
  EXPECT_NEAR(cycles[1].bifurcations[0].value, 393.825, 0.01);
}

// Between the flips the simple cycle and the one of twice its period coexist; both are motions of two turns.
TEST(Deflation, FindsTheCyclesThatCoexist) {
  const std::string time = ", intervals: 40, degree: 3, adapt_mesh: false";
  const auto studies =
      run("deflation", "inputs/rigid_rotor/short_f1.yaml",
          {"studies=[{cycle_branch: {name: two, unbalance: [a], period: 2, range: {from: 450 rad/s, to: 460 rad/s}, "
           "at: [455 rad/s], deflation: {solutions: 3, attempts: 14}" +
           time +
           "}}, "
           "{cycle_branch: {name: one, unbalance: [a], range: {from: 380 rad/s, to: 460 rad/s}, detect: [flip], "
           "follow_flips: true, at: [455 rad/s], intervals: 20, degree: 3, adapt_mesh: false}}]"});
  std::map<std::string, io::StudySummary> of;
  for (const auto& s : studies) of[s.name] = s;
  EXPECT_EQ(test::values_of(of["two"]).at("solutions"), 2);
  ASSERT_TRUE(of.contains("two solution 2"));
  EXPECT_EQ(of["two"].stability, "unstable throughout");
  EXPECT_EQ(of["two solution 2"].stability, "stable throughout");
  const std::string size = "at.455.peak_to_peak.left.x";
  EXPECT_NEAR(test::values_of(of["two solution 2"]).at(size), test::values_of(of["one flip 1"]).at(size), 1e-10);
  EXPECT_NEAR(test::values_of(of["two"]).at(size), test::values_of(of["one"]).at(size), 1e-10);
}

// A Brusselator of one inner point with a = D_u/(L dz)^2, b = D_v/(L dz)^2: beside u = A its equilibria u = A - w solve
// g w^2 - (2 A g - B/A) w + 1 + 2 a + A^2 g - B = 0, g = (1 + 2 a)/(2 b).
TEST(Deflation, FindsTheEquilibriaThatCoexist) {
  const auto studies = run("patterns", "inputs/other_systems/brusselator.yaml",
                           {"brusselator.cells=2", "brusselator.diffusion_u=0.025", "brusselator.diffusion_v=0.25",
                            "studies=[{equilibrium_branch: {name: uniform, parameter: brusselator.length, "
                            "range: {from: 1, to: 1.02}, deflation: {solutions: 5, attempts: 20}}}]"});
  ASSERT_EQ(studies.size(), 3U);
  auto values = test::values_of(studies[0]);
  EXPECT_EQ(values.at("solutions"), 3);
  const double a = 0.1, b = 1, g = (1 + 2 * a) / (2 * b), linear = 2 * 2 * g - 5.45 / 2,
               constant = 1 + 2 * a + 4 * g - 5.45, root = std::sqrt(linear * linear - 4 * g * constant);
  std::vector<double> found{values.at("solution.2.middle.x"), values.at("solution.3.middle.x")},
      exact{2 - (linear + root) / (2 * g), 2 - (linear - root) / (2 * g)};
  std::sort(found.begin(), found.end());
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(found[k], exact[k], 1e-8);
  for (const auto& s : studies) {
    EXPECT_EQ(s.status, "completed") << s.name;
    EXPECT_FALSE(s.stability.empty());
  }
}

}  // namespace
