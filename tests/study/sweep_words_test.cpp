// Words of a sweep: what its rows say of their stability, and their warnings.

#include <gtest/gtest.h>

#include "study/sweep/sweep_table.hpp"
#include "study/sweep/verdict_words.hpp"
#include "whirl/study/sweep/sweep.hpp"

using namespace whirl;

namespace {

using Lines = std::vector<std::string>;

// A row with what is unusual about its deck, and warnings of its study `m`.
study::SweepRow row(const std::string& name, Lines unusual, Lines warnings) {
  study::SweepRow r{name, {}, {}, std::move(unusual)};
  if (name != "as given") r.coordinates.push_back({"Q", 1, 0, "N/m"});
  io::StudySummary s;
  s.name = "m";
  s.warnings = std::move(warnings);
  r.studies.push_back(std::move(s));
  return r;
}

}  // namespace

// A row of a sweep says whether its machine is stable, whatever study found it.
TEST(SweepVerdict, IsThatOfTheStudies) {
  using study::StabilityWord;
  io::StudySummary branch, modes, response;
  branch.name = "balanced";
  branch.stability = "loses stability";
  branch.ranges = {{600, 5000, "rpm", "stable"}, {5000, 7500, "rpm", "unstable"}};
  EXPECT_EQ(study::verdict_of(branch).words, "stable 600 to 5000, unstable to 7500 rpm");
  EXPECT_EQ(study::verdict_of(branch).found, StabilityWord::in_part);
  modes.name = "modes";
  const auto mode = [&](double speed, const std::string& stability) {
    io::ModeEntry m;
    m.speed = speed;
    m.speed_unit = "rpm";
    m.stability = stability;
    m.more["mode"] = 1;
    modes.modes.push_back(m);
  };
  mode(3000, "stable");
  EXPECT_EQ(study::verdict_of(modes).found, StabilityWord::stable);
  mode(3000, "not resolved");
  EXPECT_EQ(study::verdict_of(modes).found, StabilityWord::stable);
  modes.modes.back().stability = "undetermined";
  EXPECT_EQ(study::verdict_of(modes).found, StabilityWord::undetermined);
  mode(7500, "diverges");
  EXPECT_EQ(study::verdict_of(modes).words, "unstable at 7500 rpm");
  modes.modes.erase(modes.modes.begin(), modes.modes.begin() + 2);
  EXPECT_EQ(study::verdict_of(modes).found, StabilityWord::unstable);
  // Of a shaft without its bearings nothing is said.
  modes.modes.front().more.clear();
  EXPECT_EQ(study::verdict_of(modes).found, StabilityWord::nothing);
  response.name = "r";
  response.stability = "unstable at the 13 speeds counted";
  EXPECT_EQ(study::verdict_of(response).found, StabilityWord::unstable);
  response.stability = "unstable from 300 to 900 rpm";
  EXPECT_EQ(study::verdict_of(response).found, StabilityWord::in_part);
  response.stability = "stable throughout";
  const std::vector<io::StudySummary> both{branch, response};
  EXPECT_EQ(study::verdict_of(both).words, "balanced: stable 600 to 5000, unstable to 7500 rpm; r: stable throughout");
  EXPECT_EQ(study::verdict_of(both).found, StabilityWord::in_part);
  modes = branch;
  modes.stability = "loses stability, by the 9 speeds computed";
  EXPECT_EQ(study::verdict_of(modes).words, "stable 600 to 5000, unstable to 7500 rpm, by the 9 speeds computed");
  response.stability.clear();
  response.status = "did not converge";
  EXPECT_EQ(study::verdict_of(response).words, "no result: did not converge");
}

TEST(SweepWarnings, StandOnceWithTheirRows) {
  const std::string mesh = "a mesh is coarse";
  EXPECT_EQ(study::warnings_of({row("as given", {}, {mesh, mesh}), row("a", {}, {mesh, "grows at 12.5 Hz"}),
                                row("b", {}, {mesh, "grows at 9e-1 Hz"})},
                               {}),
            (Lines{"all rows, m: a mesh is coarse", "'a', 'b' (numbers of 'a'), m: grows at 12.5 Hz"}));
}

