#pragma once
// Small matrices of one rank as dense ones.

#include <petscmat.h>

#include <Eigen/Core>
#include <string>

namespace whirl::rotor {

/// All entries of a matrix that stands on one rank alone.
[[nodiscard]] Eigen::MatrixXd dense(Mat sparse);

/// a^-1 b of a matrix that has to be positive definite, `what` in words. Throws core::NotConverged.
[[nodiscard]] Eigen::MatrixXd solve_definite(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                             const std::string& what);

}  // namespace whirl::rotor
