#pragma once
// One pad of a film with heat: a pressure and the temperatures of the layers at every node.
//
// Finite volumes about the nodes i = 0..n around and j along, edges included (half volumes). With V = A h/L the volume
// of a layer, out its flows out of the volume, and H the dissipation:
//
//     inner nodes  sum of out/A + dh/dt = 0;   edges  p = 0
//     dT_k/dt + [sum over inflows of min(out, 0) (T_upstream - T_k) - H_k/(rho c)]/V + L lambda/(rho c h^2) (K T - b)_k
//     = 0
//
// Flows across the layers follow from those along them, from the bush upwards; at an edge each layer leaves the pad, or
// enters it with the temperature of the feed. So a constant temperature without sources is kept exactly, and so is the
// heat of the whole pad where the mass of every layer is.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "film/fluid/layers.hpp"
#include "film/sheet/pad.hpp"
#include "whirl/film/contract/film.hpp"
#include "whirl/film/contract/thd.hpp"
#include "whirl/thermal/viscosity_table.hpp"

namespace whirl::film {

/// Heat of a pad, W: dissipation, and where it goes. At rest they balance to what Newton's method leaves.
struct HeatBalance {
  double dissipation = 0, carried = 0, bush = 0, journal = 0, stored = 0;
};

/// Volume of a film, m^3, its temperature integrated over that, K m^3, and the highest, K.
struct Warmth {
  double volume = 0, integral = 0, highest = 0;
};

/// What a report of a pad shows at its nodes.
enum class Nodal { pressure, mean, bush, journal };

/// A pad of `Count` layers, or Eigen::Dynamic and at most `Most`: a node is a few numbers, for which a heap costs more
/// than they do.
template <int Count, int Most>
class ThdPad {
public:
  using Base = ThdPad;
  ThdPad(const Pad& pad, const Thd& options, const Lubricant& lubricant);
  [[nodiscard]] int nodes() const { return columns_ * rows_; }
  [[nodiscard]] int block() const { return 1 + layers(); }
  [[nodiscard]] int states() const { return nodes() * block(); }
  /// Adds where dg/ds and dg/ds' have entries; the pad's states and rows begin at `first`.
  void add_places(int first, Places& states, Places& rates) const;
  /// Adds the force to `response.journal`, lowers its min_thickness and fills the rows [first, first + states()); the
  /// derivatives by states from `at` on, which becomes the place behind them, those by rates likewise.
  void evaluate(const JournalMotion& motion, std::span<const double> states, std::span<const double> rates, Need need,
                std::size_t first, std::size_t& at, std::size_t& at_rates, StateResponse& response);

