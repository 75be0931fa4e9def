#pragma once
// Decompositions of dense matrices by LAPACK, on this rank alone: templates for them would take compilers minutes.

#include <Eigen/Core>

#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::spectral {

/// A = U diag(sizes) V*, with as many columns of U and V as A has rows or columns, whichever are fewer.
struct Svd {
  Eigen::VectorXd sizes;  ///< falling
  Eigen::MatrixXcd u, v;
};

/// All of these return numbers that are none where the matrix is not finite or LAPACK does not converge.
[[nodiscard]] Svd svd(Eigen::MatrixXcd a);
[[nodiscard]] Eigen::VectorXd singular_values(Eigen::MatrixXcd a);
[[nodiscard]] Eigen::VectorXd singular_values(Eigen::MatrixXd a);

/// x of length one with the least |A x|; one of those with A x = 0 where A has fewer rows than columns.
[[nodiscard]] Eigen::VectorXcd least_direction(Eigen::MatrixXcd a);

/// Eigenvalues and, with `vectors`, right eigenvectors (columns of length one) of a real matrix, in no order.
[[nodiscard]] Eigenpairs real_eigenpairs(Eigen::MatrixXd a, bool vectors);
/// Eigenvalues and right eigenvectors of a complex matrix, by rising real part of the eigenvalue.
[[nodiscard]] Eigenpairs complex_eigenpairs(Eigen::MatrixXcd a);

}  // namespace whirl::spectral
