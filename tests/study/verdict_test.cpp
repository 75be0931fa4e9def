// Where a branch is stable, by points and changes together, and which change is the threshold of a speed.

#include "study/bars/verdict.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "study/bars/beyond.hpp"
#include "study/bifurcation.hpp"
#include "study/packed.hpp"

namespace {

using namespace whirl::study;
using whirl::io::Bifurcation;
using whirl::io::BifurcationType;

constexpr auto stable = StabilityClass::stable, unstable = StabilityClass::unstable;

struct Seen {
  double parameter;
  int unstable;
};

BranchVerdict verdict_of(const std::vector<Seen>& points, const std::vector<BranchChange>& changes) {
  BranchVerdict v;
  for (const Seen& p : points) v.add(p.parameter, p.unstable > 0 ? unstable : stable, p.unstable);
  for (const BranchChange& c : changes) v.add(c);
  return v;
}

std::string words(const BranchVerdict& v) {
  std::string out;
  for (const auto& r : v.ranges("")) out += fmt::format("{} {:g}..{:g}; ", r.stability, r.from, r.to);
  return out;
}

// The parameter of the threshold; not a number without one.
double threshold(const BranchVerdict& v, const std::vector<BranchChange>& changes) {
  const int k = threshold_among(v.limits());
  return k < 0 ? NAN : changes[static_cast<std::size_t>(k)].parameter;
}

// A wave of a film's mesh grows at 4800, whirl sets in at 5600: what the wave hides is not known, whirl is.
TEST(Verdict, OfAWaveOfTheMeshIsOpen) {
  auto alone = verdict_of({{4000, 0}, {4800, 0}}, {});
  alone.unresolved(1);
  EXPECT_EQ(words(alone), "stable 4000..4000; undetermined 4800..4800; ");
  EXPECT_EQ(alone.text(), "undetermined");
  const BranchChange whirl{2, 5600, 0, 2, 1, false, 0};
  auto both = verdict_of({{4000, 0}, {4800, 0}, {5300, 0}, {6000, 2}}, {whirl});
  both.unresolved(1);
  EXPECT_EQ(words(both), "stable 4000..4000; undetermined 4800..4800; stable 5300..5600; unstable 5600..6000; ");
  EXPECT_EQ(both.text(), "loses stability");
  EXPECT_EQ(threshold(both, {whirl}), 5600);
}

// Waves of the mesh grow at the points 1 to 3, where the wavering film has a fold and a Hopf point, too.
TEST(Verdict, OfAFilmThatIsNotResolvedIsOpen) {
  const BranchChange fold{2, 5, 0, 1, 1, true, 0}, hopf{3, 4.5, 1, 3, -1, false, 1}, early{0, 1.5, 0, 2, 1, false, 0};
  auto v = verdict_of({{1, 0}, {2, 0}, {4, 0}, {4.8, 1}, {4, 3}}, {fold, hopf});
  for (const int k : {1, 2, 3, 4}) v.unresolved(k);
  EXPECT_EQ(v.text(), "undetermined");
  EXPECT_EQ(v.ranges("").front().stability, "stable");
  for (std::size_t k = 1; k < v.ranges("").size(); ++k) EXPECT_EQ(v.ranges("")[k].stability, "undetermined") << k;
  EXPECT_TRUE(v.limits().empty());
  EXPECT_TRUE(v.open_at(0) && v.open_at(1));
  // What is known before stays.
  auto loses = verdict_of({{1, 0}, {2, 2}, {4, 2}}, {early});
  loses.unresolved(2);
  EXPECT_EQ(loses.text(), "loses stability");
  EXPECT_EQ(words(loses), "stable 1..1.5; unstable 1.5..2; undetermined 4..4; ");
  EXPECT_EQ(loses.limits().size(), 1U);
  EXPECT_FALSE(loses.open_at(0));
}

// Two multipliers near +1 by rounding, beside a fold: no other mesh has such a pair.
TEST(Verdict, TellsPairsBesideAFoldFromBifurcations) {
  whirl::solve::LocatedEvent pair{whirl::solve::Event::neimark_sacker, 1, 0, 0, std::polar(1.0, 0.02)};
  EXPECT_TRUE(doubtful_pair(pair, NAN));
  EXPECT_FALSE(doubtful_pair(pair, 0.5)) << "other meshes confirm it";
  pair.critical = std::polar(1.0, 1.9);
  EXPECT_FALSE(doubtful_pair(pair, NAN)) << "far from +1";
  pair.event = whirl::solve::Event::flip;
  pair.critical = 1;
  EXPECT_FALSE(doubtful_pair(pair, NAN));
}

// Stable below 4500, unstable to 5000, stable to 5600, unstable beyond.
TEST(Threshold, IsTheLowestSpeedAtWhichStabilityIsLostInEitherDirection) {
  const std::vector<BranchChange> up{{0, 4500, 0, 2, 1}, {1, 5000, 2, 0, 1}, {2, 5600, 0, 2, 1}},
      down{{0, 5600, 2, 0, -1}, {1, 5000, 0, 2, -1}, {2, 4500, 2, 0, -1}};
  const auto rising = verdict_of({{4000, 0}, {4800, 2}, {5300, 0}, {6000, 2}}, up),
             falling = verdict_of({{6000, 2}, {5300, 0}, {4800, 2}, {4000, 0}}, down);
  EXPECT_EQ(threshold(rising, up), 4500);
  EXPECT_EQ(threshold(falling, down), 4500);
  EXPECT_EQ(words(rising), "stable 4000..4500; unstable 4500..5000; stable 5000..5600; unstable 5600..6000; ");
  EXPECT_EQ(words(falling), "unstable 6000..5600; stable 5600..5000; unstable 5000..4500; stable 4500..4000; ");
  EXPECT_EQ(rising.text(), "loses stability");
  EXPECT_EQ(falling.text(), "unstable from its start");
}

TEST(Threshold, IsNoneWhereOthersAreUnstableOrStabilityIsGained) {
  const std::vector<BranchChange> others{{0, 1, 2, 4, 1}, {0, 2, 4, 2, 1}}, gained{{0, 1, 2, 0, 1}},
      gained_on_the_way_down{{0, 1, 0, 2, -1}};
  EXPECT_TRUE(std::isnan(threshold(verdict_of({{0, 2}, {3, 2}}, others), others)));
  EXPECT_TRUE(std::isnan(threshold(verdict_of({{0, 2}, {3, 0}}, gained), gained)));
  const auto down = verdict_of({{3, 0}, {0, 2}}, gained_on_the_way_down);
  EXPECT_TRUE(std::isnan(threshold(down, gained_on_the_way_down)));
  ASSERT_EQ(down.limits().size(), 1U);
  EXPECT_FALSE(down.limits()[0].stable_below);
}

// Both lie inside one step, between stable points: found late, in any order.
TEST(Verdict, SeesAPairOfChangesBetweenTwoStablePoints) {
  const std::vector<BranchChange> pair{{0, 0.1561, 2, 0, -1}, {0, 0.1683, 0, 2, -1}};
  const auto v = verdict_of({{0.2, 0}, {0.1, 0}}, pair);
  EXPECT_EQ(v.text(), "loses stability");
  EXPECT_EQ(words(v), "stable 0.2..0.1683; unstable 0.1683..0.1561; stable 0.1561..0.1; ");
  EXPECT_EQ(verdict_of({{0.2, 0}, {0.1, 0}}, {}).text(), "stable throughout");
}

// The branch turns at 5 and goes back, unstable; two more changes lie in the step of the fold.
TEST(Verdict, CutsAtFolds) {
  EXPECT_EQ(words(verdict_of({{4, 0}, {4.5, 1}}, {{0, 5, 0, 1, 0, true}})), "stable 4..5; unstable 5..4.5; ");
  EXPECT_EQ(words(verdict_of({{4, 0}, {4.5, 2}}, {{0, 5, 0, 1, 0, true}, {0, 4.8, 1, 2, -1}})),
            "stable 4..5; unstable 5..4.5; ");
  const std::vector<BranchChange> fold{{0, 5, 0, 1, 0, true}};
  EXPECT_EQ(threshold(verdict_of({{4, 0}, {4.5, 1}}, fold), fold), 5);
  // Behind a fold at the end of the branch nobody looked.
  EXPECT_EQ(verdict_of({{4, 0}, {4.9, 0}}, {{1, 5, 0, 1, 0, true}}).text(), "stable throughout");
}

TEST(Verdict, IsUndeterminedWhereAPointIsDoubtful) {
  auto v = verdict_of({{0, 0}, {1, 0}, {2, 0}}, {});
  v.doubt(1);
  EXPECT_EQ(v.text(), "undetermined");
  EXPECT_EQ(words(v), "undetermined 0..2; ");
  // Beside a located change doubt is natural.
  auto w = verdict_of({{0, 0}, {1, 0}, {2, 2}}, {{1, 1.1, 0, 2, 1}});
  w.doubt(1);
  EXPECT_EQ(w.text(), "loses stability");
}

// Multipliers of 1.01 +- 0.1 near the birth and 1.5 +- 0.1 beyond: what is known beyond is not lost.
TEST(Verdict, DoubtReachesToTheNextSettledPoint) {
  const std::vector<Seen> points{{5, 1}, {4, 1}, {3, 1}, {2, 1}, {1, 1}};
  auto birth = verdict_of(points, {});
  birth.doubt(0);
  for (const int k : {2, 3, 4}) birth.settle(k);
  EXPECT_EQ(words(birth), "undetermined 5..3; unstable 3..1; ");
  EXPECT_EQ(birth.text(), "undetermined");
  auto middle = verdict_of(points, {});
  middle.doubt(2);
  for (const int k : {0, 1, 4}) middle.settle(k);
  EXPECT_EQ(words(middle), "unstable 5..4; undetermined 4..1; ");
  middle.settle(3);
  EXPECT_EQ(words(middle), "unstable 5..4; undetermined 4..2; unstable 2..1; ");
  auto twice = verdict_of(points, {});
  for (const int k : {1, 4}) twice.doubt(k);
  for (const int k : {0, 2, 3}) twice.settle(k);
  EXPECT_EQ(words(twice), "undetermined 5..3; unstable 3..2; undetermined 2..1; ");
  auto one = verdict_of({{5, 0}}, {});
  one.doubt(0);
  EXPECT_EQ(words(one), "undetermined 5..5; ");
  // Over a fold of two unstable halves the stretch is cut, and the doubt goes on.
  auto fold = verdict_of({{1, 1}, {2, 1}, {2, 2}, {1, 2}}, {{1, 2.5, 1, 2, 0, true}});
  fold.doubt(1);
  for (const int k : {0, 2}) fold.settle(k);
  EXPECT_EQ(words(fold), "undetermined 1..2.5; undetermined 2.5..2; unstable 2..1; ");
}

std::string sentence(BifurcationType type, const char* criticality, int below, int above, bool again = false,
                     BranchKind kind = {}, const char* path = "speed") {
  Bifurcation b;
  b.type = type;
  b.parameter = path;
  b.value = 4470.71;
  b.uncertainty = 0.6;
  b.unit = "rpm";
  b.criticality = criticality;
  kind.cycles = type != BifurcationType::hopf;
  put_counts(b, {0, b.value, below, above, 1, false, 0});
  tell(b, kind, again);
  return b.sentence;
}

TEST(Sentence, SaysWhereWhirlBeginsAndNeverThatItJumpsUpWhereItEnds) {
  EXPECT_EQ(sentence(BifurcationType::hopf, "subcritical", 0, 2),
            "above this speed the rotor jumps to large whirl; just below it a disturbance can trigger the same whirl");
  EXPECT_EQ(sentence(BifurcationType::hopf, "supercritical", 0, 2), "above this speed whirl grows from nothing");
  for (const char* criticality : {"subcritical", "supercritical", "undetermined", ""})
    for (const auto type : {BifurcationType::hopf, BifurcationType::flip, BifurcationType::neimark_sacker}) {
      const std::string ends = sentence(type, criticality, type == BifurcationType::flip ? 1 : 2, 0, true);
      EXPECT_EQ(ends.find("jumps to"), std::string::npos) << ends;
      EXPECT_EQ(ends.rfind("stable again above 4470.7 rpm", 0), 0U) << ends;
    }
  EXPECT_EQ(sentence(BifurcationType::hopf, "supercritical", 2, 0, false),
            "stable above 4470.7 rpm: whirl shrinks to nothing there");
}

TEST(Sentence, OfAFurtherPairSaysNoMore) {
  for (const char* criticality : {"subcritical", "supercritical"}) {
    EXPECT_EQ(sentence(BifurcationType::hopf, criticality, 2, 4), "another pair becomes unstable");
    EXPECT_EQ(sentence(BifurcationType::flip, criticality, 1, 2), "another multiplier becomes unstable");
    EXPECT_EQ(sentence(BifurcationType::neimark_sacker, criticality, 3, 1),
              "one pair becomes stable again with rising speed; 1 multiplier remains unstable");
  }
}

TEST(Sentence, NamesWhatIsBornAndWhatVaries) {
  EXPECT_NE(sentence(BifurcationType::flip, "supercritical", 0, 1).find("half-frequency whirl grows"),
            std::string::npos);
  EXPECT_NE(sentence(BifurcationType::neimark_sacker, "supercritical", 0, 2).find("a second whirl grows"),
            std::string::npos);
  BranchKind no_shaft;
  no_shaft.shaft = false;
  EXPECT_EQ(
      sentence(BifurcationType::hopf, "subcritical", 0, 2, false, no_shaft, "brusselator.length"),
      "above this length the system jumps to a large oscillation; just below it a disturbance can trigger the same "
      "oscillation");
  EXPECT_NE(sentence(BifurcationType::hopf, "", 0, 2, false, {}, "bearings.A.film.orifices.1.supply")
                .find("above this supply"),
            std::string::npos);
}

TEST(Changes, HaveATableAndSurviveACheckpoint) {
  const std::vector<BranchChange> changes{{3, 4.5, 0, 2, -0.5, false, 1}, {4, 5, 2, 3, 0, true, -1}};
  whirl::io::Group group;
  put_changes(group, changes, "rpm");
  EXPECT_EQ(group.reals("unstable_after"), (std::vector<double>{2, 3}));
  EXPECT_EQ(group.reals("bifurcation"), (std::vector<double>{1, -1}));
  const auto back = unpack<std::vector<BranchChange>>(pack(changes));
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[0].below(), 2);
  EXPECT_EQ(back[0].bifurcation, 1);
  EXPECT_TRUE(back[1].fold);
  EXPECT_EQ(back[1].after, 4);
}

}  // namespace
