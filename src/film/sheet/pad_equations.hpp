#pragma once
// The five-point equation of any pad: its mesh, its coefficients and its source, whoever solves it.
//
// Unknowns stand at nodes i = 1..n_theta - 1 around and j along the pad; on a closed pad i = 0..n_theta - 1. Columns in
// grooves and nodes in holes hold their pressure. Per unit of cell area
//     (A p)_ij + v_j src_ij = 0,   A from conductances v_j a_(i+1/2,j)/(R dtheta)^2 around and b_(i,j+1/2)/dz^2 along.
// An aligned journal needs only half the length, unless there are holes: v_j = 1/2 on a mid-plane row, no flow across
// the mid-plane.

#include <vector>

#include "film/fluid/mobility.hpp"
#include "film/sheet/hole.hpp"
#include "film/sheet/pad.hpp"

namespace whirl::film {

/// What solvers of one pad share; theirs to inherit, so that they read as the equations do.
struct PadEquations {
  struct Faces {  // coefficients on faces, with derivatives in h and Omega
    std::vector<double> h, value, d_h, d_speed;
    void resize(std::size_t n) {
      for (auto* v : {&h, &value, &d_h, &d_speed}) v->assign(n, 0.0);
    }
  };

  PadEquations(const Pad& pad, const Reynolds& options, const Lubricant& lubricant);
  /// Coefficients and source at `motion`; throws core::DomainError unless the thickness is positive.
  void coefficients(const JournalMotion& motion);
  /// The coefficients alone, and then the source of one column of unknowns: for those who need only some of them.
  void conductances(const JournalMotion& motion);
  void source(const JournalMotion& motion, int column);
  /// Flows of the equations with `pressure(i, j)` at nodes and `deficit(i, j)` = |Omega| (1 - fill) [rad/s], which the
  /// flow around the pad lacks downstream of a node. Volume flows through the faces next to the edges of the pad, in
  /// m^3/s, and out of holes; with the squeezed volume of the cells between them they sum to zero to rounding.
  template <class Pressure, class Deficit>
  [[nodiscard]] Flows flows(const Pressure& pressure, const Deficit& deficit) const;
  // What a deficit of one at the upstream node of face i brings through it, per unit of cell area.
  double carried(int face, int j) const { return 0.5 * share(j) * a_.h[around(wrap(face), j)] / grid_.dtheta; }

  int wrap(int i) const { return pad_.closed ? (i + grid_.n_theta) % grid_.n_theta : i; }
  // Pressure given on the whole column: beyond an edge of the pad, or in a groove.
  bool wall(int i) const {
    return pad_.closed ? grooves_[static_cast<std::size_t>(wrap(i))] : i <= 0 || i >= grid_.n_theta;
  }
  // Of a column of a wall: that of a groove, zero at an edge.
  double wall_pressure(int i) const { return pad_.closed ? groove_pressure_[static_cast<std::size_t>(wrap(i))] : 0.0; }
  // Number of the hole at a node between walls, from one; 0: none.
  int hole_at(int i, int j) const { return holes_.empty() || wall(i) ? 0 : holes_.at(wrap(i), j); }
  // Pressure given at a node: in a wall or in a hole.
  bool held(int i, int j) const { return wall(i) || hole_at(i, j) > 0; }
  double held_pressure(int i, int j) const {
    const int hole = hole_at(i, j);
    return hole > 0 ? hole_pressure_[static_cast<std::size_t>(hole - 1)] : wall_pressure(i);
  }
  int place(int i) const {
    if (!pad_.closed) return i - 1;
    return 2 * i < grid_.n_theta ? 2 * i : 2 * (grid_.n_theta - i) - 1;
  }
  std::size_t at(int i, int j) const { return static_cast<std::size_t>(place(i) * rows_ + j); }
  std::size_t around(int i, int j) const { return static_cast<std::size_t>(whole_ ? i * rows_ + j : i); }
  std::size_t along(int i, int j) const { return static_cast<std::size_t>(whole_ ? i * z_faces_ + j : i); }
  double share(int j) const { return j == rows_ - 1 ? last_share_ : 1.0; }
  double row_z(int j) const { return (j + 1) * grid_.dz - 0.5 * pad_.length; }
  // Row of the unknowns that holds node j of the whole length; -1 or beyond the last one on a side.
  int row_of(int j) const { return (whole_ ? j : std::min(j, grid_.n_z - j)) - 1; }

  Pad pad_;
  Grid grid_;
  LeastThickness least_;
  bool tilt_, whole_;  // follows the slope of the journal; has unknowns over the whole length
  Resistance resistance_around_, resistance_along_;
  double viscosity_, density_;
  int rows_, z_faces_;
  double last_share_;
  int first_;                            // first column of unknowns
  std::vector<bool> grooves_;            // columns of a closed pad,
  std::vector<double> groove_pressure_;  // and what is held there
  HoleMesh holes_;
  std::vector<double> hole_pressure_;

  double speed_ = 0.0;
  int ahead_ = 1;  // +1: oil is carried towards larger theta
  double X_ = 0.0, Y_ = 0.0, tx_ = 0.0, ty_ = 0.0, h_min_ = 0.0;
  Faces a_, b_;                 // [n_theta][rows], [n_theta][z_faces]; one column if aligned
  std::vector<double> source_;  // v_j src_ij
};

template <class Pressure, class Deficit>
Flows PadEquations::flows(const Pressure& pressure, const Deficit& deficit) const {
  const double cell = pad_.radius * grid_.dtheta * grid_.dz, times = cell * (whole_ ? 1.0 : 2.0);
  Flows out;
  out.holes.assign(hole_pressure_.size(), 0.0);
  const auto from_hole = [&](int hole, double flow) {
    if (hole > 0) out.holes[static_cast<std::size_t>(hole - 1)] += flow;
  };
  for (int i = first_; i <= grid_.n_theta; ++i) {
    const bool last = i == grid_.n_theta;
    for (int j = 0; j < rows_; ++j) {
      if (!last && !wall(i)) {
        const int hole = hole_at(i, j);
        double side = j == 0 ? times * b_.value[along(i, 0)] * pressure(i, 0) : 0.0;
        if (whole_ && j + 1 == rows_) side += times * b_.value[along(i, rows_)] * pressure(i, j);
        out.sides += side;
        from_hole(hole, side);
        // The wedge is what the faces between the cells change; what is left of the source is the squeeze.
        if (hole == 0) out.squeezed += times * (source_[at(i, j)] - speed_ * (carried(i, j) - carried(i - 1, j)));
        if (const int below = j > 0 ? hole_at(i, j - 1) : hole; below != hole) {
          const double flow = times * b_.value[along(i, j)] * (pressure(i, j - 1) - pressure(i, j));
          from_hole(below, flow);
          from_hole(hole, -flow);
        }
      }
      // The face between columns i - 1 and i.
      if (last && pad_.closed) continue;
      const bool before = wall(i - 1), after = wall(i);
      const int hole_before = hole_at(i - 1, j), hole_after = hole_at(i, j);
      if (before == after && hole_before == hole_after) continue;
      const double around_it = share(j) * a_.value[around(wrap(i - 1), j)] * (pressure(i - 1, j) - pressure(i, j)),
                   flow = around_it + carried(i - 1, j) * (speed_ - ahead_ * deficit(ahead_ > 0 ? i - 1 : i, j));
      if (before) out.enters += times * flow;
      if (after) out.leaves += times * flow;
      from_hole(hole_before, times * flow);
      from_hole(hole_after, -times * flow);
    }
  }
  return out;
}

}  // namespace whirl::film
