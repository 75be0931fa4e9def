#pragma once
// What a fluid film takes and gives: journal motion in, force on the journal and its exact tangents out.

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "whirl/core/port_response.hpp"

namespace whirl::film {

/// The names of the contract of ports in films: the first body is a journal, the second one its bearing.
using core::all_ports;
using core::Port;
using core::ThinRows;
using JournalMotion = core::PortMotion;
using Response = core::PortResponse;
using StateResponse = core::PartResponse;

/// What the caller of evaluate() wants; `tangents` includes the force.
enum class Need { force, tangents };

/// Thin columns, spread like the states: [port][row of the share], ports as the film names them.
using PortColumns = std::vector<std::vector<double>>;

/// Quantities for reports, computed apart from evaluate() so that they cost nothing inside solvers.
/// NaN where the film does not know: peak pressure and side flow of finite_approximate.
struct FilmReport {
  double min_thickness = 0.0;  // m
  double max_pressure = 0.0;   // Pa
  // K, of a film with heat: highest anywhere, and mean over its volume
  double max_temperature = std::numeric_limits<double>::quiet_NaN();
  double mean_temperature = std::numeric_limits<double>::quiet_NaN();
  double side_flow = 0.0;  // m^3/s, out of both sides of all pads
  // W, friction torque on the journal times Omega; full film everywhere unless it knows its fill
  double power_loss = 0.0;
  double inlet_flow = std::numeric_limits<double>::quiet_NaN();   // m^3/s, around into all pads where their films start
  double outlet_flow = std::numeric_limits<double>::quiet_NaN();  // m^3/s, around out of all pads where they end
  // m^3/s, out of each supply hole into the film; empty if the film does not know it
  std::vector<double> hole_flows = {};
  // m^3/s, what enters less what leaves through edges and sides and what the moving journal presses out: the volume
  // that cavitation makes or loses, zero if it conserves its mass. Films that cut off their pressure do not know it.
  double imbalance = std::numeric_limits<double>::quiet_NaN();
  double mass_flow = std::numeric_limits<double>::quiet_NaN();    // kg/s, of gas out of all orifices
  double drag_torque = std::numeric_limits<double>::quiet_NaN();  // N m, on the journal, of a film of gas
};

/// One array on the grid of one pad, row-major.
struct NodalField {
  int pad;                         // 0 = lower, 1 = upper
  std::string name;                // theta, z, pressure, thickness, fill
  std::string unit;                // rad, m, Pa, m, 1
  std::vector<std::size_t> shape;  // {n_theta}, {n_z} or {n_theta, n_z}
  std::vector<double> values;
};

}  // namespace whirl::film
