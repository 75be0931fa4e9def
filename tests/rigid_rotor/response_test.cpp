// Linear response to unbalance against closed forms.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <complex>

#include "rigid_rotor/run_deck.hpp"
#include "source_dir.hpp"

namespace {

using namespace whirl;
using Complex = std::complex<double>;

// A film with states of its own answers a harmonic motion with its coefficients at that frequency, which `static`
// reports for the frequency of rotation: (K + i Omega C - m Omega^2) z = m e Omega^2 (1, -i).
TEST(LinearResponse, OfFilmsWithOwnStatesFollowsFromTheirCoefficients) {
  study::Deck deck = study::load(
      MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/compliant_rotor/water_bearing.yaml",
      {"unbalance={a: {planes: [{node: 1, eccentricity: 1 um}]}}",
       "studies=[{static: {speed: 400 rad/s}}, {unbalance_response: {unbalance: [a], nodes: [1], points: 4, "
       "range: {from: 350 rad/s, to: 420 rad/s}, refine: false, operating_speed: 400 rad/s}}]"});
  const auto studies = test::run_deck(deck, "liner_response");
  auto rest = test::values_of(studies.at(0)), response = test::values_of(studies.at(1));
  const double speed = 400, mass = 1, eccentricity = 1e-6;
  Eigen::Matrix2cd a = -mass * speed * speed * Eigen::Matrix2cd::Identity();
  const std::string axis[] = {"x", "y"};
  for (const std::string bearing : {"left", "right"})
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        const std::string head = "bearing." + bearing + ".", which = axis[i] + axis[j];
        a(i, j) += Complex(rest.at(head + "K." + which), speed * rest.at(head + "C." + which));
      }
  const Eigen::Vector2cd force = mass * eccentricity * speed * speed * Eigen::Vector2cd(1, Complex(0, -1)),
                         z = a.lu().solve(force);
  for (int i = 0; i < 2; ++i)
    EXPECT_NEAR(response.at("operating.bearing.left." + axis[i]), std::abs(z(i)), 1e-6 * std::abs(z(i)));
  EXPECT_TRUE(studies.at(1).warnings.empty());
}

// A linear motion knows no bore; an unbalance of 30 clearances drives it through.
TEST(LinearResponse, BeyondTheBoreIsMarked) {
  study::Deck deck = study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/rigid_rotor/short_f1.yaml",
                                 {"unbalance.a.planes.1.eccentricity=750 um",
                                  "studies=[{unbalance_response: {unbalance: [a], nodes: [1], points: 3, "
                                  "range: {from: 200 rad/s, to: 300 rad/s}, refine: false}}]"});
  const auto s = test::run_deck(deck, "linear_beyond").at(0);
  ASSERT_EQ(s.warnings.size(), 2U);
  EXPECT_NE(s.warnings[0].find("bearing left"), std::string::npos) << s.warnings[0];
  EXPECT_NE(s.warnings[0].find("no answer between 200 and 300 rad/s"), std::string::npos) << s.warnings[0];
  EXPECT_LT(test::values_of(s).at("bearing.left.film_min"), 0);
}

// The width of a peak does not depend on the speeds that were asked for.
TEST(LinearResponse, AmplificationFactorsAreSettledOnAnyGrid) {
  std::vector<double> factors, bars;
  for (const char* points : {"8", "300"}) {
    study::Deck deck = study::load(
        MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/tests/app/friswell_591.yaml",
        {"unbalance={u: {planes: [{node: 3, amount: 1 kg mm}]}}",
         "bearings.*.film.damping=[200 N s/m, 0 N s/m, 0 N s/m, 200 N s/m]",
         "studies=[{unbalance_response: {unbalance: [u], nodes: [1], range: {from: 300 rpm, to: 1500 rpm}}}]",
         std::string("studies.1.unbalance_response.points=") + points});
    const auto s = test::run_deck(deck, "linear_width").at(0);
    const auto at = std::find_if(s.values.begin(), s.values.end(),
                                 [](const auto& v) { return v.first == "node.1.peak.1.amplification_factor"; });
    ASSERT_NE(at, s.values.end()) << points;
    factors.push_back(at->second.value);
    bars.push_back(at->second.more.at("uncertainty"));
    EXPECT_GT(bars.back(), 1e-4 * factors.back());
    EXPECT_LT(bars.back(), 5e-3 * factors.back());
  }
  EXPECT_GT(factors[0], 1.0);
  EXPECT_NEAR(factors[0], factors[1], bars[0] + bars[1]);
}

