// Resonances between the speeds at which a response is known.
#include "study/linear/resonances.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "study/linear/response_record.hpp"

namespace whirl::study {
namespace {

using Complex = std::complex<double>;

// Both of the pair with this modulus and damping ratio; two real ones above one.
void add(std::vector<Complex>& out, double modulus, double ratio) {
  if (ratio < 1) {
    out.push_back({-ratio * modulus, modulus * std::sqrt(1 - ratio * ratio)});
    out.push_back(std::conj(out.back()));
    return;
  }
  const double root = std::sqrt(ratio * ratio - 1);
  out.insert(out.end(), {-modulus * (ratio - root), -modulus * (ratio + root)});
}

// A rotor with a disc: bending at 221 rad/s; forward and backward at 600 -+ 0.4 speed; a mode without damping; a damped
// one whose pair parts at 2000 rad/s; one that falls away at all speeds; modes above.
std::vector<Complex> rotor_at(double speed) {
  std::vector<Complex> out;
  add(out, 221, 1e-3);
  add(out, std::sqrt(0.04 * speed * speed + 360000) + 0.2 * speed, 0.02);
  add(out, std::sqrt(0.04 * speed * speed + 360000) - 0.2 * speed, 0.02);
  add(out, 3000, 0);
  add(out, 500, std::sqrt(speed / 2000));
  add(out, 50 + 0.3 * speed, 2);
  add(out, 40000, 0.3);
  add(out, 1e7, 0.01);
  return out;
}

struct Search {
  Spectra known;
  std::size_t asked = 0;
  HiddenResonances of(const std::vector<double>& computed, const std::vector<double>& tops, double limit = 1e9,
                      std::size_t most = 200) {
    known.clear();
    asked = 0;
    for (const auto* some : {&computed, &tops})
      for (const double s : *some) known[s] = rotor_at(s);
    return hidden_resonances(known, computed, tops, {limit, most}, [&](const std::vector<double>& more) {
      asked += more.size();
      for (const double s : more) known[s] = rotor_at(s);
    });
  }
};

// The speed at which the root of 0.04 s^2 + 600^2 plus or minus 0.2 s is s.
double disc(double sign) {
  return 600 / std::sqrt((1 - sign * 0.2) * (1 - sign * 0.2) - 0.04);
}

TEST(HiddenResonances, AreFoundBetweenSpeedsFarApart) {
  Search search;
  for (const std::vector<double>& computed : {std::vector<double>{10, 1e5}, {1, 5e4, 1e5}, {10, 300, 1e5}}) {
    const auto [found, gave_up] = search.of(computed, {});
    EXPECT_FALSE(gave_up);
    ASSERT_EQ(found.size(), 6U);
    const double speeds[] = {221, 500, disc(-1), disc(1), 3000, 40000};
    const double widths[] = {0.221, 250, 0.02 * disc(-1), 0.02 * disc(1), 3e-5 * 3000, 12000};
    for (std::size_t k = 0; k < 6; ++k) {
      EXPECT_NEAR(found[k].speed, speeds[k], 0.1 * widths[k]) << k;
      EXPECT_NEAR(found[k].width, widths[k], 0.1 * widths[k]) << k;
    }
    EXPECT_LE(search.asked, 40U);
  }
}

// A modulus that nears the speed, is below it from 230 to 430 rad/s and leaves it again; and growth over the same
// speeds. The known ones lie outside.
TEST(HiddenResonances, AreFoundWhereAModulusComesAndGoes) {
  const auto bend = [](double s) { return (s - 230) * (s - 430); };
  const auto at = [&](double s) {
    std::vector<Complex> out;
    add(out, s + 1e-3 * bend(s), 1e-2);
    add(out, 1e4, 1e-6 * bend(s));
    return out;
  };
  std::vector<double> computed{100, 200, 450, 600};
  Spectra known;
  for (const double s : computed) known[s] = at(s);
  EXPECT_EQ(where_growth_may_hide(known, {1e9, 100}).size(), 1U);
  const double there = where_growth_may_hide(known, {1e9, 100})[0];
  EXPECT_LT(bend(there), 0);
  EXPECT_TRUE(where_growth_may_hide(known, {50, 100}).empty());
  const auto [found, gave_up] =
      hidden_resonances(known, computed, {}, {1e9, 100}, [&](const std::vector<double>& more) {
        for (const double s : more) known[s] = at(s);
      });
  EXPECT_FALSE(gave_up);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0].speed, 230, 0.3);
  EXPECT_NEAR(found[1].speed, 430, 0.5);
}

