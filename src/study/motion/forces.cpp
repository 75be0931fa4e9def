#include "study/motion/forces.hpp"

#include <fmt/core.h>

#include "study/linear/transfer_points.hpp"

namespace whirl::study {

std::span<const deck::Name<ForceOptions::Direction>> names(ForceOptions::Direction) {
  using enum ForceOptions::Direction;
  static constexpr deck::Name<ForceOptions::Direction> table[] = {
      {x, "x", "horizontal force"},
      {y, "y", "vertical force, upward"},
      {slope_x, "slope_x", "moment that does work with dx/dz"},
      {slope_y, "slope_y", "moment that does work with dy/dz"}};
  return table;
}

namespace {

bool is_moment(const ForceOptions& o) {
  return o.direction == ForceOptions::Direction::slope_x || o.direction == ForceOptions::Direction::slope_y;
}

}  // namespace

void describe(deck::Description<ForceOptions>& d) {
  using O = ForceOptions;
  d.add("node", &O::node, deck::at_least(1), "node of the shaft on which it acts; 1 of a rigid rotor");
  d.add("bearing", &O::bearing, "instead: name of the bearing on whose journal it acts");
  d.add("direction", &O::direction, "along which freedom of the node it acts");
  d.add("arm", &O::arm, "m", deck::positive,
        "arm of a couple of such forces: the moment is force times arm; of directions slope_x and slope_y");
  d.kinds("signal", &O::signal, "how it changes with time");
  d.check([](const O& o, const deck::Report& r) {
    if (o.node.has_value() == o.bearing.has_value()) r.fail("", "a force acts either at a 'node' or on a 'bearing'");
    if (is_moment(o) && !o.arm) r.fail("direction", "a moment is a couple of forces: give its 'arm'");
    if (!is_moment(o) && o.arm) r.fail("arm", "a force along x or y has no 'arm'");
  });
}

void check_forces(const std::string& key, const std::vector<ForceOptions>& forces, const system::Machine& machine,
                  const deck::Report& report) {
  const bool rotor = system::is_rotor(machine);
  const int n_nodes = rotor ? static_cast<int>(machine.rotor.segments.size()) + 1 : 0;
  for (const ForceOptions& f : forces) {
    const std::string path = key + "." + f.name;
    if (!rotor) {
      report.fail(path, fmt::format("external forces act on rotors; '{}' is none", machine.system.name));
      continue;
    }
    if (f.node && *f.node > n_nodes)
      report.fail(path + ".node", fmt::format("node {} does not exist: the shaft has nodes 1 to {}", *f.node, n_nodes));
    if (f.bearing && !system::find_bearing(machine, *f.bearing))
      report.fail(path + ".bearing",
                  fmt::format("there is no bearing '{}'{}", *f.bearing,
                              deck::did_you_mean_one_of(*f.bearing, system::bearing_names(machine))));
    if (machine.rotor.segments.empty() && is_moment(f))
      report.fail(path + ".direction", "a rigid rotor has no slope: moments need a shaft of segments");
  }
}

int node_of(const ForceOptions& force, const system::Machine& machine) {
  return force.node ? *force.node : machine.bearings[*system::find_bearing(machine, *force.bearing)].node;
}

std::vector<transient::Forces::Entry> entries_of(const std::vector<double>& load) {
  std::vector<transient::Forces::Entry> column;
  for (std::size_t q = 0; q < load.size(); ++q)
    if (load[q] != 0) column.push_back({static_cast<PetscInt>(2 * q), load[q]});
  return column;
}

transient::Forces make_forces(const std::vector<ForceOptions>& forces, const system::Machine& machine,
                              const system::Plant& system) {
  transient::Forces out;
  for (const ForceOptions& f : forces) {
    const std::vector<double> load =
        load_on(dynamic_cast<const system::RotorSystem&>(system).rotor(), node_of(f, machine),
                static_cast<rotor::Freedom>(static_cast<int>(f.direction)), f.arm.value_or(1));
    out.add(transient::make_signal(f.signal), entries_of(load));
  }
  return out;
}

}  // namespace whirl::study
