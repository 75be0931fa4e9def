#pragma once
// The symmetric eigenproblem of a shaft in one plane.

#include <functional>
#include <vector>

#include "whirl/core/petsc.hpp"

namespace whirl::rotor {

/// Solves K v = lambda M v for the `count` eigenvalues nearest above `shift` (K - shift M positive definite),
/// ascending.
///
/// `rigid` are vectors with K r = 0 that are deflated (possibly none). `take(i, v)` is called for each eigenvector
/// (v^T M v = 1) in order if given. Fewer are returned if the problem is smaller. Collective; throws
/// core::NotConverged.
[[nodiscard]] std::vector<double> lowest_eigenvalues(Mat stiffness, Mat mass, double shift, PetscInt count,
                                                     const std::vector<Vec>& rigid,
                                                     const std::function<void(PetscInt, Vec)>& take = {});

}  // namespace whirl::rotor
