#pragma once
// Flow, shear and dissipation in a film whose viscosity changes from layer to layer, without dimensions of the film.
//
// Across the film zeta = s/h runs from the bush at rest (0) to the journal of speed U (1), in n layers of equal
// thickness with the fluidity phi = 1/mu constant in each. With f_0 = int phi, f_1 = int zeta phi over the film:
//
//     u = U J/f_0 + h^2 g (I - (f_1/f_0) J),   J = int_0^zeta phi,  I = int_0^zeta zeta phi,  g the pressure gradient
//     tau = U/(f_0 h) + g h (zeta - f_1/f_0)
//
// Source: Dowson (1962); Skarolek (2011) eqs. (4.8)-(4.17) with the errata kept by this project.

#include <Eigen/Core>

namespace whirl::film {

/// Flow in layer k, per width: U h drag_k + h^3 g pressure_k. Dissipation, per area: U^2/h couette_k + U h g cross_k +
/// h^3 g^2 poiseuille_k. Shear stress at the journal: U/h pull + h g (1 - neutral). Derivatives `d_` are in the
/// viscosities [layers x layers].
struct Layers {
  explicit Layers(int layers);
  /// mu [layers] in Pa s, all positive.
  void set(const Eigen::VectorXd& mu);

  double pull = 0, neutral = 0;                // Pa s, -
  Eigen::VectorXd drag, pressure;              // -, 1/(Pa s)
  Eigen::VectorXd couette, cross, poiseuille;  // Pa s, -, 1/(Pa s)
  Eigen::VectorXd d_pull, d_neutral;
  Eigen::MatrixXd d_drag, d_pressure, d_couette, d_cross, d_poiseuille;

private:
  Eigen::VectorXd phi_, a_, b_;  // fluidity; integrals of J and I over the layers
};

}  // namespace whirl::film
