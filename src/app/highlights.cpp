#include "highlights.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

namespace whirl::app {
namespace {

constexpr double rpm = std::numbers::pi / 30;

// Four digits are what a table of a console is for.
std::string number(std::optional<double> value) {
  if (!value) return "-";
  const double size = std::abs(*value);
  if (size != 0 && (size < 1e-3 || size >= 1e6)) return fmt::format("{:.3e}", *value);
  const int before = size == 0 ? 1 : static_cast<int>(std::floor(std::log10(size))) + 1;
  return fmt::format("{:.{}f}", *value, std::max(0, 4 - before));
}

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
  /// The value and its bar in other units, as in a sentence; "-" if there is none.
  [[nodiscard]] std::string cell(const std::string& name, double factor = 1) const {
    const auto value = get(name);
    if (!value) return "-";
    const double error = factor * bar(name);
    return std::isfinite(error) && error > 0 ? with_uncertainty(factor * *value, error, "") : number(factor * *value);
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
    grid.add({b, v.cell("load." + b, 1e-3), v.cell(head + "x", 1e6), v.cell(head + "y", 1e6),
              v.cell(head + "min_thickness", 1e6), v.cell(head + "max_pressure", 1e-6)});
  }
  return grid.text();
}

std::string of_alignment(const io::StudySummary& s, const Values& v) {
  Grid grid({"bearing", "elevation [um]", "load [kN]"});
  for (const std::string& b : Values::between(s, "elevation.", ""))
    grid.add({b, v.cell("elevation." + b, 1e6), v.cell("reaction_aligned." + b, 1e-3)});
  return grid.text();
}

// The modes at the last speed by their numbers; of many all that grow and the lowest of the others.
std::string last_modes(const io::StudySummary& s, const Values& v) {
  constexpr std::size_t most = 10;
  std::vector<io::ModeEntry> last;
  for (const io::ModeEntry& m : s.modes)
    if (m.speed == s.modes.back().speed) last.push_back(m);
  if (last.empty()) return {};
  const auto extra = [](const io::ModeEntry& m, const char* name) {
    const auto at = m.more.find(name);
    return at == m.more.end() ? std::nullopt : std::optional(at->second);
  };
  // Of supports without films there is no speed.
  const bool turns = extra(last.front(), "mode").has_value();
  Grid grid({turns ? fmt::format("mode at {:.6g} {}", last.front().speed, last.front().speed_unit) : "mode", "[Hz]",
             "log decrement", "damping ratio", "whirl", ""});
  std::size_t shown = 0;
  for (std::size_t k = 0; k < last.size(); ++k) {
    const io::ModeEntry& m = last[k];
    const bool grows = m.stability == "unstable" || m.stability == "diverges", moves = m.imag > 0;
    if (!grows && shown >= most) continue;
    ++shown;
    grid.add({fmt::format("{:.0f}", extra(m, "mode").value_or(static_cast<double>(k + 1))),
              moves ? number(m.imag / (2 * std::numbers::pi)) : "-", moves ? number(m.log_decrement) : "-",
              number(extra(m, "damping_ratio")), moves && !m.whirl.empty() ? m.whirl : "-",
              m.stability == "stable" ? ""
              : moves                 ? m.stability
                                      : fmt::format("diverges, s = +{:.4g} 1/s", m.real)});
  }
  std::string out = grid.text();
  if (shown < last.size()) out += fmt::format("    {} more stand in summary.json\n", last.size() - shown);
  if (const auto count = v.get("overdamped"); count && *count > 0)
    out += fmt::format(
        "    {:.0f} motions that decay without vibrating (damping ratio above 0.9) stand in the table "
        "'overdamped'\n",
        *count);
  return out;
}

// By API 684 a resonance whose amplification factor is below 2.5 is no critical speed.
std::string damped_verdict(std::optional<double> factor, double bar) {
  constexpr double least = 2.5;
  const double error = std::isfinite(bar) ? bar : 0;
  if (factor && *factor + error < least) return "damped, not critical";
  return factor && *factor - error < least ? "undetermined" : "";
}

std::string of_modes(const io::StudySummary& s, const Values& v) {
  const auto criticals = Values::between(s, "critical.", ".speed");
  if (criticals.empty()) return last_modes(s, v);
  const std::string unit = v.unit("critical." + criticals.front() + ".speed");
  Grid grid(
      {"critical speed", "[" + unit + "]", "mode", "log decrement", "amplification", "margin [%]", "required [%]", ""});
  std::vector<std::vector<std::string>> damped;
  for (const std::string& k : criticals) {
    const std::string head = "critical." + k + ".";
    const auto decrement = v.get(head + "log_decrement");
    std::string verdict = damped_verdict(v.get(head + "amplification_factor"), v.bar(head + "amplification_factor"));
    if (decrement && *decrement < 0) verdict = "unstable there";
    const bool apart = verdict.starts_with("damped");
    std::vector<std::string> row{k,
                                 v.cell(head + "speed"),
                                 number(v.get(head + "mode")),
                                 decrement && *decrement == 0 ? "undamped" : v.cell(head + "log_decrement"),
                                 v.cell(head + "amplification_factor"),
                                 apart ? "-" : v.cell(head + "separation_margin", 100),
                                 apart ? "-" : v.cell(head + "required_margin", 100),
                                 verdict};
    if (const auto mode = v.get(head + "mode")) row[2] = fmt::format("{:.0f}", *mode);
    if (apart)
      damped.push_back(std::move(row));
    else
      grid.add(std::move(row));
  }
  for (auto& row : damped) grid.add(std::move(row));
  return grid.text();
}

// The bar with two digits, the value as far as it reaches; "-" if there is none.
std::string cell_of(const io::Quantity& q, double factor = 1) {
  if (!std::isfinite(q.value)) return "-";
  const auto bar = q.more.find("uncertainty");
  const double error = bar == q.more.end() ? io::no_value : factor * bar->second;
  return std::isfinite(error) && error > 0 ? with_uncertainty(factor * q.value, error, "") : number(factor * q.value);
}

// Peaks of the shaft; those of the journals stand in the report. A grid for each place.
std::string of_response(const io::StudySummary& s) {
  std::string out;
  std::vector<std::string> places;
  for (const io::PeakEntry& p : s.peaks)
    if (p.place.starts_with("node ") && std::find(places.begin(), places.end(), p.place) == places.end())
      places.push_back(p.place);
  for (const std::string& place : places) {
    std::vector<io::PeakEntry> own;
    std::copy_if(s.peaks.begin(), s.peaks.end(), std::back_inserter(own),
                 [&](const io::PeakEntry& p) { return p.place == place; });
    Grid grid({"peak at " + place, "[" + own.front().speed.unit + "]", "0-peak [um]", "amplification", "margin [%]",
               "required [%]", ""});
    for (std::size_t k = 0; k < own.size(); ++k) {
      const io::PeakEntry& p = own[k];
      std::vector<std::string> marks = p.notes;
      const bool damped = p.verdict.starts_with("damped");
      if (!p.verdict.empty() && p.verdict != "far enough")
        marks.insert(marks.begin(), p.verdict == "too near" ? "TOO NEAR" : p.verdict);
      if (!p.stability.empty() && p.stability != "stable")
        marks.insert(marks.begin(), p.stability == "unstable" ? "UNSTABLE there" : "stability undetermined");
      grid.add({fmt::format("{}", k + 1), cell_of(p.speed), cell_of(p.semi_major, 1e6), cell_of(p.amplification_factor),
                cell_of(p.separation_margin, 100), damped ? "-" : cell_of(p.required_margin, 100),
                fmt::format("{}", fmt::join(marks, "; "))});
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
      grid.add({p, v.cell(head + "peak_to_peak." + p + ".x", length ? 1e6 : 1),
                v.cell(head + "peak_to_peak." + p + ".y", length ? 1e6 : 1)});
    out += grid.text();
  }
  return out;
}

// The threshold is that of the study, and not the first Hopf point of the list: on a falling range that is another one.
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

std::string of_transfers(const io::StudySummary& s, const Values& v) {
  std::string out;
  for (const auto& [name, q] : s.values)
    if (name.ends_with(".difference"))
      out += fmt::format("  {}: at most {:.3g} of the matrix apart, at {} {}\n", name.substr(0, name.size() - 11),
                         q.value, v.cell(name + "_at"), v.unit(name + "_at"));
  Grid grid({"largest answer", "amplitude", "unit",
             fmt::format("at [{}]", s.values.empty() ? "" : v.unit(s.values[1].first))});
  for (const auto& [name, q] : s.values)
    if (name.ends_with(".largest"))
      grid.add({name.substr(0, name.size() - 8), v.cell(name), q.unit, v.cell(name + "_at")});
  return out + grid.text();
}

std::string of_bearing_map(const io::StudySummary& s, const Values& v) {
  std::string out;
  if (v.get("threshold.speed"))
    out += fmt::format(
        "  a rigid rotor of this load is stable up to {}, at eccentricity {}, and whirls at {} of the speed\n",
        with_uncertainty(*v.get("threshold.speed"), v.bar("threshold.speed"), "rad/s"),
        v.cell("threshold.eccentricity"), v.cell("threshold.whirl_ratio"));
  Grid grid({"Sommerfeld number", "eccentricity", "attitude [deg]", "speed limit", "whirl ratio"});
  for (const std::string& load : Values::between(s, "sommerfeld.", ".eccentricity")) {
    const std::string head = "sommerfeld." + load + ".";
    grid.add({load, v.cell(head + "eccentricity"), v.cell(head + "attitude", 180 / std::numbers::pi),
              v.cell(head + "speed_limit"), v.cell(head + "whirl_ratio")});
  }
  return out + grid.text();
}

// A row for each speed, frequency and enforced amplitude of the summary; tilts stand in the tables.
std::string of_coefficients(const io::StudySummary& s, const Values& v) {
  const std::vector<std::string> speeds = Values::between(s, "speed.", ".eccentricity");
  const std::string amplitude = ".amplitude.";
  const bool enforced = std::ranges::any_of(
      s.values, [&](const auto& named) { return named.first.find(amplitude) != std::string::npos; });
  const auto unit_of = [&](const std::string& speed) { return v.unit("speed." + speed + ".speed"); };
  // In the head where it is the same for all.
  const bool mixed =
      std::ranges::any_of(speeds, [&](const auto& other) { return unit_of(other) != unit_of(speeds.front()); });
  const std::string unit = speeds.empty() || mixed ? "" : " [" + unit_of(speeds.front()) + "]";
  std::vector<std::string> heads{"speed" + unit, "eccentricity", "omega/Omega"};
  if (enforced) heads.emplace_back("amplitude");
  for (const char* head : {"K xx [N/m]", "K xy", "K yx", "K yy", "C xx [N s/m]", "C xy", "C yx", "C yy"})
    heads.emplace_back(head);
  Grid grid(heads);
  for (const std::string& speed : speeds) {
    const std::string head = "speed." + speed + ".";
    for (const std::string& ratio : Values::between(s, head + "ratio.", ".K.xx")) {
      const std::size_t found = ratio.find(amplitude);
      std::vector<std::string> row{mixed ? speed + " " + unit_of(speed) : speed, v.cell(head + "eccentricity"),
                                   ratio.substr(0, found)};
      if (enforced) row.push_back(found == std::string::npos ? "small" : ratio.substr(found + amplitude.size()));
      for (const char* letter : {".K.", ".C."})
        for (const char* pair : {"xx", "xy", "yx", "yy"})
          row.push_back(v.cell(head + "ratio." + ratio + letter + pair));
      grid.add(std::move(row));
    }
  }
  return grid.text();
}

// Variants down, values across, those with bars first; the rest is in the tables.
std::string of_sweep(const io::StudySummary& s) {
  constexpr std::size_t most = 6;
  std::vector<const io::SweepColumn*> columns;
  for (const io::SweepColumn& c : s.columns) columns.push_back(&c);
  const auto has_bar = [](const io::SweepColumn* c) {
    return std::any_of(c->uncertainties.begin(), c->uncertainties.end(), [](double u) { return u > 0; });
  };
  std::stable_partition(columns.begin(), columns.end(), has_bar);
  const std::size_t shown = std::min(most, columns.size());
  std::vector<std::string> heads{"variant"};
  for (std::size_t c = 0; c < shown; ++c) {
    const bool bare = columns[c]->unit.empty() || columns[c]->unit == "1";
    heads.push_back(columns[c]->name + (bare ? "" : " [" + columns[c]->unit + "]"));
  }
  Grid grid(heads);
  // The columns begin with the deck as given if the sweep counts it.
  const std::size_t rows = columns.empty() ? 0 : columns.front()->values.size(), given = rows - s.variants.size();
  for (std::size_t i = 0; i < rows; ++i) {
    std::vector<std::string> row{i < given ? "as given" : s.variants[i - given].name};
    for (std::size_t c = 0; c < shown; ++c) {
      const double value = columns[c]->values[i];
      row.push_back(std::isfinite(value) ? with_uncertainty(value, columns[c]->uncertainties[i], "") : "-");
    }
    grid.add(std::move(row));
  }
  std::string out = grid.text();
  if (shown < columns.size())
    out += fmt::format("    and {} more values: see the report or the CSV table\n", columns.size() - shown);
  return out;
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
  const int size = -places(std::max(std::abs(value), uncertainty));
  if (size < -4 || size > 6) {
    const double unit_of_size = std::pow(10, size);
    return fmt::format("({})e{:+03d}{}", with_uncertainty(value / unit_of_size, uncertainty / unit_of_size, ""), size,
                       tail);
  }
  const int wanted = 1 + places(uncertainty);
  if (wanted > most) return fmt::format("{:.7g} +- {:.1g}{}", value, uncertainty, tail);
  const int decimals = std::max(0, wanted);
  return fmt::format("{:.{}f} +- {:.{}f}{}", value, decimals, uncertainty, decimals, tail);
}

std::string in_usual_unit(const io::Quantity& q) {
  const auto bar = q.more.find("uncertainty");
  const auto shown = [&](double value, double factor, const std::string& unit) {
    const io::Quantity there{factor * value, unit,
                             bar == q.more.end()
                                 ? std::map<std::string, double>{}
                                 : std::map<std::string, double>{{"uncertainty", factor * bar->second}}};
    return cell_of(there) + (unit.empty() ? "" : " " + unit);
  };
  if (q.unit == "m") return std::abs(q.value) < 0.01 ? shown(q.value, 1e6, "um") : shown(q.value, 1e3, "mm");
  if (q.unit == "Pa") return shown(q.value, 1e-6, "MPa");
  if (q.unit == "K") return shown(q.value - 273.15, 1, "degC");
  return shown(q.value, 1, q.unit == "1" ? "" : q.unit);
}

std::string highlights(const io::StudySummary& s) {
  const Values v(s);
  if (s.kind == "static") return of_static(s, v);
  if (s.kind == "alignment") return of_alignment(s, v);
  if (s.kind == "modes") return of_modes(s, v);
  if (s.kind == "unbalance_response") return of_response(s);
  if (s.kind == "equilibrium_branch") return of_equilibria(s, v);
  if (s.kind == "cycle_branch") return of_cycles(s, v);
  if (s.kind == "run_up") return of_run_up(s, v);
  if (s.kind == "motion") return of_motion(s, v);
  if (s.kind == "bearing_map") return of_bearing_map(s, v);
  if (s.kind == "dynamic_coefficients") return of_coefficients(s, v);
  if (s.kind == "frequency_response") return of_transfers(s, v);
  if (s.kind == "sweep") return of_sweep(s);
  return {};
}

}  // namespace whirl::app
