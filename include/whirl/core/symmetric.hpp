#pragma once
// Dense symmetric matrices, by LAPACK: Eigen's solvers take seconds of compiling in each file.

#include <Eigen/Core>
#include <string>

namespace whirl::core {

/// Eigenvalues in rising order; an eigenvector in each column, or none.
struct SymmetricPairs {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// a v = lambda v, v^T v = 1, of a symmetric matrix `what`, of which the lower triangle is read. core::NotConverged if
/// there is no answer or the matrix is not finite.
[[nodiscard]] SymmetricPairs symmetric_pairs(Eigen::MatrixXd a, const std::string& what);
/// a v = lambda b v, v^T b v = 1, with b, which is `what`, positive definite; no vectors are formed without `vectors`.
/// core::NotConverged as above, and if b is not positive definite.
[[nodiscard]] SymmetricPairs symmetric_pairs(Eigen::MatrixXd a, Eigen::MatrixXd b, const std::string& what,
                                             bool vectors = true);

/// a^-1 b of a matrix `what` that has to be positive definite, of which the lower triangle is read. core::NotConverged
/// if it is not.
[[nodiscard]] Eigen::MatrixXd solve_definite(Eigen::MatrixXd a, Eigen::MatrixXd b, const std::string& what);

}  // namespace whirl::core
