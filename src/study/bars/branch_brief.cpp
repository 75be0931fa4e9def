#include "study/bars/branch_brief.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include "study/bars/beyond.hpp"
#include "study/bars/error_bar.hpp"
#include "study/bifurcation.hpp"
#include "study/brief.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {
namespace {

using Type = io::BifurcationType;

io::Quantity with_bar(double value, double bar, const std::string& unit) {
  return {value, unit, {{"uncertainty", bar}}};
}

std::string place_of(const io::Bifurcation& b) {
  return io::reading(with_bar(b.value, b.uncertainty, b.unit));
}

// Frequency [Hz] of the motion that is born. At a fold it is the frequency of the cycle.
io::Quantity frequency_of(const io::Bifurcation& b) {
  const double omega = more_of(b, "whirl_frequency_rad_s"), bar = more_of(b, "uncertainty_whirl_frequency_rad_s");
  constexpr double turn = 2 * std::numbers::pi;
  if (std::isfinite(omega)) return with_bar(omega / turn, bar / turn, "Hz");
  if (!(b.period_s > 0)) return {};
  const double frequency = 1 / (b.type == Type::flip ? 2 * b.period_s : b.period_s);
  if (b.parameter != "speed") return {frequency, "Hz"};
  // Of a forced cycle, whose period is a number of turns of the shaft, it is as exact as the speed.
  const double turns = deck::number_to_si(b.value, b.unit) * b.period_s / turn;
  const bool forced = std::abs(turns - std::round(turns)) < 1e-6;
  return with_bar(frequency, forced ? frequency * std::abs(b.uncertainty / b.value) : io::no_value, "Hz");
}

// Per speed of the shaft, where that is the parameter; nothing of a fold of vibration at the speed itself.
io::Quantity ratio_of(const io::Bifurcation& b) {
  const io::Quantity f = frequency_of(b);
  if (b.parameter != "speed" || (b.type != Type::hopf && b.type != Type::cyclic_fold) || !std::isfinite(f.value))
    return {};
  const double ratio = f.value * 2 * std::numbers::pi / deck::number_to_si(b.value, b.unit);
  if (std::abs(ratio - 1) < 1e-6) return {};
  if (b.type == Type::cyclic_fold && !(f.bar() > 0)) return {ratio, "1"};
  return with_bar(ratio, ratio * (f.bar() / f.value + std::abs(b.uncertainty / b.value)), "1");
}

bool is_border(const io::Bifurcation& b) {
  return b.criticality == "supercritical" || b.criticality == "subcritical";
}

// The number whose sign is the criticality, where its bar leaves the sign open.
io::Quantity open_coefficient(const io::Bifurcation& b) {
  const double value = more_of(b, "criticality_coefficient"), bar = more_of(b, "criticality_uncertainty");
  if (b.criticality != "undetermined" || !std::isfinite(bar) || decided(value, bar)) return {};
  return with_bar(value, bar, "1");
}

// The sentence of the bifurcation, with what has to be known of it, and what is not known.
std::string meaning(const io::Bifurcation& b) {
  std::string words = b.sentence;
  if (words.empty() && more_of(b, "others_unstable") > 0) words = "another mode is unstable already";
  std::string reason = b.criticality_by;
  if (std::isfinite(open_coefficient(b).value))
    reason = "the sign of its coefficient decides, and the error bar contains zero. A finer mesh shortens the bar";
  if (b.criticality == "undetermined" && !reason.empty()) words += words.empty() ? reason : ". " + as_sentence(reason);
  return words;
}

// The one at which the stability of a branch changes at `place`; null: none that was asked for.
const io::Bifurcation* change_near(const io::StudySummary& s, double place) {
  const io::Bifurcation* nearest = nullptr;
  for (const io::Bifurcation& b : s.bifurcations) {
    // The Hopf point that cycles are born at is none of their own.
    if (more_of(b, "others_unstable") > 0 || (b.type == Type::hopf && s.kind == "cycle_branch")) continue;
    if (!nearest || std::abs(b.value - place) < std::abs(nearest->value - place)) nearest = &b;
  }
  if (!nearest) return nullptr;
  const double bar = std::isfinite(nearest->uncertainty) ? nearest->uncertainty : 0;
  return std::abs(nearest->value - place) <= std::max(bar, 1e-6 * std::abs(place)) ? nearest : nullptr;
}

bool grows(const JoinedStretch& s) {
  return s.stability == "unstable";
}

bool dies_out(const JoinedStretch& s) {
  return s.stability == "stable" || s.stability == "undamped";
}

std::string span(const JoinedStretch& s, const std::string& unit) {
  std::string text = s.turns.empty()
                         ? from_to(s.from, s.to, unit)
                         : fmt::format("from {} to {}", io::reading({s.from, unit}), io::reading({s.to, unit}));
  if (s.turns.size() == 1) text += fmt::format(" (turning at {})", io::reading({s.turns.front(), unit}));
  if (s.turns.size() > 1) text += fmt::format(" (turning {} times)", s.turns.size());
  return text;
}

// "stable from 500 to 600 rpm, then undetermined from 600 to 700 rpm".
std::string in_turn(const std::vector<JoinedStretch>& all, std::size_t count, const std::string& unit) {
  std::vector<std::string> parts;
  for (std::size_t k = 0; k < std::min(count, all.size()); ++k)
    parts.push_back(all[k].stability + " " + span(all[k], unit));
  return fmt::format("{}{}", fmt::join(parts, ", then "), count < all.size() ? ", and goes on as in the table" : "");
}

// "loses stability at 5025 +- 12 rpm (subcritical Hopf point), where whirl of 41.2 Hz begins, 0.49 of the speed".
std::string loss(const io::StudySummary& s, const JoinedStretch& last, const JoinedStretch& next,
                 const std::string& unit) {
  const char* what = last.stability == "undamped" ? "is undamped and becomes unstable" : "loses stability";
  if (last.to != next.from)
    return fmt::format("{} between {} and {}", what, io::reading({last.to, unit}), io::reading({next.from, unit}));
  const io::Bifurcation* b = change_near(s, last.to);
  if (!b) return fmt::format("{} at {}", what, io::reading({last.to, unit}));
  const double threshold = Values(s)["threshold"].value, here = deck::number_to_si(b->value, b->unit);
  const bool lowest = std::abs(threshold - here) <= 1e-9 * std::abs(here);
  std::string words = fmt::format("{} at {}{} ({}{})", what, lowest ? "the threshold " : "", place_of(*b),
                                  is_border(*b) ? b->criticality + " " : "", short_words_of(b->type));
  if (const io::Quantity f = frequency_of(*b); !b->born.empty() && std::isfinite(f.value))
    words += fmt::format(", where {} of {} begins", with_article(b->born), io::reading(f));
  if (const io::Quantity ratio = ratio_of(*b); std::isfinite(ratio.value))
    words += fmt::format(", {} of the speed", io::reading(ratio));
  if (const std::string more = meaning(*b); !more.empty()) words += ". " + as_sentence(more);
  return words;
}

// Where it is stable behind the first stretches.
std::string later(const std::vector<JoinedStretch>& all, std::size_t first, const std::string& unit) {
  constexpr std::size_t most = 4;
  std::vector<std::string> parts;
  bool again = false, folds = false;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (k >= first && all[k].stability == "stable") parts.push_back(span(all[k], unit));
    again = again || (k < first && all[k].stability == "stable");
    folds =
        folds || !all[k].turns.empty() || (k > 0 && (all[k].to - all[k].from) * (all[k - 1].to - all[k - 1].from) < 0);
  }
  if (parts.empty()) return {};
  const std::string head =
      fmt::format("{} is stable{}", folds ? "Further along the branch it" : "It", again ? " again" : "");
  if (parts.size() > most) return fmt::format("{} on {} stretches, which the table shows.", head, parts.size());
  return fmt::format("{} {}.", head, fmt::join(parts, " and "));
}

