#pragma once
// The invariant subspace of the largest eigenvalues of an operator that is known by its products only.

#include <mpi.h>

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <vector>

namespace whirl::solve {

/// M X of this rank's rows [n_local x columns]. Collective.
using BlockProduct = std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>;

/// Eigenvalues of largest modulus, and an orthonormal basis (this rank's rows [n_local x p]) of the invariant subspace
/// of those above `radius`.
struct DominantSubspace {
  /// Falling modulus: all above the radius, and at least one below; or SubspaceOptions::most of those above.
  std::vector<std::complex<double>> values;
  Eigen::MatrixXd basis;
};

struct SubspaceOptions {
  double radius = 0.3;
  double tolerance = 1e-9;  ///< residual of an eigenpair above the radius, in its eigenvalue
  int most = 1 << 20;       ///< of them (and the other one of a pair), although more may be above the radius
};

/// A block method of Arnoldi's kind: Rayleigh and Ritz on a growing basis, to which each round adds the residuals of
/// all eigenpairs that are wanted and have not converged (the block Davidson method without a preconditioner, whose
/// basis spans block Krylov spaces; Saad 2011, sec. 6.2 and 8.4). `start` [n_local x any number of columns] is what is
/// known of the subspace, to which generic vectors are added: they show what it does not hold. Columns that are
/// multiplied together share a pass over the operator. Every rank of `comm` takes part, and all decide alike. Throws
/// core::NotConverged beyond `core::plan::products()`.
[[nodiscard]] DominantSubspace dominant_subspace(MPI_Comm comm, const BlockProduct& multiply,
                                                 const Eigen::MatrixXd& start, const SubspaceOptions& options);

/// The same for the multipliers of a cycle, above `radius` instead of options.radius. Where the search is given up the
/// radius becomes 0.5 and stays so. Films on soft liners at high speed have a dense band of multipliers, as have stiff
/// films at Gauss points: it takes no part in what the cycle does, and is left below. Throws core::NotConverged if that
/// search is given up too.
[[nodiscard]] DominantSubspace dominant_multipliers(MPI_Comm comm, const BlockProduct& multiply,
                                                    const Eigen::MatrixXd& start, SubspaceOptions options,
                                                    double& radius);

/// Columns without a pattern that a machine could have, the same on any number of ranks.
[[nodiscard]] Eigen::MatrixXd generic_columns(MPI_Comm comm, Eigen::Index local, Eigen::Index columns);
/// Adds `more` to the orthonormal columns of `v`, but for what lies in their span.
void add_orthonormal(MPI_Comm comm, Eigen::MatrixXd& v, const Eigen::MatrixXd& more);

}  // namespace whirl::solve
