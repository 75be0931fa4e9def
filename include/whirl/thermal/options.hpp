#pragma once
// What a deck says about a film with heat: its lubricant, what feeds it, and what stands beside it. Plain data in SI.

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "whirl/deck/description.hpp"
#include "whirl/thermal/fluid.hpp"

namespace whirl::thermal {

/// The law of another property, as a choice.
struct PropertyOptions {
  PropertyLaw law;
};

struct FluidOptions {
  enum class Type { gas, liquid };
  Type type = Type::liquid;
  ViscosityOptions viscosity;
  double gas_constant = 286.7;  // J/(kg K)
  double heat_ratio = 1.4;      // -, of specific heats
  double density = 0;           // kg/m^3, of a liquid
  double heat_capacity = 0;     // J/(kg K)
  double conductivity = 0;      // W/(m K)
  PropertyOptions density_law, heat_capacity_law, conductivity_law;
};

/// What the options say of the fluid of a film.
[[nodiscard]] Fluid make_fluid(const FluidOptions& options);

/// A ring of equal orifices.
struct OrificeRing {
  int count = 8;
  double angle = 0;     // rad, of the first
  double z = 0;         // m, from the mid-plane
  double diameter = 0;  // m
  double pressure = 0;  // Pa, absolute, of the supply
  enum class Inlet { supply, bush };
  Inlet inlet = Inlet::supply;  // what temperature the gas enters with
  double temperature = 300;     // K, of the supply
};

/// An axial groove through which oil comes.
struct SupplyGroove {
  double angle = 0;              // rad, of its middle
  double width = 0;              // rad
  std::optional<double> length;  // m, about the mid-plane; that of the bearing if absent
  double pressure = 0;           // Pa, above ambient
  double temperature = 313.15;   // K
};

/// What a wall of the film is.
struct WallOptions {
  enum class Type { isothermal, adiabatic, solid };
  Type type = Type::isothermal;
  double temperature = 300;               // K, isothermal
  double conductivity = 0;                // W/(m K), solid
  double radius = 0;                      // m, solid: outer radius of a bush / radius of the bore of a journal
  int layers = 8;                         // -, solid
  double convection = 0;                  // W/(m^2 K), solid, at all its free surfaces
  std::optional<double> bore_convection;  // W/(m^2 K), solid journal: in the bore; `convection` if absent
  double ambient = 300;                   // K, solid
  double shaft_length = 0;                // m, solid journal
  double shaft_before = 0;                // m, solid journal: from its first end to the film
  bool growth = false;                    // solid: its growth changes the clearance
  double expansion = 0;                   // 1/K, solid with growth, linear
  std::optional<double> reference;        // K, at which the clearance is that of the bearing; `ambient` if absent
};

struct Ambient {
  double pressure = 101325;  // Pa
  double temperature = 300;  // K
};

}  // namespace whirl::thermal
