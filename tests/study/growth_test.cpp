// What grows about an equilibrium, in numbers and words, and the speeds over which modes grow.

#include <gtest/gtest.h>

#include <numbers>

#include "study/growth.hpp"
#include "study/linear/mode_stations.hpp"
#include "study/packed.hpp"

using namespace whirl;
using study::Border;
using study::ShaftMode;
using Complex = std::complex<double>;

namespace {

study::Growth growth(std::vector<Complex> values) {
  return study::growth_of(solve::make_stability(std::move(values), [](Complex v) { return v.real(); }));
}

ShaftMode mode(Complex lambda, int id) {
  ShaftMode m;
  m.lambda = lambda;
  m.x = {1, 0};
  m.y = {0, Complex(0, 1)};
  m.id = id;
  m.undamped = lambda.real() == 0;
  return m;
}

// A mode whose real part is (speed - onset)/1000 up to `end`, beyond which it falls again.
Complex at(double speed, double onset, double end) {
  return {std::min(speed - onset, end - speed) / 1000, 100};
}

}  // namespace

TEST(Growth, CountsRealAndComplexEigenvalues) {
  const double w = 2 * std::numbers::pi * 10;
  const auto g =
      growth({{-3, 0}, {2, w}, {2, -w}, {5, 0}, {7, 0}, {-1, 4}, {-1, -4}, {1e-12, 0}, {-1e-3, 9}, {-1e-3, -9}});
  EXPECT_EQ(g.real, (std::vector<double>{7, 5, 1e-12}));
  ASSERT_EQ(g.pairs.size(), 1U);
  EXPECT_EQ(g.count(), 5);
  EXPECT_STREQ(g.verdict(), "unstable");
  EXPECT_EQ(
      g.words(),
      "it diverges (s = +7 1/s, the fastest of 3 real eigenvalues), and an oscillation grows (10 Hz, log decrement "
      "-0.2)");
  io::StudySummary told, missed, silent;
  const auto sent = study::unpack<std::optional<study::Growth>>(study::pack(std::optional(g)));
  study::put_growth(sent, "at 1 rpm", "The end", told);
  EXPECT_EQ(told.stability, "unstable");
  EXPECT_EQ(told.warnings, std::vector{"at 1 rpm the equilibrium is unstable: " + g.words() + ". The end"});
  study::Growth some = growth({{-3, 0}});
  some.missed = 1;
  study::put_growth(some, "", "", missed);
  study::put_growth({}, "", "", silent);
  EXPECT_EQ(missed.stability, "undetermined");
  EXPECT_EQ(silent.stability, "undetermined");
  auto none = growth({{-3, 0}, {-1, 4}, {-1, -4}});
  EXPECT_STREQ(none.verdict(), "stable");
  EXPECT_EQ(none.known_count(), 0);
  none.undamped = 2;
  EXPECT_STREQ(none.verdict(), "undamped");
  none.missed = 1;
  EXPECT_STREQ(none.verdict(), "undetermined");
  EXPECT_EQ(none.known_count(), -1);
  EXPECT_EQ(none.words(), "");
  io::StudySummary summary;
  study::warn_of(none, "at 100 rpm", "no", summary);
  EXPECT_TRUE(summary.warnings.empty());
  study::warn_of(growth({{311.27, 0}}), "at 100 rpm", "The end", summary);
  ASSERT_EQ(summary.warnings.size(), 1U);
  EXPECT_EQ(summary.warnings[0], "at 100 rpm the equilibrium is unstable: it diverges (s = +311.3 1/s). The end");
}

TEST(UnstableRanges, LieBetweenCrossings) {
  std::vector<study::Station> stations;
  for (const double speed : {100.0, 200.0, 300.0, 400.0, 500.0}) {
    study::Station s{speed, true};
    s.modes = {mode(at(speed, 150, 420), 1), mode(at(speed, 0, 1e9), 2), mode(at(speed, 1e9, 2e9), 3)};
    s.listed = 3;
    stations.push_back(std::move(s));
  }
  const auto crossings = study::crossings_of(stations);
  std::vector<study::CrossingPoint> points;
  std::size_t critical = 0;
  for (const auto& c : crossings) {
    points.push_back(study::locate(c, [&](double speed) { return std::vector{mode(at(speed, 150, 420), 1)}; }));
    critical += c.border == Border::critical;
  }
  EXPECT_EQ(critical, 0U);  // 100 rad/s is met at no speed above the first
  const auto ranges = study::unstable_ranges(stations, crossings, points);
  ASSERT_EQ(ranges.size(), 2U);
  EXPECT_EQ(ranges[0].id, 2);
  EXPECT_FALSE(ranges[0].begins);
  EXPECT_FALSE(ranges[0].ends);
  EXPECT_EQ(ranges[0].from, 100);
  EXPECT_EQ(ranges[0].to, 500);
  EXPECT_EQ(ranges[1].id, 1);
  EXPECT_TRUE(ranges[1].begins && ranges[1].ends);
  EXPECT_NEAR(ranges[1].from, 150, 1e-3);
  EXPECT_NEAR(ranges[1].to, 420, 1e-3);
  EXPECT_TRUE(ranges[1].begin_crossing && ranges[1].end_crossing);
}

// A mode that is listed where it grows alone begins and ends there: only a look beyond the list finds its limits.
TEST(UnstableRanges, AreFoundOutsideTheList) {
  std::vector<study::Station> stations;
  for (const double speed : {100.0, 200.0, 300.0, 400.0}) {
    study::Station s{speed, true};
    if (at(speed, 150, 320).real() > 0) s.modes = {mode(at(speed, 150, 320), 1)};
    s.listed = s.modes.size();
    stations.push_back(std::move(s));
  }
  const auto all = [](double speed) { return std::vector{mode({-1, 900}, 0), mode(at(speed, 150, 320), 0)}; };
  const auto ranges_of = [&] {
    const auto crossings = study::crossings_of(stations);
    std::vector<study::CrossingPoint> points;
    for (const auto& c : crossings) points.push_back(study::locate(c, all));
    return study::unstable_ranges(stations, crossings, points);
  };
  const auto seen = ranges_of();
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_FALSE(seen[0].begins || seen[0].from_start || seen[0].to_end);
  EXPECT_TRUE(study::lost_modes(stations, [](const ShaftMode&, double) { return false; }).empty());
  const auto lost = study::lost_modes(stations, [](const ShaftMode&, double) { return true; });
  ASSERT_EQ(lost.size(), 2U);
  for (const auto& l : lost) study::put_back(l, all(stations[l.station].speed), stations);
  const auto found = ranges_of();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].from, 150, 1e-3);
  EXPECT_NEAR(found[0].to, 320, 1e-3);
}

// Undamped at rest, unstable as soon as it turns: no crossing, and yet it begins there.
TEST(UnstableRanges, BeginWhereAModeIsUndamped) {
  std::vector<study::Station> stations;
  for (const double speed : {0.0, 100.0, 200.0}) {
    study::Station s{speed, true};
    s.modes = {mode({speed / 1e3, 500}, 1)};
    s.listed = 1;
    stations.push_back(std::move(s));
  }
  const auto crossings = study::crossings_of(stations);
  EXPECT_TRUE(crossings.empty());
  const auto ranges = study::unstable_ranges(stations, crossings, {});
  ASSERT_EQ(ranges.size(), 1U);
  EXPECT_TRUE(ranges[0].begins);
  EXPECT_EQ(ranges[0].from, 0);
  EXPECT_FALSE(ranges[0].begin_crossing.has_value());
}
