#include "study/equilibrium/alignment.hpp"

#include <fmt/core.h>

#include "study/brief.hpp"
#include "study/common.hpp"
#include "study/layout.hpp"
#include "whirl/rotor/alignment.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::study {

StudyResult Alignment::run(Context& context) {
  const auto names = names_of_bearings(context.machine);
  const auto position = [&](const std::string& name) {
    return static_cast<int>(*system::find_bearing(context.machine, name)) + 1;
  };
  rotor::Options shaft = context.machine.rotor;
  shaft.reduction = {};
  std::vector<rotor::RigidSupport> supports;
  for (const auto& b : context.machine.bearings) supports.push_back({b.node, b.elevation});
  for (const system::Element& e : context.machine.elements)
    if (system::holds_shaft(e)) supports.push_back({e.node, 0});
  rotor::AlignmentRule rule;
  for (const auto& name : options.adjust) rule.adjustable.push_back(position(name));
  rule.zero_moment_nodes = options.zero_moment;
  for (const auto& [name, load] : options.loads) {
    rule.loaded.push_back(position(name));
    rule.loads.push_back(load);
  }
  MPI_Comm space = plan(context, Sharing::machine).space;
  const double down = -system::lateral(context.machine.gravity)[1];  // loads come when the machine runs
  const auto as_given = rotor::rigid_static(space, shaft, supports, down);
  const auto elevations = rotor::align(space, shaft, supports, rule, down);
  for (std::size_t b = 0; b < supports.size(); ++b) supports[b].elevation = elevations[b];  // of other supports zero
  const auto aligned = rotor::rigid_static(space, shaft, supports, down);

  auto& summary = context.results.summary();
  summary.set("mass.total", rotor::total_mass(shaft), "kg");
  for (std::size_t b = 0; b < names.size(); ++b) {
    summary.set("elevation." + names[b], elevations[b], "m");
    summary.set("reaction." + names[b], as_given.reactions[b], "N");  // at the elevations of the deck
    summary.set("reaction_aligned." + names[b], aligned.reactions[b], "N");
  }
  for (const int node : options.zero_moment) {
    summary.set(fmt::format("moment.{}", node), as_given.moment[static_cast<std::size_t>(node - 1)], "N m");
    summary.set(fmt::format("moment_aligned.{}", node), aligned.moment[static_cast<std::size_t>(node - 1)], "N m");
  }
  auto& nodes = context.results.group().child("nodes");
  nodes.put("z", rotor::node_positions(shaft), "m", "axial position of the shaft's nodes");
  nodes.put("y", aligned.deflection, "m", "aligned shaft on rigid supports, positive up");
  nodes.put("slope_y", aligned.slope, "1", "dy/dz of the aligned shaft");
  nodes.put("moment", aligned.moment, "N m", "bending moment of the aligned shaft, sagging positive");
  summary.points = 1;
  return context.results.finish("completed", true);
}

io::Brief Alignment::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const Values v(result.summary);
  io::BriefTable table{"Alignment on rigid supports",
                       {{"bearing"}, {"elevation", "m"}, {"load as in the deck", "N"}, {"load aligned", "N"}},
                       {},
                       "loads of the shaft on its supports, positive down"};
  for (const std::string& b : v.between("elevation.", ""))
    table.rows.push_back({b, v["elevation." + b], v["reaction." + b], v["reaction_aligned." + b]});
  return {{}, {std::move(table)}};
}

}  // namespace whirl::study
