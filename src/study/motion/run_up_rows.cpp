#include "study/motion/run_up_rows.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "study/brief.hpp"
#include "study/motion/run_up.hpp"

namespace whirl::study {

std::vector<io::Table::Column> run_up_columns(const std::string& unit, const std::vector<std::string>& bearings,
                                              const std::vector<int>& nodes) {
  const auto wide = io::Table::wide;
  std::vector<io::Table::Column> all{
      {"revolution", "1", "since the beginning"},
      {"time", "s", "at its end"},
      {"speed", unit, "in its middle"},
      {"start_transient", "1", "1 while the free vibration of the start may be more than 5 % of the amplitude, else 0"},
      wide("amplitude", "m",
           "largest distance of the journal in this revolution from its mean position over the revolutions about it",
           bearings),
      wide("x_max", "m", "largest x of the journal relative to the bearing centre", bearings),
      wide("x_min", "m", "smallest", bearings),
      wide("y_max", "m", "largest y of the journal relative to the bearing centre", bearings),
      wide("y_min", "m", "smallest", bearings),
      wide("eccentricity_max", "1", "largest eccentricity per clearance; zero for a bearing without clearance",
           bearings),
      wide("film_min", "m", "thinnest film in this revolution; not a number where there is none", bearings)};
  if (!nodes.empty()) {
    const std::vector<std::string> names = io::node_labels(nodes);
    all.push_back(wide("node_amplitude", "m", "as `amplitude`, of the shaft's node", names));
    all.push_back(wide("node_x", "m", "half the travel of the node in x", names));
    all.push_back(wide("node_y", "m", "half the travel of the node in y", names));
  }
  return all;
}

void put_peaks(io::StudySummary& summary, const io::Table& table, const std::string& column,
               const std::vector<std::string>& names, const std::string& unit) {
  const auto& speed = table.column("speed");
  const auto& all = table.column(column);
  const auto& transient = table.column("start_transient");
  const auto settled = static_cast<std::size_t>(std::find(transient.begin(), transient.end(), 0.0) - transient.begin());
  for (std::size_t p = 0; p < names.size(); ++p) {
    const auto largest = [&](std::size_t from, std::size_t to) {
      std::size_t best = from;
      for (std::size_t k = from; k < to; ++k)
        if (all[k * names.size() + p] > all[best * names.size() + p]) best = k;
      return best;
    };
    const std::size_t best = settled < speed.size() ? largest(settled, speed.size()) : largest(0, speed.size());
    const std::size_t first = largest(0, std::min(settled, speed.size()));
    if (settled > 0 && all[first * names.size() + p] > all[best * names.size() + p])
      summary.warnings.push_back(fmt::format(
          "{}: {:.4g} um at {:.6g} {} is larger than the peak, but belongs to the start, whose free vibration fades "
          "until {:.6g} {}",
          names[p], 1e6 * all[first * names.size() + p], speed[first], unit, speed[settled], unit));
    summary.set(names[p] + ".peak.amplitude", all[best * names.size() + p], "m");
    summary.set(names[p] + ".peak.speed", speed[best], unit);
  }
}

void put_thinnest(io::StudySummary& summary, const io::Table& table, const std::vector<std::string>& names,
                  const std::string& unit) {
  const auto &films = table.column("film_min"), &speed = table.column("speed");
  const std::size_t n = names.size();
  for (std::size_t b = 0; b < n; ++b) {
    std::size_t best = 0;
    for (std::size_t k = 0; k < table.rows(); ++k)
      if (!(films[k * n + b] >= films[best * n + b])) best = k;
    if (!std::isfinite(films[best * n + b])) continue;
    const std::string head = "bearing." + names[b] + ".thinnest_film";
    summary.set(head, films[best * n + b], "m");
    summary.set(head + ".speed", speed[best], unit);
  }
}

io::Brief RunUp::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const Values v(result.summary);
  const std::vector<std::string> places = v.between("", ".peak.amplitude");
  const auto name = [](const std::string& place) {
    return place.starts_with("node.") ? "node " + place.substr(5) : place.substr(place.find('.') + 1);
  };
  const auto peak = [&](const std::string& place) { return v[place + ".peak.amplitude"]; };
  const auto top = std::ranges::max_element(places, {}, [&](const auto& p) { return peak(p).value; });
  if (top == places.end()) return {};
  const bool faded = std::ranges::find(result.summary.warnings, not_faded) == result.summary.warnings.end();
  io::BriefTable table{
      "Largest vibration on the way",
      {{"place"}, {"amplitude, 0-peak", "m"}, {"at", options.range.unit}},
      {},
      fmt::format("0-peak: largest distance from the mean position within a revolution; the free vibration of the "
                  "start is {}",
                  faded ? "left out" : "contained")};
  for (const std::string& p : places) table.rows.push_back({name(p), peak(p), v[p + ".peak.speed"]});
  const bool up = options.range.to > options.range.from;
  std::vector<std::string> sentences{
      fmt::format("The largest vibration on the way {} is {} 0-peak at {}, reached at {}.", up ? "up" : "down",
                  io::reading(peak(*top)), name(*top), io::reading(v[*top + ".peak.speed"]))};
  const std::vector<std::string> films = v.between("bearing.", ".thinnest_film");
  const auto film = [&](const std::string& bearing) { return v["bearing." + bearing + ".thinnest_film"]; };
  if (const auto least = std::ranges::min_element(films, {}, [&](const auto& b) { return film(b).value; });
      least != films.end())
    sentences.push_back(fmt::format("The thinnest film is {}, in {} at {}.", io::reading(film(*least)), *least,
                                    io::reading(v["bearing." + *least + ".thinnest_film.speed"])));
  return {std::move(sentences), {std::move(table)}};
}

}  // namespace whirl::study