// An undamped resonance has a place and no height, and one that was not refined has no bar.
TEST(LinearResponse, PeaksSayWhatTheyDoNotKnow) {
  const auto response = [](const std::string& damping, const std::string& more, const std::string& loss = "0") {
    study::Deck deck =
        study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/tests/app/friswell_591.yaml",
                    {"unbalance={u: {planes: [{node: 3, amount: 1 kg mm}]}}", "rotor.loss_factor=" + loss,
                     "bearings.*.film.damping=[" + damping + " N s/m, 0 N s/m, 0 N s/m, " + damping + " N s/m]",
                     "studies=[{unbalance_response: {unbalance: [u], nodes: [3], range: {from: 300 rpm, to: 1500 rpm}" +
                         more + "}}]"});
    return test::run_deck(deck, "linear_unknown").at(0);
  };
  const auto undamped = response("0", "");
  ASSERT_EQ(undamped.warnings.size(), 1U);
  EXPECT_NE(undamped.warnings[0].find("is undamped"), std::string::npos) << undamped.warnings[0];
  EXPECT_NEAR(test::values_of(undamped).at("node.3.peak.1.speed"), 829.87, 0.02);
  EXPECT_TRUE(std::isnan(test::values_of(undamped).at("node.3.peak.1.semi_major")));
  EXPECT_TRUE(std::isnan(test::values_of(undamped).at("node.3.peak.1.amplification_factor")));
  EXPECT_TRUE(undamped.stability.starts_with("stable or undamped")) << undamped.stability;
  // It moves with the mesh, and is a peak on every one.
  const io::PeakEntry& peak = undamped.peaks.front();
  EXPECT_GT(peak.speed.bar(), 0);
  EXPECT_LT(peak.speed.bar(), 1);
  EXPECT_EQ(peak.stability, "undamped");
  ASSERT_EQ(peak.notes.size(), 1U);
  EXPECT_TRUE(peak.notes[0].starts_with("undamped: ")) << peak.notes[0];
  // Damping ratios of 2e-7, which no speed of a double shows, and a loss factor, which eigenvalues know nothing of.
  for (const auto& [damping, loss] : {std::pair{"0.01", "0"}, {"0.01", "1e-6"}}) {
    const auto narrow = response(damping, ", points: 9", loss);
    // Eigenvalues without the loss factor tell nothing of stability, which is said.
    const bool lossless = std::string(loss) == "0";
    ASSERT_EQ(narrow.warnings.size(), lossless ? 1U : 2U);
    const auto says = [&](const char* words) {
      return std::ranges::any_of(narrow.warnings,
                                 [&](const std::string& w) { return w.find(words) != std::string::npos; });
    };
    EXPECT_TRUE(says("is narrower than 1e-05 of its speed")) << narrow.warnings[0];
    EXPECT_EQ(says("does not tell where a shaft with a loss factor is unstable"), !lossless);
    const io::PeakEntry& damped = narrow.peaks.front();
    EXPECT_EQ(damped.stability, lossless ? "stable" : "");
    ASSERT_EQ(damped.notes.size(), 1U);
    EXPECT_TRUE(damped.notes[0].starts_with("narrower than ")) << damped.notes[0];
    EXPECT_TRUE(std::isnan(test::values_of(narrow).at("node.3.peak.1.semi_major")));
    EXPECT_EQ(narrow.stability.find("undamped"), std::string::npos) << narrow.stability;
  }
  const auto coarse = response("2000", ", points: 9, refine: false");
  for (const auto& [name, value] : coarse.values)
    if (name == "node.3.peak.1.speed") {
      EXPECT_TRUE(std::isnan(value.more.at("uncertainty")));
    }
}

