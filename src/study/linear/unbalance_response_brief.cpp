// What a reader of `unbalance_response` wants to know first: its largest peak, and the peaks with their margins.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "study/linear/linear_brief.hpp"
#include "study/linear/separation.hpp"
#include "study/linear/unbalance_response.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {
namespace {

bool at_node(const io::PeakEntry& p) {
  return p.place.starts_with("node ");
}
bool has_no_limit(const io::PeakEntry& p) {
  return p.stability == "undamped";
}

// Whether the machine moves like that there: about a stable equilibrium, with a film left in every bearing, and higher
// than beside the peak by more than the bar.
bool is_answer(const io::PeakEntry& p) {
  return (p.stability.empty() || p.stability == "stable") && std::ranges::none_of(p.notes, [](const std::string& note) {
           return note.starts_with("no answer") || note.starts_with("undetermined");
         });
}

// What has to be known with a peak, in a few words. The margin of no motion deserves no verdict.
std::string mark_of(const io::PeakEntry& p) {
  std::vector<std::string> marks;
  if (!p.stability.empty() && p.stability != "stable")
    marks.emplace_back(p.stability == "unstable" ? "UNSTABLE" : has_no_limit(p) ? p.stability : "stability?");
  const bool moves = p.stability != "unstable";
  if (moves && p.verdict.starts_with("damped"))
    marks.emplace_back("damped");
  else if (moves && !p.verdict.empty())
    marks.push_back(margin_mark(p.verdict));
  if (std::ranges::any_of(p.notes, [](const auto& note) { return note.starts_with("no answer"); }))
    marks.emplace_back("no film left");
  return fmt::format("{}", fmt::join(marks, "; "));
}

// An undamped peak grows without limit; of one that is too narrow nothing is known.
io::BriefCell unless_narrow(const io::PeakEntry& p, const io::Quantity& q) {
  if (!std::isinf(q.value)) return q;
  return has_no_limit(p) ? io::BriefCell("without limit") : io::BriefCell();
}

// Peaks by place and falling height; what their notes say stands below, each once with the numbers of its peaks.
io::BriefTable peak_table(const std::vector<io::PeakEntry>& peaks, std::string caption) {
  io::BriefTable table{std::move(caption),
                       {{"peak"},
                        {"place"},
                        {"speed", peaks.empty() ? "" : peaks.front().speed.unit},
                        {"0-peak", "m"},
                        {"AF (3 dB)", "1"},
                        {"margin", "%"},
                        {"need", "%"},
                        {"verdict"}},
                       {},
                       {}};
  std::vector<std::pair<std::string, std::vector<std::size_t>>> notes;
  for (const io::PeakEntry& p : peaks) {
    const std::size_t number = table.rows.size() + 1;
    const bool damped = p.verdict.starts_with("damped"), bounded = !std::isinf(p.amplification_factor.value);
    table.rows.push_back({std::to_string(number), p.place.substr(0, p.place.find(", journal")), p.speed,
                          unless_narrow(p, p.semi_major),
                          bounded ? compact(p.amplification_factor) : unless_narrow(p, p.amplification_factor),
                          compact_percent(p.separation_margin),
                          damped ? io::BriefCell() : compact_percent(p.required_margin), mark_of(p)});
    for (const std::string& note : p.notes) {
      const auto known = std::ranges::find(notes, note, [](const auto& n) { return n.first; });
      if (known == notes.end())
        notes.push_back({note, {number}});
      else
        known->second.push_back(number);
    }
  }
  for (const auto& [note, numbers] : notes)
    table.note += fmt::format("{}{}: {}", table.note.empty() ? "" : "; ", fmt::join(numbers, ", "), note);
  return table;
}

// Of the journals the highest ones, and what is not far enough.
std::vector<io::PeakEntry> of_journals(const std::vector<io::PeakEntry>& peaks) {
  constexpr int most = 4;
  std::map<std::string, int> count;
  std::vector<io::PeakEntry> out;
  for (const io::PeakEntry& p : peaks)
    if (!at_node(p) && (++count[p.place] <= most || p.verdict == "too near" || p.verdict == "undetermined"))
      out.push_back(p);
  return out;
}

// "largest peak 23.20 +- 0.40 um at node 4, 3094.0 +- 1.2 rpm, amplification 12".
std::vector<std::string> of_peaks(const std::vector<io::PeakEntry>& peaks, const std::string& range) {
  std::vector<io::PeakEntry> known;
  std::ranges::copy_if(peaks, std::back_inserter(known), at_node);
  if (known.empty()) known = peaks;
  std::vector<std::string> out;
  const auto endless = std::ranges::find_if(known, has_no_limit);
  if (endless != known.end())
    out.push_back(fmt::format("undamped peak at {}, {}: the amplitude grows without limit there", endless->place,
                              io::reading(endless->speed)));
  std::vector<io::PeakEntry> found;
  std::ranges::copy_if(known, std::back_inserter(found),
                       [](const io::PeakEntry& p) { return is_answer(p) && std::isfinite(p.semi_major.value); });
  if (known.empty())
    out.push_back("no peak from " + range);
  else if (!found.empty()) {
    const io::PeakEntry& p = *std::ranges::max_element(found, {}, [](const auto& f) { return f.semi_major.value; });
    const io::Quantity& factor = p.amplification_factor;
    out.push_back(fmt::format("largest peak {} at {}, {}{}", io::reading(p.semi_major), p.place, io::reading(p.speed),
                              std::isfinite(factor.value) ? ", amplification " + factor_words(factor.value) : ""));
  } else if (endless == known.end())
    out.push_back(fmt::format("{} peak{}, none of which is known to be a motion of the machine", known.size(),
                              known.size() > 1 ? "s" : ""));
  // One resonance shows at many places, at speeds that differ a little.
  constexpr double same = 0.02;
  std::vector<double> speeds;
  for (const io::PeakEntry& p : peaks)
    if (p.verdict == "too near" && is_answer(p)) speeds.push_back(p.speed.value);
  std::ranges::sort(speeds);
  std::vector<std::string> near;
  for (std::size_t k = 0, first = 0; k < speeds.size(); ++k)
    if (k + 1 == speeds.size() || speeds[k + 1] > (1 + same) * speeds[k]) {
      const std::string low = fmt::format("{:.4g}", speeds[first]), high = fmt::format("{:.4g}", speeds[k]);
      near.push_back(low == high ? low : low + " to " + high);
      first = k + 1;
    }
  if (!near.empty()) out.push_back("too near the operating speed: " + in_words(near, 6, peaks.front().speed.unit));
  return out;
}

// Of a range without a peak the largest amplitude at its nodes, at speeds where the linear response is a motion.
std::string largest_amplitude(const io::Group& group, const std::string& unit) {
  if (!group.has_group("response")) return {};
  const io::Group& r = group.group("response");
  if (!r.has_dataset("semi_major") || !r.has_dataset("answer")) return {};
  const auto &speed = r.reals("speed"), &height = r.reals("semi_major");
  const auto &node = r.integers("node"), &answer = r.integers("answer");
  double most = 0;
  std::string where;
  for (std::size_t k = 0; k < speed.size(); ++k)
    for (std::size_t n = 0; n < node.size(); ++n)
      if (answer[k] > 0 && (!r.has_dataset("unstable_count") || r.integers("unstable_count")[k] == 0) &&
          height[k * node.size() + n] > most) {
        most = height[k * node.size() + n];
        where = fmt::format("at most {} at node {}, {}", io::reading({most, "m"}), node[n],
                            io::reading({deck::from_si(speed[k], unit), unit}));
      }
  return where;
}

// "unbalance g63: 2.366 kg mm, by its grade for a mass of 196.7 kg", of each that a grade gives.
std::vector<std::string> of_grades(const Values& v) {
  std::vector<std::string> out;
  for (const std::string& name : v.between("unbalance.", ".mass")) {
    double amount = 0;
    for (const std::string& plane : v.between("unbalance." + name + ".plane.", ""))
      amount += v["unbalance." + name + ".plane." + plane].value;
    out.push_back(fmt::format("unbalance {}: {} in all planes, by its grade for a mass of {}", name,
                              io::reading({amount, "kg m"}), io::reading(v["unbalance." + name + ".mass"])));
  }
  return out;
}

// Largest amplitude at the operating speed, and all of them.
struct Operating {
  std::string sentence = {};
  io::BriefTable table = {};
};
Operating at_operating_speed(const Values& v, const std::string& at) {
  Operating out;
  out.table = {"At " + at, {{"place"}, {"0-peak", "m"}}, {}, {}};
  std::string largest;
  io::Quantity most;
  for (const std::string& node : v.between("operating.node.", ".semi_major")) {
    const io::Quantity q = v["operating.node." + node + ".semi_major"];
    out.table.rows.push_back({"node " + node, q});
    if (!(q.value <= most.value)) most = q, largest = "node " + node;
  }
  for (const std::string& b : v.between("operating.bearing.", ".x"))
    for (const char* axis : {"x", "y"})
      out.table.rows.push_back({fmt::format("{}, {}", b, axis), v["operating.bearing." + b + "." + axis]});
  if (largest.empty()) return out;
  const double growing = v["operating_speed.unstable_count"].value;
  std::string doubt;
  if (v["operating_speed.answer"].value == 0)
    doubt = ", but a bearing is left too little film";
  else if (growing > 0)
    doubt = ", but the equilibrium is unstable there";
  else if (growing < 0)
    doubt = ", if the equilibrium is stable there, which is not known";
  out.sentence = fmt::format("at {}: at most {}, at {}{}", at, io::reading(most), largest, doubt);
  return out;
}

}  // namespace

