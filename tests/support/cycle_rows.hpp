#pragma once
// Cycles as a whole, which tests compare, and the rows of them that the ranks of a system hold.

#include "whirl/problem/system.hpp"
#include "whirl/solve/cycle/cycle.hpp"

namespace whirl::test {

/// Of a cycle that every rank has as a whole, the rows of this rank. Collective on the system, as below.
inline solve::Cycle rows_of(solve::Cycle whole, const problem::System& system) {
  const core::Vector v = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  PetscInt begin = 0;
  core::check(VecGetOwnershipRange(v.get(), &begin, nullptr));
  whole.x = whole.x.middleRows(begin, system.local_size()).eval();
  return whole;
}

/// The other way.
inline solve::Cycle whole_of(solve::Cycle rows, const problem::System& system) {
  const core::Vector v = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  Eigen::MatrixXd x(system.size(), rows.x.cols());
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    {
      const core::WriteArray a(v.get());
      Eigen::Map<Eigen::VectorXd>(a.data(), a.size()) = rows.x.col(k);
    }
    const std::vector<double> all = core::gather(v.get());
    x.col(k) = Eigen::Map<const Eigen::VectorXd>(all.data(), x.rows());
  }
  rows.x = std::move(x);
  return rows;
}

}  // namespace whirl::test
