#pragma once
// What grows about an equilibrium.

#include <complex>
#include <optional>
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
  /// Likewise; -1 where the verdict is "undetermined".
  [[nodiscard]] int known_count() const { return any() || all_known() ? count() : -1; }
  /// "unstable", "undetermined" (nothing grows among the eigenvalues found, and some may be missing or were left out),
  /// "undamped" or "stable".
  [[nodiscard]] const char* verdict() const;
  /// None is known to be missing, and none was left out.
  [[nodiscard]] bool all_known() const { return missed == 0 && mesh_waves.empty(); }
  /// "it diverges (s = +311.3 1/s)", "an oscillation grows (181.2 Hz, log decrement -0.00917)", with the number of
  /// those that grow where there are several; empty if nothing grows.
  [[nodiscard]] std::string words() const;
  void members(auto& archive) { archive(real, pairs, undamped, missed, mesh_waves); }
};

[[nodiscard]] Growth growth_of(const solve::Stability& stability);
/// Of the equilibrium x at the system's parameter; nothing where the search finds no eigenvalues, with the reason.
/// Cost: one eigenvalue problem without vectors. Collective.
[[nodiscard]] std::optional<Growth> growth_at(system::Plant& system, Vec x, std::string* reason = nullptr);
/// Verdict of a linear study at one speed, "undetermined" where nothing is known; with warn_of() its warning.
void put_growth(const std::optional<Growth>& growth, const std::string& where, const std::string& consequence,
                io::StudySummary& summary);
/// Adds the warning "WHERE the equilibrium is unstable: ..., CONSEQUENCE" if something grows; `where` as "at 3600 rpm".
/// warn_of_waves() is called as well.
void warn_of(const Growth& growth, const std::string& where, const std::string& consequence, io::StudySummary& summary);
/// Adds a warning before all others: who reads only one reads the gravest.
void warn_first(io::StudySummary& summary, std::string words);
/// Says which waves of a film's mesh were left out, if any.
void warn_of_waves(const Growth& growth, const std::string& where, io::StudySummary& summary);

}  // namespace whirl::study
