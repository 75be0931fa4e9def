#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "study/equilibrium/alignment.hpp"

namespace whirl::study {

void describe(deck::Description<AlignmentOptions>& d) {
  d.add("name", &AlignmentOptions::name, "name in the results; the kind if not given");
  d.add("zero_moment", &AlignmentOptions::zero_moment, deck::positive,
        "nodes without bending moment, such as couplings");
  d.add("loads", &AlignmentOptions::loads, "N", deck::any, "wanted load of bearings by name, positive down");
  d.add("adjust", &AlignmentOptions::adjust, "bearings whose elevation is sought").required();
  d.check([](const AlignmentOptions& o, const deck::Report& r) {
    const std::size_t conditions = o.zero_moment.size() + o.loads.size();
    if (o.adjust.size() != conditions)
      r.fail("adjust", fmt::format("{} bearings to adjust for {} conditions: there must be as many", o.adjust.size(),
                                   conditions));
  });
}

void Alignment::validate(const system::Machine& machine, const deck::Report& report) const {
  if (machine.rotor.type == rotor::Options::Type::rigid)
    return report.fail("", "the alignment is that of a shaft; this rotor is rigid");
  check_held(machine, report);
  std::map<int, std::string> at;
  const auto stands = [&](const std::string& name, int node) {
    if (const auto [first, fresh] = at.emplace(node, name); !fresh)
      report.fail("", fmt::format("{} and {} both hold node {}: an alignment knows one support at a node",
                                  first->second, name, node));
  };
  for (const system::Bearing& b : machine.bearings) stands("bearing " + b.name, b.node);
  for (const system::Element& e : machine.elements)
    if (system::holds_shaft(e)) stands("element " + e.name, e.node);
  check_nodes("zero_moment", options.zero_moment, machine, report);
  const std::vector<std::string> bearings = system::bearing_names(machine);
  auto exists = [&](const std::string& name, const std::string& path) {
    if (!system::find_bearing(machine, name))
      report.fail(path, fmt::format("there is no bearing '{}'{}", name, deck::did_you_mean_one_of(name, bearings)));
  };
  for (const auto& [name, load] : options.loads) exists(name, "loads." + name);
  for (std::size_t i = 0; i < options.adjust.size(); ++i) {
    const std::string path = fmt::format("adjust.{}", i + 1);
    exists(options.adjust[i], path);
    if (std::count(options.adjust.begin(), options.adjust.begin() + static_cast<std::ptrdiff_t>(i), options.adjust[i]))
      report.fail(path, fmt::format("bearing {} is named twice", options.adjust[i]));
  }
}

}  // namespace whirl::study
