#pragma once
// What a fluid film takes and gives: journal motion in, force on the journal and its exact tangents out.

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace whirl::film {

/// Motion of the journal relative to the bearing centre; x right, y up, shaft turning x -> y.
struct JournalMotion {
  std::array<double, 4> position{};  // x, y [m], tilt dx/dz, dy/dz [-] about the mid-plane of the bearing
  std::array<double, 4> velocity{};  // their rates [m/s, 1/s]
  double speed = 0.0;                // Omega [rad/s]

  friend bool operator==(const JournalMotion&, const JournalMotion&) = default;
};

/// What the caller of evaluate() wants; `tangents` includes the force.
enum class Need { force, tangents };

/// Film force on the journal and the derivatives of the discrete force, work-conjugate to JournalMotion::position.
struct Response {
  std::array<double, 4> force{};                      // F_x, F_y [N], M_x, M_y [N m]
  std::array<std::array<double, 4>, 4> d_position{};  // [i][j] = d force_i / d position_j; stiffness K is its negative
  std::array<std::array<double, 4>, 4> d_velocity{};  // [i][j] = d force_i / d velocity_j; damping C is its negative
  std::array<double, 4> d_speed{};                    // [i] = d force_i / d Omega
  double min_thickness = 0.0;                         // m, least of all pads, exactly; infinite for a linear film
};

/// A motion of the journal that a film sees, and the force that does work with it: where they stand in JournalMotion
/// and in Response.
enum class Port { x, y, tilt_x, tilt_y };
/// In their order; a film that does not follow tilt sees the first two.
inline constexpr std::array<Port, 4> all_ports = {Port::x, Port::y, Port::tilt_x, Port::tilt_y};

/// Thin blocks of derivatives, spread like the states: [port][row of the share], ports as the film names them.
using PortColumns = std::vector<std::vector<double>>;

/// g(motion, s, s') of the rows of a share, its part of the force on the journal, and all derivatives. Forces and their
/// derivatives of all shares of a film add up (min_thickness: the least). A film without states has the journal's
/// alone.
struct StateResponse {
  Response journal;                       // force and its derivatives at constant s
  std::vector<double> residual;           // [rows] g
  std::vector<double> d_states, d_rates;  // dg/ds, dg/ds' at the places of the share
  PortColumns d_position, d_velocity;     // dg/d(position), dg/d(velocity)
  std::vector<double> d_speed;            // [rows] dg/dOmega
  PortColumns force_d_states;             // d force/d s_k of the states k held
  PortColumns force_d_rates;              // likewise d force/d s'_k; no ports if zero

  /// Leaves no rows and nothing of an evaluation before; returns the journal's part.
  Response& without_states() {
    for (std::vector<double>* v : {&residual, &d_states, &d_rates, &d_speed}) v->clear();
    for (PortColumns* columns : {&d_position, &d_velocity, &force_d_states, &force_d_rates}) columns->clear();
    return journal = {};
  }
};

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
