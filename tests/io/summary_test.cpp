#include "whirl/io/summary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "io/temporary.hpp"
#include "whirl/core/error.hpp"

using namespace whirl;
using namespace whirl::io;

namespace {

Summary example() {
  StudySummary s;
  s.name = "pair, G2.5";
  s.kind = "cycle_branch";
  s.status = "ended at 5400 rpm: film thickness is negative";
  s.wall_seconds = 12.5;
  s.set("mass.total", 42165.66, "kg");
  s.set("load.B3", NAN, "N");
  s.set("alpha.last", 1, "1");
  s.set("mass.total", 42000.0, "kg");
  s.bifurcations.push_back({.type = BifurcationType::neimark_sacker,
                            .parameter = "speed",
                            .value = 5057,
                            .unit = "rpm",
                            .period_s = 60 / 5057.0,
                            .uncertainty = 40,
                            .more = {{"angle_rad", 0.93}, {"error.film", INFINITY}}});
  s.modes.push_back({.speed = 3600,
                     .real = -0.583,
                     .imag = 81.678,
                     .log_decrement = 0.0448,
                     .whirl = "forward",
                     .speed_unit = "rpm"});
  s.points = 73;
  Summary whole;
  whole.title = "Train \"A\"";
  whole.version = "0.1.0";
  whole.ranks = 2;
  whole.wall_seconds = 20;
  whole.set(s);
  return whole;
}

}  // namespace

TEST(Summary, HasTheFieldsThatScriptsReadInOrder) {
  const auto j = nlohmann::ordered_json::parse(example().to_json());
  std::vector<std::string> keys;
  for (const auto& [k, v] : j.items()) keys.push_back(k);
  EXPECT_EQ(keys, (std::vector<std::string>{"title", "version", "ranks", "wall_seconds", "options", "studies"}));
  const auto& s = j["studies"][0];
  keys.clear();
  for (const auto& [k, v] : s.items()) keys.push_back(k);
  EXPECT_EQ(keys, (std::vector<std::string>{"name", "kind", "status", "wall_seconds", "values", "bifurcations", "modes",
                                            "points"}));
  EXPECT_EQ(s["values"].begin().key(), "mass.total");
  EXPECT_EQ(s["values"]["mass.total"]["value"], 42000.0);
  EXPECT_EQ(s["values"]["mass.total"]["unit"], "kg");
  EXPECT_EQ(s["bifurcations"][0]["type"], "neimark_sacker");
  EXPECT_EQ(s["bifurcations"][0]["angle_rad"], 0.93);
  EXPECT_TRUE(s["bifurcations"][0]["criticality"].is_null());
  EXPECT_EQ(s["modes"][0]["whirl"], "forward");
  EXPECT_EQ(s["points"], 73);
}

TEST(Summary, NumbersThatAreNotFiniteBecomeNull) {
  const std::string text = example().to_json();
  const auto j = nlohmann::json::parse(text);  // strict: NaN or Infinity would not parse
  EXPECT_TRUE(j["studies"][0]["values"]["load.B3"]["value"].is_null());
  EXPECT_TRUE(j["studies"][0]["bifurcations"][0]["error.film"].is_null());
}

TEST(Summary, AnEmptyStudyHasEmptyTables) {
  Summary s;
  s.set({.name = "static", .kind = "static"});
  const auto j = nlohmann::json::parse(s.to_json());
  EXPECT_TRUE(j["studies"][0]["values"].is_object());
  EXPECT_TRUE(j["studies"][0]["bifurcations"].is_array());
  EXPECT_TRUE(j["studies"][0]["modes"].is_array());
}

TEST(Summary, ReadsBackWhatItWrote) {
  const test::Temporary folder;
  const Summary s = example();
  s.write(folder / "summary.json");
  const Summary back = Summary::read(folder / "summary.json");
  EXPECT_EQ(back.to_json(), s.to_json());
  EXPECT_TRUE(std::isnan(back.studies[0].values[1].second.value));
}

