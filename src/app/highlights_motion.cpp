#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "highlights.hpp"

namespace whirl::app {
namespace {

constexpr double rpm = std::numbers::pi / 30;

}  // namespace

std::string of_cycles(const io::StudySummary& s, const Values& v) {
  std::string out;
  if (v.get("contact"))
    out += fmt::format("  contact at {}\n", with_uncertainty(*v.get("contact"), v.bar("contact"), v.unit("contact")));
  for (const std::string& key : Values::between(s, "at.", ".period")) {
    const std::string head = "at." + key + ".";
    const auto places = Values::between(s, head + "peak_to_peak.", ".x");
    const auto modulus = v.get(head + "multiplier.modulus");
    const bool length = !places.empty() && v.unit(head + "peak_to_peak." + places.front() + ".x") == "m";
    Grid grid({"at " + key + (modulus ? fmt::format(", largest multiplier {:.4f}", *modulus) : ""),
               length ? "x [um, peak to peak]" : "x, peak to peak",
               length ? "y [um, peak to peak]" : "y, peak to peak"});
    for (const std::string& p : places)
      grid.add({p, v.cell(head + "peak_to_peak." + p + ".x", length ? 1e6 : 1),
                v.cell(head + "peak_to_peak." + p + ".y", length ? 1e6 : 1)});
    out += grid.text();
  }
  return out;
}

// The study says which speed is the threshold. On a falling range it is not the first Hopf point of the list.
std::string of_equilibria(const io::StudySummary& s, const Values& v) {
  const auto threshold = v.get("threshold"), whirl = v.get("whirl_frequency");
  if (!threshold || v.unit("threshold") != "rad/s") return {};
  const auto hopf = std::find_if(s.bifurcations.begin(), s.bifurcations.end(), [&](const io::Bifurcation& b) {
    const double factor = b.unit == "rpm" ? rpm : b.unit == "Hz" ? 2 * std::numbers::pi : 1;
    return b.type == io::BifurcationType::hopf && std::abs(b.value * factor - *threshold) <= 1e-9 * *threshold;
  });
  std::string out = "  threshold ";
  if (hopf == s.bifurcations.end())
    out += with_uncertainty(*threshold / rpm, v.bar("threshold") / rpm, "rpm");
  else
    out += with_uncertainty(hopf->value, hopf->uncertainty, hopf->unit);
  if (whirl) out += fmt::format(", whirl at {:.1f} rpm, {:.3f} of the speed", *whirl / rpm, *whirl / *threshold);
  return out + "\n";
}

std::string of_motion(const io::StudySummary& s, const Values& v) {
  std::string out;
  for (const std::string& kind : Values::between(s, "motion.", "")) {
    std::string name = kind;
    std::replace(name.begin(), name.end(), '_', ' ');
    out += "  motion: " + name;
    const auto period = v.get("period"), time = v.get("period.time");
    if (period && time)
      out += fmt::format(", returns after {:.6g} s, crossing its section {:.0f} times", *time, *period);
    else if (period)
      out += fmt::format(", returns after {:.0f} revolutions", *period);
    out += "\n";
  }
  if (const auto exponent = v.get("lyapunov.1.per_revolution")) {
    const auto error = v.get("lyapunov.1.uncertainty"), rate = v.get("lyapunov.1");
    const double bar = error && rate && *rate != 0 ? std::abs(*exponent * *error / *rate) : io::no_value;
    out += fmt::format("  largest Lyapunov exponent {} per revolution\n", with_uncertainty(*exponent, bar, ""));
  }
  if (const auto rotation = v.get("rotation")) {
    out += fmt::format("  rotation number {} turns per return", with_uncertainty(*rotation, v.bar("rotation"), ""));
    if (const auto p = v.get("rotation.locked.numerator"))
      out += fmt::format(", locked at {:.0f}/{:.0f}", *p, *v.get("rotation.locked.denominator"));
    out += "\n";
  }
  const auto places = Values::between(s, "peak_to_peak.", ".x");
  if (places.empty()) return out;
  const bool length = v.unit("peak_to_peak." + places.front() + ".x") == "m";
  Grid grid({"place", length ? "x [um, peak to peak]" : "x, peak to peak",
             length ? "y [um, peak to peak]" : "y, peak to peak", "strongest tone in y [Hz]", "per revolution"});
  for (const std::string& p : places)
    grid.add({p, v.cell("peak_to_peak." + p + ".x", length ? 1e6 : 1),
              v.cell("peak_to_peak." + p + ".y", length ? 1e6 : 1), v.cell("tone." + p + ".y.1.frequency"),
              v.cell("tone." + p + ".y.1.order")});
  return out + grid.text();
}

std::string of_run_up(const io::StudySummary& s, const Values& v) {
  const auto places = Values::between(s, "", ".peak.amplitude");
  if (places.empty()) return {};
  Grid grid({"largest at", "[" + v.unit(places.front() + ".peak.speed") + "]", "0-peak [um]"});
  for (const std::string& p : places) grid.add({p, v.cell(p + ".peak.speed"), v.cell(p + ".peak.amplitude", 1e6)});
  return grid.text();
}

}  // namespace whirl::app
