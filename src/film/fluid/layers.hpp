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
/// `Count` layers, or Eigen::Dynamic and at most `Most`.
template <int Count, int Most>
struct Layers {
  using Vector = Eigen::Matrix<double, Count, 1, 0, Most, 1>;
  using Matrix = Eigen::Matrix<double, Count, Count, 0, Most, Most>;
  explicit Layers(int layers) {
    for (Vector* v : {&drag, &pressure, &couette, &cross, &poiseuille, &phi_, &a_, &b_}) v->resize(layers);
    for (Matrix* m : {&d_drag, &d_pressure, &d_couette, &d_cross, &d_poiseuille}) m->resize(layers, layers);
  }
  /// mu [layers] in Pa s, all positive; derivatives only if wanted.
  void set(const Vector& mu, bool derivatives);

  double pull = 0, neutral = 0;       // Pa s, -
  Vector drag, pressure;              // -, 1/(Pa s)
  Vector couette, cross, poiseuille;  // Pa s, -, 1/(Pa s)
  Matrix d_drag, d_pressure, d_couette, d_cross, d_poiseuille;

private:
  Vector phi_, a_, b_;  // fluidity; integrals of J and I over the layers
};

// f_0, f_1 and the integrals of J and I are linear in phi; all else follows from them.
template <int Count, int Most>
void Layers<Count, Most>::set(const Vector& mu, bool derivatives) {
  if constexpr (Count == 1) {  // the same, written out
    const double fluidity = 1.0 / mu(0), twelfth = fluidity / 12.0;
    pull = mu(0);
    neutral = 0.5;
    drag(0) = 0.5;
    pressure(0) = -twelfth;
    couette(0) = mu(0);
    cross(0) = 0.0;
    poiseuille(0) = twelfth;
    d_drag(0, 0) = d_cross(0, 0) = 0.0;
    d_couette(0, 0) = 1.0;
    d_pressure(0, 0) = twelfth * fluidity;
    d_poiseuille(0, 0) = -twelfth * fluidity;
    return;
  }
  const Eigen::Index n = mu.size();
  const double d = 1.0 / static_cast<double>(n);
  const auto low = [d](Eigen::Index k) { return d * static_cast<double>(k); };
  const auto moment = [&](Eigen::Index k) { return d * (low(k) + 0.5 * d); };  // int zeta over a layer
  const auto inside = [&](Eigen::Index k) { return 0.5 * low(k) * d * d + d * d * d / 6.0; };
  phi_ = mu.cwiseInverse();
  double f0 = 0.0, f1 = 0.0;
  for (Eigen::Index k = 0; k < n; ++k) {
    a_(k) = d * f0 + 0.5 * d * d * phi_(k);
    b_(k) = d * f1 + inside(k) * phi_(k);
    f0 += d * phi_(k);
    f1 += moment(k) * phi_(k);
  }
  pull = 1.0 / f0;
  neutral = f1 / f0;
  drag = pull * a_;
  pressure = b_ - neutral * a_;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double from = low(k) - neutral, to = from + d;
    const double first = 0.5 * (to * to - from * from), second = (to * to * to - from * from * from) / 3.0;
    couette(k) = phi_(k) * pull * pull * d;
    cross(k) = 2.0 * phi_(k) * pull * first;
    poiseuille(k) = phi_(k) * second;
    for (Eigen::Index m = 0; derivatives && m < n; ++m) {
      const double by_mu = -phi_(m) * phi_(m);
      const double pull_m = -pull * pull * d * by_mu, neutral_m = (moment(m) - neutral * d) * pull * by_mu;
      const double a_m = by_mu * (m < k ? d * d : m == k ? 0.5 * d * d : 0.0);
      const double b_m = by_mu * (m < k ? d * moment(m) : m == k ? inside(k) : 0.0);
      const double phi_m = m == k ? by_mu : 0.0;
      d_drag(k, m) = pull_m * a_(k) + pull * a_m;
      d_pressure(k, m) = b_m - neutral_m * a_(k) - neutral * a_m;
      d_couette(k, m) = d * pull * (phi_m * pull + 2.0 * phi_(k) * pull_m);
      d_cross(k, m) = 2.0 * ((phi_m * pull + phi_(k) * pull_m) * first - phi_(k) * pull * d * neutral_m);
      d_poiseuille(k, m) = phi_m * second - 2.0 * phi_(k) * first * neutral_m;
    }
  }
}

}  // namespace whirl::film