TEST(Summary, BarsStandBesideTheirValuesAndComeBack) {
  Summary all = example();
  all.studies[0].set("load.B1", 5, "N", {{"uncertainty", 0.5}, {"uncertainty_film_mesh", NAN}});
  all.studies[0].modes[0].more["imag_uncertainty"] = 0.25;
  const auto j = nlohmann::json::parse(all.to_json())["studies"][0];
  EXPECT_EQ(j["values"]["load.B1"]["uncertainty"], 0.5);
  EXPECT_TRUE(j["values"]["load.B1"]["uncertainty_film_mesh"].is_null());
  EXPECT_FALSE(j["values"]["mass.total"].contains("uncertainty"));
  EXPECT_EQ(j["modes"][0]["imag_uncertainty"], 0.25);
  EXPECT_EQ(Summary::from_json(all.to_json()).to_json(), all.to_json());
}

TEST(Summary, PointsOfCodimensionTwoAndSuspicionsComeBack) {
  Summary s = example();
  EXPECT_FALSE(nlohmann::json::parse(s.to_json())["studies"][0].contains("suspected"));
  s.studies[0].codimension_two.push_back({.type = "resonance_1_2",
                                          .parameter = "speed",
                                          .second_parameter = "unbalance.a.grade",
                                          .value = {1384.6, "rad/s"},
                                          .second_value = {6.8, "um"},
                                          .uncertainty = 1e-6,
                                          .more = {{"nondimensional_speed", 8.65}}});
  s.studies[0].suspected.push_back({1, 2, "rpm", "a reason"});
  const Summary back = Summary::from_json(s.to_json());
  EXPECT_EQ(back.to_json(), s.to_json());
  EXPECT_EQ(back.studies[0].codimension_two[0].second_value.value, 6.8);
  EXPECT_EQ(back.studies[0].codimension_two[0].more.at("nondimensional_speed"), 8.65);
  EXPECT_EQ(back.studies[0].suspected[0].reason, "a reason");
}

TEST(Summary, AStudyOfTheSameNameIsReplaced) {
  Summary s = example();
  StudySummary again;
  again.name = "pair, G2.5";
  s.set(again);
  EXPECT_EQ(s.studies.size(), 1u);
  EXPECT_EQ(s.studies[0].points, 0);
}

TEST(Summary, TextThatIsNotUtf8IsWrittenAnyway) {
  Summary s = example();
  s.title = "bad \xff byte";
  EXPECT_TRUE(nlohmann::json::accept(s.to_json()));
}

TEST(Summary, ADamagedFileIsAnErrorWithItsName) {
  const test::Temporary folder;
  std::ofstream(folder / "summary.json") << "{\"title\": \"x\"";
  try {
    (void)Summary::read(folder / "summary.json");
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("summary.json"), std::string::npos);
  }
  EXPECT_THROW((void)Summary::read(folder / "none.json"), core::Error);
}

TEST(Summary, VerdictsAndCurvesComeBack) {
  Summary whole = example();
  StudySummary s = whole.studies[0];
  s.stability = "loses stability";
  s.warnings = {"film of bearing B4 is thin"};
  s.curve = {{"parameter", "rpm", {5000, NAN}}, {"others_unstable", "1", {0, 2}}};
  s.modes[0].stability = "undamped";
  whole.set(s);
  const auto j = nlohmann::ordered_json::parse(whole.to_json());
  EXPECT_EQ(j["studies"][0]["curve"]["others_unstable"]["values"][1], 2);
  const StudySummary back = Summary::from_json(whole.to_json()).studies[0];
  EXPECT_EQ(back.stability, s.stability);
  EXPECT_EQ(back.warnings, s.warnings);
  EXPECT_EQ(back.modes[0].stability, "undamped");
  ASSERT_EQ(back.curve.size(), 2U);
  EXPECT_EQ(back.curve[0].name, "parameter");
  EXPECT_EQ(back.curve[0].unit, "rpm");
  EXPECT_TRUE(std::isnan(back.curve[0].values[1]));
  // None of them stands in the file where there is nothing to say.
  EXPECT_FALSE(nlohmann::ordered_json::parse(example().to_json())["studies"][0].contains("stability"));
}
