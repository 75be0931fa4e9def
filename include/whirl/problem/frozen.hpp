#pragma once
// The linearised equations of a system at one point, for systems that know how to solve them.

#include <petscvec.h>

namespace whirl::problem {

/// A = alpha dF/dx + sigma dF/d(dx/dt) at one point, without a matrix. Vectors are states and rows in the scales of
/// System::scales(). All members are collective.
class Frozen {
public:
  Frozen() = default;
  Frozen(const Frozen&) = delete;
  Frozen& operator=(const Frozen&) = delete;
  virtual ~Frozen() = default;

  /// y = A v.
  virtual void multiply(Vec v, Vec y) const = 0;
  /// y = dF/d(dx/dt) v.
  virtual void multiply_rates(Vec v, Vec y) const = 0;
  /// A y = r to the relative residual `tolerance`, at a cost in proportion to the number of states. Throws
  /// core::DomainError, agreed, if it does not come that far.
  virtual void solve(Vec r, Vec y, double tolerance) const = 0;
};

}  // namespace whirl::problem
