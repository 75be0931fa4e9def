#include "service_vibration.hpp"

#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "study/service_speeds.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {

std::vector<io::ServiceFact> facts_of_cycles(const io::StudySummary& s, const io::Group& group, double speed) {
  std::vector<io::ServiceFact> facts;
  const double here = deck::from_si(speed, group.text("parameter_unit"));
  for (const auto& [name, q] : s.values) {
    constexpr std::string_view travel = ".peak_to_peak.", film = ".min_thickness.";
    const bool thin = name.find(film) != std::string::npos;
    const std::size_t place = name.find(thin ? film : travel);
    double at = 0;
    if (!name.starts_with("at.") || place == std::string::npos || q.unit != "m" || !std::isfinite(q.value)) continue;
    const auto [end, code] = std::from_chars(name.data() + 3, name.data() + place, at);
    if (code != std::errc() || end != name.data() + place || std::abs(at - here) > same_speed * here) continue;
    const std::string rest = name.substr(place + (thin ? film : travel).size());
    const std::size_t dot = thin ? rest.size() : rest.rfind('.');
    const std::string journal = rest.substr(0, dot);
    std::string mark = thin ? "least over a cycle" : "cycle, half of peak to peak in " + rest.substr(dot + 1);
    if (const io::Quantity* largest = find(s, name.substr(0, place) + ".multiplier.modulus")) {
      const double over = largest->value - 1, bar_of_it = largest->bar();
      mark += std::abs(over) <= bar_of_it ? ", whose stability is undetermined" : over > 0 ? ", which is unstable" : "";
    }
    if (thin)
      facts.push_back({"thinnest film", journal, q, mark, s.name});
    else
      facts.push_back({"largest vibration", journal, {q.value / 2, "m", bar(q.bar() / 2)}, mark, s.name});
  }
  return facts;
}

std::vector<io::ServiceFact> facts_of_motion(const io::StudySummary& s, const io::Group& group) {
  std::vector<io::ServiceFact> facts;
  for (const auto& [name, q] : s.values) {
    if (!name.starts_with("peak_to_peak.") || q.unit != "m" || !std::isfinite(q.value)) continue;
    const std::size_t dot = name.rfind('.'), head = std::string_view("peak_to_peak.").size();
    const std::string mark =
        fmt::format("motion in time ({}), half of peak to peak in {}",
                    group.has_attribute("motion") ? group.text("motion") : s.status, name.substr(dot + 1));
    facts.push_back({"largest vibration", name.substr(head, dot - head), {q.value / 2, "m"}, mark, s.name});
  }
  return facts;
}

std::vector<io::ServiceFact> facts_of_run_up(const io::StudySummary& s, const io::Group& group, double speed) {
  std::vector<io::ServiceFact> facts;
  const io::Group& table = group.group("run_up");
  const std::string& unit = table.dataset("speed").unit;
  std::vector<double> speeds;
  for (const double v : table.reals("speed")) speeds.push_back(deck::number_to_si(v, unit));
  if (speeds.size() < 2) return facts;
  const double slack = 1.01 * std::abs(speeds[speeds.size() - 1] - speeds[speeds.size() - 2]);
  const io::Quantity* grows = find(s, "operating_speed.unstable_count");
  for (const char* column : {"amplitude", "node_amplitude"}) {
    if (!table.has_dataset(column)) continue;
    const io::Dataset& data = table.dataset(column);
    const std::vector<double>& all = table.reals(column);
    const std::size_t places = data.shape.at(1);
    for (std::size_t p = 0; p < places; ++p) {
      const auto at = at_speed(
          speeds, [&](std::size_t k) { return all[k * places + p]; }, speed, slack);
      if (!at) continue;
      const auto in_start = at_speed(
          speeds, [&](std::size_t k) { return table.reals("start_transient")[k]; }, speed, slack);
      const std::string mark =
          fmt::format("0-peak, run-up at {:.4g} rad/s^2{}{}", group.real("acceleration"),
                      in_start && in_start->value > 0 ? ", with the free vibration of its start" : "",
                      grows && grows->value > 0 ? ", about an unstable equilibrium" : "");
      facts.push_back({"largest vibration", data.labels.at(0).at(p), {at->value, "m"}, mark, s.name});
    }
  }
  return facts;
}

}  // namespace whirl::study
