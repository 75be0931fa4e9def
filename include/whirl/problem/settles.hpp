#pragma once
// Systems some of whose states follow the others at once in equilibrium, through equations that are only piecewise
// smooth.

#include <petscvec.h>

namespace whirl::problem {

/// Implemented by a System beside problem::System.
class Settles {
public:
  virtual ~Settles() = default;
  /// False if there is nothing to settle. Not collective, the same on all ranks.
  [[nodiscard]] virtual bool settles() const = 0;
  /// Brings these states in x to where their own equations at rest hold, the others unchanged. Newton's method on the
  /// whole does so along its steps: which nodes of a film are full is then never asked of a line search. Collective.
  /// Throws core::DomainError or core::NotConverged, agreed on all ranks; x is then as it was or partly settled.
  virtual void settle(Vec x) = 0;
};

}  // namespace whirl::problem
