#include "study/bars/error_bar.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "study/bars/film_mesh.hpp"
#include "study/bars/shaft_mesh.hpp"
#include "whirl/film/contract/options.hpp"
#include "whirl/study/layout_options.hpp"

namespace whirl::study {
namespace {

// A number on a mesh with spacings h (around) and k (along), one and one being the mesh in use.
using Law = std::function<double(double h, double k)>;

Bar bar_of(const Law& law, const MeshLaw& known = {}, const std::vector<double>& spacings = {0.5, 2}) {
  std::vector<Sample> samples;
  for (const double r : spacings) {
    samples.push_back({Axis::around, r, law(r, 1)});
    samples.push_back({Axis::along, r, law(1, r)});
  }
  return error_bar(law(1, 1), samples, known);
}

double error_of(const Law& law) {
  return std::abs(law(1, 1) - law(1e-9, 1e-9));
}

TEST(ErrorBar, OfARegularLawCoversAndIsClose) {
  const Law law = [](double h, double k) { return 3 + 0.2 * h * h - 0.05 * k * k; };
  EXPECT_GE(bar_of(law).total(), error_of(law));
  EXPECT_LE(bar_of(law).total(), 2.1 * error_of(law));
}

TEST(ErrorBar, DoesNotVanishWhereTheTwoDirectionsCancel) {
  const Law law = [](double h, double k) { return 3 + 0.2 * h * h - 0.2 * k * k; };
  EXPECT_NEAR(error_of(law), 0, 1e-12);
  EXPECT_GE(bar_of(law).total(), 0.1 * (1 - 1e-12));  // a quarter of each
}

// Errors that halving both directions at once would hide: 0.3 h^2 - 0.1 k^3.
TEST(ErrorBar, CoversWhereHalvingBothDirectionsAtOnceShowsLittle) {
  const double c = 0.3 * 3 / 7;  // 0.3 (4 - 1) = c (8 - 1)
  const Law law = [c](double h, double k) { return 0.3 * h * h - c * k * k * k; };
  EXPECT_NEAR(law(2, 2), law(1, 1), 1e-12);
  EXPECT_GE(bar_of(law).total(), error_of(law));
}

TEST(ErrorBar, DoesNotVanishWhereTwoMeshesAgreeByChance) {
  // On the coarser mesh the same as here, on the finer one not; and the other way round.
  for (const double at : {2.0, 0.5}) {
    const Law law = [at](double h, double) { return h * h * (h == at ? 1 / (h * h) : 1); };
    std::vector<Sample> samples{{Axis::around, 0.5, law(0.5, 1)}, {Axis::around, 2, law(2, 1)}};
    EXPECT_GE(error_bar(1, samples, {}).total(), 1) << at;
  }
}

// On coarser meshes a feed stands elsewhere, which takes away what the spacing does.
TEST(ErrorBar, HoldsWhereAFeedThatMovesCancelsTheSpacing) {
  const auto value = [](double h, double moved) { return 3 + 0.2 * h - 0.2 * moved; };
  const std::vector<Sample> samples{{Axis::around, 2, value(2, 1)}, {Axis::around, 4, value(4, 2)}};
  MeshLaw law{.film_order = 1};
  EXPECT_LT(error_bar(value(1, 0), samples, law).total(), 0.2);
  law.feeds_move = true;
  EXPECT_GE(error_bar(value(1, 0), samples, law).total(), 0.2);
  // Numbers that no mesh changes are exact.
  EXPECT_EQ(error_bar(3, {{Axis::around, 2, 3.0}, {Axis::around, 4, 3.0}}, law).total(), 0);
}

// Multipliers of the rigid rotor at a* = 0.2, 400 rad/s on 10, 20 and 40 Gauss intervals of degree two: the first two
// agree to 5e-6, and both are off by 3.4e-4 (0.972015 on 160 of degree two).
TEST(ErrorBar, LeansOnAThirdMeshWhereTwoAgreeByChance) {
  const double here = 0.97167652, true_one = 0.972015;
  const MeshLaw law{.film_order = 2, .time_order = 4};
  std::vector<Sample> samples{{Axis::time, 0.5, 0.97168202}};
  EXPECT_LT(error_bar(here, samples, law).total(), 0.1 * (true_one - here)) << "two meshes do not see it";
  samples.push_back({Axis::time, 0.25, 0.97208832});
  EXPECT_GE(error_bar(here, samples, law).total(), true_one - here);
}

// Twice the cells agree too well (an order of 9.6): the coarser mesh says by theory what is left.
TEST(ErrorBar, BelievesNoOrderAboveTheory) {
  const std::vector<Sample> samples{{Axis::time, 2, 0.3 * 15}, {Axis::time, 0.5, -0.3 * 15 * std::exp2(-9.6)}};
  EXPECT_GE(error_bar(0, samples, {.film_order = 2, .time_order = 4}).total(), 0.3 * (1 - 1e-12));
}

TEST(ErrorBar, OfAShaftIsThatOfOneCut) {
  const Bar bar = error_bar(1546.707, {{Axis::shaft, 0.5, 1546.092}}, {});
  EXPECT_NEAR(bar.shaft_mesh, 3 * 0.615 * 16 / 15, 1e-9);
  EXPECT_EQ(bar.total(), bar.shaft_mesh);
  EXPECT_EQ(bar.parts(false).at("uncertainty_shaft_mesh"), bar.shaft_mesh);
}

TEST(ErrorBar, SeesALowerOrderThanThatOfTheory) {
  const Law law = [](double h, double k) { return 0.3 * h + 0.1 * std::sqrt(k); };
  EXPECT_GE(bar_of(law).total(), error_of(law));
}

TEST(ErrorBar, OfOneOtherMeshIsThreeTimesItsEstimate) {
  const Bar bar = error_bar(1, {{Axis::around, 2, 1.3}}, {});
  EXPECT_NEAR(bar.total(), 0.3, 1e-12);
}

TEST(ErrorBar, IsUnknownWhereNoOtherMeshHasTheNumber) {
  EXPECT_TRUE(std::isnan(error_bar(1, {{Axis::around, 2, NAN}, {Axis::along, 2, 1.0}}, {}).total()));
  EXPECT_EQ(error_bar(1, {}, {}).total(), 0) << "without a mesh there is no error of one";
}

TEST(ErrorBar, KeepsTimeApart) {
  const Bar bar =
      error_bar(1, {{Axis::time, 0.5, 1.07}, {Axis::time, 2, 0.44}, {Axis::around, 0.5, 1.0}}, {.time_order = 3});
  EXPECT_NEAR(bar.time_mesh, 0.08 * 1.25, 1e-12);  // 1.08 - 0.08 r^3
  EXPECT_EQ(bar.film_mesh, 0);
}

// A share of 2000 laws whose bar covers, and the median of bar over error.
struct Coverage {
  double share, median;
};
Coverage coverage(const std::function<Law(double phase)>& family, const MeshLaw& known,
                  const std::vector<double>& spacings) {
  std::vector<double> ratio;
  for (int k = 0; k < 2000; ++k) {
    const Law law = family(k * std::numbers::phi);
    ratio.push_back(bar_of(law, known, spacings).total() / error_of(law));
  }
  std::sort(ratio.begin(), ratio.end());
  const auto first = std::lower_bound(ratio.begin(), ratio.end(), 1.0);
  return {static_cast<double>(ratio.end() - first) / 2000, ratio[1000]};
}

// The edge of the film moves over the cells: part of the second-order error is periodic in the mesh.
TEST(ErrorBar, CoversAnOscillatingRemainder) {
  const auto family = [](double phase) -> Law {
    return [phase](double h, double k) {
      return h * h * (1 + 0.5 * std::sin(40 / h + phase)) - 0.5 * k * k + 0.3 * h * h * h * std::cos(phase);
    };
  };
  const Coverage c = coverage(family, {}, {0.5, 2});
  EXPECT_GE(c.share, 0.99);
  EXPECT_LE(c.median, 5);
}

TEST(ErrorBar, StudentsQuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(student_quantile(0.95, 1), 12.7062, 1e-4);
  EXPECT_NEAR(student_quantile(0.95, 2), 4.30265, 1e-5);
  EXPECT_NEAR(student_quantile(0.95, 3), 3.18245, 1e-5);
  EXPECT_NEAR(student_quantile(0.95, 6), 2.44691, 1e-5);
  EXPECT_NEAR(student_quantile(0.99, 7), 3.49948, 1e-5);
}

// Weights that jump with the edge: first order, and nothing but oscillation; or, against the rule, as large on every
// mesh.
TEST(ErrorBar, CoversKinksWhenToldOfThem) {
  const MeshLaw kinks{.kinks = true};
  const std::vector<double> four{0.5, 2.0 / 3, 4.0 / 3, 2}, coarser{2, 1.6, 4.0 / 3, 8.0 / 7};
  // How fast it oscillates is chance, too.
  const auto falling = [](double phase) -> Law {
    return [phase](double h, double k) {
      return h * h * 0.2 + h * std::sin((30 + std::fmod(phase, 50)) / h + phase) +
             0.5 * k * std::sin((40 + std::fmod(phase, 47)) / k + 2 * phase);
    };
  };
  const Coverage c = coverage(falling, kinks, four);
  EXPECT_GE(c.share, 0.97);
  EXPECT_LE(c.median, 4);
  EXPECT_GE(coverage(falling, kinks, coarser).share, 0.97);
  // The limit has none: error_of() would see it there.
  const auto equal = [](double phase) -> Law {
    return [phase](double h, double k) {
      if (h < 1e-6) return 0.0;
      return 0.3 * h * h - 0.2 * k + std::sin((50 + std::fmod(phase, 61)) / h + phase) +
             0.7 * std::sin((40 + std::fmod(phase, 47)) / k + 2 * phase);
    };
  };
  const Coverage e = coverage(equal, kinks, four);
  EXPECT_GE(e.share, 0.97);
  EXPECT_LE(e.median, 4);
  EXPECT_GE(coverage(equal, kinks, coarser).share, 0.97);
  // One frequency, in one direction: the meshes see one and the same oscillation and are not independent. So fewer are
  // covered than the 95 of 100 that t says, but more than if only two of the five numbers were: of these the mean errs
  // by less than the bar, t(0.95, 4) s/sqrt 5, in 2/pi atan(t sqrt(2/5)) = 67 of 100.
  const auto one = [](double phase) -> Law {
    return [phase](double h, double) { return h * h * 0.2 + h * std::sin(37 / h + phase); };
  };
  const Coverage o = coverage(one, kinks, four);
  EXPECT_LT(o.share, 0.95);
  EXPECT_GT(o.share, 0.67);
  EXPECT_LE(o.median, 2);
  EXPECT_GE(coverage(one, kinks, coarser).share, 0.99);
  EXPECT_LT(coverage(one, {}, {0.5, 2}).share, o.share) << "without the word it would cover less";
}

TEST(ErrorBar, OfKinksIsNoLongerThanTheScatter) {
  const MeshLaw kinks{.kinks = true};
  // A regular law has no scatter, and is covered of whichever order it is.
  for (const double order : {1.0, 2.0}) {
    const Law law = [order](double h, double k) { return 3 + 0.2 * std::pow(h, order) - 0.05 * std::pow(k, order); };
    const Bar bar = bar_of(law, kinks, {0.5, 2.0 / 3, 4.0 / 3, 2});
    EXPECT_GE(bar.total(), 0.25 * (1 - 1e-12)) << order;
    EXPECT_LE(bar.total(), order == 1 ? 0.3 : 1) << order;
  }
  // Two neighbouring meshes that differ by as much as any others do not make it long: what counts is not their
  // distance. Nor does a slope that leaves a little less variance but may as well be none.
  std::vector<Sample> samples;
  for (const Axis axis : {Axis::around, Axis::along})
    for (const auto& [spacing, value] : {std::pair{2.0, 0.5}, {10.0 / 9, 1.0}, {0.9, -1.0}, {0.5, -0.5}})
      samples.push_back({axis, spacing, value});
  EXPECT_LT(error_bar(0, samples, kinks).total(), 2);
  EXPECT_GT(error_bar(0, samples, kinks).total(), 1);
  for (Sample& s : samples) s.value *= 1 + 0.1 * (s.spacing - 1);
  EXPECT_LT(error_bar(0, samples, kinks).total(), 2) << "a little change of the samples";
}

// Four cells are no fewer, and three quarters of six are those that half of eleven are: a mesh counts once.
TEST(ErrorBar, HasEachMeshOnce) {
  system::Machine machine;
  film::Reynolds film;
  film.cavitation = film::Reynolds::Cavitation::mass_conserving;
  LayoutOptions layout;
  const auto cells = [&](std::array<int, 2> of) {
    film.cells = of;
    machine.bearings.resize(1);
    machine.bearings[0].film = film;
    std::array<std::vector<int>, 2> out;
    for (const FilmMesh& m : film_meshes(machine, layout)) {
      const std::size_t d = m.axis == Axis::around ? 0 : 1;
      out[d].push_back(film::facts(film::refined(machine.bearings[0].film, m.factor)).cells[d]);
      EXPECT_NEAR(m.spacing, static_cast<double>(of[d]) / out[d].back(), 1e-12);
    }
    return out;
  };
  EXPECT_EQ(cells({60, 16}), (std::array{std::vector{32, 43, 82, 112}, std::vector{8, 11, 22, 30}}));
  EXPECT_EQ(cells({4, 5}), (std::array{std::vector{5, 7}, std::vector{4, 7, 9}}));
  // Few cells: four times as many, too.
  film::Reynolds smooth;
  const auto smooth_cells = [&](std::array<int, 2> of) {
    smooth.cells = of;
    machine.bearings[0].film = smooth;
    std::array<std::vector<int>, 2> out;
    for (const FilmMesh& m : film_meshes(machine, layout)) {
      const std::size_t d = m.axis == Axis::around ? 0 : 1;
      out[d].push_back(film::facts(film::refined(machine.bearings[0].film, m.factor)).cells[d]);
    }
    return out;
  };
  EXPECT_EQ(smooth_cells({12, 30}), (std::array{std::vector{6, 24, 48}, std::vector{15, 60}}));
  EXPECT_EQ(smooth_cells({17, 5}), (std::array{std::vector{9, 34, 68}, std::vector{4, 10, 20}}));
  EXPECT_EQ(smooth_cells({24, 14}), (std::array{std::vector{12, 48}, std::vector{7, 28}}));
  EXPECT_EQ(smooth_cells({60, 16}), (std::array{std::vector{30, 120}, std::vector{8, 32}}));
  // More states than the deck lets bars refine (60 x 8 on half of an aligned pad): coarser ones only, as many.
  film.states = film::States::dynamic;
  EXPECT_EQ(cells({60, 16})[0].back(), 112);
  layout.refined_states = 400;
  EXPECT_EQ(cells({60, 16})[0], (std::vector{30, 38, 45, 53}));
}

// `bars: none`: no mesh of any kind beside the one in use, and a bar that is unknown, not zero.
TEST(ErrorBar, IsUnknownWhereNoneIsWanted) {
  system::Machine machine;
  machine.bearings.resize(1);
  film::Reynolds film;
  film.cells = {60, 16};
  machine.bearings[0].film = film;
  machine.rotor.type = rotor::Options::Type::shaft;
  LayoutOptions layout;
  EXPECT_FALSE(film_meshes(machine, layout).empty());
  EXPECT_TRUE(has_shaft_mesh(machine, layout));
  EXPECT_EQ(error_bar(1, {}, law_of(machine, layout)).total(), 0);
  layout.bars = BarsFrom::none;
  EXPECT_TRUE(film_meshes(machine, layout).empty());
  EXPECT_FALSE(has_shaft_mesh(machine, layout));
  EXPECT_TRUE(std::isnan(error_bar(1, {}, law_of(machine, layout)).total()));
}

// Bars of cycles and curves leave the shaft's mesh out, and say so where it matters.
TEST(ErrorBar, SaysWhatLeavesTheShaftOut) {
  system::Machine machine;
  machine.rotor.type = rotor::Options::Type::shaft;
  machine.rotor.segments.resize(2);
  const auto warnings = [&](bool with_bar, bool curve, double value = 100) {
    io::StudySummary summary;
    summary.bifurcations.resize(1);
    summary.bifurcations[0].value = value;
    if (with_bar) summary.bifurcations[0].more["uncertainty_shaft_mesh"] = 1;
    if (curve)
      warn_curve_without_shaft_mesh(summary, machine, LayoutOptions{});
    else
      warn_of_shaft_mesh(summary, machine, LayoutOptions{});
    return summary.warnings;
  };
  EXPECT_EQ(warnings(false, false).size(), 1);
  EXPECT_TRUE(warnings(true, false).empty());
  ASSERT_EQ(warnings(true, false, -40).size(), 1);
  EXPECT_EQ(
      warnings(true, false, -40)[0],
      "the mesh of the shaft (2 elements, rotor.element timoshenko) leaves up to 2.5 % in these bifurcations: cut "
      "the segments shorter");
  ASSERT_EQ(warnings(true, true).size(), 1);
  EXPECT_EQ(
      warnings(true, true)[0].find("the error bars of the curve leave out the error of the 2 elements of the shaft"),
      0);
  machine.rotor.reduction.type = rotor::Reduction::Type::guyan;
  EXPECT_TRUE(warnings(false, false).empty());
  EXPECT_TRUE(warnings(false, true).empty());
}

// The power loss of a bearing of the train on 17 x 40 cells: on 9 and 34 it seems to be of second order, and a bar of
// these two was 165 W long. It is of first order: 54028 W on 136 cells.
TEST(ErrorBar, OfAPowerLossOnFewCellsCovers) {
  const Bar bar =
      error_bar(53828, {{Axis::around, 17.0 / 9, 53484}, {Axis::around, 0.5, 53918}, {Axis::around, 0.25, 53988}}, {});
  EXPECT_GE(bar.total(), 54068 - 53828);
  EXPECT_LE(bar.total(), 4 * (54068 - 53828));
}

// Thresholds of the train in films that conserve their mass, on 120 x 24 cells and the eight meshes beside it
// (docs/mass_conserving.md). By Reynolds' condition, which has the same limit, the threshold is 7093 +- 16 rpm.
TEST(ErrorBar, OfTheTrainsThresholdCovers) {
  std::vector<Sample> samples;
  const auto add = [&](Axis axis, const std::vector<double>& values) {
    const double spacings[] = {2, 4.0 / 3, 2.0 / 3, 0.5};
    for (std::size_t k = 0; k < 4; ++k) samples.push_back({axis, spacings[k], values[k]});
  };
  add(Axis::around, {7042, 7164, 7099, 7093});
  add(Axis::along, {7091, 7126, 7046, 7079});
  const Bar bar = error_bar(7044, samples, {.kinks = true});
  EXPECT_GE(bar.total(), 7093 - 7044 + 16);
  EXPECT_LE(bar.total(), 3 * 40) << "of the scatter, 40 rpm";
}

TEST(ErrorBar, OfKinksIsUnknownWhereNothingShowsTheScatter) {
  const MeshLaw kinks{.kinks = true};
  EXPECT_TRUE(std::isnan(error_bar(1, {{Axis::around, 2, 1.1}}, kinks).total()));
  EXPECT_EQ(error_bar(1, {{Axis::around, 2, 1.0}}, kinks).total(), 0) << "it does not depend on the mesh";
  EXPECT_TRUE(std::isnan(error_bar(1, {{Axis::around, 2, NAN}, {Axis::around, 0.5, NAN}}, kinks).total()));
}

// Errors of time steps with jumps in the force's derivative k + 1: h^(k+2), times where in its step the jump stands.
double share_in_time(int k, double order) {
  int covered = 0;
  for (int n = 0; n < 2000; ++n) {
    const auto law = [&](double h) {
      return std::pow(h, k + 2) * std::sin(37 / h + 2 * std::numbers::pi * n * std::numbers::phi);
    };
    const std::vector<Sample> samples{{Axis::time, 0.5, law(0.5)}, {Axis::time, 2, law(2)}};
    covered += error_bar(law(1), samples, {.time_order = order}).total() >= std::abs(law(1));
  }
  return covered / 2000.0;
}

TEST(ErrorBar, CoversKinksInTimeWithTheOrderThatTheyLeave) {
  system::Machine machine;
  film::Options& film = machine.bearings.emplace_back().film;
  film = film::Short{};
  EXPECT_EQ(order_in_time(machine, 7), 7) << "smooth";
  film = film::Reynolds{};
  EXPECT_GE(share_in_time(1, order_in_time(machine, 7)), 0.99) << "tangents with kinks";
  EXPECT_LT(share_in_time(1, 7), 0.99) << "with the order of the scheme it does not";
  film::CompliantShort on_liner;
  on_liner.quadrature = film::Compliant::Quadrature::simpson;
  film = on_liner;
  EXPECT_GE(share_in_time(0, order_in_time(machine, 7)), 0.99) << "forces with kinks";
  EXPECT_LT(share_in_time(0, 7), 0.95);
}

TEST(ErrorBar, DecidesOnlyOutsideTheBar) {
  EXPECT_TRUE(decided(-2, 1));
  EXPECT_FALSE(decided(-1, 1));
  EXPECT_FALSE(decided(1, NAN));
}

}  // namespace
}  // namespace whirl::study
