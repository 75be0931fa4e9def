#include "study/service_speeds.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/bars/unresolved.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/film/contract/options.hpp"

namespace whirl::study {

double error_at(const io::StudySummary& s, double speed) {
  double error = 0;
  const auto take = [&](double value, const std::string& unit, double bar) {
    if (std::abs(deck::number_to_si(value, unit) - speed) <= same_speed * speed && std::isfinite(bar))
      error = std::max(error, deck::number_to_si(bar, unit));
  };
  for (const io::Bifurcation& b : s.bifurcations) take(b.value, b.unit, b.uncertainty);
  for (const auto& [name, q] : s.values)
    if (name == "threshold" || between(name, "unstable.", ".from") || between(name, "unstable.", ".to"))
      take(q.value, q.unit, q.bar());
  return error;
}

std::vector<SpeedLimit> limits_of(const io::StudySummary& s) {
  std::vector<SpeedLimit> out;
  for (std::size_t k = 1; k < s.ranges.size(); ++k) {
    const io::StabilityRange &a = s.ranges[k - 1], &b = s.ranges[k];
    const bool grows_before = a.stability == "unstable", grows_behind = b.stability == "unstable";
    // Between stretches with a gap nothing was located.
    if (grows_before == grows_behind || std::abs(a.to - b.from) > same_speed * std::abs(a.to)) continue;
    const double at = deck::number_to_si(a.to, a.unit);
    out.push_back({at, error_at(s, at), grows_before ? b.to < b.from : a.from < a.to});
  }
  return out;
}

std::optional<Interpolated> at_speed(const std::vector<double>& speeds, const std::function<double(std::size_t)>& value,
                                     double speed, double slack) {
  std::optional<std::size_t> below, above;
  for (std::size_t k = 0; k < speeds.size(); ++k) {
    if (!std::isfinite(value(k))) continue;
    if (speeds[k] <= speed * (1 + same_speed) && (!below || speeds[k] > speeds[*below])) below = k;
    if (speeds[k] >= speed * (1 - same_speed) && (!above || speeds[k] < speeds[*above])) above = k;
  }
  if (!below && above && speeds[*above] - speed <= slack) below = above;
  if (!above && below && speed - speeds[*below] <= slack) above = below;
  if (!below || !above) return std::nullopt;
  const double a = speeds[*below], b = speeds[*above], w = b > a ? (speed - a) / (b - a) : 0;
  return Interpolated{(1 - w) * value(*below) + w * value(*above), a, b};
}

std::string between_words(const Interpolated& at, const std::string& unit) {
  if (at.above - at.below <= same_speed * at.above) return {};
  return fmt::format("between {:.6g} and {:.6g} {}, which were computed", deck::from_si(at.below, unit),
                     deck::from_si(at.above, unit), unit);
}

std::map<std::string, double> bar(double error) {
  return std::isfinite(error) && error > 0 ? std::map<std::string, double>{{"uncertainty", error}}
                                           : std::map<std::string, double>{};
}

const io::Quantity* find(const io::StudySummary& s, const std::string& name) {
  const auto at = std::ranges::find(s.values, name, [](const auto& v) { return v.first; });
  return at == s.values.end() || !std::isfinite(at->second.value) ? nullptr : &at->second;
}

std::size_t doubt::rank_of(const std::string& word) {
  const auto at = std::find(words.begin(), words.end(), word == "diverges" ? "unstable" : word);
  return at == words.end() ? undetermined : static_cast<std::size_t>(at - words.begin());
}

std::vector<ModesAt> modes_by_speed(const io::StudySummary& s) {
  std::map<double, ModesAt> by;
  for (const io::ModeEntry& m : s.modes) {
    if (m.stability == not_resolved) continue;
    const double speed = deck::number_to_si(m.speed, m.speed_unit);
    ModesAt& at = by[speed];
    at.speed = speed;
    at.worst = std::max(at.worst, doubt::rank_of(m.stability));
    if (m.imag == 0 || !std::isfinite(m.log_decrement) || at.decrement <= m.log_decrement) continue;
    const auto error = m.more.find("log_decrement_uncertainty");
    at.decrement = m.log_decrement;
    at.error = error == m.more.end() ? io::no_value : error->second;
  }
  std::vector<ModesAt> out;
  for (const auto& [speed, at] : by) out.push_back(at);
  return out;
}

std::optional<std::string> between(const std::string& name, const std::string& head, const std::string& tail) {
  if (name.size() <= head.size() + tail.size() || !name.starts_with(head) || !name.ends_with(tail)) return std::nullopt;
  return name.substr(head.size(), name.size() - head.size() - tail.size());
}

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
