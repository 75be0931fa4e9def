#pragma once
// This rank's entries of a distributed vector as an Eigen vector.

#include <Eigen/Core>

#include "whirl/core/petsc.hpp"

namespace whirl::core {

inline void put(const Eigen::VectorXd& values, Vec v) {
  const WriteArray a(v);
  Eigen::Map<Eigen::VectorXd>(a.data(), values.size()) = values;
}

inline void get(Vec v, Eigen::VectorXd& values) {
  const ReadArray a(v);
  values = Eigen::Map<const Eigen::VectorXd>(a.data(), a.size());
}

[[nodiscard]] inline Eigen::VectorXd get(Vec v) {
  const ReadArray a(v);
  return Eigen::Map<const Eigen::VectorXd>(a.data(), a.size());
}

}  // namespace whirl::core
