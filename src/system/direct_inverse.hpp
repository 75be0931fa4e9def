#pragma once
// The inverse of a film that offers none of its own.

#include <mpi.h>

#include <memory>

#include "whirl/film/contract/film.hpp"

namespace whirl::system {

/// A^-1 to rounding, A = alpha dg/ds + sigma dg/ds', by a sparse LU of the rows of a film: Eigen's of a film on one
/// rank, MUMPS's on `comm` of one whose shares stand on all ranks of it in their order. Complex frequencies on several
/// ranks are solved in real form, twice the size. Collective.
[[nodiscard]] std::unique_ptr<film::StateInverse> make_direct_inverse(MPI_Comm comm, const film::Share& share);

}  // namespace whirl::system
