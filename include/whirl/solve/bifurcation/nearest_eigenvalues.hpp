#pragma once
// Eigenvalues of large linearised machines next to given places.

#include <Eigen/Core>

#include "whirl/problem/structure.hpp"

namespace whirl::solve {

/// For each of `starts` [1/s] the nearest lambda with det(L0 - B S C + lambda L1) = 0, `tangents` S = df/dw [r x w]:
/// inverse iteration for all at once by one sparse LU. For machines on one rank that tell their blocks and have no own
/// states of films.
///
/// Meant for starts that are nearly right, such as eigenvalues of a reduced model: where two eigenvalues are as near,
/// the answer lies between them or is one of the two. Not collective. Throws core::NotConverged.
[[nodiscard]] Eigen::ArrayXcd nearest_eigenvalues(problem::System& system, const Eigen::MatrixXd& tangents,
                                                  const Eigen::ArrayXcd& starts);

}  // namespace whirl::solve
