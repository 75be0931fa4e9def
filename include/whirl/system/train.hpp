#pragma once
// A machine with every name resolved and every number in SI: what the equations are made of.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "whirl/film/contract/options.hpp"
#include "whirl/rotor/options.hpp"
#include "whirl/system/element.hpp"

namespace whirl::system {

/// A bearing: film between the journal at `node` and a pedestal (or the rigid ground).
struct Support {
  std::string name;      ///< for messages
  int node = 0;          ///< 1-based
  double elevation = 0;  ///< of the bearing centre, positive up [m]
  /// dx/dz, dy/dz of the bearing's axis, of a film that tilts; that of the shaft at rest on its bearings if absent
  std::optional<std::array<double, 2>> slope;
  film::Geometry geometry;
  film::Options film;
  film::Lubricant lubricant;
  double minimum_film = 0;  ///< film thickness below which journal and bearing touch [m]; 0 where there is no film
  bool has_pedestal = false;
  std::array<double, 2> mass{}, stiffness{}, damping{};  ///< of the pedestal in x and y [kg, N/m, N s/m]
};

/// An unbalance U at a node: force U Omega^2 (cos, sin)(angle + phase); of a couple a moment on its slopes.
struct UnbalanceMass {
  int node = 0;
  double amount = 0;  ///< U [kg m], of a couple [kg m^2]
  double phase = 0;   ///< [rad]
  bool couple = false;
  friend bool operator==(const UnbalanceMass&, const UnbalanceMass&) = default;
};

/// A force and a moment that stand still: a belt, a radial thrust.
struct StaticLoad {
  int node = 0;                   ///< 1-based
  std::array<double, 2> force{};  ///< along x and y [N]
  /// About x and y [N m]: on the slopes dx/dz and dy/dz it is (M_y, -M_x). A reduction keeps the slopes where it is
  /// given, be it zero.
  std::optional<std::array<double, 2>> moment;
  friend bool operator==(const StaticLoad&, const StaticLoad&) = default;
};

class RestFinder;

struct Train {
  rotor::Options rotor;
  double gravity = 9.81;  ///< along -y [m/s^2]
  double gravity_x = 0;   ///< along x [m/s^2]
  std::vector<StaticLoad> loads;
  std::vector<Support> supports;
  std::vector<Element> elements;
  std::vector<UnbalanceMass> unbalance;
  /// Finds the static equilibrium about which elements act that carry no static load; machines whose films are all
  /// linear need none.
  const RestFinder* rest = nullptr;
};

}  // namespace whirl::system
