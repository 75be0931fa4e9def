#pragma once
// Blocks of a machine that is linear but for thin forces, as matrices of one kind.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "whirl/problem/kinematic.hpp"

namespace whirl::problem {

/// L1, L0 [n x n], B [n x r], C [w x n] of F = L1 xdot + L0 x - l - B f(C x), and the rows of L1 and L0 that say which
/// states are rates of others.
template <class Matrix>
struct LinearBlocks {
  Matrix l1, l0, b, c;
  std::vector<KinematicRow> kinematic;
};
using DenseBlocks = LinearBlocks<Eigen::MatrixXd>;
using ThinBlocks = LinearBlocks<Eigen::SparseMatrix<double>>;

}  // namespace whirl::problem