TEST(HiddenResonances, AreNoneWhereTheResponseShowsThem) {
  Search search;
  // Between 2900 and 3100 rad/s stands the undamped one.
  EXPECT_EQ(search.of({2900, 3100}, {}).found.size(), 1U);
  EXPECT_TRUE(search.of({2900, 3100}, {3000.1}).found.empty());
  EXPECT_EQ(search.asked, 0U);
  // The disc's forward mode is 15.5 rad/s wide on either side.
  EXPECT_TRUE(search.of({760, 770, 780, 790}, {}).found.empty());
  EXPECT_EQ(search.asked, 0U);
  EXPECT_EQ(search.of({700, 740, 830, 900}, {}).found.size(), 1U);
  // What lies above the limit is not looked for, nor what has no peak.
  EXPECT_TRUE(search.of({2900, 3100}, {}, 2500).found.empty());
  EXPECT_TRUE(search.of({40, 80}, {}).found.empty());
}

TEST(HiddenResonances, AreGivenUpWhereTheyCostTooMuch) {
  Search search;
  EXPECT_TRUE(search.of({10, 1e5}, {}, 1e9, 5).gave_up);
  EXPECT_LE(search.asked, 5U);
}

HiddenResonances of_machine(std::vector<Complex> (*spectrum)(double), std::size_t most = 200) {
  Spectra known{{10, spectrum(10)}, {2000, spectrum(2000)}};
  return hidden_resonances(known, {10, 2000}, {}, {1e9, most}, [&](const std::vector<double>& more) {
    for (const double s : more)
      if (std::vector<Complex> found = spectrum(s); !found.empty()) known[s] = std::move(found);
  });
}

TEST(HiddenResonances, AreNoEigenvaluesThatDiverge) {
  const auto diverging = [](double) { return std::vector<Complex>{500, -500}; };
  const auto [found, gave_up] = of_machine(diverging);
  EXPECT_TRUE(found.empty());
  EXPECT_FALSE(gave_up);
  // A flutter that grows slowly is one, and one that grows fast has no peak.
  EXPECT_EQ(of_machine([](double) { return std::vector<Complex>{{5, 500}, {5, -500}}; }).found.size(), 1U);
  EXPECT_TRUE(of_machine([](double) { return std::vector<Complex>{{400, 300}, {400, -300}}; }).found.empty());
}

// From 700 rad/s on a search finds one pair less: what is next in the order stands far from the speed.
TEST(HiddenResonances, AreNoJumpsOfTheSpectrum) {
  const auto [found, gave_up] = of_machine([](double speed) {
    std::vector<Complex> out;
    if (speed < 700) add(out, 3000, 0.01);
    if (speed >= 700) add(out, 20, 0.01);
    add(out, 5000, 0.01);
    return out;
  });
  EXPECT_TRUE(found.empty());
  EXPECT_FALSE(gave_up);
}

// Where spectra fail the search ends, and says so.
TEST(HiddenResonances, MayBeMissingWhereASpectrumFails) {
  const auto [found, gave_up] = of_machine([](double speed) {
    std::vector<Complex> out;
    if (speed < 20 || speed > 1900) add(out, 500, 0.001);
    return out;
  });
  EXPECT_TRUE(found.empty());
  EXPECT_TRUE(gave_up);
}

