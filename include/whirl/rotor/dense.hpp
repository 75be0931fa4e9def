#pragma once
// Small matrices of one rank as dense ones.

#include <petscmat.h>

#include <Eigen/Cholesky>
#include <string>

namespace whirl::rotor {

/// All entries of a matrix that stands on one rank alone.
[[nodiscard]] Eigen::MatrixXd dense(Mat sparse);

/// The Cholesky factors of a matrix that has to be positive definite, `what` in words. Throws core::NotConverged.
[[nodiscard]] Eigen::LLT<Eigen::MatrixXd> definite(const Eigen::MatrixXd& a, const std::string& what);

}  // namespace whirl::rotor
