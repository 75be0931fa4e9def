// What the answer of a branch says first, of all verdicts that a branch can have.

#include "study/bars/branch_brief.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "study/brief.hpp"

namespace {

using namespace whirl;
using study::brief_of_branch;

io::StudySummary branch(const std::string& stability, std::vector<io::StabilityRange> ranges) {
  io::StudySummary s;
  s.kind = "equilibrium_branch";
  s.stability = stability;
  s.ranges = std::move(ranges);
  return s;
}

io::Bifurcation hopf(double value, int others) {
  io::Bifurcation b;
  b.type = io::BifurcationType::hopf;
  b.parameter = "speed";
  b.value = value;
  b.unit = "rpm";
  b.uncertainty = 12;
  b.criticality = "subcritical";
  b.born = "whirl";
  b.sentence = "above this speed the rotor jumps to large whirl";
  b.more = {{"others_unstable", others}, {"whirl_frequency_rad_s", value * std::numbers::pi / 60}};
  return b;
}

std::vector<std::string> said(const io::StudySummary& s) {
  io::Brief brief = brief_of_branch(s, "equilibrium");
  io::typeset(brief);
  return brief.sentences;
}

const io::BriefTable* table(const io::Brief& brief, const std::string& caption) {
  const auto at = std::ranges::find(brief.tables, caption, &io::BriefTable::caption);
  return at == brief.tables.end() ? nullptr : &*at;
}

using Sentences = std::vector<std::string>;

TEST(BranchBrief, OfOneStretchSaysHowFarItReaches) {
  EXPECT_EQ(said(branch("stable throughout", {{500, 8000, "rpm", "stable"}})),
            Sentences{"The equilibrium is stable throughout, from 500 to 8000 rpm."});
  EXPECT_EQ(said(branch("unstable as far as followed", {{500, 500, "rpm", "unstable"}})),
            Sentences{"The equilibrium is unstable as far as followed, at 500 rpm."});
  EXPECT_TRUE(said(branch("", {})).empty());
  const auto open = said(branch("undetermined", {{500, 8000, "rpm", "undetermined"}}));
  ASSERT_EQ(open.size(), 1U);
  EXPECT_TRUE(open[0].starts_with("Whether the equilibrium is stable is undetermined from 500 to 8000 rpm")) << open[0];
}

// A mode that becomes unstable behind another one is no loss of stability.
TEST(BranchBrief, OfALossNamesTheBifurcationAndWhatItMeans) {
  auto s = branch("loses stability",
                  {{500, 5025, "rpm", "stable"}, {5025, 6000, "rpm", "unstable"}, {6000, 8000, "rpm", "stable"}});
  s.bifurcations = {hopf(4990, 2), hopf(5025, 0)};
  const Sentences lost{
      "The equilibrium loses stability at 5025 +- 12 rpm (subcritical Hopf point), where whirl of 41.875 Hz begins, "
      "0.5000 +- 0.0012 of the "
      "speed. Above this speed the rotor jumps to large whirl.",
      "It is stable again from 6000 to 8000 rpm."};
  EXPECT_EQ(said(s), lost);
  s.set("threshold", 5025 * std::numbers::pi / 30, "rad/s");
  EXPECT_NE(said(s)[0].find("loses stability at the threshold 5025 +- 12 rpm"), std::string::npos);
  s.bifurcations.clear();
  EXPECT_EQ(said(s)[0], "The equilibrium loses stability at 5025 rpm.");
}

// Followed downwards: the branch begins unstable, and its threshold is where it becomes stable.
TEST(BranchBrief, OfAFallingRangeHasItsThreshold) {
  auto s = branch("unstable from its start", {{8000, 5025, "rpm", "unstable"}, {5025, 500, "rpm", "stable"}});
  s.bifurcations = {hopf(5025, 0)};
  s.set("threshold", 5025 * std::numbers::pi / 30, "rad/s");
  const auto words = said(s);
  ASSERT_EQ(words.size(), 3U);
  EXPECT_EQ(words[0], "The equilibrium is unstable from the start of the branch, from 8000 to 5025 rpm.");
  EXPECT_EQ(words[1], "It is stable from 5025 to 500 rpm.");
  EXPECT_TRUE(words[2].starts_with("The threshold is 5025 +- 12 rpm")) << words[2];
}

// Neighbours of one verdict are one stretch, also over a fold; gaps and what the mesh leaves open are told.
TEST(BranchBrief, JoinsStretchesOfOneVerdict) {
  const std::vector<io::StabilityRange> ranges{
      {2.4, 3.2, "", "undetermined"}, {3.2, 2.7, "", "undetermined"}, {2.7, 2.5, "", "stable"}};
  const auto all = study::joined(ranges);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].to, 2.7);
  EXPECT_EQ(all[0].turns, std::vector<double>{3.2});
  const auto words = said(branch("undetermined", ranges));
  EXPECT_EQ(words[0], "The equilibrium is undetermined from 2.4 to 2.7 (turning at 3.2), then stable from 2.7 to 2.5.");
  const auto gap = said(branch("loses stability", {{500, 4471, "rpm", "stable"}, {4500, 6000, "rpm", "unstable"}}));
  EXPECT_EQ(gap[0], "The equilibrium loses stability between 4471 rpm and 4500 rpm.");
  const auto waves = said(branch("loses stability", {{400, 500, "rpm", "stable"},
                                                     {510, 520, "rpm", "undetermined"},
                                                     {530, 560, "rpm", "stable"},
                                                     {560, 600, "rpm", "unstable"}}));
  EXPECT_EQ(waves, (Sentences{"The equilibrium loses stability at 560 rpm.",
                              "Whether it is stable is undetermined from 510 to 520 rpm."}));
}

