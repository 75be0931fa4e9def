#pragma once
// Parts of vectors by their names alone.

#include "whirl/core/local_part.hpp"

namespace whirl::solve {

using core::get;
using core::put;

}  // namespace whirl::solve
