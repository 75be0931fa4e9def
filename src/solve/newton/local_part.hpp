#pragma once
// This rank's entries of a distributed vector as an Eigen vector.

#include <Eigen/Core>

#include "whirl/core/petsc.hpp"

namespace whirl::solve {

inline void put(const Eigen::VectorXd& values, Vec v) {
  const core::WriteArray a(v);
  Eigen::Map<Eigen::VectorXd>(a.data(), values.size()) = values;
}

[[nodiscard]] inline Eigen::VectorXd get(Vec v) {
  const core::ReadArray a(v);
  return Eigen::Map<const Eigen::VectorXd>(a.data(), a.size());
}

}  // namespace whirl::solve
