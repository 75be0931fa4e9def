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

#include <span>

#include "film/pad_equations.hpp"
#include "film/report.hpp"
#include "whirl/film/state_model.hpp"

namespace whirl::film {

class ContentPad : private PadEquations {
public:
  ContentPad(const Pad& pad, const Reynolds& options, const Lubricant& lubricant);
  [[nodiscard]] std::size_t states() const { return columns_.size() * static_cast<std::size_t>(rows_); }
  /// Adds force and derivatives of the force to `response.journal`, lowers its min_thickness, and appends the rows of
  /// this pad with their derivatives; `first` is its first state, q [states()] those of this pad.
  void append(const Motion& motion, std::span<const double> q, std::span<const double> rates, int first, Need need,
              StateResponse& response);
  [[nodiscard]] PadReport report(const Motion& motion, std::span<const double> q);
  /// States `to` of this pad at which p and theta are those that `other`, the same pad on another mesh, has in `from`,
  /// interpolated linearly.
  void resample(const Motion& motion, ContentPad& other, std::span<const double> from, std::span<double> to);

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
    int state = -1;               // of the neighbour; -1 in a wall
    double k = 0.0, k_h = 0.0, k_speed = 0.0, couette = 0.0, couette_h = 0.0;
    const Node* upstream = nullptr;  // null along the shaft
    double cosine = 0.0, sine = 0.0, z = 0.0;
  };
  void read(const Motion& motion, std::span<const double> q);
  [[nodiscard]] std::array<Side, 4> sides(int i, int j) const;
  void row(int i, int j, double rate, int first, Need need, StateResponse& response) const;
  void integrate(Need need, std::size_t first, StateResponse& response) const;
  // A thickness that falls as `by` with the position of the journal at the angle of (cosine, sine).
  void add_thickness(double by, double cosine, double sine, double z, std::array<double, 4>& to) const;
  [[nodiscard]] const Node& node(int i, int j) const {
    return nodes_[static_cast<std::size_t>((pad_.closed ? wrap(i) : i) * rows_ + j)];
  }
  [[nodiscard]] int state(int i, int j) const {
    const int column = wall(i) ? -1 : column_of_[static_cast<std::size_t>(wrap(i))];
    return column < 0 ? -1 : column * rows_ + j;
  }

  double bulk_modulus_, empty_at_edge_;
  std::vector<int> columns_, column_of_;  // of unknowns, in the order of the states, and the inverse
  std::vector<Node> nodes_;               // [n_theta + 1][rows_]
};

/// Film on rigid pads that conserves its mass, with what its gap holds as states. Throws core::InputError on values
/// outside their range.
std::unique_ptr<StateModel> make_content(const Geometry& geometry, const Reynolds& options, const Lubricant& lubricant);

}  // namespace whirl::film
