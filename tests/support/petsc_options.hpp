#pragma once
// Options of PETSc for a stretch of a test.

#include <petscsys.h>

#include <string>
#include <utility>
#include <vector>

#include "whirl/core/petsc.hpp"

namespace whirl::test {

/// Names (with their dash) and values in PETSc's database for the life of this.
class WithOptions {
public:
  using List = std::vector<std::pair<std::string, std::string>>;
  explicit WithOptions(List options) : options_(std::move(options)) {
    for (const auto& [name, value] : options_)
      core::check(PetscOptionsSetValue(nullptr, name.c_str(), value.empty() ? nullptr : value.c_str()));
  }
  WithOptions(const WithOptions&) = delete;
  WithOptions& operator=(const WithOptions&) = delete;
  ~WithOptions() {
    for (const auto& [name, value] : options_) (void)PetscOptionsClearValue(nullptr, name.c_str());
  }

private:
  List options_;
};

/// Newton's linear equations by MUMPS, from the matrix that a problem hands out.
inline WithOptions::List by_mumps() {
  return {{"-newton_pc_type", "lu"}, {"-newton_pc_factor_mat_solver_type", "mumps"}};
}

}  // namespace whirl::test
