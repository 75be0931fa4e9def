#include "whirl/core/count.hpp"

#include <fmt/core.h>

#include <limits>

#include "whirl/core/error.hpp"

namespace whirl::core {

PetscInt begin_of_share(PetscInt count, int rank, int size) {
  return static_cast<PetscInt>(std::int64_t{count} * rank / size);
}

PetscInt count_of(std::int64_t count, const std::string& what) {
  constexpr std::int64_t limit = std::numeric_limits<PetscInt>::max();
  if (count > limit)
    throw InputError(fmt::format("{}: {} are more than the {} that this PETSc can count", what, count, limit));
  return static_cast<PetscInt>(count);
}

}  // namespace whirl::core
