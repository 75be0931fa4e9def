#include "whirl/thermal/rows.hpp"

#include <vector>

#include "whirl/core/agree.hpp"

namespace whirl::thermal {

using core::check;

Rows::Rows(const Mesh& mesh, MPI_Comm comm) : mesh_(mesh), comm_(comm) {
  const int ranks = core::size_of(comm), m = mesh.nodes_along();
  // Flows of second order look two rows far; a grid of fewer on a rank would be refused by that rank alone.
  core::agree(comm, [&] {
    if (ranks > 1 && m < 2 * ranks)
      throw core::InputError("a film of " + std::to_string(m) + " rows cannot be spread over " + std::to_string(ranks) +
                             " ranks: each needs two");
  });
  std::vector<PetscInt> rows(static_cast<std::size_t>(ranks));
  for (int r = 0; r < ranks; ++r) rows[static_cast<std::size_t>(r)] = m * (r + 1) / ranks - m * r / ranks;
  const DMBoundaryType around = mesh.closed ? DM_BOUNDARY_PERIODIC : DM_BOUNDARY_GHOSTED;
  const PetscInt n = mesh.nodes_around();
  check(DMDACreate2d(comm, around, DM_BOUNDARY_GHOSTED, DMDA_STENCIL_STAR, n, m, 1, ranks, 1, 1, nullptr, rows.data(),
                     nodes_.put()));
  check(DMSetUp(nodes_.get()));
  check(DMDACreate3d(comm, DM_BOUNDARY_NONE, around, DM_BOUNDARY_GHOSTED, DMDA_STENCIL_STAR, mesh.across, n, m, 1, 1,
                     ranks, 1, 2, nullptr, nullptr, rows.data(), cells_.put()));
  check(DMSetUp(cells_.get()));
  const int rank = core::rank_of(comm);
  begin_ = m * rank / ranks;
  end_ = m * (rank + 1) / ranks;
}

}  // namespace whirl::thermal
