#include "study/sweep/value_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <regex>
#include <string_view>
#include <utility>

namespace whirl::study {

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
