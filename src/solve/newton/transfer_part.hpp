#pragma once
// What a transfer function holds of a part.

#include "whirl/core/petsc.hpp"
#include "whirl/solve/newton/transfer_function.hpp"

namespace whirl::solve {

struct TransferFunction::Coupled {
  core::IndexSet rows;
  PetscInt first = 0, count = 0;      // its local rows
  core::Matrix a, b;                  // A_i = a + lambda b
  Eigen::MatrixXd g0, g1, f0, f1;     // G_i and F_i^T likewise [local x ports], [local x forces]
  core::Matrix real, right, answers;  // A_i in real form, and its columns
  core::LinearSolver solver;
  Eigen::MatrixXcd x, dx;  // A_i^-1 G_i where it was evaluated last [local x ports], and its derivative

  // out = A_i^-1 right, for all columns.
  void solve(const Eigen::MatrixXcd& columns, Eigen::MatrixXcd& out);
  // b times complex columns.
  [[nodiscard]] Eigen::MatrixXcd rates_times(const Eigen::MatrixXcd& columns) const;
};

}  // namespace whirl::solve
