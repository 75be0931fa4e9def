// Sweeps: who takes which variant, what a variant's deck is, the table and its trends.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "source_dir.hpp"
#include "study/job_queue.hpp"
#include "study/sweep/sweep_table.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/io/csv.hpp"
#include "whirl/io/hdf5.hpp"
#include "whirl/rotor/advice.hpp"
#include "whirl/study/deck.hpp"
#include "whirl/study/sweep/sweep.hpp"

namespace {

using namespace whirl;
namespace fs = std::filesystem;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

const fs::path train = fs::path(WHIRL_SOURCE_DIR) / "inputs/turbine_train/train.yaml";

// A deck of the train with these studies; the same file on every rank.
study::Deck load(const std::string& studies) {
  const int rank = core::rank_of(MPI_COMM_WORLD);
  const fs::path path =
      fs::temp_directory_path() / ("whirl_sweep_test_" + std::to_string(core::size_of(MPI_COMM_WORLD)) + ".yaml");
  if (rank == 0) std::ofstream(path) << "base: " << train.string() << "\nstudies:\n" << studies;
  MPI_Barrier(MPI_COMM_WORLD);
  study::Deck deck = study::load(MPI_COMM_WORLD, path.string(), {});
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank == 0) fs::remove(path);
  return deck;
}

const study::Sweep& sweep_of(const study::Deck& deck) {
  return dynamic_cast<const study::Sweep&>(*deck.studies.back());
}

const std::string branch =
    "  - static: {speed: 3600 rpm}\n"
    "  - equilibrium_branch: {name: balanced, range: {from: 500 rpm, to: 800 rpm}}\n";

io::StudySummary with_hopf(std::vector<std::pair<double, double>> points) {
  io::StudySummary s;
  s.name = "balanced";
  for (const auto& [value, bar] : points) {
    io::Bifurcation b;
    b.type = io::BifurcationType::hopf;
    b.value = value;
    b.uncertainty = bar;
    b.unit = "rpm";
    s.bifurcations.push_back(b);
  }
  return s;
}

const io::Trend& trend(const std::vector<io::Trend>& all, const std::string& column) {
  for (const auto& t : all)
    if (t.column == column) return t;
  throw core::Bug("no trend of " + column);
}

}  // namespace

