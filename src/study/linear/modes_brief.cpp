// What a reader of `modes` wants to know first: critical speeds with their margins, where the machine is unstable, and
// the modes at the last speed.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "study/bars/unresolved.hpp"
#include "study/linear/linear_brief.hpp"
#include "study/linear/modes.hpp"
#include "study/linear/separation.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {
namespace {

constexpr double hertz = 1 / (2 * std::numbers::pi);

io::Quantity in_hertz(const io::Quantity& q) {
  return scaled(q, hertz, "Hz");
}

std::optional<double> extra(const io::ModeEntry& m, const char* name) {
  const auto at = m.more.find(name);
  return at == m.more.end() || !std::isfinite(at->second) ? std::nullopt : std::optional(at->second);
}

io::Quantity with_bar(double value, const std::string& unit, std::optional<double> bar) {
  return {value, unit, bar ? std::map<std::string, double>{{"uncertainty", *bar}} : std::map<std::string, double>{}};
}

bool grows(const io::ModeEntry& m) {
  return m.stability == "unstable" || m.stability == "diverges";
}

io::Brief of_shaft_alone_brief(const io::StudySummary& s, const ModesOptions& options) {
  const Values v(s);
  const std::vector<std::string> numbers = v.between("frequency.", "");
  if (numbers.empty()) return {};
  const bool bends = options.motion == ModesOptions::Motion::bending;
  const std::string what = options.motion == ModesOptions::Motion::torsion ? "torsion"
                           : options.motion == ModesOptions::Motion::axial ? "motion along the shaft"
                           : options.supports == ModesOptions::Supports::pinned
                               ? "bending of the shaft, pinned at its supports"
                               : "bending of the free shaft";
  io::BriefTable table{fmt::format("Natural frequencies of {}", what),
                       {{"mode"}, {"frequency", "Hz"}},
                       {},
                       fmt::format("at rest, without damping{}", bends ? ", in one plane" : "")};
  for (const std::string& n : numbers) table.rows.push_back({n, in_hertz(v["frequency." + n])});
  return {
      {fmt::format("lowest natural frequency of {}: {}", what, io::reading(in_hertz(v["frequency." + numbers[0]])))},
      {std::move(table)}};
}

// Backward and forward whirl beside the number of a mode.
std::string brief_whirl(const std::string& whirl) {
  return whirl == "forward" ? "fwd" : whirl == "backward" ? "bwd" : whirl;
}

std::vector<io::BriefTable> critical_tables(const std::vector<CriticalSpeed>& all, const Values& v) {
  io::BriefTable critical{"Critical speeds: damped frequency equal to the speed",
                          {{"no."},
                           {"speed", all.front().speed.unit},
                           {"mode"},
                           {"log dec.", "1"},
                           {"AF", "1"},
                           {"margin", "%"},
                           {"need", "%"},
                           {"verdict"}},
                          {},
                          "AF = pi/log decrement of the mode, at fixed speed"};
  if (const std::string note = margin_note(v); !note.empty()) critical.note += "; " + note;
  io::BriefTable damped{"Damped, not critical: amplification factor below 2.5 (API 684)",
                        critical.columns,
                        {},
                        "no.: counted by speed over both tables"};
  for (const CriticalSpeed& c : all) {
    const bool apart = c.verdict.starts_with("damped"), undamped = c.stability == "undamped";
    std::vector<io::BriefCell> row{c.number, c.speed};
    row.emplace_back(std::isfinite(c.mode.value) ? fmt::format("{:.0f} {}", c.mode.value, brief_whirl(c.whirl)) : "");
    row.push_back(undamped ? io::BriefCell(c.stability) : compact(c.log_decrement));
    row.push_back(undamped ? io::BriefCell("without limit") : compact(c.amplification_factor));
    row.push_back(apart ? io::BriefCell() : compact_percent(c.separation_margin));
    row.push_back(apart ? io::BriefCell() : compact_percent(c.required_margin));
    row.emplace_back(c.stability == "unstable" ? "UNSTABLE" : margin_mark(c.verdict));
    (apart ? damped : critical).rows.push_back(std::move(row));
  }
  if (std::ranges::find(all, not_excited, &CriticalSpeed::verdict) != all.end())
    critical.note +=
        fmt::format("; {}: backward whirl on circles, which unbalance does not excite on these supports", not_excited);
  if (critical.rows.empty()) damped.note.clear();
  return {std::move(critical), std::move(damped)};
}

// "critical speeds with an amplification above 2.5: 1234 +- 5 and 2345 rpm".
std::vector<std::string> of_criticals(const std::vector<CriticalSpeed>& all, const std::string& range) {
  std::vector<std::string> known, growing, near, out;
  for (const CriticalSpeed& c : all) {
    const std::string at = io::reading(c.speed.value, c.speed.bar());
    if (c.stability == "unstable")
      growing.push_back(at);
    else if (!c.verdict.starts_with("damped"))
      known.push_back(at);
    if (c.verdict == "too near" && c.stability != "unstable") near.push_back(at);
  }
  const std::string unit = all.empty() ? "" : all.front().speed.unit;
  const auto say = [&](const std::vector<std::string>& speeds, const char* one, const char* several) {
    if (!speeds.empty())
      out.push_back(fmt::format("{}: {}", speeds.size() == 1 ? one : several, in_words(speeds, 6, unit)));
  };
  say(known, "critical speed with an amplification above 2.5", "critical speeds with an amplification above 2.5");
  if (known.empty())
    out.push_back(
        fmt::format("no critical speed{} found from {}", all.empty() ? "" : " with an amplification above 2.5", range));
  say(near, "too near the operating speed", "too near the operating speed");
  say(growing, "speed at the frequency of a mode that grows", "speeds at the frequencies of modes that grow");
  return out;
}

// "unstable up to 700 rpm and from 9572.6 +- 5.7 rpm", by the stretches of the range; the borders with their bars.
std::string of_ranges(const io::StudySummary& s, const Values& v) {
  if (s.ranges.empty()) return {};
  const auto border = [&](double at) {
    for (const std::string& k : v.between("unstable.", ".mode"))
      for (const char* end : {".from", ".to"}) {
        const io::Quantity q = v["unstable." + k + end];
        if (std::abs(q.value - at) <= 1e-9 * std::abs(at)) return io::reading(q.value, q.bar());
      }
    return io::reading(at);
  };
  const std::string unit = " " + s.ranges.front().unit;
  std::vector<std::string> sentences;
  for (const char* word : {"unstable", "undetermined"}) {
    std::vector<std::string> where;
    for (std::size_t k = 0; k < s.ranges.size(); ++k) {
      const io::StabilityRange& r = s.ranges[k];
      if (r.stability != word) continue;
      const bool first = k == 0, last = k + 1 == s.ranges.size();
      where.push_back(first && last    ? fmt::format("over the whole range, {} to {}", border(r.from), border(r.to))
                      : r.from == r.to ? "at " + border(r.from)
                      : first          ? "up to " + border(r.to)
                      : last           ? "from " + border(r.from)
                                       : fmt::format("from {} to {}", border(r.from), border(r.to)));
    }
    if (where.empty()) continue;
    const bool known = std::string_view(word) == "unstable";
    sentences.push_back((known ? "unstable " : "it is not known whether the machine is stable ") + in_words(where, 4) +
                        unit);
  }
  return in_words(sentences);
}

// Some modes, or all, neither decay nor grow.
std::string of_undamped(const io::StudySummary& s) {
  const auto count = [&](const char* word) { return std::ranges::count(s.modes, word, &io::ModeEntry::stability); };
  const auto undamped = count("undamped"), all = static_cast<long>(s.modes.size()) - count(not_resolved);
  return undamped == 0 ? "" : undamped == all ? "no mode found has damping" : "some modes are undamped";
}

// What is known at one speed of the list.
std::string of_speed(const io::StudySummary& s, const Values& v, const std::string& speed) {
  const std::string head = "at." + speed + ".";
  const std::string unit = s.modes.front().speed_unit;
  const double growing = v[head + "unstable"].value;
  if (growing > 0)
    return fmt::format("unstable at {} {}: {:.0f} mode{}", speed, unit, growing, growing > 1 ? "s grow" : " grows");
  std::vector<std::string> found;
  for (const io::ModeEntry& m : s.modes)
    if (m.stability != not_resolved && fmt::format("{:.6g}", m.speed) == speed) found.push_back(m.stability);
  if (!found.empty() && std::ranges::count(found, "undamped") == static_cast<long>(found.size()))
    return fmt::format("at {} {} no mode found has damping", speed, unit);
  std::string text = std::ranges::count(found, "undetermined") > 0
                         ? fmt::format("at {} {} it is not known whether a mode grows", speed, unit)
                         : fmt::format("at {} {} no mode found grows", speed, unit);
  const io::Quantity f = in_hertz(v[head + "least_damped.frequency"]), d = v[head + "least_damped.log_decrement"];
  if (!(f.value > 0) || !std::isfinite(d.value)) return text;
  return text + (d.value == 0 ? fmt::format("; the one of {} is undamped", io::reading(f))
                              : fmt::format("; the least damped one has {} and a log decrement of {}", io::reading(f),
                                            io::reading(d)));
}

// Over the speeds of a list: the first forward mode and the least damped one.
io::BriefTable over_speeds(const Values& v, const std::vector<std::string>& speeds, const std::string& unit) {
  io::BriefTable table{"Over the speed: the first mode of forward whirl, and the least damped mode",
                       {{"speed [" + unit + "]"},
                        {"forward", "Hz"},
                        {"log dec. fwd", "1"},
                        {"least damped", "Hz"},
                        {"log dec.", "1"},
                        {"modes that grow", "1"}},
                       {},
                       {}};
  for (const std::string& speed : speeds) {
    const std::string head = "at." + speed + ".";
    table.rows.push_back({speed, in_hertz(v[head + "first_forward.frequency"]), v[head + "first_forward.log_decrement"],
                          in_hertz(v[head + "least_damped.frequency"]), v[head + "least_damped.log_decrement"],
                          v[head + "unstable"]});
  }
  return table;
}

// Where modes grow over a range.
io::BriefTable unstable_table(const Values& v) {
  io::BriefTable table{
      "Unstable speeds",
      {{"mode"}, {"from", v["unstable.1.from"].unit}, {"to", v["unstable.1.from"].unit}, {"frequency", "Hz"}},
      {},
      "a stretch that begins or ends with the speeds of the study may go on"};
  for (const std::string& k : v.between("unstable.", ".mode")) {
    const std::string head = "unstable." + k + ".";
    table.rows.push_back({fmt::format("{:.0f}", v[head + "mode"].value), v[head + "from"], v[head + "to"],
                          in_hertz(v[head + "frequency"])});
  }
  if (const double count = v["unstable.count"].value; count > static_cast<double>(table.rows.size()))
    table.note += fmt::format("; {:.0f} more in the table 'unstable'", count - static_cast<double>(table.rows.size()));
  return table;
}

// Of many modes all that grow and the lowest of the others.
io::BriefTable last_modes(const io::StudySummary& s, const Values& v) {
  constexpr std::size_t most = 10;
  std::vector<io::ModeEntry> last;
  for (const io::ModeEntry& m : s.modes)
    if (m.speed == s.modes.back().speed) last.push_back(m);
  io::BriefTable table{fmt::format("Modes at {}", io::reading({last.front().speed, last.front().speed_unit})),
                       {{"mode"},
                        {"frequency", "Hz"},
                        {"log dec.", "1"},
                        {"damping ratio", "1"},
                        {"whirl"},
                        {"condition", "1"},
                        {"verdict"}},
                       {},
                       {}};
  bool either = false, conditioned = false;
  for (std::size_t k = 0; k < last.size(); ++k) {
    const io::ModeEntry& m = last[k];
    const bool moves = m.imag > 0;
    if (!grows(m) && table.rows.size() >= most) continue;
    either = either || m.whirl == "either";
    auto& row = table.rows.emplace_back();
    row.emplace_back(fmt::format("{:.0f}", extra(m, "mode").value_or(static_cast<double>(k + 1))));
    row.push_back(moves ? in_hertz(with_bar(m.imag, "rad/s", extra(m, "imag_uncertainty"))) : io::Quantity{});
    row.push_back(moves ? compact(with_bar(m.log_decrement, "1", extra(m, "log_decrement_uncertainty")))
                        : io::BriefCell());
    const auto ratio = extra(m, "damping_ratio");
    row.push_back(ratio ? to_digits({*ratio, "1"}, 4) : io::Quantity{});
    row.emplace_back(moves ? m.whirl : "");
    const auto condition = extra(m, "condition");
    conditioned = conditioned || condition;
    row.push_back(condition ? io::BriefCell(to_digits({*condition, "1"}, 3)) : io::BriefCell());
    row.emplace_back(m.stability == "stable"     ? ""
                     : m.stability == "unstable" ? "UNSTABLE"
                     : moves                     ? m.stability
                                                 : fmt::format("diverges, s = +{:.4g} 1/s", m.real));
  }
  std::vector<std::string> notes;
  if (conditioned) notes.emplace_back("condition: 1 is best; it multiplies relative errors of the matrices");
  if (const auto error = v.get("reduction.largest_error"); error && *error > 0)
    notes.push_back(
        fmt::format("the bars leave out the reduction of the shaft, which changes these eigenvalues by up to {}",
                    io::reading(to_digits(in_hertz({*error, "rad/s"}), 2))));
  if (either) notes.emplace_back("either: equal modes, any combination of which is a mode");
  if (const auto count = std::ranges::count(last, not_resolved, &io::ModeEntry::stability); count > 0)
    notes.push_back(
        fmt::format("{} not resolved: vibration{} of single elements of the shaft, which decide{} on nothing", count,
                    count > 1 ? "s" : "", count > 1 ? "" : "s"));
  if (table.rows.size() < last.size())
    notes.push_back(fmt::format("{} more stand in summary.json", last.size() - table.rows.size()));
  if (const auto count = v.get("overdamped"); count && *count > 0)
    notes.push_back(fmt::format(
        "{:.0f} more decay without vibration (damping ratio above 0.9): see the table 'overdamped'", *count));
  for (const std::string& n : notes) table.note += (table.note.empty() ? "" : "; ") + n;
  return table;
}

}  // namespace

