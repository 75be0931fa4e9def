// Bifurcations on finer film meshes: the limit from synthetic values, and a deck whose finest mesh is also computed
// directly.
#include <gtest/gtest.h>

#include <cmath>

#include "rigid_rotor/run_deck.hpp"
#include "whirl/study/mesh_convergence.hpp"

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
}

// Flips, and the fold of the doubled cycle, of the rotor of figure 5.8 with B = 1.
TEST(MeshConvergence, FinestMeshIsThatOfABranchComputedOnIt) {
  const auto run = [](const std::string& name, int cells, const std::string& more) {
    study::Deck deck = study::load(
        MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/compliant_rotor/short.yaml",
        {"bearings.half.film.compliance=1", "bearings.half.film.cells=[" + std::to_string(cells) + ", 4]",
         "studies=[{cycle_branch: {name: branch, unbalance: [a], follow_flips: true, intervals: 24, degree: 3, "
         "adapt_mesh: false, orbits: 0, tolerance: 1e-11, range: {from: 336 rad/s, to: 520 rad/s}, "
         "step: {initial: 8 rad/s, min: 0.001 rad/s, max: 32 rad/s}}}" +
             more + "]"});
    return test::run_deck(deck, "mesh_convergence_" + name);
  };
  const auto direct = run("direct", 80, ""),
             refined = run("refined", 20,
                           ", {mesh_convergence: {name: flips, of: branch}}, "
                           "{mesh_convergence: {name: fold, of: branch flip 1, bifurcations: [1]}}");
  const auto find = [](const auto& all, const std::string& name) {
    for (const auto& s : all)
      if (s.name == name) return s;
    ADD_FAILURE() << name;
    return io::StudySummary{};
  };
  const auto flips = find(refined, "flips"), fold = find(refined, "fold"), branch = find(direct, "branch"),
             doubled = find(direct, "branch flip 1");
  ASSERT_EQ(flips.status, "completed");
  ASSERT_EQ(fold.status, "completed");
  ASSERT_EQ(flips.bifurcations.size(), 2U);
  ASSERT_EQ(branch.bifurcations.size(), 2U);
  ASSERT_EQ(fold.bifurcations.size(), 1U);
  ASSERT_GE(doubled.bifurcations.size(), 1U);
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_NEAR(flips.bifurcations[k].more.at("refined_4"), branch.bifurcations[k].value, 1e-4) << k;
  EXPECT_EQ(fold.bifurcations[0].type, io::BifurcationType::cyclic_fold);
  EXPECT_NEAR(fold.bifurcations[0].more.at("refined_4"), doubled.bifurcations[0].value, 1e-4);
}

}  // namespace
