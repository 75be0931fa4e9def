#pragma once
// What grows about an equilibrium.

#include <complex>
#include <string>
#include <vector>

#include "whirl/io/summary.hpp"
#include "whirl/solve/branch/continuation.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

/// The eigenvalues of an equilibrium whose real part is positive beyond rounding. Real ones: the machine leaves the
/// equilibrium without oscillation (divergence). Complex pairs: an oscillation grows.
struct Growth {
  std::vector<double> real;                 ///< [1/s], the fastest first
  std::vector<std::complex<double>> pairs;  ///< [1/s, rad/s], the member with imag > 0, the fastest first
  int undamped = 0;  ///< eigenvalues whose real part is rounding, both of each pair: neither growth nor decay
  int missed = 0;    ///< as solve::Stability::missed
  std::vector<std::complex<double>> mesh_waves{};  ///< as solve::Stability::mesh_waves

  [[nodiscard]] bool any() const { return !real.empty() || !pairs.empty(); }
  /// Unstable eigenvalues, both of each pair.
  [[nodiscard]] int count() const { return static_cast<int>(real.size() + 2 * pairs.size()); }
  /// Nothing grows, and nothing is known to be missing or left out. Undamped equilibria count as stable.
  [[nodiscard]] bool stable() const { return !any() && missed == 0 && mesh_waves.empty(); }
  /// "it diverges (s = +311.3 1/s)", "an oscillation grows (181.2 Hz, log decrement -0.00917)", with the number of
  /// those that grow where there are several; empty if nothing grows.
  [[nodiscard]] std::string words() const;
};

[[nodiscard]] Growth growth_of(const solve::Stability& stability);
/// Of the equilibrium x at the system's parameter. Cost: one eigenvalue problem without vectors. Collective; throws
/// core::NotConverged.
[[nodiscard]] Growth growth_at(system::Plant& system, Vec x);
/// As numbers that ranks and pieces of a checkpoint hold.
[[nodiscard]] std::vector<double> packed(const Growth& growth);
/// Verdict of a linear study at one speed, "stable", "unstable" or "undetermined" (nothing is known, or eigenvalues may
/// be missing), from packed(); with warn_of() its warning.
void put_growth(const std::vector<double>& packed, const std::string& where, const std::string& consequence,
                io::StudySummary& summary);
/// Adds the warning "WHERE the equilibrium is unstable: ..., CONSEQUENCE" if something grows; `where` as "at 3600 rpm".
/// warn_of_waves() is called as well.
void warn_of(const Growth& growth, const std::string& where, const std::string& consequence, io::StudySummary& summary);
/// Says which waves of a film's mesh were left out, if any.
void warn_of_waves(const Growth& growth, const std::string& where, io::StudySummary& summary);

}  // namespace whirl::study
