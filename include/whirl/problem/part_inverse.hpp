#pragma once
// What the parts of a system offer to solve their own linearised equations with.

#include <petscvec.h>

#include "whirl/core/inverse.hpp"

namespace whirl::problem {

/// Where a system is linearised: shaft angle [rad], state and its rate.
struct Point {
  double angle;
  Vec x, xdot;
};

/// Inverses of the own equations of all parts: of the block A_pp of A = alpha dF/dx + sigma dF/d(dx/dt), in the scales
/// of System::scales(). Its rows are the parts' rows on this rank, part after part as in System::fields().
/// They outlast a change of the parameter and end with the system. set() throws core::DomainError on all ranks outside
/// the validity of a film.
using PartInverse = core::Inverse<Point>;
/// At a complex frequency the system is at rest: xdot is zero.
using ExactPartInverse = core::ExactInverse<Point>;

}  // namespace whirl::problem
