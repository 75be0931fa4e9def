#pragma once
// One pad of a film whose content is its state: how much oil the gap holds beyond or short of its volume.
//
// The content m = h + q of a cell per unit of its area, with h its mean thickness: q = h p/K where the gap is full, K
// the bulk modulus of the oil, and q = -(1 - theta) h where it holds the share theta and p = 0. So one state per node,
//
//     p = K max(q, 0)/h,   1 - theta = max(-q, 0)/h
//     g = q' + dh/dt + (flow out of the cell)/(its area) = q' + [A p + v src - Omega (c_e (1 - theta)_e - c_w (1 -
//     theta)_w)]/v
//
// with A and src as in pad_equations.hpp, c = v h/(2 dtheta) at a face and theta of the node upstream of it. Only what
// the gap stores is compressible, not what flows: at q' = 0 these are the equations of mass_conserving.cpp.

#include <array>
#include <span>
#include <vector>

#include "film/sheet/pad_equations.hpp"
#include "film/sheet/report.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film {

/// What a share holds of a pad: columns [begin, end), from `row` among its rows, and where it finds what they see.
struct PadShare {
  int begin = 0, end = 0, row = 0;
  std::vector<int> seen;  // of each column of states its first one among those seen, or -1
  std::vector<std::array<std::size_t, 5>>
      at;  // [rows] of dg/ds by ContentPad's places; meaningless where there is none
};

class ContentPad : private PadEquations {
public:
  ContentPad(const Pad& pad, const Reynolds& options, const Lubricant& lubricant);
  [[nodiscard]] std::size_t states() const { return columns_.size() * static_cast<std::size_t>(rows_); }
  /// States of a column; columns stand one behind the other around the pad.
  [[nodiscard]] int column() const { return rows_; }
  /// Whether the states of a column depend on those of another one.
  [[nodiscard]] bool sees(int column, int other) const;
  /// Neighbours of a node, and itself.
  static constexpr int places = 5;
  /// Adds where dg/ds has entries at one of the places, for all rows of the share.
  void add_places(int place, PadShare& share, Places& to) const;
  /// Adds force and derivatives of the force to `response.journal`, lowers its min_thickness, and fills the rows of
  /// this pad with their derivatives; q and rates are those seen.
  void evaluate(const JournalMotion& motion, const PadShare& share, std::span<const double> q,
                std::span<const double> rates, Need need, StateResponse& response);
  [[nodiscard]] PadReport report(const JournalMotion& motion, std::span<const double> q);
  /// States `to` of this pad at which p and theta are those that `other`, the same pad on another mesh, has in `from`,
  /// interpolated linearly.
  void resample(const JournalMotion& motion, ContentPad& other, std::span<const double> from, std::span<double> to);

private:
  // At a node: mean thickness of its cell, which falls with the position of the journal along (cosine, sine); pressure
  // and the part of the gap that is empty with their derivatives in q and h.
  struct Node {
    double h = 0.0, cosine = 0.0, sine = 0.0, z = 0.0;
    double p = 0.0, p_q = 0.0, p_h = 0.0, empty = 0.0, empty_q = 0.0, empty_h = 0.0;
  };
  // What lies between a node and one of its neighbours, per unit of cell area: a conductance with its derivatives, the
  // Couette flow of a full gap per Omega, out of the cell positive, and the normal of the bearing there.
  struct Side {
    const Node* other = nullptr;  // null beyond a side of the pad, where p = 0
    bool state = false;           // it is one, not in a wall
    double k = 0.0, k_h = 0.0, k_speed = 0.0, couette = 0.0, couette_h = 0.0;
    const Node* upstream = nullptr;  // null along the shaft
    double cosine = 0.0, sine = 0.0, z = 0.0;
  };
  void read(const JournalMotion& motion, std::span<const double> q);
  // Node of column i; its content, where it is a state.
  void read(int i, int j, const double* value);
  [[nodiscard]] std::array<Side, 4> sides(int i, int j) const;
  // Row k of the share.
  void row(int i, int j, double rate, std::size_t k, const PadShare& share, Need need, StateResponse& response) const;
  void row_in_hole(int i, int j, double value, double rate, std::size_t k, const PadShare& share, Need need,
                   StateResponse& response) const;
  // Column i, whose states are rows from k on; -1: it has none.
  void integrate(int i, int k, Need need, StateResponse& response) const;
  // A thickness that falls as `by` with the position of the journal at the angle of (cosine, sine).
  void add_thickness(double by, double cosine, double sine, double z, std::array<double, 4>& to) const;
  [[nodiscard]] const Node& node(int i, int j) const {
    return nodes_[static_cast<std::size_t>((pad_.closed ? wrap(i) : i) * rows_ + j)];
  }
  // Column of states at i, -1 in a wall.
  [[nodiscard]] int column_at(int i) const { return wall(i) ? -1 : column_of_[static_cast<std::size_t>(wrap(i))]; }

  double bulk_modulus_, empty_at_edge_;
  double in_holes_ = 0.0;                 // 1/s, at which states of nodes in holes go to zero
  std::vector<int> columns_, column_of_;  // of unknowns, in the order of the states, and the inverse
  std::vector<Node> nodes_;               // [n_theta + 1][rows_]
};

/// Film on rigid pads that conserves its mass, with what its gap holds as states. Throws core::InputError on values
/// outside their range.
std::unique_ptr<Film> make_content(const Geometry& geometry, const Reynolds& options, const Lubricant& lubricant);

}  // namespace whirl::film
