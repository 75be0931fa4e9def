#include "premises.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "sense.hpp"
#include "study/bearing/thd_study.hpp"
#include "study/linear/unbalance_response.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::study {

namespace {

// A response is asked for at the service speed of the machine too, unless it names another one.
bool serves(const system::Machine& machine, const Study& study) {
  const auto* response = dynamic_cast<const UnbalanceResponse*>(&study);
  return response && !response->given().operating_speed && machine.service_speed;
}

// [rad/s]
std::vector<double> asked_speeds(const system::Machine& machine, const Study& study) {
  std::vector<double> speeds = study.speeds();
  if (serves(machine, study)) speeds.push_back(machine.service_speed->value);
  return speeds;
}

// Least thickness of the film of each bearing in the tables of a result, NaN where they have none.
std::vector<double> thinnest_films(const io::Group& group, const system::Machine& machine, const std::string& bearing) {
  std::vector<double> thinnest(machine.bearings.size(), io::no_value);
  const auto one = system::find_bearing(machine, bearing);
  for (const auto& [table, column] : {std::pair("branch", "film"),
                                      {"branch", "film_min"},
                                      {"places", "min_thickness"},
                                      {"curves", "min_thickness"},
                                      {"equilibria", "min_thickness"},
                                      {"locus", "min_thickness"}}) {
    if (!group.has_group(table) || !group.group(table).has_dataset(column)) continue;
    const std::vector<double>& all = group.group(table).reals(column);
    for (std::size_t k = 0; k < all.size(); ++k) {
      double& here = thinnest[one ? *one : k % thinnest.size()];
      here = std::fmin(here, all[k]);
    }
  }
  return thinnest;
}

// What the films of a study are like where its equations of them end.
void judge_films(StudyResult& result, const system::Machine& machine, const Study& study) {
  constexpr std::array without_films{"alignment", "critical_speed_map"};
  if (!result.delivered || machine.bearings.empty() || std::ranges::count(without_films, study.kind()) > 0) return;
  if (study.kind() == ThdStudy::key) return;  // which has a film of its own
  AskedFilms asked;
  for (const double speed : asked_speeds(machine, study)) asked.speed = std::max(asked.speed, std::abs(speed));
  if (asked.speed == 0) return;
  if (result.group.has_attribute("bearing")) asked.bearing = result.group.text("bearing");
  asked.thinnest = thinnest_films(result.group, machine, asked.bearing);
  warn_of_films(result.summary, system::train_of(machine), asked);
}

// Outer diameter of the thicker segment beside a node, 0 where there is none.
double shaft_at(const rotor::Options& rotor, int node) {
  const auto& segments = rotor.segments;
  if (node < 1 || static_cast<std::size_t>(node) > segments.size() + 1) return 0;
  double shaft = 0;
  const auto left = static_cast<std::size_t>(node) - 1;
  if (left > 0) shaft = rotor::section_at(segments[left - 1], 1).outer_mass_diameter;
  if (left < segments.size()) shaft = std::max(shaft, rotor::section_at(segments[left], 0).outer_mass_diameter);
  return shaft;
}

// A disc of a mass that its shaft could not carry or would not feel, or of inertias that no body of its mass has: a
// wrong unit is likely. Bodies are compared with steel, whose density shafts without mass in decks do not have.
void judge_discs(const rotor::Options& rotor, std::vector<std::string>& lines) {
  constexpr double steel = 7850, heaviest = 100, lightest = 1e-3, longest = 20, thinnest = 1e-3, widest = 5;
  rotor::Material of_steel = rotor.material;
  of_steel.density = steel;
  double length = 0, shaft_mass = 0;
  for (const rotor::Segment& s : rotor.segments) {
    length += s.length;
    shaft_mass += rotor::segment_mass(s, of_steel);
  }
  for (std::size_t i = 0; i < rotor.discs.size(); ++i) {
    const rotor::Disc disc = rotor::resolved(rotor.discs[i], rotor.material);
    const double m = disc.mass, shaft = shaft_at(rotor, disc.node);
    if (!(m > 0) || !(shaft > 0)) continue;
    const std::size_t before = lines.size();
    const auto ask = [&](const std::string& what) {
      lines.push_back(fmt::format("rotor.discs.{}: {}: is a unit wrong?", i + 1, what));
    };
    const double piece = steel * std::numbers::pi / 4 * shaft * shaft * shaft;
    if (m > heaviest * shaft_mass)
      ask(fmt::format("its mass of {:.4g} kg is {:.3g} times that of the whole shaft in steel, {:.4g} kg", m,
                      m / shaft_mass, shaft_mass));
    else if (m < lightest * piece)
      ask(fmt::format("its mass of {:.4g} kg is {:.3g} of that of the shaft at its node over one diameter, {:.4g} kg",
                      m, m / piece, piece));
    if (disc.polar_inertia > 0 && lines.size() == before) {
      // I_p = m R^2/2 and m = rho pi R^2 t.
      const double radius = std::sqrt(2 * disc.polar_inertia / m);
      const double thickness = m / (steel * std::numbers::pi * radius * radius), part = thickness / radius;
      if (part > longest || part < thinnest || radius > widest * length)
        ask(fmt::format(
            "with a mass of {:.4g} kg and a polar inertia of {:.4g} kg m^2 it would be a cylinder of steel of "
            "{:.4g} m radius and {:.4g} m length",
            m, disc.polar_inertia, radius, thickness));
    }
    // I_d = I_p/2 + m t^2/12.
    const double along = std::sqrt(std::max(12 * (disc.diametral_inertia - disc.polar_inertia / 2) / m, 0.0));
    if (along > widest * length && lines.size() == before)
      ask(fmt::format(
          "with a mass of {:.4g} kg and a diametral inertia of {:.4g} kg m^2 it would be {:.4g} m long, and the "
          "shaft is {:.4g} m",
          m, disc.diametral_inertia, along, length));
  }
}

// Proportions of a bearing that no usual machine has: a wrong unit is likely.
void judge_bearing(const system::Machine& machine, const system::Bearing& bearing, std::vector<std::string>& lines) {
  if (!bearing.geometry || !(bearing.geometry->radius > 0)) return;
  constexpr double least_clearance = 1e-4, most_clearance = 1e-2, longest = 3;
  const film::Geometry& g = *bearing.geometry;
  const auto ask = [&](const std::string& what) {
    lines.push_back(fmt::format("bearing {}: {}: is a unit wrong?", bearing.name, what));
  };
  if (const double part = g.clearance / g.radius; part < least_clearance || part > most_clearance)
    ask(fmt::format("a clearance of {:.4g} um on a radius of {:.4g} mm is {:.3g} per mille of it, usual are 0.2 to 5",
                    g.clearance * 1e6, g.radius * 1e3, part * 1e3));
  if (const double ratio = g.length / (2 * g.radius); ratio > longest)
    ask(fmt::format("a length of {:.4g} mm is {:.3g} diameters, usual are 0.2 to 1.5", g.length * 1e3, ratio));
  const double shaft = shaft_at(machine.rotor, bearing.node);
  if (const double bore = 2 * g.radius; shaft > 0 && (shaft > 2 * bore || shaft < bore / 2))
    ask(fmt::format("a shaft of {:.4g} mm at its node in a bore of {:.4g} mm", shaft * 1e3, bore * 1e3));
}

}  // namespace

