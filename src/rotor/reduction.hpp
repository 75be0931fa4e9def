#pragma once
// Guyan, Craig-Bampton and modal bases of one plane.

#include <Eigen/Core>
#include <vector>

#include "planar.hpp"
#include "whirl/rotor/rotor.hpp"

namespace whirl::rotor {

/// What has to be positive definite in every reduction.
inline constexpr const char* held_stiffness = "the stiffness of the shaft with its masters held";

/// Freedoms of a plane that are kept, ascending.
[[nodiscard]] std::vector<int> planar_masters(const Reduction& reduction);

/// Basis T of one plane, columns: masters (ascending), then fixed-interface modes.
struct PlanarBasis {
  Eigen::MatrixXd rows;    // this rank's rows of T (2 per owned node)
  Eigen::VectorXd offset;  // this rank's rows of what the exact static shape under `weight` adds to T q
  ReductionQuality quality;
};

/// Guyan and Craig-Bampton: T = [[I, 0], [-K_ss^-1 K_sm, Phi]] with K_ss Phi = M_ss Phi Lambda, Phi^T M_ss Phi = I, and
/// offset = [0; (K_ss^-1 - Phi Lambda^-1 Phi^T) f_s]. Collective.
///
/// Modal: the span of the lowest modes of K + support at the masters (Psi), with the masters among its coordinates:
/// T = Psi [V_m V_0] with Psi_m V_m = I and Psi_m V_0 = 0, V_0 diagonal in K and M, V_m orthogonal to it in K.
/// Partial decoupling by real modes, Skarolek (2011) sec. 2.3. Throws core::InputError if the modes do not tell the
/// masters apart.
[[nodiscard]] PlanarBasis planar_basis(const Planar& planar, const Reduction& reduction);

/// A^T times the rows of all ranks: `mine` of this one. Collective.
[[nodiscard]] Eigen::MatrixXd sum_over_ranks(const Eigen::MatrixXd& mine, MPI_Comm comm);

/// T^T A T on all ranks, symmetrised. Collective.
[[nodiscard]] Eigen::MatrixXd projected(Mat a, const Eigen::MatrixXd& rows);

/// The modal basis, whose offset is not set.
[[nodiscard]] PlanarBasis modal_basis(const Planar& planar, const Reduction& reduction);

/// `rows` of this rank and `columns` here as a distributed matrix; exact zeros are left out. Collective.
[[nodiscard]] core::Matrix matrix_of(const Eigen::MatrixXd& rows, PetscInt columns, MPI_Comm comm);

/// T as a distributed matrix: rows as the plane, columns split by PETSc; exact zeros are left out. Collective.
[[nodiscard]] core::Matrix to_matrix(const PlanarBasis& basis, MPI_Comm comm);

/// T^T A T, symmetrised, as a distributed matrix with the column layout of to_matrix. Collective.
[[nodiscard]] core::Matrix project(Mat a, const PlanarBasis& basis);

/// T^T f. Collective.
[[nodiscard]] core::Vector project(Vec f, const PlanarBasis& basis);

}  // namespace whirl::rotor