TEST(BranchBrief, TellsWhatIsOpenBehindAnUnstableStart) {
  const auto words = said(branch("undetermined", {{545, 434, "rpm", "unstable"}, {434, 640, "rpm", "undetermined"}}));
  EXPECT_EQ(words, (Sentences{"The equilibrium is unstable from the start of the branch, from 545 to 434 rpm.",
                              "Whether it is stable is undetermined from 434 to 640 rpm."}));
}

TEST(BranchBrief, TablesHaveBifurcationsAndWhatIsNotResolved) {
  auto s = branch("loses stability", {{500, 5025, "rpm", "stable"}, {5025, 6000, "rpm", "unstable"}});
  s.bifurcations = {hopf(5025, 0)};
  s.bifurcations[0].criticality = "undetermined";
  s.bifurcations[0].criticality_by = "the film is not resolved here";
  EXPECT_EQ(brief_of_branch(s, "equilibrium").tables[0].rows[0].back().text, "") << "the first sentence says it";
  s.bifurcations.push_back(hopf(5500, 2));
  s.bifurcations.push_back(s.bifurcations[0]);
  s.bifurcations[2].sentence = "above this speed whirl sets in. It is not known whether it grows from nothing";
  s.bifurcations[2].criticality_by = "first Lyapunov coefficient has an error bar that contains zero";
  s.bifurcations[2].more["criticality_coefficient"] = -5.4;
  s.bifurcations[2].more["criticality_uncertainty"] = 12.3;
  s.suspected = {{5100, 5200, "rpm", "two eigenvalues cross together"}};
  io::Brief brief = brief_of_branch(s, "equilibrium");
  io::typeset(brief);
  const auto* found = table(brief, "Bifurcations");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->columns[1].name, "speed");
  EXPECT_EQ(found->rows[0][1].text, "5025 +- 12");
  EXPECT_EQ(found->rows[0].back().text,
            "above this speed the rotor jumps to large whirl. The film is not resolved here.");
  // The number stands in the table, the sentence says what it leaves open and what would decide it.
  EXPECT_EQ(found->rows[2].back().text,
            "above this speed whirl sets in. It is not known whether it grows from nothing. The sign of its "
            "coefficient decides, and the error bar contains zero. A finer mesh shortens the bar.");
  const auto coefficient = std::ranges::find(found->columns, "coefficient", &io::BriefColumn::name);
  ASSERT_NE(coefficient, found->columns.end());
  const auto at = static_cast<std::size_t>(coefficient - found->columns.begin());
  EXPECT_EQ(found->rows[2][at].text, "-5 +- 12");
  EXPECT_EQ(found->rows[1][at].text, "");
  ASSERT_TRUE(table(brief, "Along the branch"));
  EXPECT_EQ(table(brief, "Along the branch")->rows.size(), 2U);
  ASSERT_TRUE(table(brief, "Not resolved: bifurcations may lie here"));
  EXPECT_EQ(brief.tables.back().rows[0][2].text, "two eigenvalues cross together");
}

}  // namespace