io::Brief UnbalanceResponse::brief(const StudyResult& result, std::span<const io::StudySummary> before) const {
  const io::StudySummary& s = result.summary;
  if (!result.delivered || s.points == 0) return {};
  const Values v(s);
  const std::string& unit = options.range.unit;
  const auto [low, high] = std::minmax(options.range.from, options.range.to);
  io::Brief out{of_peaks(s.peaks, fmt::format("{} to {} {}", io::reading(deck::from_si(low, unit)),
                                              io::reading(deck::from_si(high, unit)), unit)),
                {}};
  std::vector<io::PeakEntry> nodes;
  std::ranges::copy_if(s.peaks, std::back_inserter(nodes), at_node);
  io::BriefTable table = peak_table(nodes, "Peaks of the response at the nodes");
  const auto say = [&](const std::string& words) {
    if (!words.empty()) table.note += (table.note.empty() ? "" : "; ") + words;
  };
  say("0-peak: semi-major axis of the orbit");
  say(margin_note(v));
  const auto has_factor = [](const auto& x) { return std::isfinite(x.amplification_factor.value); };
  std::string words = "AF (3 dB): N/(N2 - N1) of this response at 0.707 of its peak (API 684)";
  // Two studies of one run give two factors of one resonance.
  const auto modes = std::ranges::find_if(
      before, [&](const io::StudySummary& b) { return std::ranges::any_of(critical_speeds_of(b), has_factor); });
  if (modes != before.end() && std::ranges::any_of(s.peaks, has_factor))
    words += fmt::format(
        "; '{}' gives pi/delta of the mode at fixed speed. They differ where the frequency of the mode changes with "
        "the "
        "speed",
        modes->name);
  say(words);
  out.tables.push_back(std::move(table));
  out.tables.push_back(peak_table(of_journals(s.peaks), "Peaks of the journals in their bearings"));
  // That of the study, or the service speed.
  std::string at = options.operating_speed
                       ? io::reading(deck::from_si(options.operating_speed->value, options.operating_speed->unit)) +
                             " " + options.operating_speed->unit
                   : std::isfinite(v["operating_speed"].value) ? io::reading(v["operating_speed"])
                                                               : "";
  Operating operating = at_operating_speed(v, at.empty() ? "the service speed" : "the operating speed, " + at);
  if (s.peaks.empty() && operating.sentence.empty()) operating.sentence = largest_amplitude(result.group, unit);
  out.sentences.push_back(std::move(operating.sentence));
  out.tables.push_back(std::move(operating.table));
  for (std::string& grade : of_grades(v)) out.sentences.push_back(std::move(grade));
  return out;
}

}  // namespace whirl::study
