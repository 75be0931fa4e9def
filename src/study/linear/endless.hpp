#pragma once
// Transfer functions about undamped resonances, where they grow without limit.

#include <array>
#include <complex>
#include <span>
#include <string>
#include <vector>

#include "study/linear/passed_over.hpp"
#include "study/linear/resonances.hpp"
#include "study/linear/transfer_points.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

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

/// The frequency of an undamped resonance among the eigenvalues [1/s] on another mesh: the nearest one; NaN of none.
[[nodiscard]] double nearest_to(double frequency, const std::vector<std::complex<double>>& eigenvalues);

/// Says where transfer functions grow without limit, with `bars` [rad/s] of these frequencies; none: not known.
void warn_of_endless(io::StudySummary& summary, const std::vector<Endless>& endless, const std::vector<double>& bars,
                     const std::vector<ResponseName>& names, const std::string& unit);

}  // namespace whirl::study
