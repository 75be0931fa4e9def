// Entries that are added over and over to matrices of one pattern: on any number of ranks what PETSc's own insertion
// makes of them.

#include "whirl/core/entry_stream.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/dense.hpp"

using namespace whirl;
using core::check;

TEST(EntryStream, AddsWhatPetscWouldAdd) {
  const PetscInt local = 4, n = local * core::size_of(MPI_COMM_WORLD), first = local * core::rank_of(MPI_COMM_WORLD);
  core::Matrix a = core::make_matrix(MPI_COMM_WORLD, local, std::vector<PetscInt>(local, n));
  core::EntryStream stream;
  // Own rows see the first, the last and their own unknowns; every rank adds to row 0 too, some entries come twice.
  const auto add = [&](double factor, auto&& to) {
    for (PetscInt i = first; i < first + local; ++i) {
      for (const PetscInt j : {n - 1, i, PetscInt{0}, i}) to(i, j, factor * std::sin(1.0 + 3.0 * i + 0.7 * j));
      to(0, i, factor * std::cos(2.0 * i));
    }
  };
  const auto pass = [&](double factor) {
    stream.begin(a.get());
    add(factor, [&](PetscInt i, PetscInt j, double v) { stream.add(i, j, v); });
    stream.end();
  };
  pass(1);  // the pattern
  for (const double factor : {0.3, -2.0, 0.9}) {
    core::Matrix expected;
    check(MatDuplicate(a.get(), MAT_COPY_VALUES, expected.put()));
    add(factor, [&](PetscInt i, PetscInt j, double v) { check(MatSetValue(expected.get(), i, j, v, ADD_VALUES)); });
    check(MatAssemblyBegin(expected.get(), MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(expected.get(), MAT_FINAL_ASSEMBLY));
    pass(factor);
    const Eigen::MatrixXd all = test::dense(a.get());
    EXPECT_GT(all.norm(), 0);
    EXPECT_LT((all - test::dense(expected.get())).norm(), 1e-14 * static_cast<double>(n));
  }
}
