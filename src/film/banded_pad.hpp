#pragma once
// Any pad by a banded factorisation of the five-point equation.
//
// Unknowns p_ij, i = 1..n_theta - 1 around and j along the pad, numbered along z first; on a closed pad i = 0..n_theta
// - 1 with the columns in the order 0, n - 1, 1, n - 2, ..., which keeps neighbours within twice the bandwidth. Columns
// in grooves hold p = 0. Per unit of cell area
//     (A p)_ij + v_j src_ij = 0,   A from conductances v_j a_(i+1/2,j)/(R dtheta)^2 around and b_(i,j+1/2)/dz^2 along.
// An aligned journal needs only half the length: v_j = 1/2 on a mid-plane row, no flow across the mid-plane.
// With lambda = A^-1 dF/dp the derivative of a force in any parameter is dF = -lambda . (d src + dA p). Reynolds
// cavitation adds a part of each cell that is filled (see rupture.hpp) and moves the rupture by Newton's method.

#include <optional>
#include <vector>

#include "film/band.hpp"
#include "film/general_band.hpp"
#include "film/mobility.hpp"
#include "film/pad.hpp"

namespace whirl::film {

class BandedPad final : public PadSolver {
public:
  BandedPad(const Pad& pad, const Options& options, const Lubricant& lubricant);
  void add(const Motion& motion, Need need, Response& response) override;
  std::vector<double> pressure(const Motion& motion) override;
  std::vector<double> fill(const Motion& motion) override;
  std::optional<Flows> flows(const Motion& motion) override;

private:
  struct Faces {  // coefficients on faces, with derivatives in h and Omega
    std::vector<double> h, value, d_h, d_speed;
    void resize(std::size_t n) {
      for (auto* v : {&h, &value, &d_h, &d_speed}) v->assign(n, 0.0);
    }
  };
  void coefficients(const Motion& motion);
  void assemble();
  void solve();
  void integrate(Need need, Response& response);
  void adjoint(const Motion& motion, Response& response);
  void solve_ruptured();
  void factor_ruptured();
  void enter_ruptured();
  double move_rupture();
  double residual(int i, int j) const;
  void integrate_ruptured(Need need, Response& response);
  void weigh_ruptured();
  void enter_conserving(double edge_fill);
  void solve_conserving();
  void assemble_conserving();
  void integrate_conserving(Need need, Response& response);
  double deficit_at(int i, int j) const;
  double carried(int face, int j) const;

  int wrap(int i) const { return pad_.closed ? (i + grid_.n_theta) % grid_.n_theta : i; }
  // Pressure zero on the whole column: beyond an edge of the pad, or in a groove.
  bool wall(int i) const {
    return pad_.closed ? grooves_[static_cast<std::size_t>(wrap(i))] : i <= 0 || i >= grid_.n_theta;
  }
  int place(int i) const {
    if (!pad_.closed) return i - 1;
    return 2 * i < grid_.n_theta ? 2 * i : 2 * (grid_.n_theta - i) - 1;
  }
  std::size_t at(int i, int j) const { return static_cast<std::size_t>(place(i) * rows_ + j); }
  std::size_t around(int i, int j) const { return static_cast<std::size_t>(tilt_ ? i * rows_ + j : i); }
  std::size_t along(int i, int j) const { return static_cast<std::size_t>(tilt_ ? i * z_faces_ + j : i); }
  // A groove reaches from side to side, where the pressure is zero as everywhere.
  double pressure_at(int i, int j) const {
    if (j < 0 || j >= rows_ || (!pad_.closed && wall(i))) return 0.0;
    return wall(i) ? groove_pressure_[static_cast<std::size_t>(wrap(i))] : x_[at(wrap(i), j)];
  }
  double share(int j) const { return j == rows_ - 1 ? last_share_ : 1.0; }
  // Mobility around the pad at a node, for the curvature of the pressure at the rupture.
  double mobility_at(int i, int j) const {
    return stiffen_ * 0.5 * (a_.value[around(wrap(i - 1), j)] + a_.value[around(i, j)]);
  }
  double row_z(int j) const { return (j + 1) * grid_.dz - 0.5 * pad_.length; }

  Pad pad_;
  Grid grid_;
  LeastThickness least_;
  bool tilt_;
  Options::Cavitation cavitation_;
  Resistance resistance_around_, resistance_along_;
  double viscosity_, density_;
  int rows_, z_faces_;
  double last_share_;
  // The parabola in front of the rupture is seen by cells that are short against the length of the pad; where they are
  // not, 1 + (dx/(L/4))^4 flattens it and whole cells remain.
  double stiffen_;
  int first_;                            // first column of unknowns
  std::vector<bool> grooves_;            // columns of a closed pad,
  std::vector<double> groove_pressure_;  // and what is held there

  double speed_ = 0.0;
  double X_ = 0.0, Y_ = 0.0, tx_ = 0.0, ty_ = 0.0, h_min_ = 0.0;
  Faces a_, b_;                  // [n_theta][rows], [n_theta][z_faces]; one column if aligned
  std::vector<double> source_;   // v_j src_ij
  std::vector<char> cavitated_;  // nodes that are held at p = 0: in a groove
  Band band_, base_;             // factorised; of ruptured films the equations of a full one
  std::vector<double> x_;        // pressure
  std::vector<Quad> load_;       // adjoint variables of F_x, F_y, M_x, M_y
  // Reynolds cavitation only: distance of the rupture from each node, kept as the start of the next evaluation; what
  // cells cut or in the cavity add to the diagonal; dF = -(by_source_ d src + by_mobility_ da) beside the adjoint of A.
  std::vector<double> u_, more_;
  std::vector<Quad> by_source_, by_mobility_;
  // Mass-conserving cavitation only.
  std::optional<GeneralBand> general_;
  std::vector<char> full_;        // nodes with pressure; kept as the start of the next evaluation
  std::vector<double> deficit_;   // s of the others, rad/s
  std::vector<double> diagonal_;  // of A
  double void_at_edge_ = 0.0;     // 1 - edge_fill
  int ahead_ = 1;                 // +1: oil is carried towards larger theta
  int mark_ = 0;                  // rows from here on change while the rupture moves (Band::factor)
  bool stale_ = false;            // the rupture has moved since band_ was factorised
  // What x_ and band_ belong to: solvers ask for the force first, then for the tangents at the same place.
  std::optional<Motion> solved_;
};

}  // namespace whirl::film