ResponseAtSpeed response_of(double speed, double height) {
  return {speed, height, {{height, {0, height}}}, {}, {}};
}

// Speeds about a resonance show it: a peak that the curve has beside them is none of theirs.
TEST(HiddenResonances, AreToldOfWithPeaksThatTheSpeedsAboutThemShow) {
  const std::vector<ResponseAtSpeed> curve{response_of(100, 1e-6), response_of(200, 5e-6), response_of(300, 1e-6),
                                           response_of(500, 1e-6)};
  const std::vector<ResponsePlace> places = places_of({1}, {});
  const std::vector<ResponseAtSpeed> falling{response_of(220, 4e-6), response_of(240, 3e-6), response_of(260, 2e-6)};
  EXPECT_TRUE(shown_by(curve, falling, {{240, 50}}, places, "rad/s").empty());
  const std::vector<ResponseAtSpeed> top{response_of(399, 2e-6), response_of(400, 3e-6), response_of(401, 2e-6)};
  const auto words = shown_by(curve, top, {{400, 150}}, places, "rad/s");
  ASSERT_EQ(words.size(), 1U);
  EXPECT_EQ(words[0], "400 rad/s (3 um at least, node 1)");
}

// Of a single machine over the frequency: each pair once, what shows and what has no peak left out.
TEST(NarrowResonances, AreThoseBetweenFrequenciesFarApart) {
  const std::vector<Complex> at_rest = rotor_at(0.01);
  const std::vector<Resonance> found = narrow_resonances(at_rest, {100, 400, 592, 608, 2000, 5000}, {1e9, 0});
  ASSERT_EQ(found.size(), 3U);
  EXPECT_NEAR(found[0].speed, 221, 1e-9);
  EXPECT_NEAR(found[0].width, 0.221, 1e-9);
  EXPECT_NEAR(found[1].speed, 500, 1e-9);
  EXPECT_NEAR(found[2].speed, 3000, 1e-9);
  EXPECT_EQ(narrow_resonances(at_rest, {100, 400, 592, 608, 2000, 5000}, {2500, 0}).size(), 2U);
  EXPECT_EQ(narrow_resonances(at_rest, {2000, 4000}, {1e9, 0}).size(), 1U);
  EXPECT_TRUE(narrow_resonances(at_rest, {2000, 4000}, {1e9, 0, 0.5}).empty());
}

// Three speeds around a resonance show it.
TEST(HiddenResonances, ShowInSpeedsAroundThem) {
  const Resonance narrow{3000, 0.09};
  std::vector<double> computed{10, 1e5};
  EXPECT_FALSE(shows(computed, narrow.speed, narrow.width));
  for (const double s : around(narrow)) computed.insert(computed.end() - 1, s);
  EXPECT_TRUE(shows(computed, narrow.speed, narrow.width));
  EXPECT_TRUE(shows(computed, 2e5, 1));  // beyond what was asked for
}

// Only the mode at the peak says whether that is undamped, if its spectrum is known there.
TEST(HiddenResonances, UndampedIsTheModeNearestToAPeak) {
  Spectra known;
  add(known[1000], 1000.5, 1e-6);
  add(known[1000], 999, 0);
  add(known[2000], 2000, 1e-9);
  const ResonanceSearch search{1e9, 0};
  EXPECT_FALSE(undamped_at(known, 1000.4, search));
  EXPECT_TRUE(undamped_at(known, 999.1, search));
  EXPECT_TRUE(undamped_at(known, 2001, search));
  EXPECT_FALSE(undamped_at(known, 2100, search));
  EXPECT_FALSE(undamped_at({}, 2000, search));
  ResonanceSearch lossy = search;
  lossy.lossless = false;
  EXPECT_FALSE(undamped_at(known, 2000, lossy));
}

}  // namespace
}  // namespace whirl::study