TEST(JobQueue, EveryJobIsTakenOnce) {
  const int rank = core::rank_of(MPI_COMM_WORLD);
  for (const int ranks : {1, 2}) {
    study::JobQueue queue(MPI_COMM_WORLD, ranks, 20);
    std::vector<int> taken(20, 0);
    queue.run([&](std::size_t k) {
      if (core::rank_of(queue.group()) == 0) ++taken[k];
      EXPECT_EQ(core::size_of(queue.group()) >= std::min(ranks, core::size_of(MPI_COMM_WORLD)), true);
    });
    MPI_Allreduce(MPI_IN_PLACE, taken.data(), 20, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
    for (const int n : taken) EXPECT_EQ(n, 1) << rank;
  }
}

TEST(JobQueue, AfterAnErrorNobodyTakesAnotherJob) {
  study::JobQueue queue(MPI_COMM_WORLD, 1, 1000);
  int taken = 0, thrown = 0;
  try {
    queue.run([&](std::size_t) {
      if (++taken == 2 || core::size_of(MPI_COMM_WORLD) == 1) throw core::Error("disk full");
    });
  } catch (const core::Error&) {
    thrown = 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, &thrown, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, &taken, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  EXPECT_GE(thrown, 1);
  EXPECT_LT(taken, 1000);
}

// The rank that fails leaves its queue without waiting for the others, who are at work and would never come.
TEST(JobQueue, WhoFailsAloneWaitsForNobody) {
  const int rank = core::rank_of(MPI_COMM_WORLD), size = core::size_of(MPI_COMM_WORLD), last = size - 1;
  int left = 0;
  try {
    study::JobQueue queue(MPI_COMM_WORLD, 1, static_cast<std::size_t>(10 * size));
    // The others do not come to the end of their queue before the last rank has left its own.
    if (rank != last) MPI_Recv(&left, 1, MPI_INT, last, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    throw core::Error("disk full");
  } catch (const core::Error&) {
    if (rank == last) left = 1;
    for (int to = 0; to < last && rank == last; ++to) MPI_Send(&left, 1, MPI_INT, to, 0, MPI_COMM_WORLD);
  }
  EXPECT_EQ(left, 1);
}

// What one rank holds, on all; an error of that rank is one of all, and nobody waits for the bytes.
TEST(FromOwner, BytesOrTheErrorReachEveryRank) {
  const int rank = core::rank_of(MPI_COMM_WORLD), last = core::size_of(MPI_COMM_WORLD) - 1;
  const std::string bytes = study::from_owner(MPI_COMM_WORLD, last, [&] {
    EXPECT_EQ(rank, last);
    return std::string("a\0b", 3);
  });
  EXPECT_EQ(bytes, std::string("a\0b", 3));
  try {
    (void)study::from_owner(MPI_COMM_WORLD, last,
                            []() -> std::string { throw core::Error("no memory for a variant"); });
    ADD_FAILURE() << "no error on rank " << rank;
  } catch (const core::Error& e) {
    EXPECT_STREQ(e.what(), "no memory for a variant");
  }
}

TEST(Sweep, VariantsAreDecksOfTheirOwn) {
  const study::Deck deck =
      load(branch +
           "  - sweep:\n"
           "      of: [balanced]\n"
           "      variants:\n"
           "        wide: {\"bearings.{B2,B3}.geometry.clearance\": x1.2, bearings.B5.elevation: by +500 um}\n"
           "        arc: {\"bearings.{B2,B3,B4}.geometry.arc\": 140 deg}\n");
  const auto& variants = sweep_of(deck).variants();
  ASSERT_EQ(variants.size(), 2U);
  EXPECT_EQ(variants[0].name, "wide");
  const auto& wide = variants[0].deck->machine.bearings;
  EXPECT_NEAR(wide[1].geometry->clearance, 264e-6, 1e-18);
  EXPECT_NEAR(wide[2].geometry->clearance, 480e-6, 1e-18);
  EXPECT_NEAR(wide[3].geometry->clearance, 300e-6, 1e-18);
  EXPECT_NEAR(wide[4].elevation, 7175e-6, 1e-15);
  ASSERT_EQ(variants[0].deck->studies.size(), 1U);  // of what is repeated
  EXPECT_EQ(variants[0].deck->studies[0]->name(), "balanced");
  // The first quantity that changes as a number: a common ratio where values differ, the value where they are alike.
  ASSERT_EQ(variants[0].coordinates.size(), 1U);
  EXPECT_NEAR(variants[0].coordinates[0].value, 1.2, 1e-12);
  EXPECT_EQ(variants[0].coordinates[0].unit, "1");
  EXPECT_NEAR(variants[1].coordinates[0].value, 140, 1e-12);
  EXPECT_NEAR(variants[1].coordinates[0].given, 160, 1e-12);
  EXPECT_EQ(variants[1].coordinates[0].unit, "deg");
}

TEST(Sweep, GridsHoldEveryCombination) {
  const study::Deck deck =
      load(branch +
           "  - sweep:\n"
           "      of: [balanced]\n"
           "      grid:\n"
           "        bearings.B5.elevation: [by +0 um, by +500 um]\n"
           "        bearings.B1.pedestal.stiffness: {from: x0.1, to: x10, points: 3, spacing: log}\n"
           "        bearings.B1.geometry.clearance: {from: 100 um, to: 0.2 mm, points: 3}\n");
  const auto& variants = sweep_of(deck).variants();
  ASSERT_EQ(variants.size(), 18U);
  EXPECT_EQ(variants.front().name, "elevation by +0 um, stiffness x0.1, clearance 100 um");
  EXPECT_EQ(variants[1].name, "elevation by +0 um, stiffness x0.1, clearance 150 um");
  EXPECT_EQ(variants.back().name, "elevation by +500 um, stiffness x10, clearance 200 um");
  EXPECT_NEAR(variants.back().deck->machine.bearings[0].pedestal->stiffness[1], 1.5e10, 1);
  EXPECT_NEAR(variants[3].deck->machine.bearings[0].pedestal->stiffness[0], 1e9, 1e-3);
  EXPECT_NEAR(variants[1].deck->machine.bearings[0].geometry->clearance, 150e-6, 1e-18);
}

// Tables become part of the deck, so that the resolved one stands for itself.
TEST(Sweep, TheResolvedDeckHasTheSameVariants) {
  const study::Deck deck = load(
      branch +
      "  - sweep:\n      of: [balanced]\n      at: 13\n      variants:\n        \"11\": {at: 11, rotor.segments: " +
      (train.parent_path() / "variants/segments_lambda11.csv").string() + ", bearings.B4.elevation: 2107 um}\n");
  const fs::path path =
      fs::temp_directory_path() / ("whirl_sweep_resolved_" + std::to_string(core::size_of(MPI_COMM_WORLD)) + ".yaml");
  if (core::rank_of(MPI_COMM_WORLD) == 0) std::ofstream(path) << study::resolved_text(deck);
  MPI_Barrier(MPI_COMM_WORLD);
  const study::Deck again = study::load(MPI_COMM_WORLD, path.string(), {});
  const auto &a = sweep_of(deck).variants()[0], &b = sweep_of(again).variants()[0];
  EXPECT_NEAR(
      a.deck->machine.rotor.segments[120].outer_mass_diameter / b.deck->machine.rotor.segments[120].outer_mass_diameter,
      1, 1e-14);
  EXPECT_GT(std::abs(a.deck->machine.rotor.segments[120].outer_mass_diameter /
                         deck.machine.rotor.segments[120].outer_mass_diameter -
                     1),
            0.05);
  EXPECT_EQ(a.coordinates[0].value, 11);
  EXPECT_EQ(a.coordinates[0].given, 13);
  EXPECT_EQ(study::resolved_text(again), study::resolved_text(deck));
}

TEST(SweepTable, ASignCountsIfItsBarDoesNotContainZero) {
  const auto row = [](const std::string& name, double at, std::vector<std::pair<double, double>> points) {
    return study::SweepRow{name, {{"clearance", at, 1, "1"}}, {with_hopf(std::move(points))}};
  };
  const std::vector<study::SweepRow> rows{
      {"as given", {}, {with_hopf({{5000, 10}, {5600, 10}, {6000, 10}, {7000, unknown}})}},
      row("narrow", 0.8, {{4000, 20}, {5590, 1}, {5900, 1}, {6500, 1}}),
      row("wide", 1.2, {{5500, 30}, {5700, 10}, {5800, 1}, {7500, 1}}),
      row("wider", 1.5, {{5600, 30}, {5800, 10}, {5900, 1}, {7000, 1}, {8000, 5}})};
  const auto columns = study::table_of(rows);
  const auto trends = study::trends_of(rows, columns);
  const auto& first = trend(trends, "balanced.hopf.1");
  EXPECT_EQ(first.variants, (std::vector<std::string>{"narrow", "as given", "wide", "wider"}));
  EXPECT_EQ(first.at, (std::vector<double>{0.8, 1, 1.2, 1.5}));
  EXPECT_EQ(first.difference, (std::vector<double>{1000, 500, 100}));
  EXPECT_EQ(first.uncertainty, (std::vector<double>{30, 40, 60}));
  EXPECT_EQ(first.sign, "+");
  EXPECT_EQ(trend(trends, "balanced.hopf.2").sign, "undetermined");
  EXPECT_EQ(trend(trends, "balanced.hopf.3").sign, "mixed");
  EXPECT_EQ(trend(trends, "balanced.hopf.4").sign, "no bar");
  EXPECT_EQ(trend(trends, "balanced.hopf.count").difference, (std::vector<double>{0, 0, 1}));
  // The second one of five need not be the second one of four.
  EXPECT_TRUE(std::isnan(trend(trends, "balanced.hopf.2").difference[2]));
  EXPECT_EQ(trend(trends, "balanced.hopf.count").sign, "+");
  // A value that only one variant has shows no trend.
  EXPECT_THROW((void)trend(trends, "balanced.hopf.5"), core::Bug);
  study::Findings results(MPI_COMM_WORLD, "s", "sweep", "s.checkpoint.h5", nullptr);
  study::put_table(results, rows, {});
  const auto files = io::csv_tables(results.group());
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0].name, "table");
  const std::string& csv = files[0].text;
  EXPECT_EQ(csv.substr(0, 80), "variant,verdict,clearance,balanced.hopf.1 [rpm],balanced.hopf.1 +- [rpm],balance")
      << csv;
  EXPECT_NE(csv.find("\nnarrow,-,0.8,4000,20,5590,1,"), std::string::npos) << csv;
}

// Values carry their bars into the table where their study gives them.
TEST(SweepTable, ValuesHaveTheBarsOfTheirStudy) {
  io::StudySummary s;
  s.name = "static";
  s.set("load.B1", 12.4e3, "N");
  s.set("load.B2", 47.8e3, "N");
  s.values[0].second.more["uncertainty"] = 3.0;
  const auto columns = study::columns_of(s);
  ASSERT_EQ(columns.size(), 2U);
  EXPECT_EQ(columns[0].name, "static.load.B1");
  EXPECT_EQ(columns[0].uncertainties[0], 3.0);
  EXPECT_TRUE(std::isnan(columns[1].uncertainties[0]));
}

TEST(SweepTable, LinesOfAGridKeepTheOtherQuantities) {
  std::vector<study::SweepRow> rows{{"as given", {}, {with_hopf({{100, 1}})}}};
  for (const double a : {1.0, 2.0})
    for (const double b : {5.0, 6.0})
      rows.push_back({"v", {{"a", a, 1, "m"}, {"b", b, 5, "N"}}, {with_hopf({{100 * a - 10 * (b - 5), 1}})}});
  int of_a = 0, of_b = 0;
  for (const auto& t : study::trends_of(rows, study::table_of(rows))) {
    if (t.column != "balanced.hopf.1") continue;
    if (t.quantity == "a") {
      ++of_a;
      EXPECT_EQ(t.sign, "+");
      EXPECT_EQ(t.beside, of_a == 1 ? "b 5 N" : "b 6 N");
    } else {
      ++of_b;
      EXPECT_EQ(t.sign, "-");
    }
  }
  EXPECT_EQ(of_a, 2);
  EXPECT_EQ(of_b, 2);
}

// Companions that are no numbers are told apart by their names, and neither takes the other's points.
TEST(SweepTable, LinesBesideNamedVariantsAreTheirOwn) {
  const study::Deck deck = load(
      branch +
      "  - sweep:\n"
      "      of: [balanced]\n"
      "      variants:\n"
      "        thin: {bearings.B1.lubricant: hot_vg46}\n"
      "        plain: {bearings.B2.geometry: {type: cylindrical, radius: 0.2 m, length: 0.2 m, clearance: 200 um}}\n"
      "      grid:\n"
      "        bearings.B3.geometry.clearance: [x0.9, x1.1]\n");
  const auto& variants = sweep_of(deck).variants();
  ASSERT_EQ(variants.size(), 4U);
  std::vector<study::SweepRow> rows{{"as given", {}, {with_hopf({{100, 1}})}}};
  for (std::size_t k = 0; k < 4; ++k)
    rows.push_back({variants[k].name, variants[k].coordinates, {with_hopf({{k == 1 ? 110 : k == 3 ? 90 : 100, 1}})}});
  std::vector<std::string> beside, sign;
  for (const auto& t : study::trends_of(rows, study::table_of(rows))) {
    if (t.column != "balanced.hopf.1") continue;
    beside.push_back(t.beside);
    sign.push_back(t.sign);
  }
  EXPECT_EQ(beside, (std::vector<std::string>{"thin", "plain"}));
  EXPECT_EQ(sign, (std::vector<std::string>{"+", "-"}));
}

// A balance grade is a number in mm/s.
TEST(Sweep, GradesAreNumbers) {
  const study::Deck deck =
      load(branch + "  - sweep:\n      of: [balanced]\n      grid: {unbalance.gen_pair.grade: [x2, G6.3]}\n");
  const auto& variants = sweep_of(deck).variants();
  ASSERT_EQ(variants.size(), 2U);
  EXPECT_NEAR(variants[0].deck->machine.unbalance[0].grade->velocity, 5e-3, 1e-18);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(variants[k].coordinates[0].value, k == 0 ? 5 : 6.3, 1e-12);
    EXPECT_NEAR(variants[k].coordinates[0].given, 2.5, 1e-12);
    EXPECT_EQ(variants[k].coordinates[0].unit, "mm/s");
  }
}

