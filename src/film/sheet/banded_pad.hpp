#pragma once
// Any pad by a banded factorisation of the five-point equation.
//
// Unknowns p_ij are numbered along z first; those of a closed pad with the columns in the order 0, n - 1, 1, n - 2,
// ..., which keeps neighbours within twice the bandwidth. With lambda = A^-1 dF/dp the derivative of a force in any
// parameter is dF = -lambda . (d src + dA p). Reynolds cavitation adds a part of each cell that is filled (see
// rupture.hpp) and moves the rupture by Newton's method.

#include <optional>
#include <vector>

#include "film/algebra/pack.hpp"
#include "film/sheet/pad_equations.hpp"
#include "whirl/core/band_lu.hpp"

namespace whirl::film {

class BandedPad final : public PadSolver, private PadEquations {
public:
  BandedPad(const Pad& pad, const Reynolds& options, const Lubricant& lubricant);
  void add(const JournalMotion& motion, Need need, Response& response) override;
  void start_from(const PadSolver& other) override;
  std::vector<double> pressure(const JournalMotion& motion) override;
  std::vector<double> fill(const JournalMotion& motion) override;
  std::optional<Flows> flows(const JournalMotion& motion) override;
  /// Factorisations so far.
  [[nodiscard]] long factorisations() const { return factorisations_; }

private:
  void assemble();
  void solve();
  void integrate(Need need, Response& response);
  void adjoint(const JournalMotion& motion, Response& response);
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
  std::size_t fullest(int row) const;

  // A groove reaches from side to side, where the pressure is zero as everywhere.
  double pressure_at(int i, int j) const {
    if (j < 0 || j >= rows_ || (!pad_.closed && wall(i))) return 0.0;
    return wall(i) ? wall_pressure(i) : x_[at(wrap(i), j)];
  }
  // Mobility around the pad at a node, for the curvature of the pressure at the rupture.
  double mobility_at(int i, int j) const {
    return stiffen_ * 0.5 * (a_.value[around(wrap(i - 1), j)] + a_.value[around(i, j)]);
  }

  Reynolds::Cavitation cavitation_;
  // The parabola in front of the rupture is seen by cells that are short against the length of the pad; where they are
  // not, 1 + (dx/(L/4))^4 flattens it and whole cells remain.
  double stiffen_;
  std::vector<char> cavitated_;  // nodes whose pressure is held: in a groove or a hole
  core::BandLu band_, base_;     // factorised; of ruptured films the equations of a full one
  std::vector<double> x_;        // pressure
  std::vector<Quad> load_;       // adjoint variables of F_x, F_y, M_x, M_y
  Eigen::MatrixXd sides_;        // the same by columns
  // Reynolds cavitation only: distance of the rupture from each node, kept as the start of the next evaluation; what
  // cells cut or in the cavity add to the diagonal; dF = -(by_source_ d src + by_mobility_ da) beside the adjoint of A.
  std::vector<double> u_, more_;
  std::vector<Quad> by_source_, by_mobility_;
  // Mass-conserving cavitation only.
  std::vector<char> full_;        // nodes with pressure; kept as the start of the next evaluation
  std::vector<char> before_;      // in the iteration before
  std::vector<int> unheld_rows_;  // around a whole circle, without a node that is held
  std::vector<double> deficit_;   // s of the others, rad/s
  std::vector<double> diagonal_;  // of A
  double void_at_edge_ = 0.0;     // 1 - edge_fill
  long factorisations_ = 0;
  int mark_ = 0;        // rows from here on change while the rupture moves (BandLu::factor)
  bool stale_ = false;  // the rupture has moved since band_ was factorised
  // What x_ and band_ belong to: solvers ask for the force first, then for the tangents at the same place.
  std::optional<JournalMotion> solved_;
};

}  // namespace whirl::film
