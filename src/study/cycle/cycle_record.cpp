#include "study/cycle/cycle_record.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/bars/film_limit.hpp"
#include "study/bars/mesh_wave.hpp"
#include "study/packed.hpp"
#include "whirl/core/error.hpp"

namespace whirl::study {
namespace {

constexpr int samples_per_orbit = 128;

struct Extremes {
  std::vector<double> x_max, x_min, y_max, y_min, radius;
};

// What is shown of all places at `count` equidistant times: [time][place][x, y].
std::vector<double> sample(const CycleOrbit& orbit, int count) {
  std::vector<double> out;
  StateRows states(orbit.system);
  for (int k = 0; k < count; ++k)
    for (const auto& j : states.shown(orbit.at(static_cast<double>(k) / count))) {
      out.push_back(j.position[0]);
      out.push_back(j.position[1]);
    }
  return out;
}

// Largest value of a periodic signal by the parabola through the largest sample and its neighbours.
template <class Signal>
double peak(std::size_t n, const Signal& signal) {
  const auto value = [&](std::size_t k) { return signal(k % n); };
  std::size_t best = 0;
  for (std::size_t k = 1; k < n; ++k)
    if (value(k) > value(best)) best = k;
  const double a = value(best + n - 1), b = value(best), c = value(best + 1), curvature = a - 2 * b + c;
  return curvature < 0 ? b - (a - c) * (a - c) / (8 * curvature) : b;
}

Extremes extremes(const std::vector<double>& motion, std::size_t bearings) {
  Extremes e;
  const std::size_t n = motion.size() / (2 * bearings);
  for (std::size_t i = 0; i < bearings; ++i) {
    const auto x = [&](std::size_t k) { return motion[(k * bearings + i) * 2]; };
    const auto y = [&](std::size_t k) { return motion[(k * bearings + i) * 2 + 1]; };
    e.x_max.push_back(peak(n, x));
    e.x_min.push_back(-peak(n, [&](std::size_t k) { return -x(k); }));
    e.y_max.push_back(peak(n, y));
    e.y_min.push_back(-peak(n, [&](std::size_t k) { return -y(k); }));
    e.radius.push_back(peak(n, [&](std::size_t k) { return std::hypot(x(k), y(k)); }));
  }
  return e;
}

std::vector<io::Table::Column> columns(const system::ShownPlaces& places, const std::string& unit,
                                       std::size_t multipliers) {
  const std::vector<std::string>&b = places.names, m = io::numbered(multipliers, {});
  const std::string& length = places.unit;
  const auto wide = io::Table::wide;
  return {
      {"parameter", unit, "parameter of the branch"},
      {"period", "s", "period of the cycle"},
      {"stable", "1", "1 if no multiplier is outside the unit circle; not a number where they are unknown"},
      {"unstable_count", "1", "multipliers outside the unit circle; -1 where they are unknown"},
      {"mesh_waves", "1", "of a film's mesh that grow, pairs of multipliers outside the unit circle that are left out"},
      {"step", unit, "arclength from the previous point"},
      {"newton_iterations", "1", "of the accepted step"},
      {"intervals", "1", "of the time mesh"},
      wide("x_max", length, "largest x of " + places.text, b),
      wide("x_min", length, "smallest", b),
      wide("y_max", length, "largest y of " + places.text, b),
      wide("y_min", length, "smallest", b),
      wide("eccentricity_max", "1", "largest eccentricity per clearance; zero where there is no clearance", b),
      wide(
          "film_min", length,
          "smallest film thickness over the cycle, at mid-plane of films that do not tilt, not a number without a film",
          b),
      wide("multipliers_real", "1", "leading Floquet multipliers, the largest first; not a number: beyond those found",
           m),
      wide("multipliers_imag", "1", "their imaginary parts", m)};
}

std::vector<io::Table::Column> columns_of_birth(const system::ShownPlaces& places, const std::string& unit) {
  std::vector<io::Table::Column> some;
  for (auto& c : columns(places, unit, 0))
    if (c.name == "parameter" || c.name == "period" || c.name == "eccentricity_max" || c.name.ends_with("_max") ||
        c.name.ends_with("_min"))
      some.push_back(c);
  return some;
}

}  // namespace

CycleRecord::CycleRecord(system::ShownPlaces places, std::string unit, int multipliers)
    : places_(std::move(places)),
      unit_(std::move(unit)),
      multipliers_(multipliers),
      table_(columns(places_, unit_, static_cast<std::size_t>(multipliers))),
      birth_(columns_of_birth(places_, unit_)),
      closing_(birth_) {}

std::vector<double> CycleRecord::per_clearance(const std::vector<double>& radius) const {
  std::vector<double> eccentricity(places_.names.size(), 0.0);
  for (std::size_t i = 0; i < eccentricity.size(); ++i)
    if (places_.clearances[i] > 0) eccentricity[i] = radius[i] / places_.clearances[i];
  return eccentricity;
}

void CycleRecord::keep(io::Table& end, const CycleOrbit& orbit, double scale) const {
  const Extremes e = extremes(sample(orbit, samples_per_orbit), places_.names.size());
  end.append({{orbit.cycle.parameter / scale},
              {orbit.cycle.period},
              e.x_max,
              e.x_min,
              e.y_max,
              e.y_min,
              per_clearance(e.radius),
              film_column(least_films(orbit.cycle, orbit.system), places_.names.size())});
}

void CycleRecord::begin(const CycleOrbit& orbit, double scale) {
  keep(birth_, orbit, scale);
}

void CycleRecord::close(const CycleOrbit& orbit, double scale) {
  keep(closing_, orbit, scale);
}

void CycleRecord::drop_last() {
  if (orbits_.empty()) return;
  orbits_.pop_back();
  table_.truncate(orbits_.size());
}

void CycleRecord::append(const solve::BranchPoint& point, const CycleOrbit& orbit, double scale) {
  std::vector<double> motion = sample(orbit, samples_per_orbit);
  const Extremes e = extremes(motion, places_.names.size());
  // Only so many were searched for, and zero would be a multiplier.
  std::vector<double> re(static_cast<std::size_t>(multipliers_), std::numeric_limits<double>::quiet_NaN()), im = re;
  for (std::size_t k = 0; k < re.size() && k < point.stability.values.size(); ++k) {
    re[k] = point.stability.values[k].real();
    im[k] = point.stability.values[k].imag();
  }
  const int unstable = point.stability.unstable();
  const bool unknown = point.stability.unknown;
  table_.append({{orbit.cycle.parameter / scale},
                 {orbit.cycle.period},
                 {unknown         ? io::no_value
                  : unstable == 0 ? 1.0
                                  : 0.0},
                 {unknown ? -1.0 : static_cast<double>(unstable)},
                 {static_cast<double>(point.stability.mesh_waves.size())},
                 {point.step},
                 {static_cast<double>(point.newton_iterations)},
                 {static_cast<double>(orbit.cycle.intervals())},
                 e.x_max,
                 e.x_min,
                 e.y_max,
                 e.y_min,
                 per_clearance(e.radius),
                 film_column(least_films(orbit.cycle, orbit.system), places_.names.size()),
                 re,
                 im});
  orbits_.push_back(std::move(motion));
}

std::vector<std::vector<double>> CycleRecord::drawn(const CycleOrbit& orbit) const {
  const Extremes e = extremes(sample(orbit, samples_per_orbit), places_.names.size());
  std::vector<std::vector<double>> axes;
  for (std::size_t i = 0; i < e.radius.size(); ++i) {
    axes.push_back({e.x_max[i], e.x_min[i]});
    axes.push_back({e.y_max[i], e.y_min[i]});
  }
  return axes;
}

double CycleRecord::eccentricity(const CycleOrbit& orbit) const {
  const auto radii = per_clearance(extremes(sample(orbit, samples_per_orbit), places_.names.size()).radius);
  return radii.empty() ? 0.0 : std::ranges::max(radii);
}

double CycleRecord::modulus(int point) const {
  const auto k = static_cast<std::size_t>(point) * static_cast<std::size_t>(multipliers_);
  return std::hypot(table_.column("multipliers_real")[k], table_.column("multipliers_imag")[k]);
}

BranchVerdict CycleRecord::verdict() const {
  BranchVerdict verdict;
  for (std::size_t k = 0; k < table_.rows(); ++k) {
    const int count = static_cast<int>(table_.column("unstable_count")[k]), unstable = std::max(count, 0);
    verdict.add(table_.column("parameter")[k], unstable > 0 ? StabilityClass::unstable : StabilityClass::stable,
                unstable);
    if (count < 0 || table_.column("mesh_waves")[k] > 0) verdict.unresolved(static_cast<int>(k));
  }
  return verdict;
}

void CycleRecord::warn_of_waves(io::StudySummary& summary) const {
  MeshWaves waves;
  for (std::size_t k = 0; k < table_.rows(); ++k)
    waves.add(table_.column("parameter")[k],
              std::vector<std::complex<double>>(static_cast<std::size_t>(table_.column("mesh_waves")[k])));
  waves.warn(summary, unit_);
}

void CycleRecord::warn_of_unknown(io::StudySummary& summary) const {
  const auto &at = table_.column("parameter"), &count = table_.column("unstable_count");
  std::vector<double> places;
  for (std::size_t k = 0; k < table_.rows(); ++k)
    if (count[k] < 0) places.push_back(at[k]);
  if (places.empty()) return;
  const auto [least, most] = std::ranges::minmax(places);
  const std::string where =
      least == most ? fmt::format("{:.6g} {}", least, unit_) : fmt::format("{:.6g} to {:.6g} {}", least, most, unit_);
  summary.warnings.push_back(fmt::format(
      "the search for multipliers did not converge at {} of {} points, {}: whether the motion is stable there is not "
      "known (-monodromy_products)",
      places.size(), table_.rows(), where));
}

bool CycleRecord::one_sided() const {
  const auto& stable = table_.column("stable");
  return std::all_of(stable.begin(), stable.end(), [&](double s) { return s == stable.front(); });
}

int CycleRecord::passes(double parameter) const {
  const auto& at = table_.column("parameter");
  int times = 0;
  for (std::size_t k = 1; k < at.size(); ++k) times += (at[k - 1] < parameter) != (at[k] < parameter) ? 1 : 0;
  return times;
}

void CycleRecord::report(const std::string& key, const CycleOrbit& orbit, const solve::Stability& stability,
                         io::StudySummary& summary) {
  const Extremes e = extremes(sample(orbit, 4 * samples_per_orbit), places_.names.size());
  const std::vector<double> films = film_column(least_films(orbit.cycle, orbit.system), places_.names.size());
  const std::string head = "at." + key + ".";
  for (std::size_t i = 0; i < places_.names.size(); ++i) {
    summary.set(head + "peak_to_peak." + places_.names[i] + ".x", e.x_max[i] - e.x_min[i], places_.unit);
    summary.set(head + "peak_to_peak." + places_.names[i] + ".y", e.y_max[i] - e.y_min[i], places_.unit);
    if (std::isfinite(films[i])) summary.set(head + "min_thickness." + places_.names[i], films[i], places_.unit);
  }
  if (!stability.values.empty()) {
    summary.set(head + "multiplier.modulus", std::abs(stability.values.front()), "1");
    summary.set(head + "multiplier.angle", std::abs(std::arg(stability.values.front())), "rad");
  }
  summary.set(head + "period", orbit.cycle.period, "s");
  if (!reported(key)) reported_.push_back(key);
}

void CycleRecord::write(io::Group& group, bool everything) const {
  table_.write(group.child("branch"));
  if (birth_.rows() > 0) birth_.write(group.child("birth"));
  if (closing_.rows() > 0) closing_.write(group.child("closing"));
  if (!everything) return;
  put_packed(group, "orbits", orbits_, "what is shown of every point");
  put_packed(group, "reported", reported_, "parameters already reported");
}

void CycleRecord::read(const io::Group& group) {
  table_.read(group.group("branch"));
  if (group.has_group("birth")) birth_.read(group.group("birth"));
  orbits_ = take_packed<std::vector<std::vector<double>>>(group, "orbits");
  reported_ = take_packed<std::vector<std::string>>(group, "reported");
}

void CycleRecord::write_orbits(io::Group& group, int count) const {
  const std::size_t total = orbits_.size(),
                    n = std::min<std::size_t>(total, static_cast<std::size_t>(std::max(count, 0)));
  std::vector<double> parameter, x, y;
  std::vector<std::int64_t> point;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = n == 1 ? 0 : k * (total - 1) / (n - 1);
    parameter.push_back(table_.column("parameter")[i]);
    point.push_back(static_cast<std::int64_t>(i));
    for (std::size_t v = 0; v < orbits_[i].size(); v += 2) {
      x.push_back(orbits_[i][v]);
      y.push_back(orbits_[i][v + 1]);
    }
  }
  const io::Shape shape{n, samples_per_orbit, places_.names.size()};
  group.put("parameter", parameter, unit_, "where on the branch");
  group.put("point", point, "its row in the table of the branch, from 0");
  group.put("x", shape, x, places_.unit, "x of " + places_.text + " [orbit][time][bearing]");
  group.put("y", shape, y, places_.unit, "y of " + places_.text + " [orbit][time][bearing]");
  group.label_each({{}, places_.names});
}

void write_cycle(io::Group& group, const solve::Cycle& cycle, const SharedRows& like) {
  group.put("mesh", cycle.mesh, "1", "s = t/T");
  put_columns(group, "states", cycle.x, like, "SI", "in natural order [state][node]");
  group.set("period", cycle.period);
  group.set("parameter", cycle.parameter);
}

solve::Cycle read_cycle(const io::Group& group, const SharedRows& like) {
  solve::Cycle cycle;
  cycle.mesh = group.reals("mesh");
  cycle.x = take_columns(group, "states", like);
  cycle.period = group.real("period");
  cycle.parameter = group.real("parameter");
  return cycle;
}

void write_summary(io::Group& group, const io::StudySummary& summary) {
  io::Summary one;
  one.set(summary);
  group.put("json", std::vector<std::string>{one.to_json()}, "summary of the study so far");
}

void read_summary(const io::Group& group, io::StudySummary& summary) {
  const io::Summary one = io::Summary::from_json(group.strings("json").front());
  core::require(one.studies.size() == 1, "a checkpoint holds one study");
  // How this run shares the work is not what the other one chose.
  std::string layout = std::move(summary.layout);
  summary = one.studies.front();
  summary.layout = std::move(layout);
}

}  // namespace whirl::study
