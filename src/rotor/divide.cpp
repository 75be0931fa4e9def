#include "whirl/rotor/divide.hpp"

#include <algorithm>

#include "whirl/rotor/element.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {

int node_after(const Options& whole, int node, int parts) {
  int after = node;
  const std::size_t before = std::min(whole.segments.size(), static_cast<std::size_t>(node - 1));
  for (std::size_t k = 0; k < before; ++k)
    if (!coupling_at(whole, k)) after += parts - 1;
  return after;
}

Options divided(Options options, int parts) {
  if (options.type == Options::Type::rigid) return options;
  const Options given = options;
  const auto after = [&](int node) { return node_after(given, node, parts); };
  std::vector<Segment> segments;
  for (std::size_t e = 0; e < given.segments.size(); ++e) {
    const Segment& whole = given.segments[e];
    if (coupling_at(given, e)) {
      segments.push_back(whole);
      continue;
    }
    for (int k = 0; k < parts; ++k) {
      Segment s = section_at(whole, static_cast<double>(k) / parts);
      if (tapered(whole)) {
        const Segment right = section_at(whole, static_cast<double>(k + 1) / parts);
        s.right_outer_diameter = right.outer_mass_diameter;
        s.right_inner_diameter = right.inner_mass_diameter;
      }
      s.length = whole.length / parts;
      s.added_mass = whole.added_mass / parts;
      segments.push_back(s);
    }
  }
  options.segments = std::move(segments);
  for (Disc& d : options.discs) {
    d.node = after(d.node);
    for (int& node : d.hub) node = after(node);
  }
  for (auto* nodes : {&options.joints, &options.reduction.masters, &options.reduction.slopes})
    for (int& node : *nodes) node = after(node);
  for (Coupling& c : options.couplings) c.segment = after(c.segment);
  return options;
}

}  // namespace whirl::rotor
