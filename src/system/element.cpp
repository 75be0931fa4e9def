#include "whirl/system/element.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "whirl/core/error.hpp"
#include "whirl/deck/description.hpp"
#include "whirl/film/contract/describe.hpp"

namespace whirl::system {

using deck::any;
using deck::positive;

std::span<const deck::Name<Role>> names(Role) {
  static constexpr deck::Name<Role> table[] = {
      {Role::seal, "seal", "an annular seal, a wear ring, a balance drum: carries no static load unless told"},
      {Role::coupling, "coupling", "aerodynamic cross-coupling, of an impeller or a stage: likewise"},
      {Role::support, "support",
       "holds the shaft as a bearing does: studies that put it on springs, pins or rigid ground do so here as well"},
      {Role::other, "other", "anything else: carries static load unless told"}};
  return table;
}

std::span<const deck::Name<Between>> names(Between) {
  static constexpr deck::Name<Between> table[] = {
      {Between::cubic, "cubic", "cubic with a continuous slope, without overshooting (Fritsch and Butland 1984)"},
      {Between::linear, "linear", "linear: the slope jumps at the rows"}};
  return table;
}

namespace {

constexpr const char* force_text = "forces by slopes: xx, xy, yx, yy";
constexpr const char* moment_text = "moments by displacements, likewise; a moment does work with its slope";
constexpr const char* tilt_text = "moments by slopes, likewise";

template <class B>
void describe_blocks(deck::Description<B>& d, const char* thin, const char* tilt) {
  d.add("force", static_cast<std::array<double, 4> B::*>(&SlopeBlocks::force), thin, any, force_text)
      .isotropic()
      .continuable();
  d.add("moment", static_cast<std::array<double, 4> B::*>(&SlopeBlocks::moment), thin, any, moment_text)
      .isotropic()
      .continuable();
  d.add("tilt", static_cast<std::array<double, 4> B::*>(&SlopeBlocks::tilt), tilt, any, tilt_text)
      .isotropic()
      .continuable();
}

using P = ElementAt;
struct Cell {
  const char* key;
  double P::*member;
  const char* unit;
};
// Stiffness, damping, mass, each row by row.
constexpr Cell cells[] = {
    {"k_xx", &P::k_xx, "N/m"},    {"k_xy", &P::k_xy, "N/m"},    {"k_xa", &P::k_xa, "N"},
    {"k_xb", &P::k_xb, "N"},      {"k_yx", &P::k_yx, "N/m"},    {"k_yy", &P::k_yy, "N/m"},
    {"k_ya", &P::k_ya, "N"},      {"k_yb", &P::k_yb, "N"},      {"k_ax", &P::k_ax, "N"},
    {"k_ay", &P::k_ay, "N"},      {"k_aa", &P::k_aa, "N m"},    {"k_ab", &P::k_ab, "N m"},
    {"k_bx", &P::k_bx, "N"},      {"k_by", &P::k_by, "N"},      {"k_ba", &P::k_ba, "N m"},
    {"k_bb", &P::k_bb, "N m"},    {"c_xx", &P::c_xx, "N s/m"},  {"c_xy", &P::c_xy, "N s/m"},
    {"c_xa", &P::c_xa, "N s"},    {"c_xb", &P::c_xb, "N s"},    {"c_yx", &P::c_yx, "N s/m"},
    {"c_yy", &P::c_yy, "N s/m"},  {"c_ya", &P::c_ya, "N s"},    {"c_yb", &P::c_yb, "N s"},
    {"c_ax", &P::c_ax, "N s"},    {"c_ay", &P::c_ay, "N s"},    {"c_aa", &P::c_aa, "N m s"},
    {"c_ab", &P::c_ab, "N m s"},  {"c_bx", &P::c_bx, "N s"},    {"c_by", &P::c_by, "N s"},
    {"c_ba", &P::c_ba, "N m s"},  {"c_bb", &P::c_bb, "N m s"},  {"m_xx", &P::m_xx, "kg"},
    {"m_xy", &P::m_xy, "kg"},     {"m_xa", &P::m_xa, "kg m"},   {"m_xb", &P::m_xb, "kg m"},
    {"m_yx", &P::m_yx, "kg"},     {"m_yy", &P::m_yy, "kg"},     {"m_ya", &P::m_ya, "kg m"},
    {"m_yb", &P::m_yb, "kg m"},   {"m_ax", &P::m_ax, "kg m"},   {"m_ay", &P::m_ay, "kg m"},
    {"m_aa", &P::m_aa, "kg m^2"}, {"m_ab", &P::m_ab, "kg m^2"}, {"m_bx", &P::m_bx, "kg m"},
    {"m_by", &P::m_by, "kg m"},   {"m_ba", &P::m_ba, "kg m^2"}, {"m_bb", &P::m_bb, "kg m^2"},
};

}  // namespace

void describe(deck::Description<StiffnessBlocks>& d) {
  describe_blocks(d, "N", "N m");
}

void describe(deck::Description<DampingBlocks>& d) {
  describe_blocks(d, "N s", "N m s");
}

void describe(deck::Description<MassBlocks>& d) {
  describe_blocks(d, "kg m", "kg m^2");
}

void describe(deck::Description<SlopeTerms>& d) {
  d.add("stiffness", &SlopeTerms::stiffness, "what slopes add to K");
  d.add("damping", &SlopeTerms::damping, "what slopes add to C");
  d.add("mass", &SlopeTerms::mass, "what slopes add to M");
}

void describe(deck::Description<ElementAt>& d) {
  d.add("speed", &P::speed, "rad/s", deck::non_negative, "of the shaft").required();
  for (const Cell& c : cells) {
    const std::string key = c.key;
    const char* const what = key[0] == 'k' ? "stiffness" : key[0] == 'c' ? "damping" : "added mass";
    const bool first = key == "k_xx";
    d.add(key, c.member, c.unit, any,
          first ? std::string("stiffness, force along x by a motion along x; a is the slope dx/dz, b dy/dz")
                : fmt::format("{} {} by {}", what, key[2], key[3]));
  }
}

void describe(deck::Description<Element>& d) {
  const auto matrix = [&d](const char* key, std::array<double, 4> Element::*member, const char* unit,
                           const char* text) { d.add(key, member, unit, any, text).isotropic().continuable(); };
  d.add("node", &Element::node, positive, "node of the shaft at which it acts").required();
  d.add("to_node", &Element::to_node, positive,
        "another node of the shaft that is its other end; the ground if absent");
  d.add("to_pedestal", &Element::to_pedestal, "the bearing whose pedestal is its other end");
  d.add("role", &Element::role, "what it is in the machine").required();
  d.add("static_load", &Element::static_load,
        "whether it acts on the machine at rest. One that does not acts on the motion about the static equilibrium "
        "without it; 'support' and 'other' do if not given, 'seal' and 'coupling' do not");
  matrix("stiffness", &Element::stiffness, "N/m", "K: xx, xy, yx, yy of force = -K d - C d' - M d''");
  d.add("cross_coupling", &Element::cross_coupling, "N/m", any,
        "Q, which adds to K_xy and is taken from K_yx: a positive one drives forward whirl")
      .continuable();
  matrix("damping", &Element::damping, "N s/m", "C, likewise");
  matrix("mass", &Element::mass, "kg", "M, likewise: the added mass of the fluid");
  d.add("slopes", &Element::slopes,
        "what slopes of the shaft add to these: with it K, C and M are 4 x 4, by x, y, dx/dz, dy/dz");
  d.table("table", &Element::table, "coefficients over the speed, which add to those; five rows or more are wanted");
  d.add("interpolation", &Element::interpolation, "between the rows of the table");
  d.add("extrapolate", &Element::extrapolate, "coefficients at speeds beyond the table");
  d.check([](const Element& e, const deck::Report& r) {
    if (e.to_node && e.to_pedestal) r.fail("to_pedestal", "an element has one other end: 'to_node' or 'to_pedestal'");
    if (e.to_node && *e.to_node == e.node) r.fail("to_node", "an element stands between two nodes, not one");
    for (std::size_t i = 1; i < e.table.size(); ++i)
      if (!(e.table[i].speed > e.table[i - 1].speed))
        return r.fail("table", fmt::format("speeds rise: row {} does not", i + 1));
  });
}

bool carries_static_load(const Element& e) {
  return e.static_load.value_or(e.role == Role::support || e.role == Role::other);
}

bool sees_slopes(const Element& e) {
  return e.slopes || std::any_of(e.table.begin(), e.table.end(), [](const ElementAt& row) {
           return std::any_of(std::begin(cells), std::end(cells), [&row](const Cell& c) {
             const std::string_view key = c.key;
             const bool slope = key.find_first_of("ab", 2) != std::string_view::npos;
             return slope && row.*c.member != 0;
           });
         });
}

bool holds_shaft(const Element& e) {
  return e.role == Role::support && !e.to_node;
}

namespace {

// xx, xy, yx, yy into rows and columns from `row` and `column` of a 4 x 4 matrix.
void put(const std::array<double, 4>& block, std::size_t row, std::size_t column, ElementCoefficients::Matrix& to) {
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) to[4 * (row + i) + column + j] = block[2 * i + j];
}

ElementCoefficients constant_of(const Element& e) {
  ElementCoefficients out;
  const SlopeTerms none, &slopes = e.slopes ? *e.slopes : none;
  const auto fill = [](const std::array<double, 4>& plane, const SlopeBlocks& of, ElementCoefficients::Matrix& to) {
    put(plane, 0, 0, to);
    put(of.force, 0, 2, to);
    put(of.moment, 2, 0, to);
    put(of.tilt, 2, 2, to);
  };
  fill(e.stiffness, slopes.stiffness, out.stiffness);
  out.stiffness[1] += e.cross_coupling;
  out.stiffness[4] -= e.cross_coupling;
  fill(e.damping, slopes.damping, out.damping);
  fill(e.mass, slopes.mass, out.mass);
  return out;
}

}  // namespace

