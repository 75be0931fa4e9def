// A film of one layer between bush and journal, solved with them as one problem.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "thermal/solid_cases.hpp"

namespace whirl::thermal::test {
namespace {

// Columns of the film that are warmed by `heat` each and lose heat to 300 K through `leak`, beside both solids.
struct Together {
  Rows rows;
  Solid bush, journal;
  std::vector<double> g = film_conductance(rows, 2e4),
                      heat = columns(rows, [](int i, int j) { return 0.05 + 0.01 * ((i + 2 * j) % 5); });
  double leak = 1e-3;  // W/K
  std::vector<PetscInt> cell = numbers(rows);

  Together(const Mesh& mesh, const Bush& b, const Journal& j)
      : rows(mesh, PETSC_COMM_WORLD), bush(make_solid(rows, b)), journal(make_solid(rows, j)) {
    bush.join(g);
    journal.join(g);
  }
  static std::vector<PetscInt> numbers(const Rows& r) {
    std::vector<PetscInt> out;
    for (int n = 0; n < r.count() * r.mesh().nodes_around(); ++n)
      out.push_back(static_cast<PetscInt>(r.begin()) * r.mesh().nodes_around() + n);
    return out;
  }
  [[nodiscard]] PetscInt size() const { return static_cast<PetscInt>(cell.size()); }
};

// Blocks of the matrix of film and solid together, -joined in each; a row of prescribed temperature knows no film.
struct HeatCoupling {
  HeatCoupling(const Solid& solid, PetscInt cells, const std::vector<PetscInt>& film_cell) {
    const auto block = [&](PetscInt rows, PetscInt columns, core::Matrix& m) {
      core::check(MatCreateAIJ(solid.comm(), rows, columns, PETSC_DETERMINE, PETSC_DETERMINE,
                               static_cast<PetscInt>(film_cell.size()), nullptr, 0, nullptr, m.put()));
    };
    block(solid.count(), cells, solid_film);
    block(cells, solid.count(), film_solid);
    for (std::size_t c = 0; c < film_cell.size(); ++c) {
      const PetscInt wall = solid.wall()[c];
      const double joined = -solid.joined()[c];
      core::check(MatSetValue(solid_film.get(), wall, film_cell[c], solid.held(wall) ? 0 : joined, INSERT_VALUES));
      core::check(MatSetValue(film_solid.get(), film_cell[c], wall, joined, INSERT_VALUES));
    }
    for (Mat m : {solid_film.get(), film_solid.get()}) {
      core::check(MatAssemblyBegin(m, MAT_FINAL_ASSEMBLY));
      core::check(MatAssemblyEnd(m, MAT_FINAL_ASSEMBLY));
    }
  }
  core::Matrix solid_film;  // W/K [cells of the solid, cells of the film]
  core::Matrix film_solid;  // W/K [cells of the film, cells of the solid]
};

struct Found {
  core::Vector bush, journal, film;
  int iterations = 0;
};

// [ bush          B_f ] by GMRES; the film's block is diagonal, those of the solids by multigrid.
// [     journal   J_f ]
// [ f_B   f_J    film ]
Found solve_together(Together& all) {
  const HeatCoupling b(all.bush, all.size(), all.cell), j(all.journal, all.size(), all.cell);
  core::Matrix film = core::make_matrix(PETSC_COMM_WORLD, all.size(), std::vector<PetscInt>(all.cell.size(), 1));
  Found out{all.bush.temperature(300), all.journal.temperature(300),
            core::make_vector(PETSC_COMM_WORLD, all.size(), PETSC_DETERMINE), 0};
  core::Vector rhs_film = core::duplicate(out.film.get()), rhs_bush = core::duplicate(out.bush.get()),
               rhs_journal = core::duplicate(out.journal.get());
  core::check(VecCopy(all.bush.supply(), rhs_bush.get()));
  core::check(VecCopy(all.journal.supply(), rhs_journal.get()));
  for (std::size_t c = 0; c < all.cell.size(); ++c) {
    const double diagonal = all.leak + all.bush.joined()[c] + all.journal.joined()[c];
    core::check(MatSetValue(film.get(), all.cell[c], all.cell[c], diagonal, INSERT_VALUES));
    core::check(VecSetValue(rhs_film.get(), all.cell[c], all.heat[c] + all.leak * 300, INSERT_VALUES));
  }
  core::check(MatAssemblyBegin(film.get(), MAT_FINAL_ASSEMBLY));
  core::check(MatAssemblyEnd(film.get(), MAT_FINAL_ASSEMBLY));
  core::check(VecAssemblyBegin(rhs_film.get()));
  core::check(VecAssemblyEnd(rhs_film.get()));
  core::check(VecSet(out.film.get(), 300));
  Mat blocks[9] = {all.bush.matrix(),
                   nullptr,
                   b.solid_film.get(),
                   nullptr,
                   all.journal.matrix(),
                   j.solid_film.get(),
                   b.film_solid.get(),
                   j.film_solid.get(),
                   film.get()};
  core::Matrix whole;
  core::check(MatCreateNest(PETSC_COMM_WORLD, 3, nullptr, 3, nullptr, blocks, whole.put()));
  // A vector of the whole holds on each rank those of its parts one after the other.
  core::Vector rhs, x;
  core::check(MatCreateVecs(whole.get(), x.put(), rhs.put()));
  const auto lay = [](Vec flat, std::initializer_list<Vec> parts, bool back) {
    const core::WriteArray joined(flat);
    double* at = joined.data();
    for (Vec part : parts) {
      const core::WriteArray p(part);
      std::copy_n(back ? at : p.data(), p.size(), back ? p.data() : at);
      at += p.size();
    }
  };
  lay(rhs.get(), {rhs_bush.get(), rhs_journal.get(), rhs_film.get()}, false);
  lay(x.get(), {out.bush.get(), out.journal.get(), out.film.get()}, false);
  core::LinearSolver solver;
  core::check(KSPCreate(PETSC_COMM_WORLD, solver.put()));
  core::check(KSPSetOperators(solver.get(), whole.get(), whole.get()));
  core::check(KSPSetType(solver.get(), KSPGMRES));
  core::check(KSPSetTolerances(solver.get(), 1e-13, PETSC_DEFAULT, PETSC_DEFAULT, 200));
  core::check(KSPSetInitialGuessNonzero(solver.get(), PETSC_TRUE));
  PC pc = nullptr;
  core::check(KSPGetPC(solver.get(), &pc));
  core::check(PCSetType(pc, PCFIELDSPLIT));
  IS fields[3];
  core::check(MatNestGetISs(whole.get(), fields, nullptr));
  const char* names[] = {"bush", "journal", "film"};
  for (int f = 0; f < 3; ++f) core::check(PCFieldSplitSetIS(pc, names[f], fields[f]));
  core::check(PCFieldSplitSetType(pc, PC_COMPOSITE_SYMMETRIC_MULTIPLICATIVE));
  core::check(KSPSetUp(solver.get()));
  PetscInt n = 0;
  KSP* parts = nullptr;
  core::check(PCFieldSplitGetSubKSP(pc, &n, &parts));
  for (int f = 0; f < 3; ++f) {
    PC part = nullptr;
    core::check(KSPSetType(parts[f], KSPPREONLY));
    core::check(KSPGetPC(parts[f], &part));
    if (f < 2)
      use_multigrid(part);
    else
      core::check(PCSetType(part, PCJACOBI));
  }
  core::check(PetscFree(parts));
  core::check(KSPSolve(solver.get(), rhs.get(), x.get()));
  KSPConvergedReason why{};
  core::check(KSPGetConvergedReason(solver.get(), &why));
  EXPECT_GT(why, 0);
  lay(x.get(), {out.bush.get(), out.journal.get(), out.film.get()}, true);
  PetscInt iterations = 0;
  core::check(KSPGetIterationNumber(solver.get(), &iterations));
  out.iterations = static_cast<int>(iterations);
  return out;
}

std::vector<double> here(Vec v) {
  const core::ReadArray a(v);
  return {a.data(), a.data() + a.size()};
}

class JoinedSolids : public testing::TestWithParam<bool> {};

TEST_P(JoinedSolids, OneProblemHasTheSolutionOfItsParts) {
  Bush b = bush();
  b.layers = 6;
  if (GetParam()) b.surfaces.begin = prescribed(310);
  Journal j = journal();
  j.layers = 6;
  j.growth = 1.2;
  Together all(film(16, 9), b, j);
  const Found found = solve_together(all);
  EXPECT_LT(found.iterations, 60) << found.iterations;
  const std::vector<double> film = here(found.film.get());
  // Each solid by itself beside the film that was found.
  for (auto [solid, temperature] :
       {std::pair{&all.bush, found.bush.get()}, std::pair{&all.journal, found.journal.get()}}) {
    const core::Vector rhs = solid->temperature(0), alone = solid->temperature(300);
    solid->load(film, rhs.get());
    solid->solve(rhs.get(), alone.get());
    const std::vector<double> x = here(temperature), y = here(alone.get());
    for (std::size_t n = 0; n < x.size(); ++n) ASSERT_NEAR(x[n], y[n], 1e-5);
  }
  // Each column of the film keeps nothing.
  const std::vector<double> up = all.bush.wall_heat(found.bush.get(), film),
                            down = all.journal.wall_heat(found.journal.get(), film);
  for (std::size_t c = 0; c < film.size(); ++c)
    ASSERT_NEAR(up[c] + down[c] + all.leak * (film[c] - 300), all.heat[c], 1e-8);
  // What the film makes leaves through the surfaces.
  const Heats p = all.bush.heats(found.bush.get(), film), q = all.journal.heats(found.journal.get(), film);
  std::vector<double> lost;
  for (const double t : film) lost.push_back(all.leak * (t - 300));
  const double made = sum(all.rows, all.heat) - sum(all.rows, lost);
  EXPECT_NEAR(p.inner + p.outer + p.begin + p.end + q.inner + q.outer + q.begin + q.end, made, 1e-7 * made);
}

INSTANTIATE_TEST_SUITE_P(Solid, JoinedSolids, testing::Values(false, true));

TEST(Solid, IterationsOfOneProblemDoNotGrowWithTheMesh) {
  std::vector<int> iterations;
  for (const int size : {1, 2, 4}) {
    Bush b = bush();
    Journal j = journal();
    b.layers = j.layers = 4 * size;
    Together all(film(16 * size, 8 * size), b, j);
    iterations.push_back(solve_together(all).iterations);
  }
  EXPECT_LE(iterations[2], 1.3 * iterations[0]) << iterations[0] << ' ' << iterations[1] << ' ' << iterations[2];
}

// u = alpha R (mean rise): of a ring with a logarithmic profile the mean is known.
TEST(Solid, ItsWallGrowsByTheMeanRise) {
  const Rows rows(film(8, 7), PETSC_COMM_WORLD);
  Bush b = bush();
  b.layers = 64;
  b.material.expansion = 1.2e-5;
  b.surfaces.begin = b.surfaces.end = {};
  b.surfaces.outer = prescribed(300);
  Solid ring = make_solid(rows, b);
  const double inner = 0.015, outer = 0.025, hot = 400;
  const auto warm = columns(rows, [&](int, int) { return hot; });
  const Solution s = solve(ring, film_conductance(rows, 1e9), warm);
  // The mean of ln(R_o/r)/ln(R_o/R) over the section is 1/(2 ln(R_o/R)) - R^2/(R_o^2 - R^2).
  const double mean = 100 * (0.5 / std::log(outer / inner) - inner * inner / (outer * outer - inner * inner));
  for (const double u : ring.growth(s.temperature.get(), 300))
    EXPECT_NEAR(u, 1.2e-5 * inner * mean, 1e-4 * 1.2e-5 * inner * mean);
  Journal j = journal();
  j.material.expansion = 1e-5;
  const Solid shaft = make_solid(rows, j);
  const core::Vector t = shaft.temperature(340);
  const std::vector<double> u = shaft.growth(t.get(), 300);
  EXPECT_EQ(u.size(), static_cast<std::size_t>(rows.count()));
  for (const double v : u) EXPECT_NEAR(v, 1e-5 * 0.015 * 40, 1e-18);
}

}  // namespace
}  // namespace whirl::thermal::test
