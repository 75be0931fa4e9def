// What crosses the surfaces of a solid, its matrix, and what ranks and meshes must not change.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "thermal/solid_cases.hpp"

namespace whirl::thermal::test {
namespace {

Mesh pad(int around, int along) {
  Mesh out = film(around, along);
  out.closed = false;
  out.extent = 1.9;
  return out;
}

// A solid of every kind, with every kind of surface, beside the same film.
std::vector<Solid> solids(const Rows& rows) {
  std::vector<Solid> out;
  Bush b = bush();
  b.layers = 4;
  b.grading = 1.3;
  out.push_back(make_solid(rows, b));
  b.surfaces = {convection(20, 310), prescribed(305), prescribed(300), convection(30, 290)};
  out.push_back(make_solid(rows, b));
  b.ring = false;
  b.surfaces.end = prescribed(330);
  out.push_back(make_solid(rows, b));
  Journal j = journal();
  j.layers = 4;
  j.growth = 1.2;
  out.push_back(make_solid(rows, j));
  j.rotating = false;
  j.bore_radius = 0;
  j.surfaces.end = prescribed(320);
  out.push_back(make_solid(rows, j));
  return out;
}

// Numbers without a pattern, the same on any number of ranks.
double noise(PetscInt n) {
  return std::sin(12.9898 * static_cast<double>(n) + 4.1414 * std::sqrt(1.0 + static_cast<double>(n)));
}

core::Vector noisy(const Solid& s, double mean, double size, PetscInt seed) {
  core::Vector out = s.temperature(mean);
  const core::WriteArray a(out.get());
  each(s, [&](PetscInt at, int k, int i, int q) { a[at] += size * noise(s.cell(k, i, q) + seed); });
  return out;
}

class BothFilms : public testing::TestWithParam<bool> {
protected:
  [[nodiscard]] static Mesh mesh() { return GetParam() ? film(12, 7) : pad(9, 7); }
  [[nodiscard]] static std::vector<double> hot(const Rows& rows) {
    return columns(rows, [](int i, int j) { return 360 + 20 * noise(31 * j + i); });
  }
};

// The heats of any temperature leave exactly what the equations of its cells leave.
TEST_P(BothFilms, HeatsAddUpToTheResidual) {
  const Rows rows(mesh(), PETSC_COMM_WORLD);
  for (Solid& solid : solids(rows)) {
    solid.join(film_conductance(rows, 3e4));
    const core::Vector rhs = solid.temperature(0), t = noisy(solid, 330, 15, 0);
    solid.load(hot(rows), rhs.get());
    {
      // The right-hand side of a cell that is held says its temperature.
      const core::Vector diagonal = core::duplicate(t.get());
      core::check(MatGetDiagonal(solid.matrix(), diagonal.get()));
      const core::ReadArray d(diagonal.get()), b(rhs.get());
      const core::WriteArray w(t.get());
      each(solid, [&](PetscInt at, int k, int i, int q) {
        if (solid.held(solid.cell(k, i, q))) w[at] = b[at] / d[at];
      });
    }
    const core::Vector left = core::duplicate(t.get());
    core::check(MatMult(solid.matrix(), t.get(), left.get()));
    core::check(VecAYPX(left.get(), -1, rhs.get()));
    PetscScalar sum = 0;
    core::check(VecSum(left.get(), &sum));
    const Heats heats = solid.heats(t.get(), hot(rows));
    EXPECT_GT(std::abs(sum), 1);
    EXPECT_NEAR(heats.residual(), sum, 1e-10 * std::abs(heats.wall));
  }
}

TEST_P(BothFilms, WhatComesFromTheFilmLeavesThroughTheSurfaces) {
  const Rows rows(mesh(), PETSC_COMM_WORLD);
  for (Solid& solid : solids(rows)) {
    const Solution s = solve(solid, film_conductance(rows, 3e4), hot(rows));
    const Heats heats = solid.heats(s.temperature.get(), hot(rows));
    EXPECT_GT(heats.wall, 1);
    EXPECT_NEAR(heats.residual(), 0, 1e-8 * heats.wall);
    EXPECT_NEAR(heats.wall, sum(rows, solid.wall_heat(s.temperature.get(), hot(rows))), 1e-10 * heats.wall);
  }
}

TEST_P(BothFilms, TheMatrixIsSymmetric) {
  const Rows rows(mesh(), PETSC_COMM_WORLD);
  for (Solid& solid : solids(rows)) {
    solid.join(film_conductance(rows, 3e4));
    const core::Vector x = noisy(solid, 0, 1, 0), y = noisy(solid, 0, 1, 7), a = core::duplicate(x.get());
    double xay = 0, yax = 0, xax = 0;
    core::check(MatMult(solid.matrix(), y.get(), a.get()));
    core::check(VecDot(a.get(), x.get(), &xay));
    core::check(MatMult(solid.matrix(), x.get(), a.get()));
    core::check(VecDot(a.get(), y.get(), &yax));
    core::check(VecDot(a.get(), x.get(), &xax));
    EXPECT_GT(xax, 0);
    EXPECT_NE(xay, 0);
    EXPECT_NEAR(xay, yax, 1e-12 * xax);
  }
}

TEST_P(BothFilms, AnyNumberOfRanksFindsTheSame) {
  const Rows rows(mesh(), PETSC_COMM_WORLD), alone(mesh(), PETSC_COMM_SELF);
  std::vector<Solid> shared = solids(rows), whole = solids(alone);
  for (std::size_t n = 0; n < shared.size(); ++n) {
    const Solution a = solve(shared[n], film_conductance(rows, 3e4), hot(rows)),
                   b = solve(whole[n], film_conductance(alone, 3e4), hot(alone));
    const std::vector<double> x = core::gather(a.temperature.get()), y = core::gather(b.temperature.get());
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t c = 0; c < x.size(); ++c) ASSERT_NEAR(x[c], y[c], 1e-6);
    const Heats p = shared[n].heats(a.temperature.get(), hot(rows)),
                q = whole[n].heats(b.temperature.get(), hot(alone));
    EXPECT_NEAR(p.wall, q.wall, 1e-7 * q.wall);
    EXPECT_NEAR(p.end, q.end, 1e-7 * q.wall);
  }
}

INSTANTIATE_TEST_SUITE_P(Solid, BothFilms, testing::Values(true, false));

// The wall of a rotating journal takes the sum over its columns: hot and cold ones count as their mean.
TEST(Solid, ARotatingJournalFeelsTheMeanAround) {
  const Rows rows(film(8, 6), PETSC_COMM_WORLD);
  Solid solid = make_solid(rows, journal());
  const auto g = film_conductance(rows, 2e4);
  const auto uneven = columns(rows, [](int i, int) { return i % 2 == 0 ? 420.0 : 340.0; }),
             even = columns(rows, [](int, int) { return 380.0; });
  const Solution a = solve(solid, g, uneven), b = solve(solid, g, even);
  const std::vector<double> x = solid.wall_temperature(a.temperature.get(), uneven),
                            y = solid.wall_temperature(b.temperature.get(), even);
  for (std::size_t c = 0; c < x.size(); ++c) EXPECT_NEAR(x[c], y[c], 1e-6);
  EXPECT_NEAR(sum(rows, solid.wall_heat(a.temperature.get(), uneven)),
              sum(rows, solid.wall_heat(b.temperature.get(), even)), 1e-6);
}

// Bearing A at 10,000 rad/s, reference/003/coupled.json: the heats that its film gives to bush and journal, and the
// temperatures that follow. There the film is neither of one temperature nor does it give the same heat everywhere: its
// walls lie between those of these two cases, and the ends of the shaft, far from it, where both have them.
TEST(Solid, BearingAHasTheTemperaturesOfTheReference) {
  const Rows rows(film(24, 32), PETSC_COMM_WORLD);
  struct Means {
    double wall, near, far;
  };
  const auto means = [&](Solid& solid, double coefficient, double temperature, double heat) {
    const auto warm = columns(rows, [&](int, int) { return temperature; });
    const Solution s = solve(solid, film_conductance(rows, coefficient), warm);
    const double share = heat / solid.heats(s.temperature.get(), warm).wall;
    const std::vector<double> t = core::gather(s.temperature.get());
    const Cylinder& c = solid.shape();
    double near = 0, far = 0, area = 0;
    for (int k = 0; k < c.layers(); ++k) {
      area += c.sector(k);
      near += c.sector(k) * t[static_cast<std::size_t>(solid.cell(k, 0, 0))];
      far += c.sector(k) * t[static_cast<std::size_t>(solid.cell(k, 0, c.rows() - 1))];
    }
    const double wall = sum(rows, solid.wall_temperature(s.temperature.get(), warm)) / (24 * 33);
    const auto scaled = [&](double mean) { return 300 + share * (mean - 300); };
    return Means{scaled(wall), scaled(near / area), scaled(far / area)};
  };
  struct Case {
    double convection_in_bore, heat;
    Means sought;
  };
  for (const Case& c : {Case{200, 57.78047952963037, {364.63487559410055, 328.79198550860826, 306.7365072752739}},
                        Case{0, 54.31367673936354, {383.5996707541504, 343.31092883431415, 312.6082389870018}}}) {
    Journal j = journal();
    j.layers = 16;
    j.surfaces.inner.coefficient = c.convection_in_bore;
    Solid solid = make_solid(rows, j);
    const Means even = means(solid, 2e4, 400, c.heat), spread = means(solid, 1, 1e4, c.heat);
    EXPECT_LT(even.wall, c.sought.wall);
    EXPECT_GT(spread.wall, c.sought.wall);
    EXPECT_LT(spread.wall - even.wall, 7);
    for (const Means& m : {even, spread}) {
      EXPECT_NEAR(m.near, c.sought.near, 1);
      EXPECT_NEAR(m.far, c.sought.far, 0.3);
    }
  }
  Bush b = bush();
  b.layers = 16;
  Solid solid = make_solid(rows, b);
  EXPECT_NEAR(means(solid, 2e4, 400, 24.001179891841772).wall, 367.70301903058316, 0.3);
}

// The thickest layer is 18 times the thinnest.
TEST(Solid, IterationsDoNotGrowWithTheMesh) {
  std::vector<int> iterations;
  for (const int size : {1, 2, 4}) {
    const Rows rows(film(24 * size, 8 * size), PETSC_COMM_WORLD);
    Bush b = bush();
    b.layers = 4 * size;
    b.grading = std::pow(18, 1.0 / (b.layers - 1));
    Solid solid = make_solid(rows, b);
    const auto hot = columns(rows, [](int i, int j) { return 360 + 20 * noise(31 * j + i); });
    iterations.push_back(solve(solid, film_conductance(rows, 3e4), hot).iterations);
  }
  EXPECT_LE(iterations[2], 1.5 * iterations[1] + 1) << iterations[0] << ' ' << iterations[1] << ' ' << iterations[2];
  EXPECT_LE(iterations[2], 25);
}

TEST(Solid, OptionsOfTheUserOverrideItsPreconditioner) {
  const auto type = [](const char* option, const char* value) {
    PC pc = nullptr;
    core::check(PCCreate(PETSC_COMM_WORLD, &pc));
    core::check(PCSetOptionsPrefix(pc, "solid_options_test_"));
    if (option) core::check(PetscOptionsSetValue(nullptr, option, value));
    use_multigrid(pc);
    if (option) core::check(PetscOptionsClearValue(nullptr, option));
    PCType found = nullptr;
    core::check(PCGetType(pc, &found));
    std::string out = found;
    core::check(PCDestroy(&pc));
    return out;
  };
  EXPECT_EQ(type(nullptr, nullptr), PCHYPRE);
  EXPECT_EQ(type("-solid_options_test_pc_type", "jacobi"), PCJACOBI);
}

TEST(Solid, ASolvedSystemIsLeftAsItIs) {
  const Rows rows(film(12, 6), PETSC_COMM_WORLD);
  Solid solid = make_solid(rows, bush());
  const auto hot = columns(rows, [](int i, int) { return 360.0 + i; });
  Solution s = solve(solid, film_conductance(rows, 3e4), hot);
  const core::Vector rhs = solid.temperature(0);
  solid.load(hot, rhs.get());
  for (int n = 0; n < 4; ++n) EXPECT_LE(solid.solve(rhs.get(), s.temperature.get()), s.iterations + 2) << n;
  EXPECT_LE(solid.solve(rhs.get(), s.temperature.get()), 3);
}

TEST(Cylinder, CellsEndWhereTheirVolumesDo) {
  const Rows rows(pad(9, 7), PETSC_COMM_WORLD);
  Journal j = journal();
  j.rotating = false;
  j.growth = 1.3;
  const Cylinder shape = make_solid(rows, j).shape();
  const std::vector<double> theta = cell_ends(shape.theta, 2 * std::numbers::pi), z = cell_ends(shape.z);
  ASSERT_EQ(theta.size(), shape.theta.size() + 1);
  ASSERT_EQ(z.size(), shape.z.size() + 1);
  for (int i = 0; i < shape.columns(); ++i) {
    const auto n = static_cast<std::size_t>(i);
    EXPECT_NEAR(theta[n + 1] - theta[n], shape.angle(i), 1e-14);
  }
  for (int q = 0; q < shape.rows(); ++q) {
    const auto n = static_cast<std::size_t>(q);
    EXPECT_NEAR(z[n + 1] - z[n], shape.depth(q), 1e-15);
  }
  EXPECT_NEAR(z.back() - z.front(), j.length, 1e-14);
}

TEST(Solid, StoresHeatInAllOfItsVolume) {
  const Rows rows(pad(9, 7), PETSC_COMM_WORLD);
  Journal j = journal();
  j.rotating = false;
  Bush b = bush();
  b.grading = 1.3;
  const double pi = std::numbers::pi, heat = 7800 * 460;
  const auto total = [](const Solid& s) {
    PetscScalar out = 0;
    core::check(VecSum(s.capacity().get(), &out));
    return out;
  };
  const double ring = heat * pi * (0.025 * 0.025 - 0.015 * 0.015) * 0.03;
  EXPECT_NEAR(total(make_solid(rows, b)), ring, 1e-10 * ring);
  b.ring = false;
  EXPECT_NEAR(total(make_solid(rows, b)), ring * 1.9 / (2 * pi), 1e-10 * ring);
  const double shaft = heat * pi * (0.015 * 0.015 - 0.005 * 0.005) * 0.1;
  EXPECT_NEAR(total(make_solid(rows, j)), shaft, 1e-10 * shaft);
  j.rotating = true;
  EXPECT_NEAR(total(make_solid(rows, j)), shaft, 1e-10 * shaft);
}

TEST(Solid, WhatCannotBeIsRefused) {
  const Rows rows(film(8, 6), PETSC_COMM_WORLD);
  Bush b = bush();
  b.surfaces = {};
  Solid alone = make_solid(rows, b);
  const core::Vector t = alone.temperature(300), rhs = alone.temperature(0);
  EXPECT_THROW(alone.solve(rhs.get(), t.get()), core::NotConverged);
  b.outer_radius = 0.015;
  EXPECT_THROW((void)make_solid(rows, b), core::Error);
  Journal j = journal();
  j.before = 0.08;
  EXPECT_THROW((void)make_solid(rows, j), core::Error);
  j = journal();
  j.surfaces.outer = prescribed(300);
  EXPECT_THROW((void)make_solid(rows, j), core::Error);
  j = journal();
  j.bore_radius = 0.015;
  EXPECT_THROW((void)make_solid(rows, j), core::Error);
}

}  // namespace
}  // namespace whirl::thermal::test
