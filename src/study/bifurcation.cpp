#include "bifurcation.hpp"

#include <algorithm>
#include <cmath>

#include "study/columns.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/system/dimensionless_groups.hpp"

namespace whirl::study {
namespace {

void add_groups(io::Bifurcation& b, const std::optional<system::DimensionlessGroups>& groups, double speed) {
  if (!groups) return;
  b.more["nondimensional_speed"] = speed / groups->speed_scale;
  b.more["nondimensional_load"] = groups->load;
  b.more["nondimensional_unbalance"] = groups->unbalance;
  b.more["sommerfeld"] = groups->sommerfeld(speed);
}

}  // namespace

Event event_of(solve::Event e) {
  switch (e) {
    case solve::Event::fold:
      return Event::fold;
    case solve::Event::hopf:
      return Event::hopf;
    case solve::Event::cyclic_fold:
      return Event::cyclic_fold;
    case solve::Event::flip:
      return Event::flip;
    case solve::Event::neimark_sacker:
      return Event::neimark_sacker;
    default:
      return Event::branch_point;
  }
}

io::BifurcationType type_of(solve::Event event) {
  static_assert(static_cast<int>(solve::Event::neimark_sacker) ==
                static_cast<int>(io::BifurcationType::neimark_sacker));  // both in one order
  return static_cast<io::BifurcationType>(event);
}

bool wanted(solve::Event event, const std::vector<Event>& detect) {
  return event == solve::Event::branch_point ||
         std::find(detect.begin(), detect.end(), event_of(event)) != detect.end();
}

bool doubtful_pair(const solve::LocatedEvent& found, double uncertainty) {
  constexpr double small_angle = 0.1;  // rad
  return found.event == solve::Event::neimark_sacker && !std::isfinite(uncertainty) &&
         std::abs(std::arg(found.critical)) <= small_angle;
}

io::Bifurcation bifurcation_at(io::BifurcationType type, double value, const std::string& path, const std::string& unit,
                               const system::Machine& machine, const std::vector<std::string>& unbalance,
                               const system::Plant& system) {
  io::Bifurcation b;
  b.type = type;
  b.parameter = path;
  b.value = value;
  b.unit = unit;
  const double si = value * deck::number_to_si(1, unit);
  if (path == "speed")
    add_groups(b, system.groups(), si);
  else if (system::is_rotor(machine))
    add_groups(b, system::dimensionless_groups(system::train_of(with_parameter(machine, path, si), unbalance)),
               system.speed());
  return b;
}

double more_of(const io::Bifurcation& b, const std::string& name) {
  const auto at = b.more.find(name);
  return at == b.more.end() ? io::no_value : at->second;
}

void put_bifurcations(io::Group& group, const std::vector<io::Bifurcation>& all) {
  const std::string unit = all.empty() ? "1" : all.front().unit;
  auto& g = group.child("bifurcations");
  using B = io::Bifurcation;
  const auto angle = [](const B& b) { return b.more.contains("angle_rad") ? b.more.at("angle_rad") : 0.0; };
  g.put("type", column(all, [](const B& b) { return io::name_of(b.type); }), "kind of bifurcation");
  g.put("parameter", column(all, &B::value), unit, "where");
  g.put("uncertainty", column(all, &B::uncertainty), unit, "estimated error from film mesh, time mesh and location");
  g.put("angle", column(all, angle), "rad", "angle of the critical multiplier");
}

}  // namespace whirl::study