// What the deck as it stands says of itself is not repeated; what changes make unusual is said.
TEST(SweepWarnings, LeaveOutWhatTheDeckSaysAlone) {
  const std::string bars = "bars: none", damping = "bearings.B1: negative damping (C_xx = -1 N s/m)";
  const Lines given{bars}, changed{bars, damping};
  EXPECT_EQ(study::warnings_of({row("as given", given, {}), row("a", given, {}), row("b", given, {})}, given), Lines{});
  for (const bool counted : {false, true}) {
    std::vector<study::SweepRow> rows{row("a", changed, {}),
                                      row("b", {bars, "bearings.B1: negative damping (C_xx = -20 N s/m)"}, {})};
    if (counted) rows.insert(rows.begin(), row("as given", given, {}));
    const Lines found = study::warnings_of(rows, given);
    ASSERT_EQ(found.size(), 1U) << counted;
    EXPECT_TRUE(found[0].ends_with("(numbers of 'a'): " + damping)) << found[0];
  }
  // Where a change takes it away, it is said of whom it remains true.
  EXPECT_EQ(study::warnings_of({row("as given", {damping}, {}), row("a", {}, {}), row("b", {damping}, {})}, {damping}),
            (Lines{"'as given', 'b': " + damping}));
}

// Two warnings of one row are two, and digits of names are no numbers.
TEST(SweepWarnings, SwallowNone) {
  const Lines a{"bearings.B1 has 3 um", "bearings.B2 has 3 um", "node 12 moves 1.5 um", "node 40 moves 1.5 um",
                "mode 3 grows",         "mode 7 grows",         "segments.2 is 0.81",   "'run 1' ends",
                "from 1 to 2 rpm",      "from 3 to 4 rpm"};
  Lines alone;
  for (const std::string& line : a) alone.push_back("'a', m: " + line);
  EXPECT_EQ(study::warnings_of({row("a", {}, a)}, {}), alone);
  EXPECT_EQ(study::warnings_of({row("a", {}, a), row("b", {},
                                                     {"node 41 moves 1.5 um", "segments.3 is 0.81", "'run 2' ends",
                                                      "bearings.B2 has 4.25 um", "from 5 to 6 rpm"})},
                               {})
                .size(),
            a.size() + 3);
}

// Four digits where they tell the rows apart, else more; the names in the results stay.
TEST(SweepBrief, NamesAreAsShortAsTheyDiffer) {
  const auto shown = [](const Lines& names) {
    study::StudyResult result;
    io::SweepColumn column{"m.threshold", "rad/s", {}, {}};
    for (const std::string& name : names) {
      result.summary.variants.push_back({name, {}, {}});
      result.summary.variants.back().studies.emplace_back().name = "m";
      column.values.push_back(1);
      column.uncertainties.push_back(0.1);
    }
    result.summary.columns = {column};
    Lines out;
    const io::Brief brief = study::Sweep().brief(result, {});
    for (const auto& row : brief.tables.at(0).rows) out.push_back(row.at(0).text);
    return out;
  };
  EXPECT_EQ(shown({"clearance x0.933333333333, supply 4.66666666667 bar", "clearance x1.06666666667, supply 2 bar"}),
            (Lines{"clearance x0.9333, supply 4.667 bar", "clearance x1.067, supply 2 bar"}));
  EXPECT_EQ(shown({"speed 10000.0333333 rpm", "speed 12345.6666667 rpm", "load 1.5e+06 N", "G2.5", "pads 1.25"}),
            (Lines{"speed 10000 rpm", "speed 12346 rpm", "load 1.5e+06 N", "G2.5", "pads 1.25"}));
  EXPECT_EQ(shown({"gap 1.00013333333 mm", "gap 1.00016666667 mm", "gap 1.33333333333e-05 m"}),
            (Lines{"gap 1.0001 mm", "gap 1.0002 mm", "gap 1.3333e-05 m"}));
}