std::vector<std::string> on_stability(const io::StudySummary& s, const std::vector<JoinedStretch>& all,
                                      const std::string& what) {
  if (s.stability.empty() || all.empty()) return {};
  const std::string unit = s.ranges.front().unit, subject = "The " + what + " ";
  if (all.size() == 1 && all[0].stability == "undetermined")
    return {
        fmt::format("Whether the {} is stable is undetermined {}: the warnings say why.", what, span(all[0], unit))};
  if (all.size() == 1) return {fmt::format("{}is {}, {}.", subject, s.stability, span(all[0], unit))};
  if (s.stability.starts_with("stable or undamped"))
    return {fmt::format("{}is {}, {}: nothing grows.", subject, s.stability,
                        from_to(all.front().from, all.back().to, unit))};
  std::vector<std::string> open;
  for (const JoinedStretch& a : all)
    if (a.stability == "undetermined") open.push_back(span(a, unit));
  const std::string undetermined =
      open.empty() ? "" : fmt::format("Whether it is stable is undetermined {}.", fmt::join(open, " and "));
  if (grows(all[0]))
    return {fmt::format("{}is unstable from the start of the branch, {}.", subject, span(all[0], unit)), undetermined,
            later(all, 1, unit)};
  std::size_t k = 1;
  while (k < all.size() && !(grows(all[k]) && dies_out(all[k - 1]))) ++k;
  if (k == all.size())
    return {fmt::format("{}is {}.", subject, in_turn(all, 3, unit)),
            open.empty() ? "" : "The warnings say why it is undetermined.", later(all, 3, unit)};
  return {as_sentence(subject + loss(s, all[k - 1], all[k], unit)), undetermined, later(all, k + 1, unit)};
}

