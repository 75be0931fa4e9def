#pragma once
// Reynolds' equation with properties that vary across the film, for gas and liquid, and the flow that it gives.

#include <memory>
#include <vector>

#include "whirl/thermal/flow.hpp"
#include "whirl/thermal/fluid.hpp"
#include "whirl/thermal/orifice.hpp"
#include "whirl/thermal/turbulence.hpp"

namespace whirl::thermal {

/// An orifice at a node of the film, which feeds a gas.
struct Orifice {
  int i = 0, j = 0;
  double diameter = 0;       // m
  double pressure = 0;       // Pa, absolute, of the supply
  double temperature = 300;  // K, of the supply
};

/// Nodes [first, last] around and along that stand under the pressure of a groove; around they may run over the end of
/// a closed film (last >= nodes around).
struct Feed {
  int first_around = 0, last_around = 0, first_along = 0, last_along = 0;
  double pressure = 0;  // Pa
};

struct FilmFlowOptions {
  Fluid fluid;
  double heat_ratio = 1.4;  // -, of a gas
  double ambient = 0;       // Pa, at the ends of the film and of a pad: absolute of a gas, 0 of a liquid
  double speed = 0;         // rad/s
  enum class Cavitation { none, half_sommerfeld, reynolds, mass_conserving };
  Cavitation cavitation = Cavitation::none;  // half_sommerfeld: pressure below 0 does not act on the journal
  Turbulence turbulence = Turbulence::laminar;
  std::vector<Orifice> orifices;
  std::vector<Feed> feeds;
};

/// What acts and flows, all positive towards larger coordinates, the flow out of the film.
struct FlowReport {
  double force[2] = {0, 0};  // N, on the journal
  double friction = 0;       // N m, against the rotation
  double power = 0;          // W, friction times speed
  double heat = 0;           // W, that the motion leaves in the film
  double expansion = 0;      // W, work of pressure, v grad p over the film: of a gas that expands negative
  double inflow = 0;         // kg/s, of orifices and grooves
  double outflow = 0;        // kg/s, through the ends
  double defect = 0;         // kg/s, greatest flow through the journal's wall, which should be none
  double highest = 0;        // Pa
};

///   d/dx (G_x) + d/dz (G_z) = inflow,   G = sum over layers of  rho_k (P_k grad p + C_k U)
///
/// with u(s) = (dp/dx) (I(s) - (F_1/F_0) J(s)) + U J(s)/F_0, J = int ds/mu, I = int s ds/mu from the bush at rest (s =
/// 0) to the journal, of surface speed U: exact in layers of constant viscosity. Finite volumes around the nodes; the
/// properties at a face are the mean of those of both sides. Of a gas rho_k = p/(r T_k).
/// In turbulence P_k is divided by k/12 around and along, and the shear U/F_0 of the journal grows by the Couette
/// factor, at Re = rho |U| h/mu with the means across the film; C_k stays. Source: Dowson (1962); Skarolek (2011) eqs.
/// (4.8)-(4.17) with the errata kept by this project.
/// A film that conserves its mass fills the gap to the share theta where p = 0: C_k has the share of the node upstream.
/// One state u of a node stands for both: p = u where u >= 0, 1 - theta = -u/p_s below, p_s a scale of the pressure
/// (Jakobsson and Floberg 1957; Olsson 1965; Elrod and Adams 1974).
class FilmFlow {
public:
  /// `thickness` m [r, n], of the nodes of this rank, i fastest. Options of its solver begin with `film_pressure_`.
  /// Collective. Throws core::Error, on all ranks, where two orifices share a node or one has no place in the mesh,
  /// and where a film is to conserve the mass of its cavity that is a gas or at rest.
  FilmFlow(const Rows& rows, FilmFlowOptions options, std::vector<double> thickness);
  ~FilmFlow();
  FilmFlow(const FilmFlow&) = delete;
  FilmFlow& operator=(const FilmFlow&) = delete;

  /// K [r, n, l] of the cells: viscosities and densities from now on. Collective.
  void set_temperature(const std::vector<double>& cells);
  /// Another thickness m [r, n]; it acts from the next set_temperature() on. Collective.
  void set_thickness(const std::vector<double>& thickness);
  /// Newton's method starts from this pressure, Pa [r, n].
  void start(const std::vector<double>& pressure);
  /// The pressure at these, by Newton's method from the last one, until what is out of balance is `tolerance` times
  /// what is at the ambient's pressure, or `reduction` times what is at first. Returns its iterations. MUMPS up to
  /// 100,000 nodes
  /// (`-film_pressure_direct_nodes`), BoomerAMG beyond. Throws core::NotConverged on all ranks. Collective.
  int solve(double tolerance = 1e-13, double reduction = 0);
  /// Pa [r, n].
  [[nodiscard]] const std::vector<double>& pressure() const;
  /// - [r, n], share of the gap that is full of liquid: 1 but in the cavity of a film that conserves its mass.
  [[nodiscard]] const std::vector<double>& fill() const;
  [[nodiscard]] bool conserves_mass() const;
  /// [r, n], whether the film is ruptured there: by Reynolds' condition without pressure, of a film that conserves its
  /// mass not full. An end is as its neighbour inside. Never of a gas or by half_sommerfeld, whose film is full
  /// throughout.
  [[nodiscard]] std::vector<char> ruptured() const;
  /// Mass flows and heat at this pressure. What orifices and grooves give enters layer 0; at the ends each layer leaves
  /// the film by itself. Collective.
  [[nodiscard]] Flow flow() const;
  /// m/s [r, n], at s = h/2, around and along: of the velocity of which flow() is the integral, the mean of the faces
  /// beside a node, at an end the line through the two nearest. In the cavity of a film that conserves its mass it is
  /// that of the liquid there. The resistance of turbulence is that of flow(), the shape across laminar. Collective.
  struct Velocity {
    std::vector<double> around, along;
  };
  [[nodiscard]] Velocity middle() const;
  /// kg/s of each orifice, the same on all ranks. Collective.
  [[nodiscard]] std::vector<double> orifice_flows() const;
  /// W [r, n], work of pressure in the volume of each node, half of that between two nodes to each. Collective.
  [[nodiscard]] std::vector<double> expansion(const Flow& flow) const;
  /// Collective.
  [[nodiscard]] FlowReport report(const Flow& flow) const;
  /// Residual kg/s [nodes, then orifices Pa^2 of this rank] and Jacobian at any such state, to test. Collective.
  void residual(Vec u, Vec f);
  void jacobian(Vec u, Mat j);
  [[nodiscard]] Vec state() const;
  [[nodiscard]] Mat matrix() const;

private:
  struct Work;
  std::unique_ptr<Work> w_;
};

}  // namespace whirl::thermal
