#pragma once
// Small matrices of one rank as dense ones.

#include <petscmat.h>

#include <Eigen/Core>

namespace whirl::rotor {

/// All entries of a matrix that stands on one rank alone.
[[nodiscard]] Eigen::MatrixXd dense(Mat sparse);

}  // namespace whirl::rotor