// The threshold of a speed, where the first sentence has another limit or none.
std::string threshold_of(const io::StudySummary& s, const std::string& said) {
  const Values v(s);
  const io::Quantity threshold = v["threshold"];
  if (!std::isfinite(threshold.value) || said.find("the threshold") != std::string::npos) return {};
  const auto at = std::ranges::find_if(s.bifurcations, [&](const io::Bifurcation& b) {
    return std::abs(deck::number_to_si(b.value, b.unit) - threshold.value) <= 1e-9 * threshold.value;
  });
  std::string text = fmt::format("The threshold is {}: the lowest speed at which stability is lost with rising speed",
                                 at == s.bifurcations.end() ? io::reading(threshold) : place_of(*at));
  if (at != s.bifurcations.end())
    if (const io::Quantity ratio = ratio_of(*at); std::isfinite(ratio.value))
      text += fmt::format("; {} of {} begins there, {} of the speed", with_article(at->born),
                          io::reading(frequency_of(*at)), io::reading(ratio));
  return text + ".";
}

io::BriefTable table_of_stretches(const io::StudySummary& s, const std::vector<JoinedStretch>& all) {
  constexpr std::size_t most = 12;
  if (all.size() < 2) return {};
  const std::string& unit = s.ranges.front().unit;
  io::BriefTable table{"Along the branch", {{"from", unit}, {"turns at", unit}, {"to", unit}, {"stability"}}, {}, {}};
  for (std::size_t k = 0; k < std::min(most, all.size()); ++k) {
    const JoinedStretch& a = all[k];
    io::BriefCell turns;
    if (a.turns.size() == 1) turns = io::Quantity{a.turns.front(), unit};
    if (a.turns.size() > 1) turns = fmt::format("{} places", a.turns.size());
    table.rows.push_back({io::Quantity{a.from, unit}, turns, io::Quantity{a.to, unit}, a.stability});
  }
  if (all.size() > most) table.note = fmt::format("{} more stretches stand in summary.json", all.size() - most);
  return table;
}

}  // namespace

std::vector<JoinedStretch> joined(const std::vector<io::StabilityRange>& ranges) {
  std::vector<JoinedStretch> out;
  double direction = 0;
  for (const io::StabilityRange& r : ranges) {
    const double way = r.to - r.from;
    if (!out.empty() && out.back().stability == r.stability && out.back().to == r.from) {
      if (way * direction < 0) out.back().turns.push_back(r.from);
      out.back().to = r.to;
    } else {
      out.push_back({r.from, r.to, r.stability, {}});
    }
    if (way != 0) direction = way;
  }
  return out;
}

const char* words_of(io::BifurcationType type) {
  switch (type) {
    case Type::fold:
      return "limit point (fold)";
    case Type::hopf:
      return "Hopf point";
    case Type::cyclic_fold:
      return "limit point of cycles (fold)";
    case Type::flip:
      return "flip (period doubling)";
    case Type::neimark_sacker:
      return "Neimark-Sacker point";
    case Type::branch_point:
      break;
  }
  return "branch point";
}

std::string short_words_of(io::BifurcationType type) {
  std::string words = words_of(type);
  words.resize(std::min(words.size(), words.find(" (")));
  return words;
}

std::string from_to(double from, double to, const std::string& unit) {
  std::string a = io::reading({from, unit});
  const std::string b = io::reading({to, unit});
  if (a == b) return "at " + a;
  const auto end = a.find(' '), other = b.find(' ');
  if (end != std::string::npos && other != std::string::npos && a.substr(end) == b.substr(other)) a.resize(end);
  return fmt::format("from {} to {}", a, b);
}

