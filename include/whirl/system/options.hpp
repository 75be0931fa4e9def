#pragma once
// What a deck says about a machine: rotor, bearings, lubricants, unbalance. Plain data in SI, names not yet resolved.

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "whirl/deck/description.hpp"
#include "whirl/deck/number_or_list.hpp"
#include "whirl/film/contract/options.hpp"
#include "whirl/rotor/options.hpp"
#include "whirl/system/others.hpp"
#include "whirl/system/train.hpp"

namespace whirl::system {

/// What stands under a bearing, in x and y, uncoupled: M u'' + C u' + K u = film force on the bearing - M g in y.
struct Pedestal {
  std::array<double, 2> mass{};       ///< [kg]
  std::array<double, 2> stiffness{};  ///< [N/m]
  std::array<double, 2> damping{};    ///< [N s/m]
};

struct Bearing {
  std::string name;
  int node = 0;                                ///< 1-based
  double elevation = 0;                        ///< of the bearing centre, positive up [m]
  std::optional<std::array<double, 2>> slope;  ///< dx/dz, dy/dz of its axis; aligned to the shaft at rest if absent
  std::optional<film::Geometry> geometry;      ///< absent only for a linear film
  film::Options film;
  std::variant<std::string, film::Lubricant>
      lubricant;                       ///< a name of Machine::lubricants, or its own; unused by a linear film
  std::optional<Pedestal> pedestal;    ///< rigid if absent
  std::optional<double> minimum_film;  ///< thickness below which the surfaces touch [m]; that of the machine if absent
};

/// Permissible e Omega of ISO 21940-11 (G2.5 is 2.5 mm/s).
struct BalanceGrade {
  double velocity = 0;  ///< [m/s]
};

/// A balancing plane. Either a fraction of the unbalance of the grade, or an own amount, or the eccentricity of the
/// mass of a rigid rotor.
struct Plane {
  int node = 0;                        ///< 1-based
  std::optional<double> fraction;      ///< of M e_u
  std::optional<double> amount;        ///< U [kg m]
  std::optional<double> eccentricity;  ///< U/m of a rigid rotor [m]
  double phase = 0;                    ///< [rad]
};

/// The mass to which a grade applies: that of the rotor (ISO 21940-11), that between the two neighbouring bearings
/// between which the middle of the rotor lies (Gavalas 2022, eq. 2.2), or a given one.
struct BalanceMass {
  enum class Of { rotor, span, given };
  Of of = Of::rotor;
  double given = 0;  ///< [kg]
};

/// A named unbalance. With a grade: U = fraction M e_u, e_u = grade / service speed. Source: ISO 21940-11.
struct Unbalance {
  std::string name;
  std::optional<BalanceGrade> grade;
  std::optional<double> service_speed;  ///< [rad/s]; empty: that of the machine
  std::string rotor;                    ///< empty: the whole shaft
  BalanceMass mass;
  std::vector<Plane> planes;
};

/// Acceleration of gravity [m/s^2]: along -y, or its components x, y, z. That along the shaft loads no bearing.
using Gravity = std::variant<double, std::array<double, 3>>;
/// Its components across the shaft, x and y [m/s^2].
[[nodiscard]] std::array<double, 2> lateral(const Gravity& gravity);

/// A rotor in its bearings, or the options of another system.
struct Machine : Others {
  std::string title;
  SystemName system;
  rotor::Options rotor;
  Gravity gravity = 9.81;
  std::vector<StaticLoad> loads;
  std::optional<deck::Quantity> service_speed;  ///< at which the machine runs [rad/s]
  std::map<std::string, film::Lubricant> lubricants;
  std::vector<Bearing> bearings;       ///< in the order of the deck
  std::optional<double> minimum_film;  ///< of every bearing [m]; film::default_minimum_film() if absent
  std::vector<Element> elements;       ///< in the order of the deck
  std::vector<Unbalance> unbalance;    ///< in the order of the deck
  const RestFinder* rest = nullptr;    ///< as Train::rest; not of the deck
};

void describe(deck::Description<Pedestal>& d);
void describe(deck::Description<Bearing>& d);
void describe(deck::Description<StaticLoad>& d);
void describe(deck::Description<Plane>& d);
void describe(deck::Description<Unbalance>& d);
void describe(deck::Description<Machine>& d);
/// The options of all systems beside the rotor; after `system`, which selects one.
void describe_others(deck::Description<Machine>& d);

[[nodiscard]] inline bool is_rotor(const Machine& machine) {
  return machine.system.name == "rotor";
}

/// Position of the bearing or unbalance `name`; empty if there is none.
[[nodiscard]] std::optional<std::size_t> find_bearing(const Machine& machine, std::string_view name);
[[nodiscard]] std::optional<std::size_t> find_element(const Machine& machine, std::string_view name);
[[nodiscard]] std::optional<std::size_t> find_unbalance(const Machine& machine, std::string_view name);
[[nodiscard]] std::vector<std::string> bearing_names(const Machine& machine);
[[nodiscard]] std::vector<std::string> unbalance_names(const Machine& machine);

/// Nodes at which bearings and elements that are supports hold the shaft, ascending, each once.
[[nodiscard]] std::vector<int> support_nodes(const Machine& machine);

/// Nodes at which bearings, elements and loads act, which a reduction keeps; of those, nodes whose slopes it keeps.
/// Ascending, each once.
[[nodiscard]] std::vector<int> acting_nodes(const Machine& machine);
[[nodiscard]] std::vector<int> slope_nodes(const Machine& machine);

/// The name by which studies ask for what eccentric and skewed discs do.
inline constexpr std::string_view unbalance_of_discs = "discs";
/// Whether a disc is eccentric or skewed.
[[nodiscard]] bool discs_force(const Machine& machine);
/// Nodes on which the unbalance `name` acts, or its discs stand; empty if there is none.
[[nodiscard]] std::vector<int> unbalance_nodes(const Machine& machine, std::string_view name);

/// The two neighbouring nodes of support_nodes() between which the middle of rotor `name` lies (of the whole shaft if
/// it is empty); empty if there is no such rotor or no such pair.
[[nodiscard]] std::optional<std::array<int, 2>> enclosing_supports(const Machine& machine, std::string_view rotor);

/// M of an unbalance with a grade [kg], for a machine that was checked.
[[nodiscard]] double graded_mass(const Machine& machine, const Unbalance& unbalance);

/// Masses of one unbalance, U = fraction M e_u or the given amounts, for a machine that was checked.
[[nodiscard]] std::vector<UnbalanceMass> unbalance_masses(const Machine& machine, const Unbalance& unbalance);

/// The machine with all names resolved and the named unbalances applied (all at once; `discs`: what the discs do by
/// themselves), for the equations. Supports
/// stand in the order of the deck.
[[nodiscard]] Train train_of(const Machine& machine, const std::vector<std::string>& unbalance = {});

}  // namespace whirl::system

namespace whirl::deck {
template <>
struct CodecOf<system::BalanceGrade> {
  static std::shared_ptr<const Codec> make(const Spec&);
};
template <>
struct CodecOf<system::BalanceMass> {
  static std::shared_ptr<const Codec> make(const Spec&);
};
}  // namespace whirl::deck
