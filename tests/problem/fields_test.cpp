// Which fields make a part.
#include <gtest/gtest.h>

#include "whirl/problem/system.hpp"

namespace whirl::problem {
namespace {

// Parts are told by their numbers: neighbours of one name stay two, and a quantity may come again in a part.
TEST(Fields, BelongToPartsByTheirNumber) {
  const std::vector<Field> fields = {
      {.name = "machine", .begin = 0, .end = 5},
      {.name = "B", .begin = 5, .end = 6, .quantity = "p", .part = 1, .stride = 3, .repeats = 2},
      {.name = "B", .begin = 6, .end = 8, .quantity = "T", .part = 1, .stride = 3, .repeats = 2},
      {.name = "B", .begin = 11, .end = 12, .quantity = "p", .part = 2}};
  const std::vector<Field> parts = parts_of(fields);
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[1].begin, 5);
  EXPECT_EQ(parts[1].end, 11);
  EXPECT_EQ(parts[1].repeats, 1);
  EXPECT_EQ(parts[2].begin, 11);
  EXPECT_EQ(parts[2].quantity, "p");
  std::vector<PetscInt> rows;
  fields[2].each([&](PetscInt i) { rows.push_back(i); });
  EXPECT_EQ(rows, (std::vector<PetscInt>{6, 7, 9, 10}));
}

// A field of which a rank holds nothing.
TEST(Fields, MayBeEmpty) {
  const Field none{.name = "B", .begin = 4, .end = 4, .stride = 3, .repeats = 0};
  EXPECT_EQ(none.last(), 4);
  none.each([](PetscInt) { FAIL(); });
}

}  // namespace
}  // namespace whirl::problem
