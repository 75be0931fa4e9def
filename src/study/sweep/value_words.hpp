#pragma once
// Names of the values and the variants of a sweep as a reader has them.

#include <string>

namespace whirl::study {

/// Values that answer what was asked; all of them stand in the table of the sweep.
[[nodiscard]] bool answers(const std::string& value);

/// The name of a value as few words. `speed_unit`: of a number in the name that is a speed, empty if it is not known.
[[nodiscard]] std::string in_short(std::string value, const std::string& speed_unit);

/// Words with `digits` digits of each long decimal number: "x0.9333" of "x0.933333333333".
[[nodiscard]] std::string with_digits(const std::string& words, int digits);

}  // namespace whirl::study
