#include "study/sweep/verdict_words.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <regex>
#include <string_view>
#include <utility>
#include <vector>

namespace whirl::study {

namespace {

constexpr std::size_t most = 4;  // stretches, or speeds, that are named

StabilityWord found_in(std::string_view words) {
  const auto has = [&](std::string_view word) { return words.find(word) != std::string_view::npos; };
  if (words == "unstable" || words.starts_with("unstable throughout") || words.starts_with("unstable at the "))
    return StabilityWord::unstable;
  if (has("unstable") || has("loses stability")) return StabilityWord::in_part;
  if (has("undetermined")) return StabilityWord::undetermined;
  return has("undamped") ? StabilityWord::undamped : has("stable") ? StabilityWord::stable : StabilityWord::nothing;
}

std::string of_ranges(const std::vector<io::StabilityRange>& ranges) {
  const auto& first = ranges.front();
  if (std::ranges::all_of(ranges, [&](const auto& r) { return r.stability == first.stability; }))
    return first.stability + " throughout";
  std::string text;
  for (std::size_t k = 0; k < std::min(most, ranges.size()); ++k) {
    const auto& r = ranges[k];
    const bool joined = k > 0 && ranges[k - 1].to == r.from;
    text += fmt::format("{}{} {}{:.6g}", k == 0 ? "" : ", ", r.stability,
                        joined ? "to " : fmt::format("{:.6g} to ", r.from), r.to);
  }
  if (first.unit != "1") text += " " + first.unit;
  return ranges.size() > most ? text + fmt::format(", and {} more stretches", ranges.size() - most) : text;
}

// At a single speed, or at some.
VariantVerdict of_modes(const std::vector<io::ModeEntry>& modes) {
  std::vector<double> all, unstable;
  bool open = false, undamped = false;
  const auto note = [](std::vector<double>& speeds, double speed) {
    if (speeds.empty() || speeds.back() != speed) speeds.push_back(speed);
  };
  for (const io::ModeEntry& m : modes) {
    if (!m.more.contains("mode")) continue;  // of the shaft alone, without its bearings
    note(all, m.speed);
    if (m.stability == "unstable" || m.stability == "diverges") note(unstable, m.speed);
    open = open || m.stability == "undetermined";
    undamped = undamped || m.stability == "undamped";
  }
  if (all.empty()) return {};
  if (unstable.empty()) {
    const StabilityWord found = open       ? StabilityWord::undetermined
                                : undamped ? StabilityWord::undamped
                                           : StabilityWord::stable;
    return {found, name_of(found)};
  }
  if (unstable.size() == all.size()) return {StabilityWord::unstable, "unstable"};
  std::string text = "unstable at";
  for (std::size_t k = 0; k < std::min(most, unstable.size()); ++k)
    text += fmt::format("{} {:.6g}", k == 0 ? "" : ",", unstable[k]);
  text += " " + modes.front().speed_unit;
  if (unstable.size() > most) text += fmt::format(" and {} more speeds", unstable.size() - most);
  return {StabilityWord::in_part, text};
}

}  // namespace

const char* name_of(StabilityWord found) {
  switch (found) {
    case StabilityWord::stable:
      return "stable";
    case StabilityWord::undamped:
      return "undamped";
    case StabilityWord::undetermined:
      return "undetermined";
    case StabilityWord::no_result:
      return "no result";
    case StabilityWord::in_part:
      return "unstable in part";
    case StabilityWord::unstable:
      return "UNSTABLE";
    case StabilityWord::nothing:
      break;
  }
  return "-";
}

VariantVerdict verdict_of(const io::StudySummary& study) {
  // What ended early is not stable throughout, and its verdict knows that.
  const bool by_ranges = study.ranges.size() > 1 || (study.stability.empty() && !study.ranges.empty());
  const std::size_t by = study.stability.find(", by the ");  // ... speeds computed
  const std::string looked = by == std::string::npos ? "" : study.stability.substr(by);
  const std::string words = by_ranges ? of_ranges(study.ranges) + looked : study.stability;
  if (!words.empty()) return {found_in(words), words};
  VariantVerdict out = of_modes(study.modes);
  if (out.words.empty() && study.status != "completed" && study.values.empty())
    out = {StabilityWord::no_result, "no result: " + study.status};
  return out;
}

VariantVerdict verdict_of(std::span<const io::StudySummary> studies) {
  VariantVerdict out;
  std::string each;
  bool alike = true, stable = false;
  for (const io::StudySummary& s : studies) {
    const VariantVerdict one = verdict_of(s);
    if (one.words.empty()) continue;
    alike = alike && (out.words.empty() || one.words == out.words);
    stable = stable || one.found == StabilityWord::stable;
    each += fmt::format("{}{}: {}", each.empty() ? "" : "; ", s.name, one.words);
    out.found = std::max(out.found, one.found);
    if (out.words.empty()) out.words = one.words;
  }
  if (!alike) out.words = each;
  if (out.found == StabilityWord::unstable && stable) out.found = StabilityWord::in_part;
  return out;
}

bool answers(const std::string& value) {
  static const std::regex main(
      R"((^|.*\.)(threshold|whirl_frequency|contact|(hopf|fold|cyclic_fold|flip|neimark_sacker|branch_point)\.\d+|)"
      R"(critical\.\d+\.speed|load\.[^.]+|min_thickness|multiplier\.modulus|peak_to_peak\.[^.]+\.[xy]|)"
      R"(first_forward\.(frequency|log_decrement))|speed\.[0-9.]+\.(eccentricity|ratio\.1\.[KC]\.(xx|yy))|peak\.[1-3]\.(speed|semi_major|amplification_factor))");
  return std::regex_match(value, main);
}

std::string in_short(std::string value, const std::string& speed_unit) {
  // Of a film by itself: the number is a speed, and 1 the frequency over it.
  static const std::regex of_speed(R"(speed\.([0-9.]+)\.(?:ratio\.1\.)?(.*))");
  std::string speed;
  if (std::smatch found; std::regex_match(value, found, of_speed)) {
    speed = speed_unit.empty() ? " at speed " + found[1].str() : fmt::format(" at {} {}", found[1].str(), speed_unit);
    value = found[2].str();
  }
  const auto digit = [&](std::size_t k) {
    return k < value.size() && std::isdigit(static_cast<unsigned char>(value[k]));
  };
  for (std::size_t k = 0; k < value.size(); ++k)
    if (value[k] == '_' || (value[k] == '.' && !(k > 0 && digit(k - 1) && digit(k + 1)))) value[k] = ' ';
  for (const auto& [words, brief] : {std::pair{"amplification factor", "AF"},
                                     {"semi major", "0-peak"},
                                     {"peak to peak", "p-p"},
                                     {"first forward", "forward"},
                                     {"min thickness", "thinnest film"},
                                     {"eccentricity", "|e|/c"},
                                     {"log decrement", "log dec."},
                                     {"hopf", "Hopf"},
                                     {"neimark sacker", "Neimark-Sacker"}})
    if (const std::size_t at = value.find(words); at != std::string::npos)
      value.replace(at, std::string_view(words).size(), brief);
  if (value.starts_with("bearing ")) value.erase(0, std::string_view("bearing ").size());
  if (value.starts_with("load ")) value = value.substr(std::string_view("load ").size()) + " load";
  return value + speed;
}

std::string with_digits(const std::string& words, int digits) {
  static const std::regex decimal(R"(([0-9]+)\.[0-9]{4,}(?:e[+-]?[0-9]+)?)");
  std::string out;
  auto from = words.cbegin();
  for (std::sregex_iterator at(words.begin(), words.end(), decimal), end; at != end; ++at) {
    const int whole = static_cast<int>(at->length(1));
    out.append(from, (*at)[0].first);
    out += fmt::format("{:.{}g}", std::stod(at->str()), std::max(digits, whole));
    from = (*at)[0].second;
  }
  return out.append(from, words.cend());
}

}  // namespace whirl::study
