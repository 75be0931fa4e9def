#include <algorithm>
#include <set>

#include "whirl/film/sheet/thickness.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/system/options.hpp"

namespace whirl::system {
namespace {

template <class T>
std::optional<std::size_t> position(const std::vector<T>& all, std::string_view name) {
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].name == name) return i;
  return {};
}

template <class T>
std::vector<std::string> names_of(const std::vector<T>& all) {
  std::vector<std::string> n;
  for (const T& x : all) n.push_back(x.name);
  return n;
}

}  // namespace

std::array<double, 2> lateral(const Gravity& gravity) {
  if (const auto* g = std::get_if<std::array<double, 3>>(&gravity)) return {(*g)[0], (*g)[1]};
  return {0, -std::get<double>(gravity)};
}

std::optional<std::size_t> find_bearing(const Machine& m, std::string_view name) {
  return position(m.bearings, name);
}

std::optional<std::size_t> find_element(const Machine& m, std::string_view name) {
  return position(m.elements, name);
}

std::vector<int> support_nodes(const Machine& m) {
  std::set<int> nodes;
  for (const Bearing& b : m.bearings) nodes.insert(b.node);
  for (const Element& e : m.elements)
    if (holds_shaft(e)) nodes.insert(e.node);
  return {nodes.begin(), nodes.end()};
}

std::vector<int> acting_nodes(const Machine& m) {
  std::set<int> nodes;
  for (const Bearing& b : m.bearings) nodes.insert(b.node);
  for (const StaticLoad& l : m.loads) nodes.insert(l.node);
  for (const Element& e : m.elements) {
    nodes.insert(e.node);
    if (e.to_node) nodes.insert(*e.to_node);
  }
  return {nodes.begin(), nodes.end()};
}

std::vector<int> slope_nodes(const Machine& m) {
  std::set<int> nodes;
  for (const Bearing& b : m.bearings)
    if (film::facts(b.film).tilts) nodes.insert(b.node);
  for (const StaticLoad& l : m.loads)
    if (l.moment) nodes.insert(l.node);
  for (const Element& e : m.elements) {
    if (!sees_slopes(e)) continue;
    nodes.insert(e.node);
    if (e.to_node) nodes.insert(*e.to_node);
  }
  return {nodes.begin(), nodes.end()};
}

std::optional<std::size_t> find_unbalance(const Machine& m, std::string_view name) {
  return position(m.unbalance, name);
}

std::vector<std::string> bearing_names(const Machine& m) {
  return names_of(m.bearings);
}

std::vector<std::string> unbalance_names(const Machine& m) {
  return names_of(m.unbalance);
}

bool discs_force(const Machine& m) {
  return std::any_of(m.rotor.discs.begin(), m.rotor.discs.end(),
                     [](const rotor::Disc& d) { return d.eccentricity > 0 || d.skew > 0; });
}

std::vector<int> unbalance_nodes(const Machine& m, std::string_view name) {
  std::vector<int> nodes;
  if (name == unbalance_of_discs && discs_force(m))
    for (const rotor::Disc& d : m.rotor.discs)
      if (d.eccentricity > 0 || d.skew > 0) nodes.push_back(d.node);
  if (const auto i = find_unbalance(m, name))
    for (const Plane& p : m.unbalance[*i].planes) nodes.push_back(p.node);
  return nodes;
}

std::optional<std::array<int, 2>> enclosing_supports(const Machine& m, std::string_view rotor) {
  const std::vector<double> z = rotor::node_positions(m.rotor);
  double from = z.back(), to = z.front();
  for (std::size_t i = 0; i < m.rotor.segments.size(); ++i) {
    if (!rotor.empty() && m.rotor.segments[i].rotor != rotor) continue;
    from = std::min(from, z[i]);
    to = std::max(to, z[i + 1]);
  }
  if (from >= to) return {};
  const std::vector<int> nodes = support_nodes(m);
  const auto position_of = [&](int node) { return z.at(static_cast<std::size_t>(node - 1)); };
  const double middle = (from + to) / 2;
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    if (nodes[k + 1] > static_cast<int>(z.size())) return {};
    if (position_of(nodes[k]) < middle && middle <= position_of(nodes[k + 1])) return {{nodes[k], nodes[k + 1]}};
  }
  return {};
}

