#pragma once
// Rows q' = v.

namespace whirl::problem {

/// A row alpha state' + beta rate = 0, alpha and beta not zero, of a matrix: no other row has state', no other
/// kinematic row has one of the two states, and no thin force acts on it. Numbers of rows and states.
struct KinematicRow {
  int row, state, rate;
};

}  // namespace whirl::problem
