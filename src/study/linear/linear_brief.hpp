#pragma once
// What the briefs of the linear room share: verdicts on margins, short numbers, lists in words.

#include <string>
#include <vector>

#include "study/brief.hpp"
#include "whirl/io/brief.hpp"

namespace whirl::study {

/// A number whose bar is below 0.2 % of it as four digits without a bar, so that a table of several fits a line; the
/// values of the study have it in full.
[[nodiscard]] io::BriefCell compact(const io::Quantity& q);
/// The same times 100.
[[nodiscard]] io::BriefCell compact_percent(const io::Quantity& q);
/// With `count` significant digits.
[[nodiscard]] io::Quantity to_digits(io::Quantity q, int count);

/// An amplification factor with three digits: "25", "1150".
[[nodiscard]] std::string factor_words(double factor);

/// What a verdict of margin_verdict() says in a row; of a damped peak nothing is asked.
[[nodiscard]] std::string margin_mark(const std::string& verdict);

/// "operating speed 3600 rpm", "operating speeds 3000 to 3600 rpm"; empty if the study knows of none.
[[nodiscard]] std::string operating_words(const Values& v);
/// What the columns of margins mean; empty if the study knows no operating speed.
[[nodiscard]] std::string margin_note(const Values& v);

/// "a", "a and b", "a, b and c", "a, b and 4 more"; with a unit "a and b rpm", "a, b rpm and 4 more".
[[nodiscard]] std::string in_words(const std::vector<std::string>& items, std::size_t most = 6,
                                   const std::string& unit = "");

}  // namespace whirl::study
