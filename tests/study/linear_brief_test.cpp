// What the briefs of the linear room say of stable, unstable, undamped and empty results.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "study/linear/critical_speed_map.hpp"
#include "study/linear/element_convergence.hpp"
#include "study/linear/frequency_response.hpp"
#include "study/linear/modes.hpp"
#include "study/linear/reduction_errors.hpp"
#include "study/linear/unbalance_response.hpp"
#include "whirl/study/sweep/sweep.hpp"

namespace whirl::study {
namespace {

// What a deck would have given.
template <class S>
typename S::Given& options_of(S& study) {
  return *static_cast<typename S::Given*>(S::place(study));
}

constexpr double rpm = std::numbers::pi / 30;

io::Brief brief_of(const Study& study, io::StudySummary summary, bool delivered = true, io::Group group = {}) {
  StudyResult result;
  result.group = std::move(group);
  result.summary = std::move(summary);
  result.delivered = delivered;
  io::Brief brief = study.brief(result, {});
  io::typeset(brief);
  return brief;
}

const io::BriefTable* table(const io::Brief& b, const std::string& head) {
  for (const io::BriefTable& t : b.tables)
    if (t.caption.starts_with(head)) return &t;
  return nullptr;
}

std::vector<std::string> texts(const std::vector<io::BriefCell>& row) {
  std::vector<std::string> out;
  for (const io::BriefCell& c : row) out.push_back(c.text);
  return out;
}

io::StudySummary over_speeds() {
  io::StudySummary s;
  s.points = 30;
  s.modes.push_back({3000, -5, 300, 0.1, "forward", "rpm", {{"mode", 1}, {"damping_ratio", 0.016}}, "stable"});
  return s;
}

void put_critical(io::StudySummary& s, int number, double speed, double decrement, bool margins) {
  const std::string head = "critical." + std::to_string(number) + ".";
  s.set(head + "speed", speed, "rpm", {{"uncertainty", 5}});
  s.set(head + "log_decrement", decrement, "1");
  s.set(head + "mode", number, "1");
  if (decrement > 0) s.set(head + "amplification_factor", std::numbers::pi / decrement, "1");
  if (!margins || decrement < 0) return;
  s.set(head + "separation_margin", 0.05, "1");
  s.set(head + "required_margin", 0.15, "1");
}

TEST(ModesBrief, PartsCriticalSpeedsFromDampedOnes) {
  Modes study;
  options_of(study).range = deck::Range{500 * rpm, 3000 * rpm, "rpm"};
  io::StudySummary s = over_speeds();
  put_critical(s, 1, 1234, 0.1, true);
  put_critical(s, 2, 1500, 2, true);
  put_critical(s, 3, 2345, 0.2, true);
  put_critical(s, 4, 2500, -0.1, true);
  put_critical(s, 5, 2600, 0, false);
  s.set("operating_speed", 1300, "rpm");
  const io::Brief b = brief_of(study, s);
  ASSERT_EQ(b.sentences.size(), 3);
  EXPECT_EQ(b.sentences[0],
            "critical speeds with an amplification above 2.5: 1234.0 +- 5.0, 2345.0 +- 5.0 and 2600.0 +- 5.0 rpm");
  EXPECT_EQ(b.sentences[1], "too near the operating speed: 1234.0 +- 5.0 and 2345.0 +- 5.0 rpm");
  EXPECT_EQ(b.sentences[2], "speed at the frequency of a mode that grows: 2500.0 +- 5.0 rpm");
  const io::BriefTable* critical = table(b, "Critical speeds");
  ASSERT_TRUE(critical);
  EXPECT_EQ(texts(critical->rows[0]),
            (std::vector<std::string>{"1", "1234.0 +- 5.0", "1 fwd", "0.1", "31.42", "5", "15", "TOO NEAR"}));
  EXPECT_EQ(texts(critical->rows[2])[7], "UNSTABLE");
  EXPECT_EQ(texts(critical->rows[3])[3], "undamped");
  EXPECT_EQ(texts(critical->rows[3])[4], "without limit");
  const io::BriefTable* damped = table(b, "Damped, not critical");
  ASSERT_TRUE(damped);
  EXPECT_EQ(damped->rows.size(), 1);
  EXPECT_EQ(damped->rows[0][0].text, "2");
}

TEST(ModesBrief, SaysWhereModesGrow) {
  Modes study;
  options_of(study).range = deck::Range{500 * rpm, 12000 * rpm, "rpm"};
  io::StudySummary s = over_speeds();
  s.ranges = {{500, 700, "rpm", "unstable"}, {700, 9572.6, "rpm", "stable"}, {9572.6, 12000, "rpm", "unstable"}};
  s.set("unstable.1.from", 500, "rpm");
  s.set("unstable.1.to", 700, "rpm");
  s.set("unstable.1.mode", 2, "1");
  s.set("unstable.2.from", 9572.6, "rpm", {{"uncertainty", 5.7}});
  s.set("unstable.2.to", 12000, "rpm");
  s.set("unstable.2.mode", 1, "1");
  s.set("unstable.count", 2, "1");
  const io::Brief b = brief_of(study, s);
  EXPECT_EQ(b.sentences, (std::vector<std::string>{"no critical speed found from 500 to 12000 rpm",
                                                   "unstable up to 700 and from 9572.6 +- 5.7 rpm"}));
  ASSERT_TRUE(table(b, "Unstable speeds"));
  s.ranges = {{500, 12000, "rpm", "unstable"}};
  EXPECT_EQ(brief_of(study, s).sentences[1], "unstable over the whole range, 500 to 12000 rpm");
}

TEST(ModesBrief, SaysOfOneSpeedWhatIsKnownThere) {
  Modes study;
  options_of(study).speeds = {{500 * rpm, "rpm"}};
  io::StudySummary s = over_speeds();
  s.modes[0].speed = 500;
  s.set("at.500.least_damped.frequency", 200 * std::numbers::pi, "rad/s");
  s.set("at.500.least_damped.log_decrement", 0.05, "1", {{"uncertainty", 0.001}});
  s.set("at.500.unstable", 0, "1");
  EXPECT_EQ(brief_of(study, s).sentences[0],
            "at 500 rpm no mode found grows; the least damped one has 100 Hz and a log decrement of 0.0500 +- 0.0010");
  s.set("at.500.unstable", 1, "1");
  EXPECT_EQ(brief_of(study, s).sentences[0], "unstable at 500 rpm: 1 mode grows");
}

TEST(ModesBrief, IsEmptyWithoutAnAnswer) {
  Modes study;
  options_of(study).range = deck::Range{500 * rpm, 12000 * rpm, "rpm"};
  const io::Brief b = brief_of(study, {}, false);
  EXPECT_TRUE(b.sentences.empty() && b.tables.empty());
  EXPECT_EQ(brief_of(study, {}).sentences, std::vector<std::string>{"no mode found"});
}

io::PeakEntry peak(const std::string& place, double speed, double size, const std::string& stability) {
  io::PeakEntry p;
  p.place = place;
  p.speed = {speed, "rpm"};
  p.semi_major = {size, "m"};
  p.amplification_factor = {12, "1"};
  p.stability = stability;
  return p;
}

TEST(ResponseBrief, NamesTheLargestPeakThatIsAMotion) {
  UnbalanceResponse study;
  options_of(study).range = {500 * rpm, 6000 * rpm, "rpm"};
  io::StudySummary s;
  s.points = 10;
  EXPECT_EQ(brief_of(study, s).sentences, std::vector<std::string>{"no peak from 500 to 6000 rpm"});
  // Without a peak the largest amplitude of a motion: not the last one, about an unstable equilibrium.
  io::Group group;
  io::Group& response = group.child("response");
  response.put("speed", {100 * rpm, 200 * rpm, 300 * rpm}, "rad/s", "");
  response.put("node", std::vector<std::int64_t>{3, 7}, "");
  response.put("semi_major", io::Shape{3, 2}, {1e-6, 2e-6, 3e-6, 4e-6, 5e-6, 6e-6}, "m", "");
  response.put("answer", std::vector<std::int64_t>{1, 1, 1}, "");
  response.put("unstable_count", std::vector<std::int64_t>{0, 0, 2}, "");
  s.set("unbalance.g63.mass", 196.66, "kg");
  s.set("unbalance.g63.plane.1", 1.2e-3, "kg m");
  s.set("unbalance.g63.plane.2", 1.1e-3, "kg m");
  EXPECT_EQ(brief_of(study, s, true, group).sentences,
            (std::vector<std::string>{"no peak from 500 to 6000 rpm", "at most 4 um at node 7, 200 rpm",
                                      "unbalance g63: 2.3 kg mm in all planes, by its grade for a mass of 196.66 kg"}));
  s.peaks = {peak("node 4", 3094, 23.4e-6, "stable"), peak("node 4", 5000, 9e-5, "unstable"),
             peak("B1, journal", 3094, 5e-5, "stable")};
  s.peaks[1].notes = {"no amplification factor: the range ends"};
  s.peaks[1].amplification_factor = {};
  s.peaks[1].verdict = "far enough";  // the margin of no motion
  const io::Brief b = brief_of(study, s);
  EXPECT_EQ(b.sentences[0], "largest peak 23.4 um at node 4, 3094 rpm, amplification 12");
  const io::BriefTable* nodes = table(b, "Peaks of the response");
  ASSERT_TRUE(nodes);
  EXPECT_EQ(texts(nodes->rows[1]), (std::vector<std::string>{"2", "node 4", "5000", "90", "", "UNSTABLE"}));
  EXPECT_TRUE(nodes->note.starts_with("2: no amplification factor: the range ends"));
  ASSERT_TRUE(table(b, "Peaks of the journals"));
  for (io::PeakEntry& p : s.peaks) p.stability = "unstable";
  EXPECT_EQ(brief_of(study, s).sentences[0], "2 peaks, none of which is known to be a motion of the machine");
}

// A peak that is too narrow for a height has none; that of an undamped mode has no limit.
TEST(ResponseBrief, TellsUndampedPeaksFromNarrowOnes) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  UnbalanceResponse study;
  options_of(study).range = {500 * rpm, 6000 * rpm, "rpm"};
  io::StudySummary s;
  s.points = 10;
  s.peaks = {peak("node 4", 3094, infinity, "undamped"), peak("node 4", 5000, infinity, "stable")};
  for (io::PeakEntry& p : s.peaks) p.amplification_factor.value = infinity;
  const io::Brief b = brief_of(study, s);
  EXPECT_EQ(b.sentences[0], "undamped peak at node 4, 3094 rpm: the amplitude grows without limit there");
  EXPECT_EQ(texts(b.tables[0].rows[0])[3], "without limit");
  EXPECT_EQ(texts(b.tables[0].rows[1])[3], "");
}

io::Brief brief_of(const Study& study, StudyResult result) {
  io::Brief brief = study.brief(result, {});
  io::typeset(brief);
  return brief;
}

// A speed that grows with the root of the stiffness, and then no more.
TEST(CriticalSpeedMapBrief, SaysHowTheLowestSpeedRises) {
  CriticalSpeedMap study;
  options_of(study).count = 2;
  StudyResult result;
  io::Group& map = result.group.child("map");
  map.put("stiffness", std::vector<double>{1e4, 1e6, 1e8, 1e10}, "N/m", "");
  for (const char* whirl : {"forward", "backward"})
    map.put(whirl, {4, 2}, {10 * rpm, io::no_value, 100 * rpm, 500 * rpm, 200 * rpm, 900 * rpm, 200 * rpm, 950 * rpm},
            "rad/s", "");
  const io::Brief b = brief_of(study, result);
  ASSERT_EQ(b.sentences.size(), 1);
  EXPECT_TRUE(
      b.sentences[0].starts_with("the lowest critical speed of forward whirl: 10 rpm at 10 kN/m, 200 rpm at 10 "
                                 "GN/m; it rises with the power 0.50 of the stiffness at the soft end and 0.00"))
      << b.sentences[0];
  ASSERT_EQ(b.tables.size(), 2);
  EXPECT_EQ(texts(b.tables[0].rows[0]), (std::vector<std::string>{"10 kN/m", "10", ""}));
  EXPECT_TRUE(brief_of(study, StudyResult{}).sentences.empty());
}

TEST(ReductionErrorsBrief, NamesTheFreedomsThatAreEnough) {
  ReductionErrors study;
  options_of(study).methods = {ReductionMethod::modal_free, ReductionMethod::craig_bampton};
  options_of(study).freedoms = {10, 20};
  StudyResult result;
  for (const auto& [name, error] :
       {std::pair{"modal_free.10.", 0.1}, {"modal_free.20.", 2e-3}, {"craig_bampton.20.", 2e-4}})
    for (const char* what : {"frequency_error", "vector_error"})
      result.summary.set(std::string(name) + what, error, "1");
  const io::Brief b = brief_of(study, result);
  EXPECT_EQ(b.sentences, std::vector<std::string>{"freedoms that keep the 10 lowest whirl frequencies to 0.1 %: "
                                                  "modal_free more than tried and craig_bampton 20"});
  EXPECT_EQ(texts(b.tables[0].rows[0]), (std::vector<std::string>{"10", "10", "no answer"}));
  EXPECT_TRUE(brief_of(study, StudyResult{}).tables.empty());
}

TEST(ElementConvergenceBrief, SaysHowFarFrequenciesMove) {
  ElementConvergence study;
  options_of(study).parts = {1, 2};
  options_of(study).elements = {rotor::BeamElement::rayleigh};
  options_of(study).count = 1;
  options_of(study).condition = false;
  StudyResult result;
  io::Group& of = result.group.child("convergence").child("rayleigh");
  of.put("elements", std::vector<double>{4, 8}, "1", "");
  of.put("error", {2, 1}, {0.0123, 0}, "1", "");
  result.summary.set("rayleigh.frequency.1", 200 * std::numbers::pi, "rad/s",
                     {{"uncertainty", 2.46 * std::numbers::pi}});
  const io::Brief b = brief_of(study, result);
  EXPECT_EQ(b.sentences, std::vector<std::string>{
                             "rayleigh: from 4 to 8 elements the 1 lowest whirl frequencies move by at most 1.23 %"});
  ASSERT_EQ(b.tables.size(), 2) << "no order of two meshes, no condition numbers";
  EXPECT_EQ(texts(b.tables[0].rows[0]), (std::vector<std::string>{"1", "100.0 +- 1.2"}));
  EXPECT_TRUE(brief_of(study, StudyResult{}).tables.empty());
}

TEST(FrequencyResponseBrief, NamesLargestAnswersAndLimits) {
  FrequencyResponse study;
  options_of(study).constant_at = {{100 * std::numbers::pi, "Hz"}};
  StudyResult result;
  io::StudySummary& s = result.summary;
  s.set("7.x.from.7.x.largest", 2e-6, "m/N");
  s.set("7.x.from.7.x.largest_at", 60, "Hz");
  s.set("7.x.from.7.x.relative_error", 0.0123, "1");
  s.set("7.y.from.7.x.largest", std::numeric_limits<double>::infinity(), "m/N");
  s.set("7.y.from.7.x.largest_at", 70, "Hz");
  s.set("constant.1.difference", 0.25, "1");
  s.set("constant.1.difference_at", 40, "Hz");
  const io::Brief b = brief_of(study, result);
  EXPECT_EQ(b.sentences,
            (std::vector<std::string>{"undamped resonance at 70 Hz: 1 of 2 transfer functions grow without limit there",
                                      "largest response 2 um/N: 7 x from 7 x, at 60 Hz"}));
  ASSERT_EQ(b.tables.size(), 2);
  EXPECT_EQ(texts(b.tables[0].rows[0]), (std::vector<std::string>{"their coefficients at 50 Hz", "25", "40"}));
  EXPECT_EQ(b.tables[1].rows[1][1].text, "without limit");
  EXPECT_TRUE(brief_of(study, StudyResult{}).tables.empty());
}

// Speeds of a branch in rpm; the deck as given comes first, with the verdict of the study before.
TEST(SweepBrief, SetsVariantsSideBySide) {
  Sweep study;
  StudyResult result;
  io::StudySummary& s = result.summary;
  io::StudySummary given, variant;
  given.name = variant.name = "balanced";
  given.kind = variant.kind = "equilibrium_branch";
  given.stability = "stable throughout";
  variant.ranges = {{500, 4000, "rpm", "stable"}, {4000, 8000, "rpm", "unstable"}};
  s.variants = {{"x0.8", {}, {variant}}};
  s.columns = {{"balanced.threshold", "rad/s", {5000 * rpm, 4000 * rpm}, {12 * rpm, 9 * rpm}},
               {"balanced.hopf.1", "rpm", {5000, 4000}, {12, 9}},
               {"balanced.load.B1", "N", {100, 200}, {io::no_value, io::no_value}}};
  s.trends = {{"balanced.threshold",
               "bearings.*.geometry.clearance",
               "um",
               "",
               "+",
               {"x0.8", "as given"},
               {160, 200},
               {1000 * rpm},
               {21 * rpm}}};
  io::Brief b = study.brief(result, std::vector{given});
  io::typeset(b);
  EXPECT_EQ(b.sentences, (std::vector<std::string>{"1 variant over clearance", "unstable, at least in part: x0.8",
                                                   "threshold rises from 4000.0 +- 9.0 rpm to 5000 +- 12 rpm"}));
  ASSERT_EQ(b.tables.size(), 2);
  EXPECT_EQ(texts(b.tables[0].rows[0]), (std::vector<std::string>{"as given", "stable", "5000 +- 12", "100"}));
  EXPECT_EQ(texts(b.tables[0].rows[1]), (std::vector<std::string>{"x0.8", "unstable in part", "4000.0 +- 9.0", "200"}));
  EXPECT_TRUE(b.tables[0].note.ends_with("x0.8: stable 500 to 4000, unstable to 8000 rpm")) << b.tables[0].note;
  EXPECT_EQ(texts(b.tables[1].rows[0]),
            (std::vector<std::string>{"threshold", "clearance", "160 um", "200 um", "rises", "1000 +- 21 rpm"}));
  EXPECT_TRUE(brief_of(study, StudyResult{}).sentences.empty());
}

}  // namespace
}  // namespace whirl::study