  // Of the last evaluate().
  [[nodiscard]] HeatBalance heat() const;
  [[nodiscard]] Flows flows() const;
  /// m^3/s out of both sides, without what comes in where the pressure is below the ambient's.
  [[nodiscard]] double side_outflow() const;
  /// N m, of the shear at the journal.
  [[nodiscard]] double friction() const;
  [[nodiscard]] Warmth warmth() const;
  [[nodiscard]] const Grid& grid() const { return grid_; }
  /// m, at a node of the whole length.
  [[nodiscard]] double thickness(int i, int j) const { return nodes_[node(i, j < rows_ ? j : grid_.n_z - j)].h; }
  /// Pressure as it acts, and temperatures, at the nodes [n_theta + 1][n_z + 1] of the pad; the mean over the layers,
  /// or of one layer.
  [[nodiscard]] std::vector<double> nodal(Nodal what) const;
  /// States `to` at the nodes of this mesh from those of `other`, linearly.
  void resample(const ThdPad& other, std::span<const double> from, std::span<double> to) const;

protected:
  using Vector = Eigen::Matrix<double, Count, 1, 0, Most, 1>;
  using Matrix = Eigen::Matrix<double, Count, Count, 0, Most, Most>;
  struct Node {
    double h = 0, over_h = 0, rate = 0;  // m, 1/m, m/s
    double cosine = 0, sine = 0, z = 0;  // h falls with the position of the journal along these
    double along = 0;                    // m, of its volume
    double area = 0, over_area = 0;      // m^2, 1/m^2
    bool edge = false;
    const double* value = nullptr;  // its block of states
    Vector mu, mu_t;                // Pa s and its slope
  };
  // Between two nodes, towards larger i or j: flows q per width and dissipation d per area.
  struct Face {
    int from = 0, to = 0;
    double step = 0, over_step = 0, width = 0;  // m, 1/m, m
    double h = 0, cosine = 0, sine = 0, z = 0;
    bool around = true;
    Vector q, d;
  };
  // Their derivatives, apart: residuals are asked for more often, and then only faces go through the cache.
  struct Slopes {
    Vector q_g, q_h, q_u, d_g, d_h, d_u;  // by pressure gradient, thickness, speed of the surface
    Matrix q_mu, d_mu;
  };
  struct Side {
    int face, sign;  // -1: none; +1: q leaves the volume
  };
  [[nodiscard]] int layers() const { return Count == Eigen::Dynamic ? layers_ : Count; }  // a constant if it can be
  void lay_out();
  void read(const JournalMotion& motion, std::span<const double> states);
  // Throws core::DomainError where no law holds, so that Newton's method comes back.
  [[nodiscard]] thermal::Valued viscosity_at(double temperature);
  // Re, k - 12 and s - 1 of all faces; see flow().
  void turbulence();
  void flow(int face, bool tangents);
  // What a volume takes up: mass, m^3/s, and, layer by layer, heat with the flow, K m^3/s, and dissipation, W.
  struct Balance {
    double out = 0;
    Vector advected, dissipated;
  };
  [[nodiscard]] Balance balance(std::size_t node) const;
  void row(int node, std::span<const double> rates, Need need, std::size_t first, std::size_t at, std::size_t at_rates,
           StateResponse& response);
  void integrate(Need need, std::size_t first, StateResponse& response) const;
  [[nodiscard]] double pressure(int i, int j) const { return nodes_[node(i, j)].value[0]; }
  [[nodiscard]] std::size_t node(int i, int j) const { return static_cast<std::size_t>(i * rows_ + j); }
  // Of dg/ds.
  [[nodiscard]] std::size_t entries();
  // -q_k of all sides and of the growth of the volume: what is left to leave layer k.
  [[nodiscard]] double left_over(std::size_t node, int layer) const;

  Pad pad_;
  Thd options_;
  Grid grid_;
  LeastThickness least_;
  Lubricant lubricant_;
  bool whole_;
  int layers_, columns_, rows_;
  Resistance resistance_around_, resistance_along_, couette_;
  bool turbulent_ = false;  // in the last evaluate()
  Matrix conduction_;       // K and b of conduction across the film, in lambda/h
  Vector walls_;
  double over_rho_c_, diffusivity_;  // K m^3/J; lambda/(rho c) times the layers, m^2/s
  double hold_;                      // m/(s Pa): what a pressure at an edge weighs
  double h_min_ = 0, speed_ = 0;
  std::vector<Node> nodes_;
  std::vector<Face> faces_;  // those around, then those along
  std::vector<Slopes> slopes_;
  int around_ = 0;
  std::vector<double> reynolds_, resisting_, sheared_;  // of the faces, in turbulence
  std::vector<std::array<Side, 4>> sides_;
  std::vector<std::size_t> entries_;  // of each node: entries of dg/ds before its own
  Layers<Count, Most> profile_;
  thermal::ViscosityTable viscosity_;
  Vector mean_;
};

extern template class ThdPad<1, 1>;
extern template class ThdPad<Eigen::Dynamic, 8>;
extern template class ThdPad<Eigen::Dynamic, Eigen::Dynamic>;

}  // namespace whirl::film
