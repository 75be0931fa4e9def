#pragma once
// Linear elements that are no bearings: seals, aerodynamic cross-coupling, springs to the ground or between nodes.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "whirl/core/curve.hpp"
#include "whirl/film/contract/linear.hpp"

namespace whirl::deck {
template <class S>
class Description;
template <class E>
struct Name;
}  // namespace whirl::deck

namespace whirl::system {

/// What an element is in the machine. Only a support to the ground holds the shaft where studies put supports on pins,
/// on springs or on rigid ground, and where a span ends.
enum class Role { seal, coupling, support, other };
[[nodiscard]] std::span<const deck::Name<Role>> names(Role);

/// How a table goes on between its rows.
enum class Between { cubic, linear };
[[nodiscard]] std::span<const deck::Name<Between>> names(Between);

/// Blocks xx, xy, yx, yy of a matrix by the freedoms x, y, dx/dz, dy/dz: forces by slopes, moments by displacements,
/// moments by slopes. A moment does work with its slope.
struct SlopeBlocks {
  std::array<double, 4> force{}, moment{}, tilt{};
  friend bool operator==(const SlopeBlocks&, const SlopeBlocks&) = default;
};
struct StiffnessBlocks : SlopeBlocks {};  ///< N, N, N m
struct DampingBlocks : SlopeBlocks {};    ///< N s, N s, N m s
struct MassBlocks : SlopeBlocks {};       ///< kg m, kg m, kg m^2

struct SlopeTerms {
  StiffnessBlocks stiffness;
  DampingBlocks damping;
  MassBlocks mass;
  friend bool operator==(const SlopeTerms&, const SlopeTerms&) = default;
};

/// A row of a table over the speed. `a` stands for the slope dx/dz, `b` for dy/dz; the first letter is the force's or
/// the moment's.
struct ElementAt {
  double speed = 0;  // rad/s
  double k_xx = 0, k_xy = 0, k_xa = 0, k_xb = 0, k_yx = 0, k_yy = 0, k_ya = 0, k_yb = 0;
  double k_ax = 0, k_ay = 0, k_aa = 0, k_ab = 0, k_bx = 0, k_by = 0, k_ba = 0, k_bb = 0;
  double c_xx = 0, c_xy = 0, c_xa = 0, c_xb = 0, c_yx = 0, c_yy = 0, c_ya = 0, c_yb = 0;
  double c_ax = 0, c_ay = 0, c_aa = 0, c_ab = 0, c_bx = 0, c_by = 0, c_ba = 0, c_bb = 0;
  double m_xx = 0, m_xy = 0, m_xa = 0, m_xb = 0, m_yx = 0, m_yy = 0, m_ya = 0, m_yb = 0;
  double m_ax = 0, m_ay = 0, m_aa = 0, m_ab = 0, m_bx = 0, m_by = 0, m_ba = 0, m_bb = 0;
  friend bool operator==(const ElementAt&, const ElementAt&) = default;
};

/// K [N/m], C [N s/m] and M [kg] of an element by the freedoms x, y, dx/dz, dy/dz, row by row; moments and slopes in
/// their own units.
struct ElementCoefficients {
  using Matrix = std::array<double, 16>;
  Matrix stiffness{}, damping{}, mass{};
};

/// An element between a node and the ground, a pedestal or another node. With d the motion of the node less that of the
/// other end, counted from the static equilibrium of the machine without the elements that carry no static load, or
/// from the undeformed shaft if it carries one:
///
///     force on the node = -(K d + C d' + M d''),  the opposite on the other end
struct Element {
  std::string name;
  int node = 0;                            ///< 1-based
  std::optional<int> to_node{};            ///< 1-based
  std::optional<std::string> to_pedestal;  ///< of this bearing
  Role role = Role::other;
  std::optional<bool> static_load;    ///< carried or not; by its role if not given
  std::array<double, 4> stiffness{};  ///< N/m, xx xy yx yy
  double cross_coupling = 0;          ///< Q [N/m]: K_xy += Q, K_yx -= Q
  std::array<double, 4> damping{};    ///< N s/m
  std::array<double, 4> mass{};       ///< kg
  std::optional<SlopeTerms> slopes;   ///< what slopes feel and do
  std::vector<ElementAt> table = {};  ///< by rising speed, added to those
  Between interpolation = Between::cubic;
  film::Linear::Beyond extrapolate = film::Linear::Beyond::none;
  friend bool operator==(const Element&, const Element&) = default;
};

void describe(deck::Description<StiffnessBlocks>& d);
void describe(deck::Description<DampingBlocks>& d);
void describe(deck::Description<MassBlocks>& d);
void describe(deck::Description<SlopeTerms>& d);
void describe(deck::Description<ElementAt>& d);
void describe(deck::Description<Element>& d);

/// Whether it acts on the machine at rest.
[[nodiscard]] bool carries_static_load(const Element& element);
/// Whether slopes feel it.
[[nodiscard]] bool sees_slopes(const Element& element);
/// A support between a node and the ground or a pedestal: studies see it where they look for what holds the shaft.
[[nodiscard]] bool holds_shaft(const Element& element);

/// The coefficients of an element over the speed.
class ElementCurve {
public:
  explicit ElementCurve(const Element& element);
  /// Whether they change with the speed.
  [[nodiscard]] bool varies() const { return curve_.varies(); }
  struct At {
    ElementCoefficients value, by_speed;
  };
  /// At a speed [rad/s]. Throws core::DomainError beyond a table that does not hold its ends.
  [[nodiscard]] At at(double speed) const;

private:
  std::string name_;
  ElementCoefficients constant_;
  core::Curve curve_;
  bool hold_;
};

}  // namespace whirl::system
