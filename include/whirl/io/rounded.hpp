#pragma once
// Numbers in messages, with as many digits as are known.

#include <string>

namespace whirl::io {

/// "5021.4 +- 6.9 rpm": two digits of the uncertainty, seven of the value at most; the unit 1 is not written, and an
/// unknown uncertainty neither.
[[nodiscard]] std::string with_uncertainty(double value, double uncertainty, const std::string& unit);

}  // namespace whirl::io
