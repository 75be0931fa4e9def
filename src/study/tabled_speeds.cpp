#include "study/tabled_speeds.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "whirl/deck/units.hpp"
#include "whirl/film/contract/options.hpp"

namespace whirl::study {
namespace {

constexpr double same = 1e-9;  // of a speed
constexpr std::size_t least = 24;
constexpr long states_in_all = 100000;

}  // namespace

void put_between(std::vector<double>& speeds, double at) {
  const auto next = std::ranges::upper_bound(speeds, at);
  if (next != speeds.begin() && next != speeds.end() && at - next[-1] > same * at && *next - at > same * at)
    speeds.insert(next, at);
}

std::vector<double> tabled_speeds(const system::Machine& machine, double from, double to, std::size_t asked,
                                  long states, io::StudySummary& summary, const std::string& unit) {
  std::vector<double> all{std::min(from, to), std::max(from, to)};
  const auto look = [&all](const auto& table) {
    if (table.size() > 1)
      for (const auto& row : table) put_between(all, row.speed);
  };
  for (const system::Bearing& b : machine.bearings)
    if (const auto* film = film::find<film::Linear>(b.film)) look(film->table);
  for (const system::Element& e : machine.elements) look(e.table);
  all = {all.begin() + 1, all.end() - 1};
  const std::size_t rows = all.size(),
                    most = std::max({asked, least, static_cast<std::size_t>(states_in_all / states)});
  if (rows <= most) return all;
  std::vector<double> out;
  for (std::size_t k = 0; k < most; ++k) out.push_back(all[k * (rows - 1) / (most - 1)]);
  summary.warnings.push_back(
      fmt::format("tables of coefficients have {} rows between {:.6g} and {:.6g} {}, and the stability is looked at on "
                  "{} of them: a range of instability on others is missed. A narrower 'range' shows it",
                  rows, deck::from_si(std::min(from, to), unit), deck::from_si(std::max(from, to), unit), unit, most));
  return out;
}

}  // namespace whirl::study
