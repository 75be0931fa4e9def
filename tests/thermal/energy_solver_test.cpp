// What the energy equation keeps on any mesh, and how it is solved.
#include <gtest/gtest.h>

#include "support/heated_film.hpp"
#include "support/petsc_options.hpp"
#include "whirl/thermal/energy.hpp"

namespace whirl::thermal {
namespace {

using test::HeatedFilm;
constexpr double c = 2000, k = 0.13, feed = 313.15;

Surroundings walls_at(const HeatedFilm& film, double temperature) {
  return {film.isothermal(k, temperature), film.isothermal(k, temperature), feed, {}, {}};
}

double distance(Vec a, Vec b) {
  core::Vector d = core::duplicate(a);
  double out = 0;
  core::check(VecWAXPY(d.get(), -1, a, b));
  core::check(VecNorm(d.get(), NORM_INFINITY, &out));
  return out;
}

core::Vector uneven(const HeatedFilm& film) {
  core::Vector t = film.temperature(0);
  {
    const core::WriteArray x(t.get());
    film.each([&](int q, int i, int j) {
      x[film.rows.cell(q, i, j)] = feed + 5 * std::sin(1.7 * i + 0.9 * j + 0.8 * q + 0.3);
    });
  }
  return t;
}

// Orifices and grooves feed a bearing at its ends' temperature, and take as much elsewhere.
std::unique_ptr<HeatedFilm> fed_bearing(MPI_Comm comm) {
  auto film = test::heated_bearing(comm, 18, 9, 5, 0.8);
  film->each([&](int q, int i, int j) {
    if (j == 4 && (i == 3 || i == 4)) film->flow.inflow[film->cell(q, i, j)] = 1e-4;
    if (j == 5 && i == 9) film->flow.inflow[film->cell(q, i, j)] = -1e-4;
  });
  return film;
}

TEST(EnergyScheme, ConstantTemperatureStaysWithoutSources) {
  const auto film = test::heated_bearing(PETSC_COMM_WORLD, 18, 9, 5, 0.8);
  std::fill(film->flow.heat.begin(), film->flow.heat.end(), 0.0);
  for (const int order : {1, 2}) {
    Energy energy(film->rows, film->flow, {c, k, order}, film->thickness, walls_at(*film, feed));
    core::Vector t = film->temperature(feed), r = core::duplicate(t.get());
    energy.residual(t.get(), r.get());
    EXPECT_EQ(core::norm(r.get()), 0);
    t = film->temperature(feed + 10);
    ASSERT_TRUE(energy.solve(t.get(), 1e-13).converged);
    core::check(VecShift(t.get(), -feed));
    double off = 0;
    core::check(VecNorm(t.get(), NORM_INFINITY, &off));
    EXPECT_LT(off, 1e-9);
  }
}

// A constant rise above the ambient's is left alone where nothing enters: continuity of the flow, to rounding.
TEST(EnergyScheme, AnyConstantIsKeptByAFlowThatKeepsMass) {
  Mesh m = test::heated_bearing(PETSC_COMM_WORLD, 18, 9, 5, 0)->mesh;
  HeatedFilm film(
      m, PETSC_COMM_WORLD, [](double, double) { return 1e-4; },
      [](double x, double z0, double z1, double a, double b) {
        return (z1 - z0) * (b - a + std::sin(x / 0.05) * (b * (1 - b) - a * (1 - a)));
      },
      [](double, double, double, double, double) { return 0.0; });
  Energy energy(film.rows, film.flow, {c, k, 2}, film.thickness, {film.adiabatic(), film.adiabatic(), feed, {}, {}});
  core::Vector t = film.temperature(feed + 50), r = core::duplicate(t.get());
  energy.residual(t.get(), r.get());
  double off = 0, most = 0;
  core::check(VecNorm(r.get(), NORM_INFINITY, &off));
  for (const double f : film.flow.around) most = std::max(most, std::abs(f));
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  EXPECT_LT(off, 1e-14 * c * most * 50);
}

TEST(EnergyScheme, BalanceOfTheWholeFilmCloses) {
  for (const int order : {1, 2}) {
    const auto film = fed_bearing(PETSC_COMM_WORLD);
    Surroundings s = walls_at(*film, feed + 3);
    s.supply.assign(film->thickness.size(), feed - 8);
    Energy energy(film->rows, film->flow, {c, k, order}, film->thickness, s);
    core::Vector t = film->temperature(feed);
    const EnergySolve solved = energy.solve(t.get());
    ASSERT_TRUE(solved.converged);
    const EnergyBudget b = energy.budget(t.get());
    EXPECT_LT(std::abs(b.residual()), 1e-9 * b.heat);
    EXPECT_LT(b.supply, 0);
    EXPECT_GT(b.heat, 0);
    // Nothing but the fluxes of the budget enters the sum of residuals, at any temperature.
    core::Vector any = uneven(*film), r = core::duplicate(t.get());
    energy.residual(any.get(), r.get());
    double sum = 0;
    core::check(VecSum(r.get(), &sum));
    EXPECT_NEAR(sum, -energy.budget(any.get()).residual(), 1e-10 * b.heat);
  }
}

// A hot stripe enters a pad obliquely: nothing gets hotter or colder than what enters.
TEST(EnergyScheme, StepCarriedObliquelyMakesNoNewExtrema) {
  Mesh m;
  m.around = 30;
  m.along = 24;
  m.across = 4;
  m.closed = false;
  m.radius = 1;
  m.extent = 1;
  m.length = 0.8;
  double first = 0;
  for (const int order : {1, 2}) {
    HeatedFilm film(
        m, PETSC_COMM_WORLD, [](double, double) { return 1e-3; },
        [](double, double z0, double z1, double a, double b) { return (z1 - z0) * (b - a); },
        [](double, double x0, double x1, double a, double b) { return 0.37 * (x1 - x0) * (b - a); });
    Surroundings s{film.adiabatic(), film.adiabatic(), 300, {}, {}};
    for (int j = film.rows.begin(); j < film.rows.end(); ++j)
      for (int q = 0; q < m.across; ++q) s.entering.push_back(std::abs(m.z(j) + 0.2) < 0.1 ? 400.0 : 300.0);
    Energy energy(film.rows, film.flow, {c, 1e-9, order}, film.thickness, s);
    core::Vector t = film.temperature(300);
    ASSERT_TRUE(energy.solve(t.get(), 1e-11).converged);
    double low = 0, high = 0;
    core::check(VecMin(t.get(), nullptr, &low));
    core::check(VecMax(t.get(), nullptr, &high));
    EXPECT_GT(low, 300 - 1e-6);
    EXPECT_LT(high, 400 + 1e-6);
    // The second order carries the stripe further.
    const core::ReadArray x(t.get());
    double outlet = 0;
    for (int j = film.rows.begin(); j < film.rows.end(); ++j)
      outlet = std::max(outlet, x[film.rows.cell(0, m.around, j)]);
    MPI_Allreduce(MPI_IN_PLACE, &outlet, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
    if (order == 1) first = outlet - 300;
    EXPECT_GT(outlet - 300, order == 1 ? 0 : 1.5 * first);
  }
}

// A bearing without dissipation, with reversed flow, whose bush is hot in patches: everything stays between the
// temperatures of walls and ends.
TEST(EnergyScheme, NoNewExtremaWithoutSources) {
  constexpr double hot = feed + 50;
  for (const auto& [around, along, across] : {std::array{36, 12, 6}, {120, 40, 16}}) {
    const auto film = test::heated_bearing(PETSC_COMM_WORLD, around, along, across, 0.9);
    std::fill(film->flow.heat.begin(), film->flow.heat.end(), 0.0);
    double back = 0;
    for (const double f : film->flow.around) back = std::min(back, f);
    MPI_Allreduce(MPI_IN_PLACE, &back, 1, MPI_DOUBLE, MPI_MIN, PETSC_COMM_WORLD);
    ASSERT_LT(back, 0);
    Surroundings s = walls_at(*film, feed);
    std::size_t node = 0;
    for (int j = film->rows.begin(); j < film->rows.end(); ++j)
      for (int i = 0; i < film->mesh.nodes_around(); ++i, ++node)
        if ((6 * i / film->mesh.nodes_around() + 3 * j / film->mesh.nodes_along()) % 2 == 0)
          s.bush.temperature[node] = hot;
    Energy energy(film->rows, film->flow, {c, k, 2}, film->thickness, s);
    core::Vector t = film->temperature(feed);
    ASSERT_TRUE(energy.solve(t.get(), 1e-11).converged);
    double low = 0, high = 0;
    core::check(VecMin(t.get(), nullptr, &low));
    core::check(VecMax(t.get(), nullptr, &high));
    EXPECT_GT(low, feed - 1e-7);
    EXPECT_LT(high, hot + 1e-7);
    EXPECT_GT(high, feed + 20);
  }
}

TEST(EnergySolver, ReverseFlowIsSweptMoreOften) {
  for (const double eccentricity : {0.3, 0.9}) {
    const auto film = test::heated_bearing(PETSC_COMM_WORLD, 48, 16, 6, eccentricity);
    double back = 0;
    for (const double f : film->flow.around) back = std::min(back, f);
    MPI_Allreduce(MPI_IN_PLACE, &back, 1, MPI_DOUBLE, MPI_MIN, PETSC_COMM_WORLD);
    Energy energy(film->rows, film->flow, {c, k, 2}, film->thickness, walls_at(*film, feed));
    EXPECT_EQ(energy.sweeps(), back < 0 ? 4 : 2);
    EXPECT_EQ(back<0, eccentricity> 0.5);
    core::Vector t = film->temperature(feed);
    const EnergySolve solved = energy.solve(t.get());
    EXPECT_TRUE(solved.converged);
    EXPECT_LE(solved.newton, 14);
    EXPECT_LE(solved.krylov, 120);
  }
}

TEST(EnergySolver, IterationsDoNotGrowWithTheMeshThoughATenthOfTheFilmTurnsBack) {
  std::vector<int> counts;
  for (const int along : {12, 24}) {
    const auto film = test::heated_bearing(PETSC_COMM_WORLD, 4 * along, along, 8, 0.4, 0.6);
    Energy energy(film->rows, film->flow, {c, k, 1}, film->thickness, walls_at(*film, feed));
    core::Vector t = film->temperature(feed);
    const EnergySolve solved = energy.solve(t.get());
    EXPECT_TRUE(solved.converged);
    counts.push_back(solved.krylov);
  }
  EXPECT_LE(counts[1], 1.5 * counts[0]);
  EXPECT_LE(counts[1], 16);  // two sweeps take twice as many
}

TEST(EnergySolver, AnswerDoesNotDependOnRanks) {
  const auto film = fed_bearing(PETSC_COMM_WORLD), alone = fed_bearing(PETSC_COMM_SELF);
  Energy energy(film->rows, film->flow, {c, k, 2}, film->thickness, walls_at(*film, feed));
  Energy whole(alone->rows, alone->flow, {c, k, 2}, alone->thickness, walls_at(*alone, feed));
  core::Vector t = film->temperature(feed), u = alone->temperature(feed);
  ASSERT_TRUE(energy.solve(t.get(), 1e-12).converged);
  ASSERT_TRUE(whole.solve(u.get(), 1e-12).converged);
  const std::vector<double> all = core::gather(t.get());
  const core::ReadArray one(u.get());
  ASSERT_EQ(all.size(), static_cast<std::size_t>(one.size()));
  for (std::size_t a = 0; a < all.size(); ++a) ASSERT_NEAR(all[a], one[static_cast<PetscInt>(a)], 1e-8);
}

TEST(EnergySolver, DirectSolutionAgreesWithLines) {
  const auto film = fed_bearing(PETSC_COMM_WORLD);
  Energy lines(film->rows, film->flow, {c, k, 2}, film->thickness, walls_at(*film, feed));
  core::Vector t = film->temperature(feed), u = film->temperature(feed);
  ASSERT_TRUE(lines.solve(t.get(), 1e-12).converged);
  const test::WithOptions options(test::WithOptions::List{{"-film_energy_pc_type", "lu"}});
  Energy direct(film->rows, film->flow, {c, k, 2}, film->thickness, walls_at(*film, feed));
  const EnergySolve solved = direct.solve(u.get(), 1e-12);
  ASSERT_TRUE(solved.converged);
  EXPECT_LE(solved.krylov, 2 * solved.newton);  // the matrix is the Jacobian
  EXPECT_LT(distance(t.get(), u.get()), 1e-8);
}

TEST(EnergySolver, DerivativeIsThatOfTheResidual) {
  for (const bool closed : {true, false})
    for (const int order : {1, 2}) {
      auto made = fed_bearing(PETSC_COMM_WORLD);
      if (!closed) {
        Mesh m = made->mesh;
        m.closed = false;
        made = std::make_unique<HeatedFilm>(
            m, PETSC_COMM_WORLD, [](double x, double) { return 1e-4 * (1 + x); },
            [](double x, double z0, double z1, double a, double b) {
              return (z1 - z0) * (b * b - a * a + 2 * std::cos(20 * x) * (b * (1 - b) - a * (1 - a)));
            },
            [](double z, double x0, double x1, double a, double b) { return (x1 - x0) * (b - a) * z; });
      }
      const HeatedFilm& film = *made;
      Surroundings s = walls_at(film, feed + 1);
      for (double& g : s.journal.conductance) g *= 0.3;  // a solid behind the surface
      Energy energy(film.rows, film.flow, {c, k, order}, film.thickness, s);
      core::Vector t = uneven(film), v = uneven(film), up = core::duplicate(t.get()), down = core::duplicate(t.get());
      core::check(VecShift(v.get(), -feed - 1));
      core::Vector product = core::duplicate(t.get()), by_matrix = core::duplicate(t.get()),
                   at = core::duplicate(t.get());
      energy.linearise(t.get());
      core::check(MatMult(energy.jacobian(), v.get(), product.get()));
      core::check(MatMult(energy.assemble().get(), v.get(), by_matrix.get()));
      const double size = core::norm(product.get());
      EXPECT_GT(size, 0);
      EXPECT_LT(distance(product.get(), by_matrix.get()), 1e-12 * size);
      const double e = 1e-6;
      core::check(VecWAXPY(at.get(), e, v.get(), t.get()));
      energy.residual(at.get(), up.get());
      core::check(VecWAXPY(at.get(), -e, v.get(), t.get()));
      energy.residual(at.get(), down.get());
      core::check(VecAXPY(up.get(), -1, down.get()));
      core::check(VecScale(up.get(), 1 / (2 * e)));
      EXPECT_LT(distance(product.get(), up.get()), 1e-6 * size)
          << closed << order << ' ' << size;  // slopes are kept in single precision
    }
}

}  // namespace
}  // namespace whirl::thermal
