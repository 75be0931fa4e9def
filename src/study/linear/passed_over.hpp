#pragma once
// Resonances that stand between the frequencies of transfer functions, and undamped ones, where these grow without
// limit.

#include <array>
#include <complex>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "study/linear/resonances.hpp"
#include "study/linear/transfer_points.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/solve/branch/continuation.hpp"

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

/// An undamped resonance, and which transfer functions have a pole there.
struct Endless {
  double frequency = 0;  ///< [rad/s]
  std::vector<bool> responses;
};

/// Two frequencies beside a resonance, the second one twice as far.
[[nodiscard]] std::array<double, 2> beside_pole(const Resonance& resonance);

/// Those of the resonances at which some transfer function has a pole: at half the distance it is about twice as large.
/// `beside`: the functions at beside_pole() of each resonance; empty where there is no answer.
[[nodiscard]] std::vector<Endless> endless_of(const std::vector<Resonance>& resonances,
                                              std::span<const Transfer> beside);

/// Resonances between frequencies: damped ones that these pass over, with the transfer functions beside their tops
/// (empty where there is no answer), and undamped ones that some function has a pole at.
struct ResonancesBetween {
  std::vector<Resonance> narrow;
  std::vector<Transfer> at_narrow;
  std::vector<Endless> endless;
};
/// Among the eigenvalues [1/s] of the machine; `at`: its transfer functions at some frequencies [rad/s].
[[nodiscard]] ResonancesBetween between(const std::vector<double>& frequencies,
                                        const std::vector<std::complex<double>>& eigenvalues,
                                        const ResonanceSearch& search,
                                        const std::function<std::vector<Transfer>(const std::vector<double>&)>& at);

/// Why each of the frequencies has no answer (empty: it has one): `reasons` says why its functions were not computed,
/// or it is an undamped resonance but for rounding; then they are made not a number.
[[nodiscard]] std::vector<std::string> leave_out_poles(const std::vector<double>& frequencies,
                                                       std::vector<std::string> reasons,
                                                       const std::vector<Endless>& endless,
                                                       std::vector<std::vector<std::complex<double>>>& found);

/// The frequency of an undamped resonance among the eigenvalues [1/s] on another mesh: the nearest one; NaN of none.
[[nodiscard]] double nearest_to(double frequency, const std::vector<std::complex<double>>& eigenvalues);

/// Whether a response grows without limit; puts its largest value, which is infinite then, and the resonance that it is
/// at, in `unit`. `bars`: as of warn_of_endless().
bool put_endless(io::StudySummary& summary, const ResponseName& name, std::size_t response,
                 const std::vector<Endless>& endless, const std::vector<double>& bars, const std::string& unit);

/// Says where transfer functions grow without limit, with `bars` [rad/s] of these frequencies; none: not known.
void warn_of_endless(io::StudySummary& summary, const std::vector<Endless>& endless, const std::vector<double>& bars,
                     const std::vector<ResponseName>& names, const std::string& unit);

}  // namespace whirl::study
