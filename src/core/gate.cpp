#include "whirl/core/gate.hpp"

#include <cstdio>

namespace whirl::core {

PetscErrorCode Gate::take(const std::exception_ptr& error) noexcept {
  if (size_of(comm_) > 1 && !is_agreed(error)) {
    try {
      std::rethrow_exception(error);
    } catch (const std::exception& e) {
      std::fprintf(stderr, "whirl: rank %d: %s\n", rank_of(MPI_COMM_WORLD), e.what());
    } catch (...) {
      std::fprintf(stderr, "whirl: rank %d: unknown exception\n", rank_of(MPI_COMM_WORLD));
    }
    MPI_Abort(MPI_COMM_WORLD, static_cast<int>(Exit::bug));
  }
  try {
    std::rethrow_exception(error);
  } catch (const DomainError& e) {
    domain_error_ = true;
    domain_text_ = e.what();
    return 0;
  } catch (...) {
    stored_ = error;
    return PETSC_ERR_USER;
  }
}

void Gate::rethrow(PetscErrorCode code) {
  if (stored_) std::rethrow_exception(std::exchange(stored_, nullptr));
  check(code);
}

}  // namespace whirl::core