ElementCurve::ElementCurve(const Element& e)
    : name_(e.name), constant_(constant_of(e)), hold_(e.extrapolate == film::Linear::Beyond::hold) {
  std::vector<double> speeds, values;
  for (const ElementAt& row : e.table) {
    speeds.push_back(row.speed);
    for (const Cell& c : cells) values.push_back(row.*c.member);
  }
  curve_ = core::Curve(std::move(speeds), std::move(values),
                       e.interpolation == Between::linear ? core::Curve::Between::linear : core::Curve::Between::cubic);
}

ElementCurve::At ElementCurve::at(double speed) const {
  At out{constant_, {}};
  if (curve_.empty()) return out;
  const double low = curve_.first(), high = curve_.last(), rounding = 1e-9 * high;
  const bool beyond = curve_.varies() && !(speed >= low - rounding && speed <= high + rounding);
  if (beyond && !hold_)
    throw core::DomainError(
        fmt::format("element {}: its table reaches from {:.6g} to {:.6g} rad/s, and the speed is {:.6g} rad/s; "
                    "'extrapolate: hold' keeps the values of the nearest end",
                    name_, low, high, speed));
  std::array<double, std::size(cells)> value{}, slope{};
  curve_.at(beyond ? speed : std::clamp(speed, low, high), value, slope);
  ElementCoefficients::Matrix* const to[] = {&out.value.stiffness, &out.value.damping, &out.value.mass};
  ElementCoefficients::Matrix* const by[] = {&out.by_speed.stiffness, &out.by_speed.damping, &out.by_speed.mass};
  for (std::size_t k = 0; k < value.size(); ++k) {
    (*to[k / 16])[k % 16] += value[k];
    (*by[k / 16])[k % 16] = slope[k];
  }
  return out;
}

}  // namespace whirl::system
