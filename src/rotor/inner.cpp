#include "inner.hpp"

#include <cmath>
#include <set>

#include "whirl/rotor/element.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {
namespace {

// Curvature and shear angle jump with E I and the shear stiffness. Masses are loads on the span and make no jump.
bool same_stiffness(const Options& o, std::size_t left) {
  const Beam a = make_beam(section_at(o.segments[left], 1), o.material, o.shear),
             b = make_beam(o.segments[left + 1], o.material, o.shear);
  // Phi L^2 = 12 E I/(kappa G A)
  const double shear_a = a.shear_parameter * a.length * a.length, shear_b = b.shear_parameter * b.length * b.length;
  return std::abs(a.bending_stiffness - b.bending_stiffness) <= 1e-12 * a.bending_stiffness &&
         std::abs(shear_a - shear_b) <= 1e-12 * shear_a;
}

}  // namespace

Inner inner_freedoms(const Options& o) {
  Inner out;
  const int per_segment = n_inner(o.element);
  if (per_segment == 0) return out;
  std::set<int> split(o.joints.begin(), o.joints.end());
  for (const Disc& d : o.discs) {
    split.insert(d.node);
    split.insert(d.hub.begin(), d.hub.end());
  }
  for (std::size_t k = 0; k < o.segments.size(); ++k) {
    std::vector<int>& mine = out.of_segment.emplace_back();
    if (coupling_at(o, k)) continue;
    if (o.element == BeamElement::timoshenko_hermitian && k > 0 && !split.contains(static_cast<int>(k) + 1) &&
        !coupling_at(o, k - 1) && same_stiffness(o, k - 1)) {
      const std::vector<int>& before = out.of_segment[k - 1];
      mine.assign(before.end() - 2, before.end());
    }
    while (static_cast<int>(mine.size()) < per_segment) mine.push_back(out.count++);
  }
  return out;
}

}  // namespace whirl::rotor
