#include "whirl/rotor/divide.hpp"

#include "whirl/core/error.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {

Options divided(Options options, int parts) {
  if (options.type == Options::Type::rigid) return options;
  core::require(options.couplings.empty(), "a shaft of beams: couplings are not divided");
  std::vector<Segment> segments;
  for (const Segment& whole : options.segments)
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
  options.segments = std::move(segments);
  for (Disc& d : options.discs) {
    d.node = node_after(d.node, parts);
    for (int& node : d.hub) node = node_after(node, parts);
  }
  for (auto* nodes : {&options.joints, &options.reduction.masters, &options.reduction.slopes})
    for (int& node : *nodes) node = node_after(node, parts);
  return options;
}

}  // namespace whirl::rotor
