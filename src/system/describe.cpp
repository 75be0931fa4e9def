#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "whirl/film/contract/describe.hpp"
#include "whirl/rotor/describe.hpp"
#include "whirl/rotor/hinges.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/system/options.hpp"

namespace whirl::deck {
namespace {

// `G6.3`: 6.3 mm/s.
class GradeCodec : public Codec {
public:
  void read(const Node& node, void* value, Reading& r) const override {
    double g = 0;
    const char* last = node.text.data() + node.text.size();
    const bool lettered = node.kind == Node::Kind::scalar && node.text.size() > 1 && node.text[0] == 'G';
    const auto [end, code] = std::from_chars(node.text.data() + (lettered ? 1 : 0), last, g);
    if (!lettered || code != std::errc() || end != last || !(g > 0) || g > 1e4)
      return r.problems.add(node.place, fmt::format("'grade' must be a balance grade such as G2.5, not {}", node.text));
    static_cast<system::BalanceGrade*>(value)->velocity = number_to_si(g, "mm/s");
  }
  Node write(const void* value) const override {
    const std::string text = write_quantity(static_cast<const system::BalanceGrade*>(value)->velocity, "mm/s");
    return Node::scalar("G" + text.substr(0, text.find(' ')), true);
  }
  Node schema(bool) const override {
    Node n = Node::map();
    n.set("type", Node::scalar("string", true));
    n.set("pattern", Node::scalar("^G[0-9]+(\\.[0-9]+)?$", true));
    return n;
  }
  std::string type() const override { return "balance grade such as G2.5 (mm/s)"; }
  const Spec* spec() const override { return &spec_; }
  Access find(void* value, std::span<const std::string> path) const override {
    if (!path.empty()) return {};
    return {&static_cast<system::BalanceGrade*>(value)->velocity, "m/s", false, positive};
  }

private:
  Spec spec_{"m/s", positive, "G"};
};

// `rotor`, `span`, or `1200 kg`.
class BalanceMassCodec : public Codec {
public:
  void read(const Node& node, void* value, Reading& r) const override {
    using Of = system::BalanceMass::Of;
    auto& mass = *static_cast<system::BalanceMass*>(value);
    if (node.kind == Node::Kind::scalar && (node.text == "rotor" || node.text == "span")) {
      mass = {node.text == "rotor" ? Of::rotor : Of::span, 0};
      return;
    }
    const std::size_t before = r.problems.size();
    double kilograms = 0;
    number_->read(node, &kilograms, r);
    if (r.problems.size() == before) mass = {Of::given, kilograms};
  }
  Node write(const void* value) const override {
    using Of = system::BalanceMass::Of;
    const auto& mass = *static_cast<const system::BalanceMass*>(value);
    return mass.of == Of::given ? number_->write(&mass.given)
                                : Node::scalar(mass.of == Of::rotor ? "rotor" : "span", true);
  }
  Node schema(bool whole) const override {
    Node words = Node::map(), list = Node::list();
    for (const char* word : {"rotor", "span"}) list.push(Node::scalar(word, true));
    words.set("enum", std::move(list));
    Node n = Node::map(), either = Node::list();
    either.push(std::move(words));
    either.push(number_->schema(whole));
    n.set("anyOf", std::move(either));
    return n;
  }
  std::string type() const override { return "rotor, span, or a mass such as 1200 kg"; }
  const Spec* spec() const override { return number_->spec(); }
  Access find(void* value, std::span<const std::string> path) const override {
    auto& mass = *static_cast<system::BalanceMass*>(value);
    if (mass.of != system::BalanceMass::Of::given) throw core::InputError("the mass is no number");
    return number_->find(&mass.given, path);
  }

private:
  CodecPtr number_ = real_codec({"kg", positive});
};

}  // namespace

std::shared_ptr<const Codec> CodecOf<system::BalanceGrade>::make(const Spec&) {
  return std::make_shared<GradeCodec>();
}
std::shared_ptr<const Codec> CodecOf<system::BalanceMass>::make(const Spec&) {
  return std::make_shared<BalanceMassCodec>();
}

}  // namespace whirl::deck

