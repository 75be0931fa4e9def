#pragma once
// The exact inverse of any film.

#include <mpi.h>

#include <memory>

#include "whirl/film/contract/film.hpp"

namespace whirl::film {

/// A^-1 to rounding, A = alpha dg/ds + sigma dg/ds', by an LU (core::PencilLu) of the rows of a film whose shares stand
/// on all ranks of `comm` in their order, none of them empty. Where the states of a film on several ranks form a band
/// that pays, each rank gathers all entries and solves for all: the band of a whole film costs less than messages
/// within its elimination. Else MUMPS solves on all ranks. Collective.
[[nodiscard]] std::unique_ptr<StateInverse> make_direct_inverse(MPI_Comm comm, const Share& share);

}  // namespace whirl::film