double graded_mass(const Machine& m, const Unbalance& u) {
  if (u.mass.of == BalanceMass::Of::given) return u.mass.given;
  if (u.mass.of == BalanceMass::Of::rotor) return rotor::mass_of(m.rotor, u.rotor);
  const auto pair = enclosing_supports(m, u.rotor);
  core::require(pair.has_value(), "an unbalance whose rotor does not lie between two bearings was not refused");
  return rotor::mass_between(m.rotor, (*pair)[0], (*pair)[1]);
}

std::vector<UnbalanceMass> unbalance_masses(const Machine& m, const Unbalance& u) {
  const auto speed = [&] { return u.service_speed ? *u.service_speed : m.service_speed.value().value; };
  const double whole = u.grade ? graded_mass(m, u) * u.grade->velocity / speed() : 0;
  std::vector<UnbalanceMass> masses;
  for (const Plane& p : u.planes) {
    const double amount = u.grade ? *p.fraction * whole : p.eccentricity ? *p.eccentricity * m.rotor.mass : *p.amount;
    masses.push_back({p.node, amount, p.phase});
  }
  return masses;
}

Train train_of(const Machine& m, const std::vector<std::string>& unbalance) {
  Train t;
  t.rotor = m.rotor;
  t.gravity_x = lateral(m.gravity)[0];
  t.gravity = -lateral(m.gravity)[1];
  t.loads = m.loads;
  t.elements = m.elements;
  t.rest = m.rest;
  // What acts on slopes no reduction may take away.
  if (t.rotor.reduction.type != rotor::Reduction::Type::none) t.rotor.reduction.slopes = slope_nodes(m);
  for (const Bearing& b : m.bearings) {
    Support s;
    s.name = b.name;
    s.node = b.node;
    s.elevation = b.elevation;
    s.slope = b.slope;
    if (b.geometry) s.geometry = *b.geometry;
    s.film = b.film;
    if (const auto* own = std::get_if<film::Lubricant>(&b.lubricant))
      s.lubricant = *own;
    else if (const std::string& name = std::get<std::string>(b.lubricant); !name.empty())
      s.lubricant = m.lubricants.at(name);
    if (const film::Facts film = film::facts(b.film); !film.coefficients) {
      // Asperities that carry are beyond any limit but contact.
      const double usual = film.asperities ? 0 : film::default_minimum_film(s.geometry);
      s.minimum_film = b.minimum_film.value_or(m.minimum_film.value_or(usual));
    }
    s.has_pedestal = b.pedestal.has_value();
    if (b.pedestal) {
      s.mass = b.pedestal->mass;
      s.stiffness = b.pedestal->stiffness;
      s.damping = b.pedestal->damping;
    }
    t.supports.push_back(s);
  }
  if (m.rotor.element == rotor::BeamElement::timoshenko_hermitian) {
    for (const int node : acting_nodes(m)) t.rotor.joints.push_back(node);
    for (const Unbalance& u : m.unbalance)
      for (const UnbalanceMass& x : unbalance_masses(m, u)) t.rotor.joints.push_back(x.node);
  }
  for (const std::string& name : unbalance) {
    if (name == unbalance_of_discs && !find_unbalance(m, name)) {
      for (const rotor::TurningForce& f : rotor::disc_forces(t.rotor))
        t.unbalance.push_back({f.node, f.amount, f.phase, rotor::is_slope(f.freedom)});
      continue;
    }
    const auto i = find_unbalance(m, name);
    if (!i)
      throw core::InputError("there is no unbalance '" + name + "'" +
                             deck::did_you_mean_one_of(name, unbalance_names(m)));
    for (const UnbalanceMass& x : unbalance_masses(m, m.unbalance[*i])) t.unbalance.push_back(x);
  }
  return t;
}

}  // namespace whirl::system