std::string as_sentence(std::string words) {
  if (words.empty()) return words;
  words.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(words.front())));
  return words.back() == '.' ? words : words + ".";
}

io::BriefTable table_of_bifurcations(const io::StudySummary& s) {
  if (s.bifurcations.empty()) return {};
  const io::Bifurcation& first = s.bifurcations.front();
  io::BriefTable table{
      "Bifurcations",
      {{"what"},
       {parameter_word(first.parameter), first.unit},
       {"frequency", "Hz"},
       {"of the speed", "1"},
       {"criticality"},
       {"coefficient"},
       {"error of the shaft's reduction", first.unit},
       {"what it means"}},
      {},
      "bar: film mesh, time mesh and location; frequency: of the motion that begins there (at a fold: of the cycle)"};
  for (const io::Bifurcation& b : s.bifurcations) {
    const bool side =
        (b.type == Type::fold || b.type == Type::cyclic_fold) && (b.criticality == "above" || b.criticality == "below");
    table.rows.push_back({words_of(b.type), with_bar(b.value, b.uncertainty, b.unit), frequency_of(b), ratio_of(b),
                          side ? "branch lies " + b.criticality : b.criticality, open_coefficient(b),
                          io::Quantity{more_of(b, "reduction_error"), b.unit}, meaning(b)});
  }
  return table;
}

io::BriefTable table_of_suspicions(const io::StudySummary& s) {
  if (s.suspected.empty()) return {};
  const std::string& unit = s.suspected.front().unit;
  io::BriefTable table{"Not resolved: bifurcations may lie here", {{"from", unit}, {"to", unit}, {"why"}}, {}, {}};
  for (const io::Suspicion& x : s.suspected)
    table.rows.push_back({io::Quantity{x.from, unit}, io::Quantity{x.to, unit}, x.reason});
  return table;
}

io::BriefTable table_of_ends(const io::Group& group) {
  if (!group.has_group("branch")) return {};
  const io::Group& branch = group.group("branch");
  if (!branch.has_dataset("x") || !branch.has_dataset("y")) return {};
  const io::Dataset& x = branch.dataset("x");
  const std::vector<double>&at = branch.reals("parameter"), &xs = branch.reals("x"), &ys = branch.reals("y");
  const auto away = [](double v) { return v != 0; };
  if (at.size() < 2 || x.labels.empty() || (std::ranges::none_of(xs, away) && std::ranges::none_of(ys, away)))
    return {};
  const std::string parameter = group.text("parameter"), unit = group.text("parameter_unit");
  const std::vector<std::string>& names = x.labels.front();
  io::BriefTable table{"At the ends of the branch", {{"place"}, {parameter_word(parameter), unit}}, {}, {}};
  for (const char* axis : {"x", "y"}) table.columns.push_back({axis, x.unit});
  double largest = 0;
  for (const auto* all : {&xs, &ys})
    for (const double v : *all) largest = std::max(largest, std::abs(v));
  // What is smaller is rounding.
  const auto place = [&](double v) { return io::Quantity{std::abs(v) < 1e-12 * largest ? 0.0 : v, x.unit}; };
  for (std::size_t b = 0; b < names.size(); ++b)
    for (const std::size_t k : {std::size_t{0}, at.size() - 1})
      table.rows.push_back(
          {names[b], io::Quantity{at[k], unit}, place(xs[k * names.size() + b]), place(ys[k * names.size() + b])});
  return table;
}

io::Brief brief_of_branch(const io::StudySummary& s, const std::string& what) {
  const std::vector<JoinedStretch> all = joined(s.ranges);
  const Values v(s);
  io::Brief brief{on_stability(s, all, what), {}};
  brief.tells_stability = !brief.sentences.empty();
  brief.sentences.push_back(threshold_of(s, brief.sentences.empty() ? "" : brief.sentences.front()));
  if (const auto count = v.get("solutions"); count && *count > 1)
    brief.sentences.push_back(
        fmt::format("At the start of the range {:.0f} solutions coexist; each has a branch of its own.", *count));
  brief.tables = {table_of_bifurcations(s), table_of_stretches(s, all), table_of_suspicions(s)};
  // A single one that the first sentence has explained is not explained again.
  if (s.bifurcations.size() == 1)
    if (const std::string words = as_sentence(meaning(s.bifurcations.front()));
        !words.empty() && brief.sentences.front().ends_with(words))
      brief.tables.front().rows.front().back() = {};
  return brief;
}

}  // namespace whirl::study
