#pragma once
// Quantities with units. SI inside: the unit of an option is a coherent SI unit ("m", "Pa s", "rad/s", "1").

#include <string>
#include <string_view>

namespace whirl::deck {

/// A value in SI together with the unit in which it was written, for options whose results are reported in that unit.
struct Quantity {
  double value = 0;
  std::string unit;
};

/// An interval in SI together with the unit of its start, in which results are reported.
struct Range {
  double from = 0;
  double to = 0;
  std::string unit;
};

/// Number and unit of `text` ("180 um"); the unit is empty if there is none. Throws core::InputError (without a place)
/// if there is no finite number in front.
struct Split {
  double number = 0;
  std::string unit;
};
[[nodiscard]] Split split_quantity(std::string_view text);

/// Value in SI of `text` for an option of unit `si`: "180 um" for "m" is 180e-6.
///
/// The kind of quantity must be that of `si`, angles included: a speed ("rad/s") takes rpm, rad/s, deg/s, but neither
/// Hz nor 1/min; "1" takes bare numbers only, every other unit requires one; "K" is an absolute temperature and takes
/// degC, "delta K" a temperature difference and does not; `frequency` takes Hz beside all that a speed takes; "*" takes
/// any unit.
/// Throws core::InputError without a place, saying what was expected.
[[nodiscard]] double to_si(std::string_view text, std::string_view si);

/// The kind of a circular frequency in rad/s that may be written in Hz as well: 1 Hz is 2 pi rad/s.
inline constexpr std::string_view frequency = "rad/s or Hz";

/// `text` ("180 um", "3") times `factor` in its own unit, rounded to 15 digits. Throws core::InputError (without a
/// place) if it is no number, if the result is not finite, or if the unit has its zero elsewhere (degC).
[[nodiscard]] std::string scaled(std::string_view text, double factor);

/// A number as people would write the result of a small sum, rounded to 15 digits: 60 * 1.1 is 66, not
/// 66.00000000000001. Throws core::InputError (without a place) if it is not finite.
[[nodiscard]] std::string write_rounded(double value);

/// `value` (SI, of the kind `si`: a frequency in rad/s may have the unit Hz) as a number in `unit`; throws
/// core::InputError if `unit` is not one.
[[nodiscard]] double from_si(double value, std::string_view unit, std::string_view si = "*");

/// Value in SI of `number` in `unit`.
[[nodiscard]] double number_to_si(double number, std::string_view unit);

/// The unit of a kind: K of "delta K", rad/s of `frequency`, else the kind itself.
[[nodiscard]] std::string_view coherent(std::string_view si);

/// True if both units measure the same kind of quantity.
[[nodiscard]] bool same_kind(std::string_view unit, std::string_view other);

/// Throws core::InputError (without a place) unless a value written in `unit` suits an option of SI unit `si`.
void check_kind(std::string_view unit, std::string_view si);

/// Shortest text `number unit` that reads back, for an option of unit `si`, to exactly `value` (SI).
[[nodiscard]] std::string write_quantity(double value, std::string_view unit, std::string_view si = "*");

/// A size of memory in round numbers, "1.2 GB".
[[nodiscard]] std::string write_memory(double bytes);

/// Shortest decimal that reads back to exactly `value`.
[[nodiscard]] std::string write_number(double value);

}  // namespace whirl::deck
