#pragma once
// The parameter that a branch follows.

#include <numbers>
#include <optional>
#include <string>
#include <string_view>

#include "whirl/deck/description.hpp"
#include "whirl/system/options.hpp"

namespace whirl::study {

/// Bifurcations that a study can be asked to locate.
enum class Event { fold, hopf, branch_point, cyclic_fold, flip, neimark_sacker };
[[nodiscard]] std::span<const deck::Name<Event>> names(Event);

/// Lengths of steps along a branch, in units of the parameter (SI; as written in the unit of the range).
struct BranchStep {
  deck::Quantity initial;
  deck::Quantity min;
  deck::Quantity max;
};

/// Of solve::ContinuationOptions.
inline constexpr double default_picture_tolerance = 0.01;
inline constexpr const char* text_of_picture_tolerance =
    "how far a curve may lie from the line between two points, over the size of its picture: points are computed "
    "between the ends of a step until the lines are as near; 0: none";

/// How a branch goes on from a point.
enum class Following { arclength, natural };
[[nodiscard]] std::span<const deck::Name<Following>> names(Following);

/// A search for solutions that coexist with the first one of a branch.
struct Deflation {
  int solutions = 2;  ///< wanted in all
  int attempts = 12;  ///< guesses tried
  double power = 2;   ///< p of 1/|u - r|^p + 1
};

/// `speed`, or the path of a continuable option, and the interval to cover.
struct Parameter {
  std::string path = "speed";
  deck::Range range;               ///< SI; direction is from -> to
  std::optional<BranchStep> step;  ///< the study's own choice if absent
  Following continuation = Following::arclength;
  std::optional<Deflation> deflation;                               ///< none if absent
  double beta_1 = std::numbers::pi / 6, beta_2 = std::numbers::pi;  ///< [rad], of solve::ContinuationOptions
};

/// Coherent SI unit of the parameter; "rad/s" for speed. Throws core::InputError if there is no such option or if
/// studies may not vary it.
[[nodiscard]] std::string parameter_unit(const system::Machine& machine, std::string_view path);

/// Its present value (SI); not of the speed. Throws likewise.
[[nodiscard]] double value_of(const system::Machine& machine, std::string_view path);

/// A copy of `machine` in which the option at `path` (not speed) has the value `value` (SI).
[[nodiscard]] system::Machine with_parameter(const system::Machine& machine, std::string_view path, double value);

void describe(deck::Description<BranchStep>& d);
void describe(deck::Description<Deflation>& d);
void describe(deck::Description<Parameter>& d);

/// The parameter exists and may be varied, range and step have its unit, and `speed` is given exactly where the
/// parameter is another one.
void check_parameter(const Parameter& parameter, const std::optional<deck::Quantity>& speed,
                     const system::Machine& machine, const deck::Report& report);

}  // namespace whirl::study
