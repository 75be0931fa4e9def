#pragma once
// What films that settle on several ranks are solved with.

#include "whirl/core/petsc.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

/// dg/ds of all films that settle, one on the diagonal of the others: rows like those of own states.
struct RotorSystem::Settling {
  core::Matrix matrix;
  core::Vector residual, step, rest;
  core::LinearSolver solver;
};

}  // namespace whirl::system
