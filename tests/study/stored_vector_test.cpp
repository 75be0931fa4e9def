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

TEST_P(StoredVector, SeveralComeBackInTheirOrder) {
  std::vector<std::vector<double>> from, wanted;
  const core::Vector like = numbered(0, 20, true), other = numbered(0, 20, false);
  for (const double factor : {1.0, 2.0, 3.0}) {
    from.push_back(entries_here(numbered(factor, 20, true).get()));
    wanted.push_back(entries_here(numbered(factor, 20, false).get()));
  }
  io::Group group;
  if (GetParam() || core::size_of(PETSC_COMM_WORLD) == 1) {
    put_vectors(group, "v", from, like.get(), GetParam(), "test");
    EXPECT_EQ(take_vectors(group, "v", other.get()), wanted);
    put_vectors(group, "none", {}, like.get(), GetParam(), "test");
    EXPECT_TRUE(take_vectors(group, "none", other.get()).empty());
  }
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
