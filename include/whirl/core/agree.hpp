#pragma once
// Agreement on errors across the ranks of a communicator.

#include <mpi.h>

#include <cstddef>
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

/// Runs `work` on the rank `leader` alone and, each time that calls together(), `part` on all ranks at once: a
/// computation whose decisions are one rank's, though all ranks have a share in it.
///
/// Ranks that compute the same by themselves and go on to a collective call may part ways if their arithmetic differs
/// in the last digit; here none but the leader decides whether there is another call. `part` may communicate on `comm`.
/// If `work` or `part` throws on any rank, all ranks throw as in agree(). Collective.
void lead(MPI_Comm comm, int leader, const std::function<void(const std::function<void()>& together)>& work,
          const std::function<void()>& part);

/// Gives all ranks what rank 0 holds in `count` numbers: where every rank has computed the same and what follows
/// depends on it. Collective.
void share(MPI_Comm comm, double* values, std::size_t count);

/// True if `error` was thrown by all ranks together; only such an error may be handled without MPI_Abort on more than
/// one rank.
bool is_agreed(const std::exception_ptr& error);

}  // namespace whirl::core
