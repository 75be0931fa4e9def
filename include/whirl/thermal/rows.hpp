#pragma once
// How the mesh of a film is spread over ranks: rows j along the bearing, so that columns across the film and rings
// around it stay on one rank.

#include <petscdmda.h>

#include "whirl/core/petsc.hpp"
#include "whirl/thermal/mesh.hpp"

namespace whirl::thermal {

using Grid = core::Handle<DM, DMDestroy>;

/// The rows of a mesh on the ranks of a communicator: two or more on each.
class Rows {
public:
  /// Collective. Throws core::Error, on all ranks, where there are fewer than two rows a rank.
  Rows(const Mesh& mesh, MPI_Comm comm);
  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  [[nodiscard]] MPI_Comm comm() const { return comm_; }
  /// Rows j of this rank.
  [[nodiscard]] int begin() const { return begin_; }
  [[nodiscard]] int end() const { return end_; }
  [[nodiscard]] int count() const { return end_ - begin_; }
  /// DMDA of nodes, (i, j) with i fastest, star stencil of width 1.
  [[nodiscard]] DM nodes() const { return nodes_.get(); }
  /// DMDA of cells, (k, i, j) with k fastest, star stencil of width 2.
  [[nodiscard]] DM cells() const { return cells_.get(); }
  /// Place of a node / a cell among those of this rank; j is a row of this rank.
  [[nodiscard]] PetscInt node(int i, int j) const {
    return static_cast<PetscInt>(j - begin_) * mesh_.nodes_around() + i;
  }
  [[nodiscard]] PetscInt cell(int k, int i, int j) const { return node(i, j) * mesh_.across + k; }

private:
  Mesh mesh_;
  MPI_Comm comm_;
  int begin_ = 0, end_ = 0;
  Grid nodes_, cells_;
};

}  // namespace whirl::thermal
