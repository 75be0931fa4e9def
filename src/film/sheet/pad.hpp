#pragma once
// One pad: its arc, its grid, and the motion of the journal relative to it.

#include <optional>
#include <vector>

#include "whirl/film/contract/response.hpp"
#include "whirl/film/contract/reynolds.hpp"

namespace whirl::film {

/// A circular arc. h(theta, z) = clearance - X cos(theta) - Y sin(theta), X = x + z dx/dz - centre_x (Y alike).
struct Pad {
  double radius, length;
  double clearance;           // m, machined clearance c_p
  double start, arc;          // rad
  double centre_x, centre_y;  // m, centre of the arc relative to the bearing centre
  bool closed;                // a whole circle: the last node is the first one
};

/// The pads of a bore, lower pad first (errata of Gavalas 2022, eq. 2.10, items 18-19); a cylindrical bore is one
/// closed pad that begins at 90 deg, or one with two edges at its inlet: at 0 if that follows the maximum gap.
std::vector<Pad> make_pads(const Geometry& geometry, const Inlet& inlet = {});

/// Uniform grid of a pad: n_theta x n_z cells, nodes on all edges, faces midway between nodes along theta.
struct Grid {
  Grid(const Pad& pad, const std::array<int, 2>& cells);
  int n_theta, n_z;
  double dtheta, dz;
  double mean;  // exact cell mean of cos(theta) over its mid-point value, 2 sin(dtheta/2)/dtheta
  std::vector<double> node_cos, node_sin;  // [n_theta + 1]
  std::vector<double> face_cos, face_sin;  // [n_theta]
};

/// Least thickness of an arc, exactly and not over nodes: where h = clearance - X cos(theta) - Y sin(theta) is smallest
/// on the whole circle if the arc reaches there, else at one of its edges.
class LeastThickness {
public:
  explicit LeastThickness(const Pad& pad);
  /// X, Y: journal relative to the centre of the arc [m]; NaN if they are.
  [[nodiscard]] double operator()(double X, double Y) const;
  /// The same with the slopes tx, ty of the journal: h is linear along the shaft, least at one of the sides.
  [[nodiscard]] double operator()(double X, double Y, double tx, double ty) const;

private:
  double clearance_, half_length_;
  std::array<double, 2> middle_, first_, last_;  // directions of the middle and the edges of the arc
  double half_;                                  // cosine of half the arc
};

/// Volume flows of a pad in m^3/s: through its first edge in the sense of theta, out of its last one, out of both
/// sides, out of each hole of the film into this pad, and the volume that the moving journal presses out of the gap
/// less what it draws in. In and out balance if the film conserves its mass: enters + (sum of holes) - leaves - sides =
/// squeezed.
struct Flows {
  double enters = 0.0, leaves = 0.0, sides = 0.0, squeezed = 0.0;
  std::vector<double> holes = {};
};

/// Part of a film that answers for one pad.
class PadSolver {
public:
  PadSolver() = default;
  PadSolver(const PadSolver&) = delete;
  PadSolver& operator=(const PadSolver&) = delete;
  virtual ~PadSolver() = default;
  /// Adds force and derivatives of this pad to `response` and lowers its min_thickness.
  virtual void add(const JournalMotion& motion, Need need, Response& response) = 0;
  /// As Film::start_from().
  virtual void start_from(const PadSolver& /*other*/) {}
  /// Truncated nodal pressure [n_theta + 1][n_z + 1], Pa.
  virtual std::vector<double> pressure(const JournalMotion& motion) = 0;
  /// Part of the gap that is full of oil at the nodes [n_theta + 1][n_z + 1]; empty of a film that does not know it.
  virtual std::vector<double> fill(const JournalMotion& /*motion*/) { return {}; }
  /// Flows of the discrete equations; empty if the pressure is cut off after the solution.
  virtual std::optional<Flows> flows(const JournalMotion& /*motion*/) { return {}; }
};

/// Aligned pad without complementarity: sine modes along z, tridiagonal systems along theta.
std::unique_ptr<PadSolver> make_modal_pad(const Pad& pad, const Reynolds& options, const Lubricant& lubricant);
/// Any pad: banded factorisation; half the pad if the journal stays aligned.
std::unique_ptr<PadSolver> make_banded_pad(const Pad& pad, const Reynolds& options, const Lubricant& lubricant);

/// Throws core::DomainError unless h_min > 0.
void require_thickness(double h_min);

}  // namespace whirl::film
