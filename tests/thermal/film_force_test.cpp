// The force of a film whose pressure is cut off below the ambient's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "whirl/thermal/film_flow.hpp"

namespace whirl::thermal {
namespace {

using std::numbers::pi;
using Cavitation = FilmFlowOptions::Cavitation;

struct Force {
  double along = 0, across = 0;  // to the widest gap, and a quarter turn further
  double by_node = 0;            // along, of what is cut off node by node
};

// Oil between a journal of 50 mm and its bush, the smallest gap at `attitude`. `feed`: of
// half of the circle, the journal at rest.
Force force_of(int around, double attitude, Cavitation cavitation, double feed = 0) {
  Mesh mesh;
  mesh.around = around;
  mesh.along = 8;
  mesh.across = 1;
  mesh.radius = 0.05;
  mesh.length = 0.08;
  const Rows rows(mesh, PETSC_COMM_WORLD);
  std::vector<double> h;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < around; ++i) h.push_back(1e-4 * (1 - 0.6 * std::cos(mesh.theta(i) - attitude)));
  FilmFlowOptions o;
  o.fluid.density = 860;
  o.fluid.viscosity = ConstantViscosity{0.0277};
  o.speed = feed > 0 ? 0 : 200;
  o.cavitation = cavitation;
  if (feed > 0) o.feeds.push_back({0, around / 2, 1, mesh.along - 1, feed});
  FilmFlow film(rows, o, h);
  film.set_temperature(std::vector<double>(h.size(), 313.15));
  (void)film.solve();
  const FlowReport report = film.report(film.flow());
  Force out;
  out.along = -(report.force[0] * std::cos(attitude) + report.force[1] * std::sin(attitude));
  out.across = report.force[1] * std::cos(attitude) - report.force[0] * std::sin(attitude);
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < around; ++i)
      out.by_node += std::max(film.pressure()[static_cast<std::size_t>(rows.node(i, j))], 0.0) *
                     std::cos(mesh.theta(i) - attitude) * mesh.width(i) * mesh.depth(j);
  MPI_Allreduce(MPI_IN_PLACE, &out.by_node, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  return out;
}

// How far a force depends on where the nodes lie, over its size: the journal is turned by parts of a cell.
double spread(int around, double Force::*part) {
  constexpr int n = 10;
  double low = 1e300, high = -1e300;
  for (int k = 0; k < n; ++k) {
    const double value = force_of(around, 2 * pi / around * k / n, Cavitation::half_sommerfeld).*part;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return (high - low) / std::abs(high);
}

TEST(FilmForce, IsCutOffWithinCells) {
  const double coarse = spread(24, &Force::along), fine = spread(48, &Force::along);
  std::printf("dependence on the place of nodes: %.3g, %.3g; by node %.3g, %.3g\n", coarse, fine,
              spread(24, &Force::by_node), spread(48, &Force::by_node));
  EXPECT_GT(fine, 0);
  EXPECT_GT(std::log2(coarse / fine), 2.7) << "observed order";
  EXPECT_LT(fine, 0.2 * spread(48, &Force::by_node));
}

// Sommerfeld's film is odd about its smallest gap: what is cut off there is all of the force along, half of that
// across.
TEST(FilmForce, LosesWhatTensionWouldGive) {
  const Force whole = force_of(48, 0.3, Cavitation::none), half = force_of(48, 0.3, Cavitation::half_sommerfeld);
  EXPECT_NEAR(whole.along, 0, 1e-9 * whole.across);
  EXPECT_NEAR(half.across, whole.across / 2, 1e-3 * whole.across);
  EXPECT_GT(half.along, 0.1 * half.across);
}

TEST(FilmForce, IsThatOfAWholeFilmWhereNothingIsUnderTension) {
  const Force whole = force_of(24, 0.3, Cavitation::none, 7e4),
              half = force_of(24, 0.3, Cavitation::half_sommerfeld, 7e4);
  EXPECT_GT(std::abs(whole.across), 0.3 * 7e4 * 0.05 * 0.08);
  EXPECT_NEAR(half.along, whole.along, 1e-13 * std::abs(whole.across));
  EXPECT_NEAR(half.across, whole.across, 1e-13 * std::abs(whole.across));
}

}  // namespace
}  // namespace whirl::thermal
