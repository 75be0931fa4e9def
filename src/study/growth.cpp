#include "study/growth.hpp"

#include <fmt/core.h>

#include <numbers>
#include <utility>

#include "study/bars/mesh_wave.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/common.hpp"
#include "whirl/spectral/whirl.hpp"

namespace whirl::study {

std::string Growth::words() const {
  const auto several = [](std::size_t n, const char* what) {
    return n > 1 ? fmt::format(", the fastest of {} {}", n, what) : std::string();
  };
  std::string out;
  if (!real.empty())
    out = fmt::format("it diverges (s = +{:.4g} 1/s{})", real.front(), several(real.size(), "real eigenvalues"));
  if (!pairs.empty())
    out += fmt::format("{}an oscillation grows ({:.4g} Hz, log decrement {:.3g}{})", out.empty() ? "" : ", and ",
                       pairs.front().imag() / (2 * std::numbers::pi), spectral::log_decrement(pairs.front()),
                       several(pairs.size(), "pairs"));
  return out;
}

const char* Growth::verdict() const {
  return any() ? "unstable" : !all_known() ? "undetermined" : undamped > 0 ? "undamped" : "stable";
}

Growth growth_of(const solve::Stability& stability) {
  Growth out;
  out.undamped = stability.neutral;
  out.missed = stability.missed;
  out.mesh_waves = stability.mesh_waves;
  // By falling distance from the border of stability, so the fastest come first.
  for (std::size_t k = 0; k < stability.values.size() && stability.distance[k] > 0; ++k) {
    const std::complex<double> s = stability.values[k];
    // Two equal real eigenvalues part by rounding into a pair that does not vibrate.
    if (!spectral::vibrates(s))
      out.real.push_back(s.real());
    else if (s.imag() > 0)
      out.pairs.push_back(s);
  }
  return out;
}

std::optional<Growth> growth_at(system::Plant& system, Vec x, std::string* reason) {
  std::optional<Growth> out;
  (void)has_answer([&] { out = growth_of(equilibrium_stability(system, x)); }, reason);
  return out;
}

void put_growth(const std::optional<Growth>& growth, const std::string& where, const std::string& consequence,
                io::StudySummary& summary) {
  summary.stability = growth ? growth->verdict() : "undetermined";
  if (growth) warn_of(*growth, where, consequence, summary);
}

void warn_of(const Growth& growth, const std::string& where, const std::string& consequence,
             io::StudySummary& summary) {
  warn_of_waves(growth, where, summary);
  if (!growth.any()) return;
  warn_first(summary, fmt::format("{} the equilibrium is unstable: {}. {}", where, growth.words(), consequence));
}

void warn_first(io::StudySummary& summary, std::string words) {
  summary.warnings.insert(summary.warnings.begin(), std::move(words));
}

void warn_of_waves(const Growth& growth, const std::string& where, io::StudySummary& summary) {
  MeshWaves waves;
  waves.add(0, growth.mesh_waves);
  waves.warn(summary, {}, where);
}

}  // namespace whirl::study
