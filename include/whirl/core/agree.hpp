#pragma once
// Agreement on errors across the ranks of a communicator.

#include <mpi.h>

#include <exception>
#include <functional>

namespace whirl::core {

/// What is said where memory runs out.
inline constexpr const char* out_of_memory =
    "out of memory: a mesh, a number of intervals or of points is too large for this computer";

/// Runs `local` (which must not communicate) on every rank and, if it threw anywhere, throws on all ranks of `comm`.
///
/// The ranks that failed rethrow their own exception, marked as agreed; the others throw one of the same kind with the
/// text of the lowest failing rank. Kinds rank DomainError < NotConverged < InputError < Error < Bug: the gravest wins,
/// so that all ranks take the same way out. Collective; costs one allreduce of one integer when nothing fails.
void agree(MPI_Comm comm, const std::function<void()>& local);

/// True if `error` was thrown by all ranks together; only such an error may be handled without MPI_Abort on more than
/// one rank.
bool is_agreed(const std::exception_ptr& error);

}  // namespace whirl::core
