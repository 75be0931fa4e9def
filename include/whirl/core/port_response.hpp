#pragma once
// The contract of ports: what a part of a machine takes of the bodies that it joins, and what it gives back.

#include <Eigen/Core>
#include <array>
#include <vector>

namespace whirl::core {

/// Relative motions of the two bodies that a part joins (a journal less its bearing), and the forces that do work with
/// them: where they stand in PortMotion and in PortResponse. A part sees some of them and knows nothing of the others.
enum class Port { x, y, tilt_x, tilt_y };
/// In their order; a part that does not follow tilt sees the first two.
inline constexpr std::array<Port, 4> all_ports = {Port::x, Port::y, Port::tilt_x, Port::tilt_y};

/// Motion of the first body relative to the second one; x right, y up, the shaft turns x -> y.
struct PortMotion {
  std::array<double, 4> position{};  ///< x, y [m], tilt dx/dz, dy/dz [-] about the middle of the part
  std::array<double, 4> velocity{};  ///< their rates [m/s, 1/s]
  double speed = 0.0;                ///< Omega of the first body [rad/s]; the second one does not turn

  friend bool operator==(const PortMotion&, const PortMotion&) = default;
};

/// Force on the first body and its derivatives, work-conjugate to PortMotion::position. The second body has the
/// opposite.
struct PortResponse {
  std::array<double, 4> force{};                      ///< F_x, F_y [N], M_x, M_y [N m]
  std::array<std::array<double, 4>, 4> d_position{};  ///< [i][j] = d force_i/d position_j: minus the stiffness
  std::array<std::array<double, 4>, 4> d_velocity{};  ///< [i][j] = d force_i/d velocity_j: minus the damping
  std::array<double, 4> d_speed{};                    ///< [i] = d force_i/d Omega
  double min_thickness = 0.0;                         ///< m, the least gap, exactly; infinite where there is none
};

/// Thin derivatives, spread like the states: a row for each port in its order, row by row in memory.
using ThinRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// g(motion, s, s') of the rows of a share of a part with states s of its own, its part of the force, and all
/// derivatives. Forces and their derivatives of all shares add up (min_thickness: the least). A part without states has
/// the force alone. p ports that the part sees.
struct PartResponse {
  PortResponse journal;                   ///< force and its derivatives at constant s
  std::vector<double> residual;           ///< g [rows]
  std::vector<double> d_states, d_rates;  ///< dg/ds, dg/ds' at the places of the share
  ThinRows inputs;                        ///< dg/dw [2 p x rows], w: positions, then velocities
  std::vector<double> d_speed;            ///< dg/dOmega [rows]
  ThinRows forces;                        ///< df/ds [p x rows] of the states held
  ThinRows force_rates;                   ///< df/ds' likewise; no rows if zero

  /// Makes room for derivatives of `rows` rows at `ports` ports, or without `tangents` for none.
  void resize(bool tangents, Eigen::Index ports, Eigen::Index rows) {
    inputs.resize(2 * ports, tangents ? rows : 0);
    forces.resize(ports, tangents ? rows : 0);
    force_rates.resize(0, 0);
  }
  /// Leaves no rows and nothing of an evaluation before; returns the force's part.
  PortResponse& without_states() {
    for (std::vector<double>* v : {&residual, &d_states, &d_rates, &d_speed}) v->clear();
    for (ThinRows* m : {&inputs, &forces, &force_rates}) m->resize(0, 0);
    return journal = {};
  }
  /// Row of `inputs` of the n-th position, or velocity.
  [[nodiscard]] double* by_position(std::size_t n) { return inputs.row(static_cast<Eigen::Index>(n)).data(); }
  [[nodiscard]] double* by_velocity(std::size_t n) {
    return inputs.row(inputs.rows() / 2 + static_cast<Eigen::Index>(n)).data();
  }
  [[nodiscard]] double* of_force(std::size_t n) { return forces.row(static_cast<Eigen::Index>(n)).data(); }
  [[nodiscard]] double* of_force_rate(std::size_t n) { return force_rates.row(static_cast<Eigen::Index>(n)).data(); }
};

}  // namespace whirl::core