std::vector<std::string> machine_warnings(const system::Machine& machine) {
  std::vector<std::string> lines;
  if (const double up = system::is_rotor(machine) ? system::lateral(machine.gravity)[1] : 0; up > 0)
    lines.push_back(fmt::format("gravity is {:.6g} m/s^2 along +y: the weight points upwards", up));
  if (system::is_rotor(machine)) {
    for (const system::Bearing& b : machine.bearings) judge_bearing(machine, b, lines);
    if (machine.rotor.type == rotor::Options::Type::shaft) judge_discs(machine.rotor, lines);
    for (std::string& line : lifted_by_weight(machine)) lines.push_back(std::move(line));
  }
  for (const system::Unbalance& u : machine.unbalance) {
    if (!u.grade) continue;
    double sum = 0;
    for (const system::Plane& p : u.planes) sum += p.fraction.value_or(0);
    if (std::abs(sum - 1) > 1e-3)
      lines.push_back(
          fmt::format("unbalance '{}': the fractions of its planes sum to {:.4g}, not to 1: the whole is {:.4g} times "
                      "what the grade "
                      "permits",
                      u.name, sum, sum));
  }
  return lines;
}

std::vector<std::string> table_warnings(const system::Machine& machine, const Study& study) {
  const std::vector<double> speeds = asked_speeds(machine, study);
  if (speeds.empty() || !system::is_rotor(machine)) return {};
  const auto [least, most] = std::minmax_element(speeds.begin(), speeds.end());
  const auto both = [](double speed) {
    return fmt::format("{:.6g} rad/s ({:.6g} rpm)", speed, speed * 30 / std::numbers::pi);
  };
  const std::string asked =
      *least == *most ? "the speed " + both(*least) : fmt::format("speeds from {} to {}", both(*least), both(*most));
  std::vector<std::string> lines;
  const auto known = [&, least = least, most = most](const std::string& what, double from, double to, bool holds) {
    const double rounding = 1e-9 * to;
    if (*least >= from - rounding && *most <= to + rounding) return;
    lines.push_back(fmt::format("'{}' asks for {}{}, and the table of {} goes from {} to {}: beyond it {}",
                                study.name(), asked, serves(machine, study) ? " (service_speed among them)" : "", what,
                                both(from), both(to),
                                holds ? "the coefficients of its nearest end are kept (extrapolate: hold)"
                                      : "there is no answer; 'extrapolate: hold' keeps the coefficients of its nearest "
                                        "end"));
  };
  for (const system::Bearing& b : machine.bearings) {
    const film::Facts film = film::facts(b.film);
    known("bearing " + b.name, film.known_speeds[0], film.known_speeds[1], film.holds_beyond);
  }
  for (const system::Element& e : machine.elements)
    if (e.table.size() > 1)
      known("element " + e.name, e.table.front().speed, e.table.back().speed,
            e.extrapolate == film::Linear::Beyond::hold);
  return lines;
}

