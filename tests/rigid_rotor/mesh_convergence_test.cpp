// Bifurcations on finer film meshes: the limit from synthetic values, and a deck whose finest mesh is also computed
// directly.
#include <gtest/gtest.h>
#include <petscsys.h>

#include <cmath>

#include "rigid_rotor/run_deck.hpp"
#include "source_dir.hpp"
#include "study/convergence/mesh_convergence.hpp"

namespace {

using namespace whirl;

TEST(MeshLimit, ShowsOrderAndLimitOfAPower) {
  for (const double order : {1.0, 1.7, 2.0}) {
    std::vector<double> values;
    for (int k = 0; k < 3; ++k) values.push_back(3.0 + 0.4 * std::exp2(-order * k));
    const auto limit = study::mesh_limit(values);
    EXPECT_NEAR(limit.order, order, 1e-12);
    EXPECT_NEAR(limit.limit, 3.0, 1e-12);
    EXPECT_GE(limit.error, std::abs(values.back() - 3.0));
  }
}

TEST(MeshLimit, TrustsNoOrderThatIsNotShown) {
  const auto two = study::mesh_limit({1.0, 1.3});
  EXPECT_TRUE(std::isnan(two.order));
  EXPECT_NEAR(two.limit, 1.4, 1e-12);
  EXPECT_NEAR(two.error, 0.3, 1e-12);
  const auto waver = study::mesh_limit({1.0, 1.3, 1.2});
  EXPECT_NEAR(waver.error, 0.1, 1e-12);
  EXPECT_TRUE(std::isnan(study::mesh_limit({}).limit));
  // The last two meshes agree by chance: an order of 9.6. By theory they would differ by 0.075.
  const auto chance = study::mesh_limit({1.0, 1.3, 1.3 + 0.3 * std::exp2(-9.6)});
  EXPECT_NEAR(chance.order, 9.6, 1e-9);
  EXPECT_NEAR(chance.error, 0.075 / 3, 1e-12);
  // Of a scheme of first order a second one is not believed either, and kinks show none.
  EXPECT_GE(study::mesh_limit({1.0, 1.4, 1.5}, 1).error, 0.2 * (1 - 1e-12));
  EXPECT_NEAR(study::mesh_limit({1.0, 1.4, 1.5}, 2, true).error, 0.1, 1e-12);
  // 1.0 + 0.9 (1 - 2^(-k/4)): the bar of an order below 1/2 reaches what is left.
  std::vector<double> slow;
  for (int k = 0; k < 3; ++k) slow.push_back(1.9 - 0.9 * std::exp2(-0.25 * k));
  const auto low = study::mesh_limit(slow);
  EXPECT_LT(std::abs(low.limit - 1.9), low.error);
}

// Folds and the Neimark-Sacker point of the rotor in a rubber-lined bearing.
TEST(MeshConvergence, FinestMeshIsThatOfABranchComputedOnIt) {
  const auto run = [](const std::string& name, int cells, const std::string& more) {
    study::Deck deck =
        study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/compliant_rotor/figure_5_13.yaml",
                    {std::string("bars=") + (more.empty() ? "none" : "meshes"),
                     "bearings.rubber.film.cells=[" + std::to_string(cells) + ", 4]",
                     "studies=[{cycle_branch: {name: branch, unbalance: [residual], intervals: 16, degree: 3, "
                     "adapt_mesh: false, orbits: 0, tolerance: 1e-11, range: {from: 300 rad/s, to: 560 rad/s}, "
                     "step: {initial: 4 rad/s, min: 0.0001 rad/s, max: 32 rad/s}}}" +
                         more + "]"});
    return test::run_deck(deck, "mesh_convergence_" + name);
  };
  // With the known subspace in its preconditioner bordered systems of M (100 states) need few products.
  ASSERT_EQ(PetscOptionsSetValue(nullptr, "-bordered_ksp_max_it", "60"), 0);
  const auto direct = run("direct", 96, "").at(0).bifurcations;
  ASSERT_EQ(PetscOptionsClearValue(nullptr, "-bordered_ksp_max_it"), 0);
  const auto refined = run("refined", 24, ", {mesh_convergence: {name: fine, of: branch}}").at(1);
  EXPECT_EQ(refined.status, "completed");
  ASSERT_EQ(direct.size(), 3U);
  EXPECT_LT(direct[2].more.at("criticality_coefficient"), 0);
  EXPECT_NE(direct[2].criticality, "subcritical");
  ASSERT_EQ(refined.bifurcations.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    const io::Bifurcation& b = refined.bifurcations[k];
    EXPECT_EQ(b.type, direct[k].type) << k;
    EXPECT_NEAR(b.more.at("refined_4"), direct[k].value, 2e-4) << k;
    EXPECT_NEAR(b.more.at("observed_order"), 2, 0.3) << k;
    // The finest mesh differs from the limit by a third of its difference from the one before: within the estimate.
    EXPECT_LT(b.uncertainty, 0.15) << k;
    EXPECT_LT(std::abs(b.value - direct[k].value), b.uncertainty) << k;
  }
}

// The Hopf point of the rotor in a compliant short bearing, and its bar on the deck's own mesh.
TEST(MeshConvergence, OfAHopfPointIsWhatItsBarPromised) {
  study::Deck deck = study::load(
      MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/compliant_rotor/short.yaml",
      {"bearings.half.film.cells=[30, 4]",
       "studies=[{equilibrium_branch: {name: rest, parameter: speed, range: {from: 380 rad/s, to: 470 rad/s}}}, "
       "{mesh_convergence: {name: fine, of: rest, doublings: 3}}]"});
  const auto studies = test::run_deck(deck, "mesh_convergence_hopf");
  ASSERT_EQ(studies.at(0).bifurcations.size(), 1U);
  ASSERT_EQ(studies.at(1).bifurcations.size(), 1U);
  EXPECT_EQ(studies.at(1).status, "completed");
  const io::Bifurcation &here = studies[0].bifurcations[0], &fine = studies[1].bifurcations[0];
  EXPECT_EQ(fine.type, io::BifurcationType::hopf);
  EXPECT_EQ(fine.more.at("refined_1"), here.value);
  EXPECT_NEAR(fine.more.at("observed_order"), 2, 0.5);
  EXPECT_LT(fine.uncertainty, here.uncertainty / 4);
  const double error = std::abs(here.value - fine.value);
  EXPECT_LT(error, here.uncertainty);
  EXPECT_GT(5 * error, here.uncertainty);
  EXPECT_LT(std::abs(here.more.at("whirl_frequency_rad_s") - fine.more.at("whirl_frequency_rad_s")),
            here.more.at("uncertainty_whirl_frequency_rad_s"));
}

}  // namespace
