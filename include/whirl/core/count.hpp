#pragma once
// Counts that outgrow the 32 bits of a PetscInt on the way, or for good.

#include <petscsystypes.h>

#include <cstdint>
#include <string>

namespace whirl::core {

/// floor(count rank / size): where the share of `rank` begins if `count` things are dealt out in near equal shares.
[[nodiscard]] PetscInt begin_of_share(PetscInt count, int rank, int size);

/// `count` as PETSc counts. Throws InputError, which names `what` and the limit, if that type does not hold it.
[[nodiscard]] PetscInt count_of(std::int64_t count, const std::string& what);

}  // namespace whirl::core
