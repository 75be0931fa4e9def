#include "highlights.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <vector>

namespace whirl::app {
namespace {

constexpr double rpm = std::numbers::pi / 30;

// Values by name.
class Values {
public:
  explicit Values(const io::StudySummary& s) {
    for (const auto& [name, quantity] : s.values) all_[name] = quantity;
  }
  [[nodiscard]] std::optional<double> get(const std::string& name) const {
    const auto at = all_.find(name);
    if (at == all_.end() || !std::isfinite(at->second.value)) return std::nullopt;
    return at->second.value;
  }
  [[nodiscard]] std::string unit(const std::string& name) const {
    const auto at = all_.find(name);
    return at == all_.end() ? "" : at->second.unit;
  }
  [[nodiscard]] double bar(const std::string& name) const {
    const auto at = all_.find(name);
    if (at == all_.end() || !at->second.more.contains("uncertainty")) return io::no_value;
    return at->second.more.at("uncertainty");
  }
  /// What stands between `head` and `tail` in the names that have both, in the order of the study.
  [[nodiscard]] static std::vector<std::string> between(const io::StudySummary& s, const std::string& head,
                                                        const std::string& tail) {
    std::vector<std::string> found;
    for (const auto& [name, quantity] : s.values)
      if (name.size() > head.size() + tail.size() && name.starts_with(head) && name.ends_with(tail))
        found.push_back(name.substr(head.size(), name.size() - head.size() - tail.size()));
    return found;
  }

private:
  std::map<std::string, io::Quantity> all_;
};

// Four digits are what a table of a console is for.
std::string number(std::optional<double> value) {
  if (!value) return "-";
  const double size = std::abs(*value);
  if (size != 0 && (size < 1e-3 || size >= 1e6)) return fmt::format("{:.3e}", *value);
  const int before = size < 1 ? 1 : static_cast<int>(std::floor(std::log10(size))) + 1;
  return fmt::format("{:.{}f}", *value, std::max(0, 4 - before));
}

std::optional<double> times(std::optional<double> value, double factor) {
  if (value) *value *= factor;
  return value;
}

// Rows of cells, right-aligned below their heads, the first column left-aligned; columns without a number are left out.
class Grid {
public:
  explicit Grid(std::vector<std::string> heads) : rows_{std::move(heads)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  [[nodiscard]] std::string text() const {
    if (rows_.size() < 2) return {};
    std::string out;
    for (const auto& row : rows_) {
      std::string line = "   ";
      for (std::size_t c = 0; c < row.size(); ++c) {
        std::size_t width = 0;
        bool any = c == 0;
        for (const auto& other : rows_) width = std::max(width, other[c].size());
        for (std::size_t r = 1; r < rows_.size(); ++r) any = any || rows_[r][c] != "-";
        if (any) line += c == 0 ? fmt::format(" {:<{}}", row[c], width) : fmt::format("  {:>{}}", row[c], width);
      }
      out += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
    return out;
  }

private:
  std::vector<std::vector<std::string>> rows_;
};

std::string of_static(const io::StudySummary& s, const Values& v) {
  Grid grid({"bearing", "load [kN]", "x [um]", "y [um]", "least film [um]", "pressure [MPa]"});
  for (const std::string& b : Values::between(s, "load.", "")) {
    const std::string head = "bearing." + b + ".";
    grid.add({b, number(times(v.get("load." + b), 1e-3)), number(times(v.get(head + "x"), 1e6)),
              number(times(v.get(head + "y"), 1e6)), number(times(v.get(head + "min_thickness"), 1e6)),
              number(times(v.get(head + "max_pressure"), 1e-6))});
  }
  return grid.text();
}

std::string of_alignment(const io::StudySummary& s, const Values& v) {
  Grid grid({"bearing", "elevation [um]", "load [kN]"});
  for (const std::string& b : Values::between(s, "elevation.", ""))
    grid.add({b, number(times(v.get("elevation." + b), 1e6)), number(times(v.get("reaction_aligned." + b), 1e-3))});
  return grid.text();
}

std::string of_modes(const io::StudySummary& s, const Values& v) {
  const auto criticals = Values::between(s, "critical.", ".speed");
  if (criticals.empty()) return {};
  const std::string unit = v.unit("critical." + criticals.front() + ".speed");
  Grid grid({"critical speed", "[" + unit + "]", "log decrement", "amplification", "margin [%]", "required [%]"});
  for (const std::string& k : criticals) {
    const std::string head = "critical." + k + ".";
    const auto decrement = v.get(head + "log_decrement");
    // N/(N2 - N1) of a mode by itself is 1/(2 zeta), its log decrement 2 pi zeta.
    auto amplification = v.get(head + "amplification_factor");
    if (!amplification && decrement && *decrement > 0) amplification = std::numbers::pi / *decrement;
    grid.add({k, number(v.get(head + "speed")), decrement && *decrement == 0 ? "undamped" : number(decrement),
              number(amplification), number(times(v.get(head + "separation_margin"), 100)),
              number(times(v.get(head + "required_margin"), 100))});
  }
  return grid.text();
}

std::string of_response(const io::StudySummary& s, const Values& v) {
  std::string out;
  std::set<std::string> seen;
  for (const std::string& name : Values::between(s, "node.", ".semi_major")) {
    const std::string node = name.substr(0, name.find('.'));
    if (!seen.insert(node).second) continue;
    const auto peaks = Values::between(s, "node." + node + ".peak.", ".speed");
    const std::string unit = v.unit("node." + node + ".peak.1.speed");
    Grid grid(
        {"peak at node " + node, "[" + unit + "]", "0-peak [um]", "amplification", "margin [%]", "required [%]", ""});
    for (const std::string& k : peaks) {
      const std::string head = "node." + node + ".peak." + k + ".";
      const auto margin = v.get(head + "separation_margin"), required = v.get(head + "required_margin"),
                 factor = v.get(head + "amplification_factor");
      const bool damped = factor && *factor < 2.5;
      const std::string verdict = damped                                      ? "damped, not critical"
                                  : margin && required && *margin < *required ? "TOO NEAR"
                                                                              : "";
      grid.add({k, number(v.get(head + "speed")), number(times(v.get(head + "semi_major"), 1e6)), number(factor),
                number(times(margin, 100)), damped ? "-" : number(times(required, 100)), verdict});
    }
    out += grid.text();
  }
  return out;
}

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
      grid.add({p, number(times(v.get(head + "peak_to_peak." + p + ".x"), length ? 1e6 : 1)),
                number(times(v.get(head + "peak_to_peak." + p + ".y"), length ? 1e6 : 1))});
    out += grid.text();
  }
  return out;
}

std::string of_equilibria(const io::StudySummary& s, const Values& v) {
  const auto threshold = v.get("threshold"), whirl = v.get("whirl_frequency");
  if (!threshold || v.unit("threshold") != "rad/s") return {};
  const auto first = std::find_if(s.bifurcations.begin(), s.bifurcations.end(),
                                  [](const io::Bifurcation& b) { return b.type == io::BifurcationType::hopf; });
  if (first == s.bifurcations.end()) return {};
  std::string out = fmt::format("  threshold {}", with_uncertainty(first->value, first->uncertainty, first->unit));
  if (whirl) out += fmt::format(", whirl at {:.1f} rpm, {:.3f} of the speed", *whirl / rpm, *whirl / *threshold);
  return out + "\n";
}

std::string of_run_up(const io::StudySummary& s, const Values& v) {
  const auto places = Values::between(s, "", ".peak.amplitude");
  if (places.empty()) return {};
  Grid grid({"largest at", "[" + v.unit(places.front() + ".peak.speed") + "]", "0-peak [um]"});
  for (const std::string& p : places)
    grid.add({p, number(v.get(p + ".peak.speed")), number(times(v.get(p + ".peak.amplitude"), 1e6))});
  return grid.text();
}

}  // namespace

std::string with_uncertainty(double value, double uncertainty, const std::string& unit) {
  const std::string tail = unit.empty() || unit == "1" ? "" : " " + unit;
  if (!std::isfinite(value)) return "unknown";
  const auto places = [](double x) { return -static_cast<int>(std::floor(std::log10(std::abs(x)))); };
  const int most = value == 0 ? 6 : 6 + places(value);
  if (!std::isfinite(uncertainty) || !(uncertainty > 0)) return fmt::format("{:.7g}{}", value, tail);
  const int wanted = 1 + places(uncertainty);
  if (wanted > most) return fmt::format("{:.7g} +- {:.1g}{}", value, uncertainty, tail);
  const int decimals = std::max(0, wanted);
  return fmt::format("{:.{}f} +- {:.{}f}{}", value, decimals, uncertainty, decimals, tail);
}

std::string meaning(const io::Bifurcation& b) {
  const bool super = b.criticality == "supercritical", sub = b.criticality == "subcritical";
  if (!super && !sub) return {};
  switch (b.type) {
    case io::BifurcationType::hopf:
      return super ? "beyond it whirl grows from nothing" : "beyond it whirl jumps up; short of it a push can start it";
    case io::BifurcationType::flip:
      return super ? "beyond it half-frequency whirl grows from nothing"
                   : "beyond it half-frequency whirl jumps up; short of it a push can start it";
    case io::BifurcationType::neimark_sacker:
      return super ? "beyond it whirl beside the vibration grows from nothing"
                   : "beyond it whirl beside the vibration jumps up; short of it a push can start it";
    default:
      return {};
  }
}

std::string highlights(const io::StudySummary& s) {
  const Values v(s);
  if (s.kind == "static") return of_static(s, v);
  if (s.kind == "alignment") return of_alignment(s, v);
  if (s.kind == "modes") return of_modes(s, v);
  if (s.kind == "unbalance_response") return of_response(s, v);
  if (s.kind == "equilibrium_branch") return of_equilibria(s, v);
  if (s.kind == "cycle_branch") return of_cycles(s, v);
  if (s.kind == "run_up") return of_run_up(s, v);
  return {};
}

}  // namespace whirl::app