io::Brief Modes::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const io::StudySummary& s = result.summary;
  if (!result.delivered) return {};
  if (s.modes.empty()) return {{"no mode found"}, {}};
  if (of_shaft_alone(options)) return of_shaft_alone_brief(s, options);
  const Values v(s);
  io::Brief out;
  if (options.range) {
    const auto [low, high] = std::minmax(options.range->from, options.range->to);
    const std::string& unit = options.range->unit;
    const std::vector<CriticalSpeed> criticals = critical_speeds_of(s);
    out.sentences = of_criticals(criticals, fmt::format("{} to {} {}", io::reading(deck::from_si(low, unit)),
                                                        io::reading(deck::from_si(high, unit)), unit));
    out.sentences.push_back(of_ranges(s, v));
    out.sentences.push_back(of_undamped(s));
    if (!criticals.empty()) out.tables = critical_tables(criticals, v);
    out.tables.push_back(unstable_table(v));
  } else {
    const std::vector<std::string> speeds = v.between("at.", ".unstable");
    constexpr std::size_t few = 3;
    std::vector<std::string> growing;
    for (const std::string& speed : speeds)
      if (v["at." + speed + ".unstable"].value > 0) growing.push_back(speed);
    if (speeds.size() <= few)
      for (const std::string& speed : speeds) out.sentences.push_back(of_speed(s, v, speed));
    else if (growing.size() == speeds.size())
      out.sentences.push_back(fmt::format("unstable at all {} speeds", speeds.size()));
    else if (!growing.empty())
      out.sentences.push_back("unstable at " + in_words(growing, 6, s.modes.front().speed_unit));
    else
      out.sentences.push_back(fmt::format("no mode found grows for sure at any of the {} speeds", speeds.size()));
    if (speeds.size() > few) out.sentences.push_back(of_undamped(s));
    if (speeds.size() > 1) out.tables.push_back(over_speeds(v, speeds, s.modes.front().speed_unit));
    if (speeds.size() > 1)
      out.sentences.emplace_back("Critical speeds are searched over a 'range', not between single 'speeds'.");
  }
  out.tables.push_back(last_modes(s, v));
  return out;
}

}  // namespace whirl::study
