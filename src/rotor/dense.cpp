#include "whirl/rotor/dense.hpp"

#include <Eigen/Cholesky>

#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::rotor {

Eigen::MatrixXd dense(Mat sparse) {
  PetscInt rows = 0, width = 0;
  core::check(MatGetSize(sparse, &rows, &width));
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(rows, width);
  for (PetscInt r = 0; r < rows; ++r) {
    PetscInt count = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    core::check(MatGetRow(sparse, r, &count, &columns, &values));
    for (PetscInt k = 0; k < count; ++k) out(r, columns[k]) = values[k];
    core::check(MatRestoreRow(sparse, r, &count, &columns, &values));
  }
  return out;
}

Eigen::MatrixXd solve_definite(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const std::string& what) {
  const Eigen::LLT<Eigen::MatrixXd> factors(a);
  if (factors.info() != Eigen::Success) throw core::NotConverged(what + " is not positive definite");
  return factors.solve(b);
}

}  // namespace whirl::rotor
