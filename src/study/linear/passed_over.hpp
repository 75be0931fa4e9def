#pragma once
// Resonances that the frequencies of transfer functions pass over.

#include <complex>
#include <string>
#include <vector>

#include "study/linear/resonances.hpp"
#include "study/linear/transfer_points.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// Transfer functions as a message has them, "node.2.x.from.node.2.x" in "m/N".
struct ResponseName {
  std::string name, unit;
};

/// A transfer function in um/N or urad/N: displacements and slopes over forces are small numbers of metres and radians.
[[nodiscard]] io::Quantity in_micro(io::Quantity q);

/// Warns of the resonances between two neighbours of the rising `frequencies` [rad/s] at which a transfer function is
/// more than 1.1 times what it is at both: the largest answers are too small there. `at_resonances`: the functions
/// beside the top of each; empty where there is no answer, and nothing is said. `found`: those at the frequencies.
/// Numbers below what rounding leaves of them count for none. `unit`: of frequencies in the message.
void warn_of_passed_over(io::StudySummary& summary, const std::vector<Resonance>& resonances,
                         const std::vector<Transfer>& at_resonances, const std::vector<double>& frequencies,
                         const std::vector<std::vector<std::complex<double>>>& found,
                         const std::vector<ResponseName>& names, const std::string& unit);

}  // namespace whirl::study
