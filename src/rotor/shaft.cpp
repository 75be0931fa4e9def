#include "whirl/rotor/shaft.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "whirl/core/error.hpp"
#include "whirl/rotor/element.hpp"
#include "whirl/rotor/hinges.hpp"

namespace whirl::rotor {
namespace {

using core::InputError;
using std::numbers::pi;

void refuse_unless(bool good, const std::string& what) {
  if (!good) throw InputError("rotor: " + what);
}

void validate(const Material& m) {
  refuse_unless(m.density > 0, "the density must be positive");
  refuse_unless(m.poisson > -1 && m.poisson <= 0.5, "Poisson's ratio must lie in (-1, 0.5]");
  refuse_unless(m.shear_modulus >= 0, "the shear modulus must not be negative");
  refuse_unless(!m.modulus.empty(), "the modulus is missing");
  for (std::size_t i = 0; i < m.modulus.size(); ++i) {
    refuse_unless(m.modulus[i].second > 0, fmt::format("modulus {}: must be positive", i + 1));
    refuse_unless(i == 0 || m.modulus[i].first > m.modulus[i - 1].first,
                  fmt::format("modulus {}: temperatures must ascend", i + 1));
  }
}

void validate(const Segment& s, const std::string& name) {
  refuse_unless(s.length > 0, name + ": the length must be positive");
  refuse_unless(s.inner_mass_diameter >= 0 && s.outer_mass_diameter > s.inner_mass_diameter,
                name + ": mass diameters must satisfy outer > inner >= 0");
  if (tapered(s)) {
    const Segment right = section_at(s, 1);
    refuse_unless(right.inner_mass_diameter >= 0 && right.outer_mass_diameter > right.inner_mass_diameter,
                  name + ": diameters at the right end must satisfy outer > inner >= 0");
    refuse_unless(s.outer_stiffness_diameter == 0, name + ": a tapered segment bends with its mass diameters");
  }
  if (s.outer_stiffness_diameter != 0)
    refuse_unless(s.inner_stiffness_diameter >= 0 && s.outer_stiffness_diameter > s.inner_stiffness_diameter,
                  name + ": stiffness diameters must satisfy outer > inner >= 0");
  refuse_unless(s.added_mass >= 0, name + ": the added mass must not be negative");
  refuse_unless(s.added_mass_inner_diameter >= 0 && s.added_mass_outer_diameter >= s.added_mass_inner_diameter,
                name + ": diameters of the added mass must satisfy outer >= inner >= 0");
}

void validate(const Disc& d, int nodes, const std::string& name) {
  refuse_unless(d.node >= 1 && d.node <= nodes, fmt::format("{}: node {} is not in 1..{}", name, d.node, nodes));
  refuse_unless(d.mass >= 0 && d.polar_inertia >= 0 && d.diametral_inertia >= 0 && d.density >= 0,
                name + ": mass, inertias and density must not be negative");
  if (d.outer_diameter != 0)
    refuse_unless(d.inner_diameter >= 0 && d.outer_diameter > d.inner_diameter && d.thickness > 0,
                  name + ": geometry must satisfy outer > inner >= 0 and thickness > 0");
  refuse_unless(d.eccentricity >= 0 && d.skew >= 0, name + ": eccentricity and skew must not be negative");
  if (!d.hub.empty())
    refuse_unless(d.hub.size() == 2 && d.hub[0] >= 1 && d.hub[0] <= d.node && d.node <= d.hub[1] &&
                      d.hub[0] < d.hub[1] && d.hub[1] <= nodes,
                  name + ": the hub must be two nodes of the shaft, ascending, around that of the disc");
}

void validate(const Coupling& c, const Options& o, const std::string& name) {
  const int segments = static_cast<int>(o.segments.size());
  refuse_unless(c.segment >= 1 && c.segment <= segments,
                fmt::format("{}: segment {} is not in 1..{}", name, c.segment, segments));
  refuse_unless(c.stiffness > 0 && c.tilt_stiffness >= 0 && c.damping >= 0 && c.tilt_damping >= 0 &&
                    c.torsional_stiffness >= 0 && c.axial_stiffness >= 0,
                name + ": the stiffness must be positive, all else not negative");
  refuse_unless(!tapered(o.segments[static_cast<std::size_t>(c.segment - 1)]), name + ": its segment is tapered");
  refuse_unless(std::count_if(o.couplings.begin(), o.couplings.end(),
                              [&](const Coupling& x) { return x.segment == c.segment; }) == 1,
                fmt::format("{}: segment {} has two", name, c.segment));
}

void validate(const Reduction& r, int nodes) {
  if (r.type == Reduction::Type::none) return;
  std::set<int> seen;
  for (int node : r.masters) {
    refuse_unless(node >= 1 && node <= nodes, fmt::format("master node {} is not in 1..{}", node, nodes));
    refuse_unless(seen.insert(node).second, fmt::format("master node {} is listed twice", node));
  }
  refuse_unless(r.masters.size() >= 2, "a reduction needs at least two master nodes");
  for (const int node : std::set<int>(r.slopes.begin(), r.slopes.end()))
    refuse_unless(seen.contains(node),
                  fmt::format("node {} has its slopes as masters, but not its translations", node));
  if (r.type == Reduction::Type::guyan) return;
  if (r.type == Reduction::Type::modal) {
    const int kept = static_cast<int>(r.masters.size() + r.slopes.size());
    refuse_unless(
        r.modes >= kept && r.modes <= 2 * nodes,
        fmt::format("{} modes per plane are not in {}..{}: masters are motions of them", r.modes, kept, 2 * nodes));
    refuse_unless(r.support >= 0, "the support must not be negative");
    return;
  }
  refuse_unless(r.speed >= 0, "the speed of the modes must not be negative");
  const int slaves = 2 * nodes - static_cast<int>(r.masters.size() + r.slopes.size());
  refuse_unless(r.modes >= 0 && r.modes <= slaves,
                fmt::format("{} fixed-interface modes per plane are not in 0..{}", r.modes, slaves));
}

}  // namespace

void validate(const Options& o) {
  if (o.type == Options::Type::rigid) return refuse_unless(o.mass > 0, "the mass must be positive");
  validate(o.material);
  refuse_unless(!o.segments.empty(), "there are no segments");
  refuse_unless(n_inner(o.element) == 0 || o.shear != Shear::rigid,
                "an element with independent shear needs a shear stiffness");
  for (const int node : o.joints)
    refuse_unless(node >= 1 && node <= n_nodes(o), fmt::format("joint node {} is not in 1..{}", node, n_nodes(o)));
  refuse_unless(o.stiffness_damping >= 0, "the stiffness damping must not be negative");
  refuse_unless(o.internal_damping >= 0, "the internal damping must not be negative");
  for (std::size_t i = 0; i < o.segments.size(); ++i) {
    const std::string name = fmt::format("segment {}", i + 1);
    validate(o.segments[i], name);
    try {
      (void)modulus(o.material, o.segments[i].temperature);
    } catch (const core::DomainError& e) {
      throw InputError(fmt::format("rotor: {}: {}", name, e.what()));
    }
  }
  for (std::size_t i = 0; i < o.discs.size(); ++i) validate(o.discs[i], n_nodes(o), fmt::format("disc {}", i + 1));
  for (std::size_t i = 0; i < o.couplings.size(); ++i) validate(o.couplings[i], o, fmt::format("coupling {}", i + 1));
  refuse_unless(o.loss_factor >= 0, "the loss factor must not be negative");
  refuse_unless(o.loss_factor == 0 || o.reduction.type != Reduction::Type::craig_bampton_state,
                "a shaft with a loss factor has no equations of first order in time to reduce");
  validate(o.reduction, n_nodes(o));
  if (o.reduction.type == Reduction::Type::none) return;
  if (const auto loose = loose_part(o, o.reduction.masters, o.reduction.slopes))
    throw InputError("rotor: " + words(*loose, o, "at its masters"));
}

int n_nodes(const Options& o) {
  return static_cast<int>(o.segments.size()) + 1;
}

std::vector<double> node_positions(const Options& o) {
  std::vector<double> z{0.0};
  for (const Segment& s : o.segments) z.push_back(z.back() + s.length);
  return z;
}

double modulus(const Material& m, double temperature) {
  if (m.modulus.empty()) throw core::DomainError("the modulus is missing");
  if (m.modulus.size() == 1) return m.modulus.front().second;
  if (!(temperature >= m.modulus.front().first && temperature <= m.modulus.back().first))
    throw core::DomainError(fmt::format("temperature {} K is outside the table of the modulus, {} K to {} K",
                                        temperature, m.modulus.front().first, m.modulus.back().first));
  auto right = std::lower_bound(m.modulus.begin() + 1, m.modulus.end() - 1, temperature,
                                [](const auto& point, double t) { return point.first < t; });
  const auto& [t0, e0] = *(right - 1);
  const auto& [t1, e1] = *right;
  return e0 + (e1 - e0) * (temperature - t0) / (t1 - t0);
}

bool tapered(const Segment& s) {
  return s.right_outer_diameter.value_or(s.outer_mass_diameter) != s.outer_mass_diameter ||
         s.right_inner_diameter.value_or(s.inner_mass_diameter) != s.inner_mass_diameter;
}

Segment section_at(const Segment& s, double place) {
  Segment out = s;
  out.outer_mass_diameter += place * (s.right_outer_diameter.value_or(s.outer_mass_diameter) - s.outer_mass_diameter);
  out.inner_mass_diameter += place * (s.right_inner_diameter.value_or(s.inner_mass_diameter) - s.inner_mass_diameter);
  out.right_outer_diameter.reset();
  out.right_inner_diameter.reset();
  return out;
}

double segment_mass(const Segment& s, const Material& m) {
  if (tapered(s)) {  // areas are quadratic along it: Simpson's rule is exact
    const auto at = [&](double place) { return segment_mass(section_at(s, place), m); };
    return (at(0) + 4 * at(0.5) + at(1)) / 6;
  }
  const double area =
      pi / 4 * (s.outer_mass_diameter * s.outer_mass_diameter - s.inner_mass_diameter * s.inner_mass_diameter);
  return m.density * area * s.length + s.added_mass;
}

Disc resolved(const Disc& d, const Material& m) {
  Disc r = d;
  r.outer_diameter = r.inner_diameter = r.thickness = r.density = 0;
  if (d.outer_diameter == 0) return r;
  const double outer2 = d.outer_diameter * d.outer_diameter, inner2 = d.inner_diameter * d.inner_diameter;
  const double mass = (d.density > 0 ? d.density : m.density) * pi / 4 * (outer2 - inner2) * d.thickness;
  const double polar = mass * (outer2 + inner2) / 8;
  r.mass += mass;
  r.polar_inertia += polar;
  r.diametral_inertia += polar / 2 + mass * d.thickness * d.thickness / 12;
  return r;
}

double hub_length(const Disc& d, const Options& o) {
  double length = 0;
  for (int k = d.hub.at(0); k < d.hub.at(1); ++k) length += o.segments.at(static_cast<std::size_t>(k - 1)).length;
  return length;
}

std::vector<TurningForce> disc_forces(const Options& o) {
  std::vector<TurningForce> out;
  const auto moment = [&](const Disc& d, double amount, double phase) {
    if (d.hub.empty()) return out.push_back({d.node, Freedom::slope_x, amount, phase});
    const double force = amount / hub_length(d, o);
    out.push_back({d.hub[0], Freedom::x, -force, phase});
    out.push_back({d.hub[1], Freedom::x, force, phase});
  };
  for (const Disc& given : o.discs) {
    const Disc d = resolved(given, o.material);
    if (d.eccentricity > 0) {
      out.push_back({d.node, Freedom::x, d.mass * d.eccentricity, d.eccentricity_phase});
      if (d.offset != 0) moment(d, d.mass * d.eccentricity * d.offset, d.eccentricity_phase);
    }
    if (d.skew > 0) moment(d, (d.diametral_inertia - d.polar_inertia) * d.skew, d.skew_phase);
  }
  return out;
}

double total_mass(const Options& o) {
  if (o.type == Options::Type::rigid) return o.mass;
  double mass = 0;
  for (const Segment& s : o.segments) mass += segment_mass(s, o.material);
  for (const Disc& d : o.discs) mass += resolved(d, o.material).mass;
  return mass;
}

std::vector<double> node_masses(const Options& o) {
  if (o.type == Options::Type::rigid) return {o.mass};
  std::vector<double> mass(o.segments.size() + 1, 0.0);
  for (std::size_t k = 0; k < o.segments.size(); ++k) {
    const double half = segment_mass(o.segments[k], o.material) / 2;
    mass[k] += half;
    mass[k + 1] += half;
  }
  for (const Disc& d : o.discs) mass[static_cast<std::size_t>(d.node - 1)] += resolved(d, o.material).mass;
  return mass;
}

double mass_between(const Options& o, int from, int to) {
  refuse_unless(from >= 1 && from < to && to <= n_nodes(o), fmt::format("nodes {}, {} bound no span", from, to));
  double mass = 0;
  for (int k = from; k < to; ++k) mass += segment_mass(o.segments[static_cast<std::size_t>(k - 1)], o.material);
  for (const Disc& d : o.discs)
    if (d.node >= from && d.node < to) mass += resolved(d, o.material).mass;
  return mass;
}

namespace {

bool has_one_name(const Options& o) {
  const std::string* first = nullptr;
  for (const Segment& s : o.segments) {
    if (s.rotor.empty()) continue;
    if (first && *first != s.rotor) return false;
    first = &s.rotor;
  }
  return true;
}

// Names of the segments at both sides of a node; the same twice at an end of the shaft.
std::array<std::string_view, 2> rotors_at(const Options& o, int node) {
  const auto n = static_cast<int>(o.segments.size());
  const auto of = [&](int segment) {
    return std::string_view(o.segments[static_cast<std::size_t>(std::clamp(segment, 1, n) - 1)].rotor);
  };
  return {of(node - 1), of(node)};
}

}  // namespace

double mass_of(const Options& o, std::string_view name) {
  if (o.type == Options::Type::rigid || name.empty() || has_one_name(o)) return total_mass(o);
  double mass = 0;
  for (const Segment& s : o.segments)
    if (s.rotor == name) mass += segment_mass(s, o.material);
  for (const Disc& d : o.discs) {
    const auto [left, right] = rotors_at(o, d.node);
    if (d.rotor.empty() ? left == name && right == name : d.rotor == name) mass += resolved(d, o.material).mass;
  }
  return mass;
}

std::optional<std::size_t> disc_of_no_rotor(const Options& o, std::string_view name) {
  if (o.type == Options::Type::rigid || name.empty() || has_one_name(o)) return {};
  for (std::size_t i = 0; i < o.discs.size(); ++i) {
    const auto [left, right] = rotors_at(o, o.discs[i].node);
    if (left != right && (left == name || right == name) && o.discs[i].rotor != left && o.discs[i].rotor != right)
      return i;
  }
  return {};
}

double slenderness(const Options& o, int from, int to) {
  refuse_unless(from >= 1 && from < to && to <= n_nodes(o), fmt::format("nodes {}, {} bound no span", from, to));
  double length = 0, profile = 0;
  for (int k = from; k < to; ++k) {
    const Segment s = section_at(o.segments[static_cast<std::size_t>(k - 1)], 0.5);
    length += s.length;
    profile += s.length * (s.outer_stiffness_diameter > 0 ? s.outer_stiffness_diameter : s.outer_mass_diameter);
  }
  return length * length / profile;
}

}  // namespace whirl::rotor