namespace whirl::system {

using deck::non_negative;
using deck::positive;

void describe(deck::Description<Pedestal>& d) {
  d.add("mass", &Pedestal::mass, "kg", non_negative, "mass that moves in x and in y").required().isotropic();
  d.add("stiffness", &Pedestal::stiffness, "N/m", positive, "stiffness in x and in y")
      .required()
      .isotropic()
      .continuable();
  d.add("damping", &Pedestal::damping, "N s/m", non_negative, "damping in x and in y")
      .required()
      .isotropic()
      .continuable();
}

void describe(deck::Description<Bearing>& d) {
  d.add("node", &Bearing::node, positive, "node of the shaft that is the journal").required();
  d.add("elevation", &Bearing::elevation, "m", deck::any, "height of the bearing centre, positive up").continuable();
  d.add("slope", &Bearing::slope, "1", deck::any,
        "slope dx/dz, dy/dz of the bearing's axis, where its film follows the slope of the journal ('tilt'). Bored in "
        "line with the shaft if not given: with the slope that this has at rest under gravity on rigid supports at the "
        "elevations of all bearings, those with constant coefficients too")
      .continuable();
  d.add("geometry", &Bearing::geometry, "shape of the bore");
  d.add("film", &Bearing::film, "how the film is modelled and discretised");
  d.add("lubricant", &Bearing::lubricant, "name of a lubricant of the deck, or a lubricant written in place");
  d.add("pedestal", &Bearing::pedestal, "what stands under the bearing; rigid if absent");
  d.add("minimum_film", &Bearing::minimum_film, "m", non_negative,
        "film thickness below which journal and bearing touch, at mid-plane unless the film tilts; that of the machine "
        "if not given");
  d.check([](const Bearing& b, const deck::Report& r) {
    const film::Facts film = film::facts(b.film);
    if (b.slope && !film.tilts)
      r.fail("slope",
             "the film does not see the slope of its bearing: only one with 'tilt: true' follows that of the "
             "journal");
    if (film.coefficients) return;
    if (!b.geometry) r.fail("", "'geometry' is missing (shape of the bore)");
    const bool circle = b.geometry && b.geometry->type == film::Geometry::Bore::cylindrical;
    if (b.geometry && !circle && !film.circle_only.option.empty())
      r.fail(fmt::format("film.{}", film.circle_only.option), std::string(film.circle_only.reason));
    if (b.geometry)
      if (const auto [option, reason] = film::facts(b.film, *b.geometry).misplaced; !option.empty())
        r.fail(fmt::format("film.{}", option), reason);
    const auto* name = std::get_if<std::string>(&b.lubricant);
    if (name && name->empty()) r.fail("", "'lubricant' is missing (name of a lubricant of the deck)");
  });
}

void describe(deck::Description<StaticLoad>& d) {
  d.add("node", &StaticLoad::node, positive, "node of the shaft on which it acts").required();
  d.add("force", &StaticLoad::force, "N", deck::any, "along x and y").continuable();
  d.add("moment", &StaticLoad::moment, "N m", deck::any,
        "about x and y, by the right hand: a moment about y turns z towards x, and raises dx/dz")
      .continuable();
}

void describe(deck::Description<Plane>& d) {
  d.add("node", &Plane::node, positive, "node of the plane").required();
  d.add("fraction", &Plane::fraction, "1", positive, "part of the unbalance of the grade that sits in this plane");
  d.add("amount", &Plane::amount, "kg m", positive, "mass times radius, where there is no grade").continuable();
  d.add("eccentricity", &Plane::eccentricity, "m", positive, "distance of the centre of mass of a rigid rotor")
      .continuable();
  d.add("phase", &Plane::phase, "rad", deck::any, "angle from +x at shaft angle zero, counter-clockwise");
}

void describe(deck::Description<Unbalance>& d) {
  d.add("grade", &Unbalance::grade, "balance grade, e Omega at the service speed", "ISO 21940-11").continuable();
  d.add("service_speed", &Unbalance::service_speed, "rad/s", positive,
        "speed for which the grade holds; the 'service_speed' of the machine if not given");
  d.add("rotor", &Unbalance::rotor,
        "rotor to which the grade applies, by the name in its segments; not needed where they have one name or none");
  d.add(
      "mass", &Unbalance::mass,
      "mass to which the grade applies: rotor, its segments and the discs on their nodes, as the standard has it; "
      "span, "
      "what lies between the two neighbouring bearings between which the middle of the rotor lies (004 eq. 2.2); or a "
      "given mass",
      "ISO 21940-11");
  d.add("planes", &Unbalance::planes, "where the unbalance sits").required();
  d.check([](const Unbalance& u, const deck::Report& r) {
    if (u.planes.empty()) r.fail("planes", "'planes' is empty");
    if (!u.grade && u.mass.of != BalanceMass::Of::rotor) r.fail("mass", "'mass' has no meaning without 'grade'");
    if (!u.grade && u.service_speed) r.fail("service_speed", "'service_speed' has no meaning without 'grade'");
    for (std::size_t i = 0; i < u.planes.size(); ++i) {
      const std::string path = fmt::format("planes.{}", i + 1);
      const Plane& p = u.planes[i];
      if (u.grade && (!p.fraction || p.amount || p.eccentricity))
        r.fail(path, "a plane of a grade has a 'fraction' and no 'amount'");
      if (!u.grade && (p.amount.has_value() == p.eccentricity.has_value() || p.fraction))
        r.fail(path, "a plane without a grade has an 'amount' and no 'fraction'");
    }
  });
}

namespace {

// Whether a reduction keeps a node, beside which nothing may act.
bool kept(const rotor::Options& o, int node) {
  const auto& masters = o.reduction.masters;
  return o.type == rotor::Options::Type::rigid || o.reduction.type == rotor::Reduction::Type::none ||
         std::find(masters.begin(), masters.end(), node) != masters.end();
}

void check_bearings(const Machine& m, int n_nodes, const deck::Report& r) {
  std::vector<std::string> lubricants;
  for (const auto& [name, l] : m.lubricants) lubricants.push_back(name);
  const auto& reduction = m.rotor.reduction;
  const bool rigid = m.rotor.type == rotor::Options::Type::rigid;
  for (std::size_t i = 0; i < m.bearings.size(); ++i) {
    const Bearing& b = m.bearings[i];
    const std::string path = "bearings." + b.name;
    if (b.node > n_nodes)
      r.fail(path + ".node", fmt::format("node {} does not exist: the shaft has nodes 1 to {}", b.node, n_nodes));
    if (!kept(m.rotor, b.node))
      r.fail("rotor.reduction.masters", fmt::format("node {} of bearing {} must be a master", b.node, b.name));
    const bool tilts = film::facts(b.film).tilts;
    if (tilts && rigid)
      r.fail(path + ".film.tilt",
             "a rigid rotor has no slope: its journals stay parallel to their bearings. Leave 'tilt' out");
    else if (tilts && !b.slope && support_nodes(m).size() < 2)
      r.fail(path,
             "one bearing alone does not hold the shaft, which then has no slope at rest: give the 'slope' of the "
             "bearing");
    const auto* name = std::get_if<std::string>(&b.lubricant);
    if (name && !name->empty() && !m.lubricants.contains(*name))
      r.fail(path + ".lubricant",
             fmt::format("there is no lubricant '{}'{}", *name, deck::did_you_mean_one_of(*name, lubricants)));
  }
  if (rigid && m.bearings.empty()) r.fail("bearings", "a rotor needs a bearing");
  // Slopes that films, moments and elements turn are masters beside the nodes.
  const auto slopes = static_cast<std::ptrdiff_t>(slope_nodes(m).size());
  const auto inner = 2 * n_nodes - static_cast<std::ptrdiff_t>(reduction.masters.size()) - slopes;
  const bool fixed_interface = reduction.type == rotor::Reduction::Type::craig_bampton ||
                               reduction.type == rotor::Reduction::Type::craig_bampton_state;
  if (!rigid && slopes > 0 && fixed_interface && reduction.modes > inner)
    r.fail("rotor.reduction.modes",
           fmt::format("the shaft with its masters and the slopes of {} nodes held has {} modes per plane, not {}",
                       slopes, inner, reduction.modes));
}

void check_loads(const Machine& m, int n_nodes, const deck::Report& r) {
  for (std::size_t i = 0; i < m.loads.size(); ++i) {
    const StaticLoad& l = m.loads[i];
    const std::string path = fmt::format("loads.{}", i + 1);
    if (l.node > n_nodes)
      r.fail(path + ".node", fmt::format("node {} does not exist: the shaft has nodes 1 to {}", l.node, n_nodes));
    else if (!kept(m.rotor, l.node))
      r.fail("rotor.reduction.masters", fmt::format("node {} of load {} must be a master", l.node, i + 1));
    if (m.rotor.type == rotor::Options::Type::rigid && l.moment)
      r.fail(path + ".moment", "a rigid rotor has no slope for a moment to turn: give its force alone");
  }
}

void check_elements(const Machine& m, int n_nodes, const deck::Report& r) {
  for (const Element& e : m.elements) {
    const std::string path = "elements." + e.name;
    const auto stands = [&](const char* key, int node) {
      if (node > n_nodes)
        r.fail(path + "." + key, fmt::format("node {} does not exist: the shaft has nodes 1 to {}", node, n_nodes));
      else if (!kept(m.rotor, node))
        r.fail("rotor.reduction.masters", fmt::format("node {} of element {} must be a master", node, e.name));
    };
    stands("node", e.node);
    if (e.to_node) stands("to_node", *e.to_node);
    if (e.to_pedestal) {
      const auto at = find_bearing(m, *e.to_pedestal);
      if (!at)
        r.fail(path + ".to_pedestal", fmt::format("there is no bearing '{}'{}", *e.to_pedestal,
                                                  deck::did_you_mean_one_of(*e.to_pedestal, bearing_names(m))));
      else if (!m.bearings[*at].pedestal)
        r.fail(path + ".to_pedestal",
               fmt::format("bearing {} stands on the ground: give it a 'pedestal', or leave this out", *e.to_pedestal));
    }
    if (m.rotor.type == rotor::Options::Type::rigid && sees_slopes(e))
      r.fail(path, "a rigid rotor has no slopes: leave 'slopes' and the columns of slopes out");
  }
}

void check_unbalance(const Machine& m, int n_nodes, const deck::Report& r) {
  std::vector<std::string> rotors;
  for (const rotor::Segment& s : m.rotor.segments)
    if (!s.rotor.empty() && (rotors.empty() || rotors.back() != s.rotor)) rotors.push_back(s.rotor);
  for (const Unbalance& u : m.unbalance) {
    const std::string path = "unbalance." + u.name;
    if (u.name == unbalance_of_discs && discs_force(m))
      r.fail(path, "'discs' is what the eccentric and skewed discs of this rotor do: give the unbalance another name");
    for (std::size_t i = 0; i < u.planes.size(); ++i)
      if (u.planes[i].eccentricity && m.rotor.type != rotor::Options::Type::rigid)
        r.fail(fmt::format("{}.planes.{}.eccentricity", path, i + 1), "only a rigid rotor has an 'eccentricity'");
      else if (u.planes[i].node > n_nodes)
        r.fail(fmt::format("{}.planes.{}.node", path, i + 1),
               fmt::format("node {} does not exist: the shaft has nodes 1 to {}", u.planes[i].node, n_nodes));
    if (u.grade && !u.service_speed && !m.service_speed)
      r.fail(
          path + ".grade",
          "a grade needs the speed for which it holds: give 'service_speed' here beside it, or to the machine, beside "
          "'rotor'");
    if (u.rotor.empty() && u.grade && rotors.size() > 1 && u.mass.of != BalanceMass::Of::given)
      r.fail(path + ".grade", fmt::format("a grade needs 'rotor', the name of the rotor it applies to: one of {}",
                                          fmt::join(rotors, ", ")));
    if (u.rotor.empty() && rotors.size() > 1) continue;
    if (!u.rotor.empty() && std::find(rotors.begin(), rotors.end(), u.rotor) == rotors.end())
      r.fail(path + ".rotor",
             fmt::format("there is no rotor '{}'{}", u.rotor, deck::did_you_mean_one_of(u.rotor, rotors)));
    else if (u.grade && u.mass.of == BalanceMass::Of::span && !enclosing_supports(m, u.rotor))
      r.fail(path + ".mass", u.rotor.empty()
                                 ? "the middle of the shaft does not lie between two bearings"
                                 : fmt::format("the middle of rotor '{}' does not lie between two bearings", u.rotor));
    else if (u.grade && u.mass.of == BalanceMass::Of::rotor) {
      if (const auto disc = rotor::disc_of_no_rotor(m.rotor, u.rotor))
        r.fail(fmt::format("rotor.discs.{}", *disc + 1),
               fmt::format("two rotors meet at node {}: give the disc 'rotor', the name of the one that it belongs to, "
                           "for the mass of rotor '{}' in unbalance '{}'",
                           m.rotor.discs[*disc].node, u.rotor, u.name));
    }
  }
}

// Bearings that are bored in line with the shaft need its shape at rest, in which hinges hang on supports alone: films
// that tilt hold slopes as well.
void check_bored(const Machine& m, const deck::Report& r) {
  const std::vector<int> nodes = support_nodes(m);
  std::vector<int> slopes;
  bool bored = false;
  for (const Bearing& b : m.bearings) {
    if (!film::facts(b.film).tilts) continue;
    slopes.push_back(b.node);
    bored = bored || !b.slope;
  }
  if (!bored || nodes.size() < 2 || rotor::loose_part(m.rotor, nodes, slopes)) return;
  if (const auto loose = rotor::loose_part(m.rotor, nodes))
    r.fail(fmt::format("rotor.couplings.{}.tilt_stiffness", loose->coupling + 1),
           rotor::words(*loose, m.rotor, "on rigid supports") +
               ", and bearings whose films tilt are bored in line with the shaft at rest: give their 'slope'");
}

}  // namespace

void describe(deck::Description<Machine>& d) {
  const std::initializer_list<SystemName> rotor{{"rotor"}};
  d.add("title", &Machine::title, "what the deck is about, for the report");
  d.add("system", &Machine::system, "what the equations are those of");
  d.add("rotor", &Machine::rotor, "the shaft, or a rigid mass").only(&Machine::system, rotor).required();
  d.add("gravity", &Machine::gravity, "m/s^2", deck::any,
        "acceleration of gravity: one number along -y (negative: upwards), or [x, y, z]; along the shaft, z, it loads "
        "no bearing")
      .only(&Machine::system, rotor)
      .continuable();
  d.add("loads", &Machine::loads, "static forces and moments on nodes: a belt, a radial thrust, a misaligned coupling")
      .only(&Machine::system, rotor);
  d.add(
       "service_speed", &Machine::service_speed, "rad/s", positive,
       "speed at which the machine runs: screen and report tell together what the studies found there, and margins are "
       "counted from it where a study has no operating speed of its own; modes over a range are computed at it as "
       "well; "
       "balance grades hold for it unless they have a speed of their own")
      .only(&Machine::system, rotor);
  d.add("lubricants", &Machine::lubricants, "lubricants by name").only(&Machine::system, rotor);
  d.named("bearings", &Machine::bearings, &Bearing::name, "bearings by name").only(&Machine::system, rotor).required();
  d.add("minimum_film", &Machine::minimum_film, "m", non_negative,
        "film thickness below which journal and bearing touch: branches end there, other results are marked. Usual is "
        "three times the composite roughness of both surfaces (lambda ratio 3). Not given: 1/2000 of each clearance, "
        "three times what superfinished surfaces have, and 0 um where 'contact' lets them carry; 0 um: contact only",
        "Hamrock, Schmid and Jacobson (2004), sec. 3.8")
      .only(&Machine::system, rotor);
  d.named("elements", &Machine::elements, &Element::name,
          "linear elements that are no bearings, by name: seals, aerodynamic cross-coupling, springs. Any number may "
          "stand at a node")
      .only(&Machine::system, rotor);
  d.named("unbalance", &Machine::unbalance, &Unbalance::name, "unbalances by name, for studies to choose from")
      .only(&Machine::system, rotor);
  describe_others(d);
  d.check([](const Machine& m, const deck::Report& r) {
    if (!is_rotor(m)) return;
    const int n_nodes = static_cast<int>(m.rotor.segments.size()) + 1;
    check_bearings(m, n_nodes, r);
    check_bored(m, r);
    check_loads(m, n_nodes, r);
    check_elements(m, n_nodes, r);
    check_unbalance(m, n_nodes, r);
  });
}

}  // namespace whirl::system
