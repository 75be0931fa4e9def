// What pressure does in a film.
#include <gtest/gtest.h>

#include <cmath>

#include "whirl/thermal/film_flow.hpp"

namespace whirl::thermal {
namespace {

struct Work {
  double expansion = 0, power = 0, exact = 0;
};

// A gas film of one temperature, bearing A of Skarolek (2011) with `orifices`.
Work work_of(int around, int along, int orifices, double speed) {
  Mesh mesh;
  mesh.around = around;
  mesh.along = along;
  mesh.across = 2;
  mesh.radius = 0.015;
  mesh.length = 0.03;
  const Rows rows(mesh, PETSC_COMM_WORLD);
  FilmFlowOptions o;
  o.fluid.gas = true;
  o.fluid.viscosity = ConstantViscosity{1.846e-5};
  o.ambient = 101325;
  o.speed = speed;
  for (int k = 0; k < orifices; ++k) o.orifices.push_back({k * around / orifices, along / 2, 2e-4, 5e5, 300});
  std::vector<double> h;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < around; ++i) h.push_back(2e-5 * (1 - 0.5 * std::cos(mesh.theta(i))));
  FilmFlow film(rows, o, h);
  film.set_temperature(std::vector<double>(h.size() * 2, 300));
  (void)film.solve();
  const FlowReport report = film.report(film.flow());
  Work out{report.expansion, report.power, 0};
  const std::vector<double> flows = film.orifice_flows();
  for (std::size_t k = 0; k < flows.size(); ++k) {
    const int j = o.orifices[k].j;
    double p = 0;
    if (j >= rows.begin() && j < rows.end())
      p = film.pressure()[static_cast<std::size_t>(rows.node(o.orifices[k].i, j))];
    MPI_Allreduce(MPI_IN_PLACE, &p, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    out.exact -= 286.7 * 300 * flows[k] * std::log(p / 101325);
  }
  return out;
}

// At one temperature the work is -r T sum mdot ln(p_in/p_out): none of a film that draws in and lets out at one
// pressure.
TEST(FilmWork, OfASelfActingFilmVanishesWithTheMesh) {
  double before = 0;
  for (const int m : {2, 4, 8}) {
    const Work w = work_of(24 * m, 8 * m, 0, 1e4);
    EXPECT_GT(w.power, 10);
    if (m > 2) {
      EXPECT_GT(std::log2(std::abs(before / w.expansion)), 1.7) << m;
    }
    before = w.expansion;
  }
  EXPECT_LT(std::abs(before), 0.1);
}

// Beside an orifice the pressure changes over a step by as much on any mesh, so that a part stays.
TEST(FilmWork, OfFedFilmsIsThatOfTheirFlows) {
  for (const double speed : {0.0, 1e4}) {
    const Work w = work_of(192, 64, 8, speed);
    EXPECT_LT(w.expansion, -5);
    EXPECT_NEAR(w.expansion, w.exact, 0.003 * std::abs(w.exact)) << speed;
  }
}

}  // namespace
}  // namespace whirl::thermal
