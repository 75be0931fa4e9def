#include "change.hpp"

#include "whirl/core/error.hpp"

namespace whirl::system {
namespace {

bool same_film(const Support& a, const Support& b) {
  return a.geometry == b.geometry && a.film == b.film && a.lubricant == b.lubricant;
}

// Without what Rotor does not need to be made anew for.
rotor::Options shaft_of(rotor::Options o) {
  o.stiffness_damping = o.load = 0;
  return o;
}

}  // namespace

TrainChange change_between(const Train& from, const Train& to) {
  const rotor::Options &a = from.rotor, &b = to.rotor;
  core::require(a.type == b.type && a.segments.size() == b.segments.size() && a.reduction == b.reduction &&
                    from.supports.size() == to.supports.size() && from.loads.size() == to.loads.size() &&
                    from.elements.size() == to.elements.size(),
                "trains of the same shape");
  TrainChange out;
  out.shaft = shaft_of(a) != shaft_of(b);
  // Complex modes depend on it.
  if (a.reduction.type == rotor::Reduction::Type::craig_bampton_state)
    out.shaft = out.shaft || a.stiffness_damping != b.stiffness_damping;
  out.damping = !out.shaft && a.stiffness_damping != b.stiffness_damping;
  const bool gravity = from.gravity != to.gravity || from.gravity_x != to.gravity_x;
  out.load = out.shaft || gravity || a.load != b.load || from.loads != to.loads;
  out.axes = out.shaft || gravity;
  out.unbalance = out.shaft || from.unbalance != to.unbalance;
  out.joints = from.elements != to.elements;
  for (std::size_t i = 0; i < from.supports.size(); ++i) {
    const Support &s = from.supports[i], &t = to.supports[i];
    core::require(s.node == t.node && s.has_pedestal == t.has_pedestal, "bearings at the same places");
    if (!same_film(s, t)) out.films.push_back(i);
    out.axes = out.axes || s.elevation != t.elevation || s.slope != t.slope;
    if (!s.has_pedestal) continue;
    out.joints = out.joints || s.mass != t.mass || s.stiffness != t.stiffness || s.damping != t.damping;
    out.load = out.load || s.mass != t.mass;
  }
  return out;
}

}  // namespace whirl::system
