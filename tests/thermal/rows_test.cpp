// How rows of a film are spread over ranks.
#include <gtest/gtest.h>

#include "whirl/thermal/rows.hpp"

namespace whirl::thermal {
namespace {

Mesh mesh() {
  Mesh out;
  out.around = 6;
  out.along = 7;
  out.across = 3;
  out.radius = 0.015;
  out.length = 0.03;
  return out;
}

TEST(Rows, BothGridsHoldTheSameRows) {
  const Rows rows(mesh(), PETSC_COMM_WORLD);
  PetscInt x, y, z, nx, ny, nz;
  core::check(DMDAGetCorners(rows.nodes(), &x, &y, nullptr, &nx, &ny, nullptr));
  EXPECT_EQ(y, rows.begin());
  EXPECT_EQ(ny, rows.count());
  EXPECT_EQ(nx, 6);
  core::check(DMDAGetCorners(rows.cells(), &x, &y, &z, &nx, &ny, &nz));
  EXPECT_EQ(z, rows.begin());
  EXPECT_EQ(nz, rows.count());
  EXPECT_EQ(ny, 6);
  EXPECT_EQ(nx, 3);
  int all = rows.count();
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_SUM, PETSC_COMM_WORLD);
  EXPECT_EQ(all, 8);
}

TEST(Rows, VolumesFillTheFilm) {
  Mesh m = mesh();
  for (const bool closed : {true, false}) {
    m.closed = closed;
    double area = 0;
    for (int i = 0; i < m.nodes_around(); ++i)
      for (int j = 0; j < m.nodes_along(); ++j) area += m.width(i) * m.depth(j);
    EXPECT_NEAR(area, m.extent * m.radius * m.length, 1e-15);
  }
}

TEST(Rows, ARankWithLessThanTwoRowsIsRefusedByAll) {
  const int ranks = core::size_of(PETSC_COMM_WORLD);
  Mesh m = mesh();
  m.along = 2 * ranks - 1;
  EXPECT_NO_THROW(Rows(m, PETSC_COMM_WORLD));
  m.along = 2 * ranks - 2;
  if (ranks > 1) {
    EXPECT_THROW(Rows(m, PETSC_COMM_WORLD), core::Error);
  }
}

}  // namespace
}  // namespace whirl::thermal
