#pragma once
// What a resolvent at a complex frequency holds of a part.

#include <vector>

#include "solve/newton/port_matrix.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/solve/newton/frequency_resolvent.hpp"

namespace whirl::solve {

struct FrequencyResolvent::Coupled {
  PetscInt first = 0, count = 0;       // its local rows,
  PetscInt row = 0;                    // the first one among the rows of all parts here
  std::vector<Eigen::Index> seen, of;  // columns of the blocks that hold G_i and F_i^T
  core::Matrix a, b;                   // A_i = a + lambda b where it is wanted as a matrix
  Eigen::MatrixXcd x, dx;              // A_i^-1 G_i where it was evaluated last, with the border, and its derivative

  // G_i and F_i^T of a or of b [local x ports], [local x forces].
  [[nodiscard]] Eigen::MatrixXd g(const PortMatrix& m) const {
    return m.to_parts().middleRows(row, count)(Eigen::all, seen);
  }
  [[nodiscard]] Eigen::MatrixXd f(const PortMatrix& m) const {
    return m.from_parts()->middleRows(row, count)(Eigen::all, of);
  }
};

}  // namespace whirl::solve
