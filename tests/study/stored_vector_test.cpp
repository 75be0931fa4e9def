// Vectors in checkpoints, on whatever ranks they are wanted back.

#include <gtest/gtest.h>

#include "study/stored_vector.hpp"

namespace whirl::study {
namespace {

// Entries 0, 1, ... times a factor; `last` has all that the others do not, one each.
core::Vector numbered(double factor, PetscInt size, bool last) {
  const int rank = core::rank_of(PETSC_COMM_WORLD), ranks = core::size_of(PETSC_COMM_WORLD);
  const PetscInt here = rank == (last ? ranks - 1 : 0) ? size - ranks + 1 : 1;
  core::Vector v = core::make_vector(PETSC_COMM_WORLD, here, size);
  PetscInt begin = 0;
  core::check(VecGetOwnershipRange(v.get(), &begin, nullptr));
  const core::WriteArray a(v.get());
  for (PetscInt i = 0; i < a.size(); ++i) a[i] = factor * static_cast<double>(begin + i);
  return v;
}

class StoredVector : public testing::TestWithParam<bool> {};

TEST_P(StoredVector, ComesBackInAnotherLayout) {
  const core::Vector from = numbered(0.5, 20, true), wanted = numbered(0.5, 20, false);
  const core::Vector to = core::duplicate(wanted.get());
  io::Group group;
  put_vector(group, "v", from.get(), GetParam(), "test");
  EXPECT_EQ(group.dataset("v").share.has_value(), GetParam());
  EXPECT_EQ(group.dataset("v").whole_shape(), io::Shape{20});
  take_vector(group, "v", to.get());
  EXPECT_EQ(entries_here(to.get()), entries_here(wanted.get()));
}

// Numbered ones times 1, 2, 3 side by side: the rows of this rank, or all.
Eigen::MatrixXd three(Vec like) {
  PetscInt begin = 0, local = 0;
  core::check(VecGetOwnershipRange(like, &begin, nullptr));
  core::check(VecGetLocalSize(like, &local));
  const Eigen::VectorXd first =
      Eigen::VectorXd::LinSpaced(local, static_cast<double>(begin), static_cast<double>(begin + local - 1));
  return first * Eigen::RowVector3d(1, 2, 3);
}

// Whole ones, which every rank has, are wanted whole or by rows.
TEST_P(StoredVector, SeveralComeBackInTheirOrder) {
  const core::Vector like = numbered(0, 20, true), other = numbered(0, 20, false),
                     alone = core::make_vector(PETSC_COMM_SELF, 20, 20);
  io::Group group;
  if (GetParam())
    put_columns(group, "v", three(like.get()), like.get(), "m", "test");
  else
    put_columns(group, "v", three(alone.get()), nullptr, "m", "test");
  EXPECT_EQ(group.dataset("v").whole_shape(), (io::Shape{20, 3}));
  EXPECT_TRUE(take_columns(group, "v", other.get()) == three(other.get()));
  if (!GetParam()) {
    EXPECT_TRUE(take_columns(group, "v", nullptr) == three(alone.get()));
  }
  // Of a cycle that there is not.
  put_columns(group, "none", {}, GetParam() ? like.get() : nullptr, "m", "test");
  EXPECT_EQ(group.dataset("none").whole_shape(), (io::Shape{GetParam() ? 20U : 0U, 0}));
  EXPECT_EQ(take_columns(group, "none", GetParam() ? other.get() : nullptr).cols(), 0);
}

TEST_P(StoredVector, OneOfAnotherSizeIsTold) {
  const core::Vector from = numbered(1, 20, true), to = numbered(1, 21, true);
  io::Group group;
  put_vector(group, "v", from.get(), GetParam(), "test");
  EXPECT_THROW(take_vector(group, "v", to.get()), core::Error);
}

INSTANTIATE_TEST_SUITE_P(WholeAndByRows, StoredVector, testing::Bool());

}  // namespace
}  // namespace whirl::study
