// What a failure beside the point leaves of a result, and where a motion or a branch ends in contact.

#include <gtest/gtest.h>

#include <cmath>

#include "study/bars/film_limit.hpp"
#include "study/cycle/coexisting.hpp"
#include "study/linear/response_bars.hpp"
#include "study/motion/motion_record.hpp"
#include "whirl/core/error.hpp"

namespace whirl::study {
namespace {

template <class E>
void expect_kept(const E& error) {
  io::Group group;
  io::StudySummary summary;
  summary.set("threshold", 5021, "rpm");
  const auto found = put_solutions(group, summary, [&]() -> std::vector<solve::Cycle> { throw error; });
  EXPECT_TRUE(found.empty());
  ASSERT_EQ(summary.values.size(), 2U);
  EXPECT_EQ(summary.values[0].second.value, 5021);
  EXPECT_EQ(summary.values[1].second.value, 1) << "the first solution stays";
  ASSERT_EQ(summary.warnings.size(), 1U);
  EXPECT_NE(summary.warnings[0].find("no start"), std::string::npos) << summary.warnings[0];
  EXPECT_TRUE(solutions_in(group).empty());
}

TEST(Kept, ABranchWhoseDeflationFails) {
  expect_kept(core::NotConverged("no start"));
  expect_kept(core::DomainError("no start"));
}

TEST(Kept, AResponseWhoseBarsFail) {
  io::StudySummary summary;
  const PutPeak put = [](io::StudySummary& to, const std::string& head, double speed, double height, double) {
    to.set(head + "speed", speed, "rad/s");
    to.set(head + "height", height, "m");
  };
  put(summary, "peak.", 280, 8e-5, 10);
  std::vector<NamedPeak> peaks{{"peak.", 0, 280, 8e-5, 10}};
  put_response_bars(summary, {{Axis::around, {0.5, 1}, 2}, {Axis::around, {2, 1}, 0.5}}, {}, peaks, put,
                    [](const auto&, const auto&, const auto&) -> MeshResponse {
                      throw core::NotConverged("the matrix at this frequency is singular");
                    });
  ASSERT_EQ(summary.values.size(), 2U);
  EXPECT_EQ(summary.values[0].second.value, 280);
  EXPECT_TRUE(std::isnan(summary.values[0].second.more.at("uncertainty"))) << "unknown, and not zero";
  EXPECT_EQ(summary.warnings.size(), 1U);
}

// Three speeds that stand too far apart for a narrow peak tell nothing of its height on either mesh.
TEST(Kept, ADampedPeakOfUnknownHeightHasNoBar) {
  const PutPeak put = [](io::StudySummary& to, const std::string& head, double speed, double height, double factor) {
    to.set(head + "speed", speed, "rad/s");
    to.set(head + "height", height, "m");
    to.set(head + "factor", factor, "1");
  };
  const std::vector<std::vector<double>> told{{0.5}, {1}, {0.5}}, lost{{0.1}, {0.9}, {0.2}};
  for (const bool here : {false, true}) {
    io::StudySummary summary;
    put(summary, "peak.", 280, 8e-5, 800);
    std::vector<NamedPeak> peaks{{"peak.", 0, 280, 8e-5, 800, {1e-5, 1e-5, 1e-3}}};
    put_response_bars(summary, {{Axis::around, {0.5, 1}, 2}, {Axis::around, {2, 1}, 0.5}}, {}, peaks, put,
                      [&](const FilmMesh& mesh, const auto&, const auto&) -> MeshResponse {
                        return {(mesh.spacing == 1) == here ? lost : told, {}};
                      });
    EXPECT_TRUE(std::isfinite(summary.values[0].second.more.at("uncertainty"))) << here;
    EXPECT_TRUE(std::isnan(summary.values[1].second.more.at("uncertainty"))) << here;
    EXPECT_TRUE(std::isnan(summary.values[2].second.more.at("uncertainty"))) << here;
    EXPECT_FALSE(peaks.front().vanishes);
  }
}

// Two revolutions of a circle, and half of one that runs away: neither its size nor its spectrum knows the last one.
TEST(Kept, AMotionKnowsWholeRevolutionsOnly) {
  MotionOptions options;
  options.speed.value = 100;
  options.samples = 16;
  options.exponents = 0;
  options.orbit = 5;
  const auto played = [&](bool runs_away) {
    const core::Vector state = core::make_vector(PETSC_COMM_SELF, 2, 2);
    MotionRecord record(options, {{"B"}, {1e-4}, "m", "m/s", "place"}, true, state.get());
    for (int turn = 0; turn < (runs_away ? 3 : 2); ++turn) {
      for (int k = 1; k <= (turn < 2 ? 16 : 8); ++k) {
        const double angle = 2 * 3.14159265358979 * k / 16, r = turn < 2 ? 1e-5 : 9e-5;
        core::fill(state.get(), {r * std::cos(angle), r * std::sin(angle)});
        record.sample({{{r * std::cos(angle), r * std::sin(angle)}, {}}}, state.get());
      }
      if (turn < 2) record.close({}, 2 * 3.14159265358979 / 100);
    }
    io::Group group;
    io::StudySummary summary;
    record.write(group, summary);
    EXPECT_EQ(group.group("orbit").reals("revolutions").size(), 32U);
    std::map<std::string, double> values;
    for (const auto& [name, q] : summary.values) values[name] = q.value;
    return values;
  };
  const auto whole = played(false);
  EXPECT_NEAR(whole.at("peak_to_peak.B.x"), 2e-5, 1e-12);
  EXPECT_EQ(played(true), whole);
}

// h = 3 - p on this mesh, contact at 3; on meshes with spacing s at 3 + 0.1 (s^2 - 1), with another slope.
TEST(Kept, TheBarOfAContactHoldsItsMeshes) {
  MarginSlope slope;
  EXPECT_TRUE(std::isnan(slope.value()));
  slope.add(2.5, 0.5);
  slope.add(3, 0);
  EXPECT_EQ(slope.value(), -1);
  EXPECT_EQ(slope.step(), 0.5);
  std::vector<Sample> there;
  for (const double s : {0.5, 2.0}) {
    const auto margin = [s](double p) { return 2 * (3 + 0.1 * (s * s - 1) - p); };
    there.push_back({Axis::around, s, contact_there(3, slope, margin)});
    EXPECT_NEAR(there.back().value, 3 + 0.1 * (s * s - 1), 1e-12);
  }
  io::StudySummary summary;
  put_contact(summary, 3, "rad/s", 1e-6, {}, there);
  const auto& q = summary.values.at(0).second;
  EXPECT_EQ(q.value, 3);
  EXPECT_NEAR(q.more.at("uncertainty_film_mesh"), 0.1 * 1.25, 1e-12);
  EXPECT_EQ(q.more.at("uncertainty_location"), 1e-6);
  EXPECT_NEAR(q.more.at("uncertainty"), 0.125001, 1e-12);
  // No solution on any other mesh: nobody knows.
  for (Sample& m : there) m.value = io::no_value;
  put_contact(summary, 3, "rad/s", 1e-6, {}, there);
  EXPECT_TRUE(std::isnan(summary.values.back().second.more.at("uncertainty")));
}

// A film that thins as 1/p: on another mesh to 400 N, where the last step's slope says 416 N.
TEST(Kept, AContactOnAnotherMeshIsFoundAlongTheBranchThere) {
  const auto thins = [](double least, double end) {
    return [least, end](double p) { return p > 1.5 * end ? unknown : least * (end / p - 1); };
  };
  MarginSlope here;
  const auto own = thins(1e-3, 300);
  here.add(290, own(290));
  here.add(300, own(300));
  const auto other = thins(1.2e-3, 400);
  EXPECT_NEAR(300 - other(300) / here.value(), 416, 1) << "what one step says";
  EXPECT_NEAR(contact_there(300, here, other), 400, 1);
  // It touches earlier, and has no solution beyond.
  EXPECT_NEAR(contact_there(300, here, thins(1e-3, 190)), 190, 1);
  // The margin turns, and does not come to zero.
  EXPECT_TRUE(std::isnan(contact_there(300, here, [](double p) { return 1e-3 + 1e-8 * (p - 310) * (p - 310); })));
  // It turns twice on the way.
  const auto waves = [](double p) { return 1e-3 * (1 - p / 900) + 2e-5 * std::sin(p / 20); };
  const double found = contact_there(300, here, waves);
  EXPECT_NEAR(waves(found), 0, 1e-5);
  // There, no solution stands near the contact, and steps must be halved.
  int looks = 0;
  const auto narrow = [&looks, last = 300.0](double p) mutable {
    ++looks;
    if (std::abs(p - last) > 40 && p > 300) return unknown;
    last = p;
    return 1e-3 * (700 - p);
  };
  EXPECT_NEAR(contact_there(300, here, narrow), 700, 4.1);
  EXPECT_LE(looks, 60);
}

// Places on 30, 60 and 120 cells of a soft liner: there is no limit, and no bar that could hold it.
TEST(Kept, AContactThatRunsAwayHasNoBar) {
  const auto contact = [](double coarse, double fine) {
    io::StudySummary summary;
    put_contact(summary, 520.6, "N", 1e-3, {}, {{Axis::around, 2, coarse}, {Axis::around, 0.5, fine}});
    return summary;
  };
  const io::StudySummary away = contact(182.4, 1363);
  EXPECT_TRUE(std::isnan(away.values.at(0).second.more.at("uncertainty")));
  ASSERT_EQ(away.warnings.size(), 1U);
  EXPECT_NE(away.warnings[0].find("has no limit"), std::string::npos) << away.warnings[0];
  EXPECT_NE(away.warnings[0].find("1363 at 0.5 times"), std::string::npos) << away.warnings[0];
  // Coming to rest, however far: a bar, and where it is long a warning without that reason.
  const io::StudySummary rests = contact(182.4, 650);
  EXPECT_TRUE(std::isfinite(rests.values.at(0).second.more.at("uncertainty")));
  EXPECT_EQ(rests.warnings.at(0).find("has no limit"), std::string::npos);
  EXPECT_TRUE(contact(500, 525).warnings.empty());
}

}  // namespace
}  // namespace whirl::study
