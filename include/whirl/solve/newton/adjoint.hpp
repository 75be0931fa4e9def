#pragma once
// What minimally augmented systems ask of a problem beyond its linearisation.

#include <petscvec.h>

namespace whirl::solve {

/// The transposed linearisation of an ExtendedProblem, and its change along a direction: both in the layout of u, all
/// collective on its communicator.
class Adjoint {
public:
  Adjoint() = default;
  Adjoint(const Adjoint&) = delete;
  Adjoint& operator=(const Adjoint&) = delete;
  virtual ~Adjoint() = default;

  /// x = matrix^-T rhs for the matrix of the last linearise(): entries of x belong to equations, those of rhs to
  /// unknowns.
  virtual void solve_transposed(Vec rhs, Vec x) = 0;
  /// out = d/deps [dR/du (u + eps v)]^T w at eps = 0, the last entry of w (the added row) not used: by symmetry of
  /// second derivatives the gradient in u of w . dR/du(u) v at constant v and w. Central difference of the exact
  /// first derivatives along v, O(1e-10) relative. Throws core::DomainError, agreed on all ranks.
  virtual void curvature(Vec u, Vec v, Vec w, Vec out) = 0;
};

/// Step of central differences along a direction whose largest entry (in scaled states) is `largest`: rounding and
/// truncation in balance.
[[nodiscard]] double difference_step(double largest);

}  // namespace whirl::solve