TEST(SweepTable, ComesBackFromItsFile) {
  io::StudySummary s;
  s.name = "sweep";
  s.kind = "sweep";
  s.variants.push_back({"wide", {{"bearings.B1.geometry.clearance", "200 um"}}, {with_hopf({{5000, 10}})}});
  s.columns.push_back({"balanced.hopf.1", "rpm", {5000, unknown}, {10, unknown}});
  s.trends.push_back({"balanced.hopf.1", "clearance", "um", "", "+", {"a", "b"}, {1, 2}, {30}, {4}});
  io::Summary all;
  all.studies.push_back(s);
  const std::string text = all.to_json();
  EXPECT_EQ(io::Summary::from_json(text).to_json(), text);
  EXPECT_EQ(io::Summary::from_json(text).studies[0].variants[0].studies[0].bifurcations[0].value, 5000);
  io::Group group;
  group.child("a").put("x", {1, 2, 3}, "m", "three numbers");
  group.set("title", "bytes");
  EXPECT_EQ(io::from_bytes(io::to_bytes(group)), group);
}

TEST(Advice, OnlyUnusualSegments) {
  const study::Deck deck = load("  - static: {speed: 3600 rpm}\n");
  EXPECT_TRUE(rotor::advice(deck.machine.rotor).empty());
  rotor::Options shaft;
  const auto add = [&](double length, double stiffness, double mass) {
    rotor::Segment s;
    s.length = length;
    s.outer_stiffness_diameter = stiffness;
    s.outer_mass_diameter = mass;
    shaft.segments.push_back(s);
  };
  add(0.02, 0.1, 0.2);   // 0.2
  add(0.081, 0.1, 0.2);  // 0.81: too long, and 4.05 times its neighbour
  add(0.04, 0.1, 0.2);
  add(0.01, 0, 0.1);  // 0.1, by the diameter of the material; 4 times less is just right
  add(0.0049, 0.1, 0.1);
  const auto lines = rotor::advice(shaft);
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_NE(lines[0].find("factor of 4.05"), std::string::npos) << lines[0];
  EXPECT_EQ(lines[1], "rotor.segments.2: length over stiffness diameter is 0.81, 0.05 to 0.8 is recommended");
  EXPECT_EQ(lines[2], "rotor.segments.5: length over stiffness diameter is 0.049, 0.05 to 0.8 is recommended");
  add(0.08, 0.1, 0.1), add(0.1, 0.1, 0.1), add(0.2, 0.1, 0.1), add(0.05, 0.1, 0.1), add(0.1, 0.1, 0.1);
  EXPECT_EQ(rotor::advice(shaft)[2],
            "rotor.segments.2, 7 to 8, 10: length over stiffness diameter is 0.81 to 2, 0.05 to 0.8 is recommended");
}

