#pragma once
// The border between C++ exceptions and PETSc's C callbacks.

#include <exception>
#include <utility>

#include "whirl/core/agree.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::core {

/// Carries exceptions of callbacks through a PETSc solve: no exception ever crosses a C frame.
///
/// A callback runs its work through `run`; a DomainError becomes "domain error" (the caller tells PETSc, whose line
/// search then shortens the step), any other exception is stored, PETSc is given an error code, and `rethrow` raises it
/// again after the solve. Exceptions must be agreed across ranks before they reach the gate (agree()); one that is not,
/// on more than one rank, would leave the others waiting, so the gate prints it and calls MPI_Abort.
class Gate {
public:
  explicit Gate(MPI_Comm comm) : comm_(comm) {}

  /// Runs `work`; returns 0, also after a DomainError (then `domain_error()` is true until the next run).
  template <class Work>
  PetscErrorCode run(Work&& work) noexcept {
    domain_error_ = false;
    try {
      std::forward<Work>(work)();
      return 0;
    } catch (...) {
      return take(std::current_exception());
    }
  }

  [[nodiscard]] bool domain_error() const noexcept { return domain_error_; }
  /// Text of the last DomainError seen, empty if there was none.
  [[nodiscard]] const std::string& domain_text() const noexcept { return domain_text_; }

  /// Call after the PETSc solve: raises a stored exception, or LibraryError if `code` is not zero.
  void rethrow(PetscErrorCode code);

private:
  PetscErrorCode take(const std::exception_ptr& error) noexcept;
  MPI_Comm comm_;
  std::exception_ptr stored_;
  bool domain_error_ = false;
  std::string domain_text_;
};

}  // namespace whirl::core
