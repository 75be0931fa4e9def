#pragma once
// The words of a sweep: names of its values and variants, and what the studies of one variant say of its stability.

#include <span>
#include <string>

#include "whirl/io/summary.hpp"

namespace whirl::study {

/// By rising weight. `in_part`: unstable somewhere in the range of a study, not everywhere.
enum class StabilityWord { nothing, stable, undamped, undetermined, no_result, in_part, unstable };
/// "-", "stable", "undamped", "undetermined", "no result", "unstable in part", "UNSTABLE".
[[nodiscard]] const char* name_of(StabilityWord found);

struct VariantVerdict {
  StabilityWord found = StabilityWord::nothing;
  std::string words = {};  ///< "stable 300 to 1470 rpm, unstable to 3000 rpm"; empty where nothing is known
};

/// By the ranges of a study, else by its stability, else by its modes in the films.
[[nodiscard]] VariantVerdict verdict_of(const io::StudySummary& study);

/// Of several studies: the words once if all that know of stability agree, else "STUDY: words" for each. What was found
/// is the heaviest; unstable in part where one study finds it unstable and another one stable somewhere.
[[nodiscard]] VariantVerdict verdict_of(std::span<const io::StudySummary> studies);

/// Values that answer what was asked; all of them stand in the table of the sweep.
[[nodiscard]] bool answers(const std::string& value);

/// The name of a value as few words. `speed_unit`: of a number in the name that is a speed, empty if it is not known.
[[nodiscard]] std::string in_short(std::string value, const std::string& speed_unit);

/// Words with `digits` digits of each long decimal number: "x0.9333" of "x0.933333333333".
[[nodiscard]] std::string with_digits(const std::string& words, int digits);

}  // namespace whirl::study
