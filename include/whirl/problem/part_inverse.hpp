#pragma once
// What the parts of a system offer to solve their own linearised equations with.

#include <petscvec.h>

namespace whirl::problem {

/// Approximate inverses of the own equations A_pp of all parts, A = alpha dF/dx + sigma dF/d(dx/dt) in the scales of
/// System::scales(), at a cost in proportion to their states: good to precondition only. They outlast a change of
/// the parameter and end with the system. All members are collective on System::comm().
class PartInverse {
public:
  PartInverse() = default;
  PartInverse(const PartInverse&) = delete;
  PartInverse& operator=(const PartInverse&) = delete;
  virtual ~PartInverse() = default;

  /// Takes the derivatives at (angle, x, xdot). Throws core::DomainError on all ranks outside the validity of a film.
  virtual void set(double angle, Vec x, Vec xdot, double alpha, double sigma) = 0;
  /// y = approximately A_pp^-1 r: this rank's rows of all parts, one after the other in the order of System::fields().
  virtual void apply(const double* r, double* y) = 0;
};

}  // namespace whirl::problem
