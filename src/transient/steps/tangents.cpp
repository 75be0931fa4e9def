#include "whirl/transient/steps/tangents.hpp"

#include <cmath>

#include "whirl/core/error.hpp"

namespace whirl::transient {

using core::check;

Tangents::Tangents(Vec like, int count) {
  PetscInt n = 0, begin = 0;
  check(VecGetSize(like, &n));
  check(VecGetOwnershipRange(like, &begin, nullptr));
  core::require(count <= n, "no more directions than states");
  for (int k = 0; k < count; ++k) {
    columns_.push_back(core::duplicate(like));
    const core::WriteArray a(columns_.back().get());
    // Cosines of incommensurate frequencies: no direction of the motion is orthogonal to them by symmetry.
    for (PetscInt i = 0; i < a.size(); ++i)
      a[i] = std::cos(1.0 + std::sqrt(2.0) * static_cast<double>(begin + i) * (k + 1) + std::sqrt(3.0) * k);
  }
  (void)orthonormalise();
}

std::vector<double> Tangents::orthonormalise() {
  std::vector<double> growth;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    double norm = 1, total = 0;
    // The second pass removes what rounding of nearly parallel directions leaves behind.
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t j = 0; j < k; ++j) {
        PetscScalar along = 0;
        check(VecDot(columns_[k].get(), columns_[j].get(), &along));
        check(VecAXPY(columns_[k].get(), -along, columns_[j].get()));
      }
      check(VecNormalize(columns_[k].get(), &norm));
      total += std::log(norm);
    }
    growth.push_back(total);
  }
  return growth;
}

}  // namespace whirl::transient
