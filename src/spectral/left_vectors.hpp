#pragma once
// Left vectors of a large pencil, by a search with its transposed matrices.

#include <limits>
#include <vector>

#include "spectral/pencil_search.hpp"

namespace whirl::spectral {

/// Left vectors of A x = lambda B x nearest to the target of `options`, by Krylov-Schur with shift and invert (prefix
/// "modes_"). All members are collective on the matrices' communicator.
class LeftVectors {
public:
  struct Vector {
    std::vector<Complex> row;  ///< y* with y* B x = 1, whole on every rank; empty: not found
    double condition = std::numeric_limits<double>::quiet_NaN();  ///< as of Mode
  };
  LeftVectors(Mat a, Mat b, const EigenOptions& options);
  /// That of eigenvalue `i` of `right`, which has been solved. Of several equal eigenvalues the rows are orthogonal
  /// through B to the other vectors, where both searches have found the same number of them.
  [[nodiscard]] Vector of(EPS right, PetscInt i);

private:
  Mat b_;
  core::Matrix a_turned_, b_turned_;
  EigenSolver left_;
  std::vector<Complex> values_;
};

}  // namespace whirl::spectral
