#pragma once
// How studies write their briefs (io/brief.hpp): from the named values of their summaries.

#include <optional>
#include <string>
#include <vector>

#include "whirl/io/summary.hpp"

namespace whirl::study {

/// The values of a study by name.
class Values {
public:
  explicit Values(const io::StudySummary& s);
  /// Not a number, without a unit, if there is none.
  [[nodiscard]] io::Quantity operator[](const std::string& name) const;
  /// Nothing if there is none or it is not finite.
  [[nodiscard]] std::optional<double> get(const std::string& name) const;
  /// What stands between `head` and `tail` in the names that have both, in the order of the study.
  [[nodiscard]] std::vector<std::string> between(const std::string& head, const std::string& tail) const;

private:
  const io::StudySummary& study_;
};

/// The quantity times `factor` with its bar, in `unit`: a ratio in percent, a frequency in Hz.
[[nodiscard]] io::Quantity scaled(io::Quantity q, double factor, const std::string& unit);
/// A temperature in degC of one in K.
[[nodiscard]] io::Quantity in_celsius(io::Quantity kelvin);

}  // namespace whirl::study
