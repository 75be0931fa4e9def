#pragma once
// A pad with heat of one layer, evaluated quantity by quantity over the whole mesh.
//
// The equations are those of thd_pad.hpp. One temperature across the film leaves no small matrices at the nodes: every
// flow and derivative is an array over the mesh, and eight nodes are taken at once. Node n = i rows + j; under the same
// number stand the face from there around, to n + rows, and the one along, to n + 1. Where there is none its width is
// zero.

#include <array>
#include <span>
#include <vector>

#include "film/heat/thd_pad.hpp"

namespace whirl::film {

/// Answers as ThdPad<1, 1> does, to rounding; reports are left to that one.
class OneLayerPad : public ThdPad<1, 1> {
public:
  OneLayerPad(const Pad& pad, const Thd& options, const Lubricant& lubricant);
  /// As ThdPad::evaluate().
  void evaluate(const JournalMotion& motion, std::span<const double> states, std::span<const double> rates, Need need,
                std::size_t first, std::size_t& at, std::size_t& at_rates, StateResponse& response);

private:
  // Over the nodes, with zeros, or another value, for a column of nodes before the first and behind the last.
  class Array {
  public:
    Array() = default;
    Array(std::ptrdiff_t nodes, std::ptrdiff_t column, double value);
    [[nodiscard]] double* at(std::ptrdiff_t n) { return values_.data() + front_ + n; }
    [[nodiscard]] const double* at(std::ptrdiff_t n) const { return values_.data() + front_ + n; }
    double& operator[](std::ptrdiff_t n) { return *at(n); }

  private:
    std::vector<double> values_;
    std::ptrdiff_t front_ = 0;
  };
  // What flows through a face, or warms the film there, and its derivatives: by the pressure behind the face, the
  // thickness, the speed of the surface, and the viscosity.
  struct Through {
    Array value, by_p, by_h, by_u, by_mu;
  };
  struct Faces {
    std::ptrdiff_t to = 0;  // its node behind lies so far from the one before
    bool around = false;
    double surface = 0;                         // m/s, across it
    double over_step = 0;                       // 1/m
    Array width, half, cosine, sine, z;         // m; m^2, half its area
    Array h, mu, reynolds, resisting, sheared;  // m, Pa s; k - 12, s - 1
    Through flow, heat;                         // m^3/s; W, half of the dissipation
  };
  // How one row of a node changes: by pressure and temperature of the node itself and of its four neighbours, by the
  // position of the journal in its ports, speed, and rate of the thickness.
  struct Row {
    std::array<Array, 5> by_p, by_t;
    std::array<Array, 4> by_position;
    Array by_speed, by_rate;
  };

  void read(const JournalMotion& motion, std::span<const double> states);
  void turbulence(Faces& f, const Resistance& resistance) const;
  void flow(Faces& f);
  void slopes(Faces& f, const Resistance& resistance);
  void balance(std::span<const double> rates, std::size_t first, StateResponse& response);
  void derive();
  void write(std::size_t first, std::size_t at, StateResponse& response) const;

  std::ptrdiff_t count_, column_;  // nodes; of them in a column
  Faces around_faces_, along_faces_;
  Array cosine_, sine_, z_, area_, over_area_, inner_;  // of the nodes; inner_: 1 there, 0 on an edge
  Array p_, t_, h_, over_h_, rate_, mu_, mu_t_;         // mu_t_: half of dmu/dT, what a face sees of it
  Array out_, gone_;                                    // m^3/s; of row 1 by the thickness of the node, K/(m s)
  Array rows_p_, rows_t_;                               // the residuals
  Row flow_row_, warm_row_;
  double surface_ = 0;  // m/s
};

}  // namespace whirl::film
