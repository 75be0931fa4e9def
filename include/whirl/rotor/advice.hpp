#pragma once
// What is unusual about a shaft and its discs, though it can be computed.

#include <string>
#include <vector>

#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// A line for each segment whose length over stiffness diameter is outside 0.05 to 0.8, and for each pair of neighbours
/// whose ratios differ by more than a factor of 4; lines begin with the path of the segment. Nothing for a rigid rotor.
/// Source: Gavalas (2022), sec. 2.1.
[[nodiscard]] std::vector<std::string> advice(const Options& rotor);

/// A line for each disc with moments of inertia that no body has. J_p <= 2 J_d holds for every body, with equality for
/// a thin disc: sum m (x^2 + y^2) <= sum m (x^2 + y^2 + 2 z^2). Moments of the disc's geometry are added first. A
/// hundredth is left to rounded numbers. Units: kg m^2.
[[nodiscard]] std::vector<std::string> impossible_inertias(const Options& rotor);

}  // namespace whirl::rotor