void put_premises(StudyResult& result, const system::Machine& machine, const Study& study) {
  if (!system::is_rotor(machine)) return;
  judge_films(result, machine, study);
  for (std::string& line : table_warnings(machine, study)) result.summary.warnings.push_back(std::move(line));
  std::vector<std::string> names;
  std::vector<std::int64_t> planes, nodes;
  std::vector<double> amounts, phases;
  for (const std::string& name : study.unbalances()) {
    const auto i = system::find_unbalance(machine, name);
    if (!i) continue;  // what eccentric and skewed discs do
    const system::Unbalance& u = machine.unbalance[*i];
    if (u.grade) result.summary.set("unbalance." + name + ".mass", system::graded_mass(machine, u), "kg");
    std::int64_t plane = 0;
    for (const system::UnbalanceMass& x : system::unbalance_masses(machine, u)) {
      result.summary.set(fmt::format("unbalance.{}.plane.{}", name, ++plane), x.amount, "kg m");
      names.push_back(name);
      planes.push_back(plane);
      nodes.push_back(x.node);
      amounts.push_back(x.amount);
      phases.push_back(x.phase);
    }
  }
  if (names.empty()) return;
  io::Group& table = result.group.child("unbalance");
  table.set("columns", "unbalance plane node amount phase");
  table.put("unbalance", std::move(names), "name in the deck");
  table.put("plane", std::move(planes), "its planes, in the order of the deck");
  table.put("node", std::move(nodes), "node of the plane, 1-based");
  table.put("amount", std::move(amounts), "kg m", "U: the force is U Omega^2");
  table.put("phase", std::move(phases), "rad", "angle from +x at shaft angle zero, counter-clockwise");
}

}  // namespace whirl::study
