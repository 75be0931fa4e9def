#pragma once
// What is unusual about a discretisation, though it can be computed.

#include <string>
#include <vector>

#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// A line for each segment whose length over stiffness diameter is outside 0.05 to 0.8, and for each pair of neighbours
/// whose ratios differ by more than a factor of 4; lines begin with the path of the segment. Nothing for a rigid rotor.
/// Source: Gavalas (2022), sec. 2.1.
[[nodiscard]] std::vector<std::string> advice(const Options& rotor);

}  // namespace whirl::rotor
