#pragma once
// Guyan and Craig-Bampton bases of one plane.

#include <Eigen/Core>
#include <vector>

#include "planar.hpp"
#include "whirl/rotor/rotor.hpp"

namespace whirl::rotor {

/// Freedoms of a plane that are kept, ascending.
[[nodiscard]] std::vector<int> planar_masters(const Reduction& reduction);

/// Basis T of one plane, columns: masters (ascending), then fixed-interface modes.
struct PlanarBasis {
  Eigen::MatrixXd rows;    // this rank's rows of T (2 per owned node)
  Eigen::VectorXd offset;  // this rank's rows of what the exact static shape under `weight` adds to T q
  ReductionQuality quality;
};

/// T = [[I, 0], [-K_ss^-1 K_sm, Phi]] with K_ss Phi = M_ss Phi Lambda, Phi^T M_ss Phi = I, and
/// offset = [0; (K_ss^-1 - Phi Lambda^-1 Phi^T) f_s]. Collective.
[[nodiscard]] PlanarBasis planar_basis(const Planar& planar, const Reduction& reduction);

/// T as a distributed matrix: rows as the plane, columns split by PETSc; exact zeros are left out. Collective.
[[nodiscard]] core::Matrix to_matrix(const PlanarBasis& basis, MPI_Comm comm);

/// T^T A T, symmetrised, as a distributed matrix with the column layout of to_matrix. Collective.
[[nodiscard]] core::Matrix project(Mat a, const PlanarBasis& basis);

/// T^T f. Collective.
[[nodiscard]] core::Vector project(Vec f, const PlanarBasis& basis);

}  // namespace whirl::rotor