// A study that only stands for the variants of a sweep does not run by itself, unless another one goes on from it or
// from a branch that it adds.
TEST(Sweep, KnowsWhoGoesOnFromABranchThatIsAdded) {
  const study::Deck deck = load(
      "  - cycle_branch: {name: A, unbalance: [gen_pair], range: {from: 2000 rpm, to: 3000 rpm}, follow_flips: true}\n"
      "  - cycle_branch: {name: B, unbalance: [gen_pair], range: {from: 2000 rpm, to: 3000 rpm}}\n"
      "  - locus: {of: A flip 1, bifurcation: 1, parameter: unbalance.gen_pair.grade, range: {from: 2 mm/s, to: 3 "
      "mm/s}}\n"
      "  - locus: {name: other, of: B, bifurcation: 1, parameter: unbalance.gen_pair.grade, "
      "range: {from: 2 mm/s, to: 3 mm/s}}\n");
  const auto &a = *deck.studies[0], &b = *deck.studies[1], &of_flip = *deck.studies[2], &of_b = *deck.studies[3];
  EXPECT_TRUE(of_flip.goes_on_from(a));
  EXPECT_FALSE(of_flip.goes_on_from(b));
  EXPECT_TRUE(of_b.goes_on_from(b));
  EXPECT_FALSE(of_b.goes_on_from(a));
  EXPECT_FALSE(b.goes_on_from(a));
}
