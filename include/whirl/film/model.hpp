#pragma once
// Quasi-static fluid films: journal motion in, film force on the journal and its exact tangents out.

#include <array>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "whirl/film/options.hpp"

namespace whirl::film {

/// Motion of the journal relative to the bearing centre; x right, y up, shaft turning x -> y.
struct Motion {
  std::array<double, 4> position{};  // x, y [m], tilt dx/dz, dy/dz [-] about the mid-plane of the bearing
  std::array<double, 4> velocity{};  // their rates [m/s, 1/s]
  double speed = 0.0;                // Omega [rad/s]

  friend bool operator==(const Motion&, const Motion&) = default;
};

/// What the caller of evaluate() wants; `tangents` includes the force.
enum class Need { force, tangents };

/// Film force on the journal and the derivatives of the discrete force, work-conjugate to Motion::position.
struct Response {
  std::array<double, 4> force{};                      // F_x, F_y [N], M_x, M_y [N m]
  std::array<std::array<double, 4>, 4> d_position{};  // [i][j] = d force_i / d position_j; stiffness K is its negative
  std::array<std::array<double, 4>, 4> d_velocity{};  // [i][j] = d force_i / d velocity_j; damping C is its negative
  std::array<double, 4> d_speed{};                    // [i] = d force_i / d Omega
  double min_thickness = 0.0;  // m, least of all pads, exactly (minimum_thickness); infinite for a linear film
};

/// Quantities for reports, computed apart from evaluate() so that they cost nothing inside solvers.
/// NaN where the film does not know: peak pressure and side flow of finite_approximate.
struct Summary {
  double min_thickness = 0.0;  // m
  double max_pressure = 0.0;   // Pa
  double side_flow = 0.0;      // m^3/s, out of both sides of all pads
  double power_loss =
      0.0;  // W, friction torque on the journal times Omega; full film everywhere unless it knows its fill
  double inlet_flow = std::numeric_limits<double>::quiet_NaN();   // m^3/s, around into all pads where their films start
  double outlet_flow = std::numeric_limits<double>::quiet_NaN();  // m^3/s, around out of all pads where they end
  // m^3/s, out of each supply hole into the film; empty if the film does not know it
  std::vector<double> hole_flows = {};
  // m^3/s, what enters less what leaves through edges and sides and what the moving journal presses out: the volume
  // that cavitation makes or loses, zero if it conserves its mass. Films that cut off their pressure do not know it.
  double imbalance = std::numeric_limits<double>::quiet_NaN();
};

/// One array on the grid of one pad, row-major.
struct Field {
  int pad;                         // 0 = lower, 1 = upper
  std::string name;                // theta, z, pressure, thickness, fill
  std::string unit;                // rad, m, Pa, m, 1
  std::vector<std::size_t> shape;  // {n_theta}, {n_z} or {n_theta, n_z}
  std::vector<double> values;
};

/// A film without own states: force = f(position, velocity, Omega). Not thread-safe (own workspace).
class Model {
public:
  Model() = default;
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;
  virtual ~Model() = default;
  /// Fills `response`; the derivatives are those of the discrete force, zero if only the force is needed.
  /// Throws core::DomainError where the film thickness is not positive, or the film runs dry.
  virtual void evaluate(const Motion& motion, Need need, Response& response) = 0;
  /// Report quantities at `motion`; throws as evaluate() does.
  virtual Summary summary(const Motion& motion) = 0;
  /// Pressure and thickness at the grid nodes of every pad; empty for a linear film; throws as evaluate() does.
  virtual std::vector<Field> fields(const Motion& motion) = 0;
  /// Least thickness of the film [m] over its whole length, exactly where the bore is rigid: not positive where the
  /// surfaces touch. Infinite for a linear film. Throws as evaluate() does where the film itself has to be known.
  [[nodiscard]] virtual double least_thickness(const Motion& motion) = 0;
  /// Starts the search for its pressure from where `other` ended, a film of the same mesh with other numbers. Without
  /// effect on a film that searches nothing, or if the meshes differ.
  virtual void start_from(const Model& /*other*/) {}
};

/// Least film thickness [m] over all pads of a rigid bore, exactly and free of any mesh, with the journal at `position`
/// as in Motion (set the slopes to zero for a film that ignores tilt). Zero or negative: journal and pad touch.
[[nodiscard]] double minimum_thickness(const Geometry& geometry, const std::array<double, 4>& position);

/// The film described by the options, which has no own states; throws core::InputError on values outside their range.
std::unique_ptr<Model> make_model(const Geometry& geometry, const Options& options, const Lubricant& lubricant);

}  // namespace whirl::film
