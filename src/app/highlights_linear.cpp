#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>

#include "highlights.hpp"
#include "whirl/study/linear/separation.hpp"

namespace whirl::app {
namespace {

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
  if (std::ranges::any_of(last, [](const io::ModeEntry& m) { return m.whirl == "either"; }))
    out += "    either: equal modes, any combination of which is a mode\n";
  if (shown < last.size()) out += fmt::format("    {} more stand in summary.json\n", last.size() - shown);
  if (const auto count = v.get("overdamped"); count && *count > 0)
    out += fmt::format(
        "    {:.0f} motions that decay without vibrating (damping ratio above 0.9) stand in the table "
        "'overdamped'\n",
        *count);
  return out;
}

// What a verdict on a margin says in a row; "-" where the margin is enough.
std::string mark_of(const std::string& verdict) {
  return verdict.empty() || verdict == "far enough" ? "-" : verdict == "too near" ? "TOO NEAR" : verdict;
}

// Beside the number of a mode.
std::string brief_whirl(const std::string& whirl) {
  return whirl == "forward" ? "fwd" : whirl == "backward" ? "bwd" : whirl;
}

}  // namespace

std::string of_modes(const io::StudySummary& s, const Values& v) {
  const std::vector<study::CriticalSpeed> criticals = study::critical_speeds_of(s);
  if (criticals.empty()) return last_modes(s, v);
  Grid grid({"critical", "[" + criticals.front().speed.unit + "]", "mode", "log dec.", "AF pi/delta", "margin %",
             "need %", "mark"});
  std::vector<std::vector<std::string>> damped;
  for (const study::CriticalSpeed& c : criticals) {
    const bool apart = c.verdict.starts_with("damped");
    std::vector<std::string> row{
        c.number,
        cell_of(c.speed),
        std::isfinite(c.mode.value) ? fmt::format("{:.0f} {}", c.mode.value, brief_whirl(c.whirl)) : "-",
        c.stability == "undamped" ? c.stability : brief_cell(c.log_decrement),
        brief_cell(c.amplification_factor),
        apart ? "-" : brief_cell(c.separation_margin, 100),
        apart ? "-" : brief_cell(c.required_margin, 100),
        c.stability == "unstable" ? "UNSTABLE" : mark_of(c.verdict)};
    if (apart)
      damped.push_back(std::move(row));
    else
      grid.add(std::move(row));
  }
  for (auto& row : damped) grid.add(std::move(row));
  std::string out = grid.text();
  if (std::ranges::find(criticals, study::not_excited, &study::CriticalSpeed::verdict) != criticals.end())
    out += in_lines(fmt::format("{}: backward whirl on circles, which unbalance does not excite on these supports",
                                study::not_excited),
                    4);
  return out;
}

namespace {

// What has to be known with a peak, in a few words.
std::string mark_of(const io::PeakEntry& p) {
  std::vector<std::string> marks;
  if (!p.stability.empty() && p.stability != "stable")
    marks.emplace_back(p.stability == "unstable" ? "UNSTABLE" : p.stability == "undamped" ? "undamped" : "stability?");
  if (const std::string margin = mark_of(p.verdict); margin != "-") marks.push_back(margin);
  return marks.empty() ? "-" : fmt::format("{}", fmt::join(marks, "; "));
}

// Head of the column of amplification factors of a response: N/(N2 - N1) between the points at half power.
constexpr const char* half_power = "AF (3 dB)";

// The peaks of one place by falling height, and below them what their notes say, each once.
std::string peaks_at(const std::string& place, const std::vector<io::PeakEntry>& own) {
  Grid grid({"peak at " + place, "[" + own.front().speed.unit + "]", "0-peak [um]", half_power, "margin %",
             "required %", "mark"});
  std::vector<std::pair<std::string, std::vector<std::size_t>>> notes;
  for (std::size_t k = 0; k < own.size(); ++k) {
    const io::PeakEntry& p = own[k];
    const bool damped = p.verdict.starts_with("damped");
    grid.add({fmt::format("{}", k + 1), cell_of(p.speed), cell_of(p.semi_major, 1e6),
              brief_cell(p.amplification_factor), brief_cell(p.separation_margin, 100),
              damped ? "-" : brief_cell(p.required_margin, 100), mark_of(p)});
    for (const std::string& note : p.notes) {
      const auto known = std::ranges::find(notes, note, [](const auto& n) { return n.first; });
      if (known == notes.end())
        notes.push_back({note, {k + 1}});
      else
        known->second.push_back(k + 1);
    }
  }
  std::string out = grid.text();
  for (const auto& [note, peaks] : notes) out += in_lines(fmt::format("{}: {}", fmt::join(peaks, ", "), note), 4);
  return out;
}

}  // namespace

// Peaks at nodes of the shaft. The report has the peaks of the journals, too.
std::string of_response(const io::StudySummary& s, std::span<const io::StudySummary> before) {
  std::string out;
  std::vector<std::string> places;
  for (const io::PeakEntry& p : s.peaks)
    if (p.place.starts_with("node ") && std::ranges::find(places, p.place) == places.end()) places.push_back(p.place);
  for (const std::string& place : places) {
    std::vector<io::PeakEntry> own;
    std::ranges::copy_if(s.peaks, std::back_inserter(own), [&](const io::PeakEntry& p) { return p.place == place; });
    out += peaks_at(place, own);
  }
  // Two studies of one run give two factors of one resonance.
  const auto has_factor = [](const auto& x) { return std::isfinite(x.amplification_factor.value); };
  const auto modes = std::ranges::find_if(
      before, [&](const io::StudySummary& b) { return std::ranges::any_of(study::critical_speeds_of(b), has_factor); });
  if (modes != before.end() && std::ranges::any_of(s.peaks, has_factor))
    out +=
        in_lines(fmt::format("AF (3 dB) is N/(N2 - N1) of this response at 0.707 of its peak; '{}' gives pi/delta of "
                             "the mode at fixed speed. They differ where the frequency of the mode changes with the "
                             "speed",
                             modes->name),
                 4);
  return out;
}

std::string of_transfers(const io::StudySummary& s, const Values& v) {
  std::string out;
  for (const auto& [name, q] : s.values)
    if (name.ends_with(".difference"))
      out += fmt::format("  {}: at most {:.3g} of the matrix apart, at {} {}\n", name.substr(0, name.size() - 11),
                         q.value, v.cell(name + "_at"), v.unit(name + "_at"));
  Grid grid({"largest answer", "amplitude", "unit",
             fmt::format("at [{}]", s.values.empty() ? "" : v.unit(s.values[1].first))});
  // The file of a run that goes on has null for infinity, too.
  const auto endless = [&](double value) {
    return std::isinf(value) || (std::isnan(value) && s.stability == "undamped");
  };
  for (const auto& [name, q] : s.values)
    if (name.ends_with(".largest"))
      grid.add({name.substr(0, name.size() - 8), endless(q.value) ? "without limit" : v.cell(name), q.unit,
                v.cell(name + "_at")});
  return out + grid.text();
}

}  // namespace whirl::app
