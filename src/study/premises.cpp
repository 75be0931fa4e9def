#include "premises.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "whirl/study/linear/unbalance_response.hpp"

namespace whirl::study {

std::vector<std::string> machine_warnings(const system::Machine& machine) {
  std::vector<std::string> lines;
  if (const double up = system::is_rotor(machine) ? system::lateral(machine.gravity)[1] : 0; up > 0)
    lines.push_back(fmt::format("gravity is {:.6g} m/s^2 along +y: the weight points upwards", up));
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
  std::vector<double> speeds = study.speeds();
  if (speeds.empty() || !system::is_rotor(machine)) return {};
  // A response is asked for at the service speed of the machine too, unless it names another one.
  const auto* response = dynamic_cast<const UnbalanceResponse*>(&study);
  const bool serves = response && !response->options.operating_speed && machine.service_speed;
  if (serves) speeds.push_back(machine.service_speed->value);
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
                                study.name(), asked, serves ? " (service_speed among them)" : "", what, both(from),
                                both(to),
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
