// Heat capacity, conductivity and density over the temperature: the laws, and the energy equation with them.
#include <gtest/gtest.h>

#include <cmath>

#include "support/heated_film.hpp"
#include "support/petsc_options.hpp"
#include "whirl/core/error.hpp"
#include "whirl/thermal/energy.hpp"
#include "whirl/thermal/fluid.hpp"
#include "whirl/thermal/viscosity_table.hpp"

namespace whirl::thermal {
namespace {

using test::HeatedFilm;
constexpr double c = 2000, k = 0.13, feed = 313.15;
const PolynomialLaw air{1000, {3.653, -1.337, 3.294, -1.913, 0.2763}};

EnergyModel varied(int order) {
  return {c, k, order, LinearLaw{feed, 4e-3}, PowerLaw{300, -1.5}};
}

core::Vector uneven(const HeatedFilm& film, double middle, double size) {
  core::Vector t = film.temperature(0);
  const core::WriteArray x(t.get());
  film.each([&](int q, int i, int j) {
    x[film.rows.cell(q, i, j)] = middle + size * std::sin(1.7 * i + 0.9 * j + 0.8 * q + 0.3);
  });
  return t;
}

// A bearing with something fed and something drawn off, its walls between a surface and a solid.
struct Case {
  std::unique_ptr<HeatedFilm> film = test::heated_bearing(PETSC_COMM_WORLD, 18, 9, 5, 0.8);
  Surroundings s;
  explicit Case(const EnergyModel& m) {
    film->each([&](int q, int i, int j) {
      if (j == 4 && (i == 3 || i == 4)) film->flow.inflow[film->cell(q, i, j)] = 1e-4;
      if (j == 5 && i == 9) film->flow.inflow[film->cell(q, i, j)] = -1e-4;
    });
    const double there = k * evaluate(m.conductivity_law, feed).value;
    s = {film->isothermal(there, feed + 3), film->isothermal(there, feed + 9), feed, {}, {}};
    for (double& g : s.journal.conductance) g *= 0.3;
    s.supply.assign(film->thickness.size(), feed - 8);
  }
};

TEST(PropertyLaw, HasExactSlopesAndIntegrals) {
  for (const PropertyLaw& law : {PropertyLaw{}, PropertyLaw{LinearLaw{313, -7e-4}}, PropertyLaw{air},
                                 PropertyLaw{PowerLaw{273.15, 0.9}}, PropertyLaw{PowerLaw{300, -1}}})
    for (const double t : {280.0, 350.0, 600.0}) {
      const double d = 1e-2;
      EXPECT_NEAR(evaluate(law, t).slope, (evaluate(law, t + d).value - evaluate(law, t - d).value) / (2 * d), 1e-10);
      EXPECT_NEAR(evaluate(law, t).value, integral(law, t - d, t + d) / (2 * d), 1e-8) << law.index();
      EXPECT_NEAR(integral(law, 300, t) + integral(law, t, 410), integral(law, 300, 410), 1e-10) << law.index();
      EXPECT_EQ(integral(law, t, t), 0);
    }
}

// Pieces of a law, but for the kink of a polynomial that is held where it is least, and beyond the pieces.
TEST(ViscosityTable, IsTheLaw) {
  const Quadratic ferron{0.0277, 40, {3.287, -3.064, 0.777}};
  for (const Viscosity& law :
       {Viscosity(ConstantViscosity{0.02}), Viscosity(Sutherland{}), Viscosity(Vogel{0.04, 313.15, 800, 180}),
        Viscosity(Walther{{46e-6, 6.8e-6}, {313.15, 373.15}, 860}), Viscosity(ferron)}) {
    ViscosityTable table(law);
    for (int turn = 0; turn < 2; ++turn)
      for (double t = 190; t < 1010; t += turn == 0 ? 7.03 : 0.37) {
        const Valued found = table.at(t), wanted = viscosity(law, t);
        EXPECT_NEAR(found.value, wanted.value, 2e-13 * std::abs(wanted.value)) << law.index() << " at " << t;
        EXPECT_NEAR(found.slope, wanted.slope, 2e-10 * std::abs(wanted.slope) + 1e-12 * std::abs(wanted.value))
            << law.index() << " at " << t;
      }
  }
  const double kink = 273.15 + 40 * 3.064 / (2 * 0.777);
  ViscosityTable table{Viscosity(ferron)};
  for (const double away : {-1e-3, 1e-3}) {
    EXPECT_EQ(table.at(kink + away).value, viscosity(ferron, kink + away).value);
    EXPECT_EQ(table.at(kink + away).slope, viscosity(ferron, kink + away).slope);
  }
}

TEST(PropertyLaw, KnowsAir) {
  Fluid f{Sutherland{}, true, 287.05};
  f.heat_capacity = 287.05;
  f.heat_capacity_law = air;
  f.conductivity = 0.0241;
  f.conductivity_law = PowerLaw{273.15, 0.9};
  EXPECT_NEAR(f.c(300), 1005, 3);
  EXPECT_NEAR(f.c(600), 1051, 4);  // tables of dry air
  EXPECT_NEAR(f.k(300), 0.0263, 0.0002);
  EXPECT_NEAR(f.prandtl(300), 0.707, 0.007);
  EXPECT_NEAR(f.rho(101325, 300), 1.1766, 1e-4);
  Fluid oil{ConstantViscosity{0.01}};
  oil.density = 870;
  oil.density_law = LinearLaw{288.15, -6.5e-4};
  EXPECT_NEAR(oil.rho(0, 338.15), 870 * (1 - 6.5e-4 * 50), 1e-9);
}

// Between walls of two temperatures the heat through the film is the mean conductivity times the step over h: a
// straight law is met on any mesh.
TEST(EnergyLaw, ConductionAcrossIsKirchhoffs) {
  const double h = 1e-4, slope = -3e-3;
  for (const int layers : {2, 7}) {
    Mesh m = test::heated_bearing(PETSC_COMM_WORLD, 6, 5, layers, 0)->mesh;
    HeatedFilm film(
        m, PETSC_COMM_WORLD, [=](double, double) { return h; },
        [](double, double, double, double, double) { return 0.0; },
        [](double, double, double, double, double) { return 0.0; });
    const EnergyModel model{c, k, 2, ConstantLaw{}, LinearLaw{feed, slope}};
    Energy energy(film.rows, film.flow, model, film.thickness,
                  {film.isothermal(k, feed + 60), film.isothermal(k, feed), feed, {}, {}});
    core::Vector t = film.temperature(feed);
    ASSERT_TRUE(energy.solve(t.get(), 1e-13).converged);
    const double area = 2 * std::numbers::pi * m.radius * m.length, mean = k * (1 + slope * 30);
    EXPECT_NEAR(energy.budget(t.get()).journal, mean * 60 / h * area, 1e-9 * mean * 60 / h * area);
    EXPECT_NEAR(energy.budget(t.get()).residual(), 0, 1e-9 * mean * 60 / h * area);
  }
}

// Heat between walls of one temperature: theta = int k dT/k_w is the parabola q h^2/(2 k_w) eta (1 - eta).
TEST(EnergyLaw, HeatedFilmConvergesInSecondOrder) {
  const double h = 1e-4, a = 5e-3, q = 2e9;  // W/m^3
  double last = 0;
  for (const int layers : {5, 10, 20}) {
    Mesh m = test::heated_bearing(PETSC_COMM_WORLD, 6, 5, layers, 0)->mesh;
    HeatedFilm film(
        m, PETSC_COMM_WORLD, [=](double, double) { return h; },
        [](double, double, double, double, double) { return 0.0; },
        [](double, double, double, double, double) { return 0.0; });
    film.each([&](int s, int i, int j) {
      film.flow.heat[film.cell(s, i, j)] = q * h / layers * film.mesh.width(i) * film.mesh.depth(j);
    });
    Energy energy(film.rows, film.flow, {c, k, 2, ConstantLaw{}, LinearLaw{feed, a}}, film.thickness,
                  {film.isothermal(k, feed), film.isothermal(k, feed), feed, {}, {}});
    core::Vector t = film.temperature(feed);
    ASSERT_TRUE(energy.solve(t.get(), 1e-12).converged);
    double error = 0;
    {
      const core::ReadArray x(t.get());
      film.each([&](int s, int i, int j) {
        const double eta = film.middle(s), theta = q * h * h / (2 * k) * eta * (1 - eta);
        const double exact = (std::sqrt(1 + 2 * a * theta) - 1) / a;
        error = std::max(error, std::abs(x[film.rows.cell(s, i, j)] - feed - exact));
      });
    }
    MPI_Allreduce(MPI_IN_PLACE, &error, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 2, 0.1) << error;
    }
    last = error;
  }
}

// What flows along between walls that take no heat leaves with the enthalpy it was given, on any mesh.
TEST(EnergyLaw, EnthalpyAtTheOutletIsWhatHeated) {
  Mesh m = test::heated_bearing(PETSC_COMM_WORLD, 6, 5, 3, 0)->mesh;
  const double flow = 0.2, power = 3e4;  // kg/(s m), J/kg
  for (const int order : {1, 2}) {
    HeatedFilm film(
        m, PETSC_COMM_WORLD, [](double, double) { return 1e-4; },
        [](double, double, double, double, double) { return 0.0; },
        [=](double, double x0, double x1, double a, double b) { return flow * (x1 - x0) * (b - a); });
    film.each([&](int s, int i, int j) {
      film.flow.heat[film.cell(s, i, j)] =
          power * flow * film.mesh.width(i) / film.mesh.across * film.mesh.depth(j) / film.mesh.length;
    });
    EnergyModel model = varied(order);
    model.conductivity = 1e-9;
    Energy energy(film.rows, film.flow, model, film.thickness, {film.adiabatic(), film.adiabatic(), feed, {}, {}});
    core::Vector t = film.temperature(feed);
    ASSERT_TRUE(energy.solve(t.get(), 1e-12).converged);
    const core::ReadArray x(t.get());
    film.each([&](int s, int i, int j) {
      if (j != film.mesh.along) return;
      EXPECT_NEAR(c * integral(model.heat_capacity_law, feed, x[film.rows.cell(s, i, j)]), power, 1e-7 * power);
    });
  }
}

TEST(EnergyLaw, ConstantTemperatureStaysAndTheBalanceCloses) {
  for (const int order : {1, 2}) {
    const EnergyModel model = varied(order);
    Case made(model);
    const HeatedFilm& film = *made.film;
    Energy energy(film.rows, film.flow, model, film.thickness, made.s);
    core::Vector t = film.temperature(feed), r = core::duplicate(t.get());
    ASSERT_TRUE(energy.solve(t.get(), 1e-12).converged);
    const EnergyBudget b = energy.budget(t.get());
    EXPECT_LT(std::abs(b.residual()), 1e-8 * b.heat);
    // Nothing but the fluxes of the budget enters the sum of residuals, at any temperature.
    core::Vector any = uneven(film, feed, 20);
    energy.residual(any.get(), r.get());
    double sum = 0;
    core::check(VecSum(r.get(), &sum));
    EXPECT_NEAR(sum, -energy.budget(any.get()).residual(), 1e-9 * b.heat);
    Case still(model);
    std::fill(still.film->flow.heat.begin(), still.film->flow.heat.end(), 0.0);
    for (Wall* w : {&still.s.bush, &still.s.journal}) std::fill(w->temperature.begin(), w->temperature.end(), feed);
    still.s.supply.clear();
    Energy rests(still.film->rows, still.film->flow, model, still.film->thickness, still.s);
    t = still.film->temperature(feed);
    rests.residual(t.get(), r.get());
    EXPECT_EQ(core::norm(r.get()), 0);
  }
}

TEST(EnergyLaw, DerivativeIsThatOfTheResidual) {
  for (const int order : {1, 2})
    for (const bool mixed : {false, true}) {
      const EnergyModel model = varied(order);
      Case made(model);
      HeatedFilm& film = *made.film;
      if (mixed) {
        film.flow.mixing.resize(film.flow.across.size());
        for (std::size_t n = 0; n < film.flow.mixing.size(); ++n)
          film.flow.mixing[n] = 2 + std::sin(static_cast<double>(n));
      }
      Energy energy(film.rows, film.flow, model, film.thickness, made.s);
      core::Vector t = uneven(film, feed, 15), v = uneven(film, 1, 5), product = core::duplicate(t.get()),
                   by_matrix = core::duplicate(t.get()), up = core::duplicate(t.get()), down = core::duplicate(t.get()),
                   at = core::duplicate(t.get());
      energy.linearise(t.get());
      core::check(MatMult(energy.jacobian(), v.get(), product.get()));
      core::check(MatMult(energy.assemble().get(), v.get(), by_matrix.get()));
      const double size = core::norm(product.get());
      core::check(VecAXPY(by_matrix.get(), -1, product.get()));
      EXPECT_LT(core::norm(by_matrix.get()), 1e-12 * size);
      const double e = 1e-5;
      core::check(VecWAXPY(at.get(), e, v.get(), t.get()));
      energy.residual(at.get(), up.get());
      core::check(VecWAXPY(at.get(), -e, v.get(), t.get()));
      energy.residual(at.get(), down.get());
      core::check(VecAXPY(up.get(), -1, down.get()));
      core::check(VecScale(up.get(), 1 / (2 * e)));
      core::check(VecAXPY(up.get(), -1, product.get()));
      EXPECT_LT(core::norm(up.get()), 2e-7 * size) << order << mixed;  // slopes are kept in single precision
    }
}

TEST(EnergyLaw, DirectSolutionAgreesWithLines) {
  const EnergyModel model = varied(2);
  Case made(model);
  const HeatedFilm& film = *made.film;
  Energy lines(film.rows, film.flow, model, film.thickness, made.s);
  core::Vector t = film.temperature(feed), u = film.temperature(feed);
  ASSERT_TRUE(lines.solve(t.get(), 1e-12).converged);
  const test::WithOptions options(test::WithOptions::List{{"-film_energy_pc_type", "lu"}});
  Energy direct(film.rows, film.flow, model, film.thickness, made.s);
  ASSERT_TRUE(direct.solve(u.get(), 1e-12).converged);
  core::check(VecAXPY(u.get(), -1, t.get()));
  EXPECT_LT(core::norm(u.get()), 1e-7);
}

// A straight line ends somewhere: that is said, on all ranks.
TEST(EnergyLaw, RefusesWhatIsNotPositive) {
  const EnergyModel model{c, k, 2, LinearLaw{feed, -0.1}, ConstantLaw{}};
  Case made(model);
  const HeatedFilm& film = *made.film;
  Energy energy(film.rows, film.flow, model, film.thickness, made.s);
  core::Vector t = film.temperature(feed + 50), r = core::duplicate(t.get());
  EXPECT_THROW(energy.residual(t.get(), r.get()), core::DomainError);
}

}  // namespace
}  // namespace whirl::thermal