// A transfer function has no largest value where it grows without limit, however near to that a frequency lies.
TEST(LinearResponse, TransferFunctionsOfAnUndampedMachineHaveNoLargestValue) {
  const auto transfer = [](const std::string& damping, const std::string& range,
                           const std::string& stiffness = "1 MN/m") {
    study::Deck deck = study::load(
        MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/tests/app/friswell_591.yaml",
        {"bearings.*.film.damping=[" + damping + " N s/m, 0 N s/m, 0 N s/m, " + damping + " N s/m]",
         "bearings.*.film.stiffness=[" + stiffness + ", 0 N/m, 0 N/m, " + stiffness + "]",
         "studies=[{frequency_response: {speed: 0 rpm, inputs: [{node: 3}], points: 20, range: {" + range + "}}}]"});
    return test::run_deck(deck, "linear_endless").at(0);
  };
  const auto largest = [](const io::StudySummary& s) {
    return test::values_of(s).at("node.3.x.from.node.3.x.largest");
  };
  double place = 0;
  for (const char* range : {"from: 20 rad/s, to: 150 rad/s", "from: 86 rad/s, to: 87.5 rad/s"}) {
    const auto s = transfer("0", range);
    EXPECT_TRUE(std::isnan(largest(s))) << range;
    ASSERT_FALSE(s.warnings.empty());
    EXPECT_TRUE(s.warnings[0].starts_with("undamped resonances: ")) << s.warnings[0];
    for (const auto& [name, q] : s.values)
      if (name.ends_with(".largest_at")) {
        EXPECT_GT(q.bar(), 0);
        EXPECT_LT(q.bar(), 0.1);
        if (place > 0) {
          EXPECT_NEAR(q.value, place, 1e-9 * place);
        }
        place = q.value;
      }
  }
  // On springs of 100 N/m the shaft, four orders stiffer, is rigid: m w^2 = 2 k of its mass about, and J w^2 = k (a^2 +
  // b^2) of its tilt, coupled by k (b - a).
  constexpr double pi = 3.14159265358979, length = 1.5, stiffness = 100;
  const auto mass_of = [](double outer, double inner, double thickness) {
    return 7810 * pi / 4 * (outer * outer - inner * inner) * thickness;
  };
  double mass = 0, moment = 0, about_left = 0;
  const auto add = [&](double at, double outer, double inner, double thickness) {
    const double m = mass_of(outer, inner, thickness);
    mass += m;
    moment += m * at;
    about_left += m * (at * at + (outer * outer + inner * inner) / 16 + thickness * thickness / 12);
  };
  add(length / 2, 0.05, 0, length);
  add(0.5, 0.28, 0.05, 0.07);
  add(1.0, 0.35, 0.05, 0.07);
  const double centre = moment / mass, tilt = about_left - mass * centre * centre;
  Eigen::Matrix2d a;
  const double coupled = stiffness * (length - 2 * centre);
  a << 2 * stiffness / mass, coupled / mass, coupled / tilt,
      stiffness * (centre * centre + std::pow(length - centre, 2)) / tilt;
  const double lowest = std::sqrt(a.trace() / 2 - std::sqrt(a.trace() * a.trace() / 4 - a.determinant()));
  const auto rigid = test::values_of(transfer("0", "from: 0.5 rad/s, to: 2 rad/s", "100 N/m"));
  EXPECT_NEAR(rigid.at("node.3.x.from.node.3.x.largest_at"), lowest, 3e-4 * lowest);
  EXPECT_TRUE(std::isfinite(largest(transfer("0", "from: 20 rad/s, to: 60 rad/s"))));
  EXPECT_TRUE(std::isfinite(largest(transfer("200", "from: 20 rad/s, to: 150 rad/s"))));
}

}  // namespace
