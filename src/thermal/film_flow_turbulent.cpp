// What turbulence does to the flow of a film.
#include <cmath>

#include "thermal/film_flow_work.hpp"

namespace whirl::thermal {

double FilmFlow::Work::reynolds(std::size_t a, std::size_t b) const {
  double dense = 0, viscous = 0;
  for (std::size_t k = 0; k < mu_at_.size(); ++k) {
    dense += density(a, b, k);
    viscous += mu_at_[k];
  }
  return dense * std::abs(options.speed) * mesh.radius * 0.5 * (h[a] + h[b]) / viscous;
}

Valued FilmFlow::Work::resist(const Resistance& law, double reynolds) const {
  if (!(reynolds > 0)) return {1, 0};
  const double value = evaluate(law, reynolds);
  return {value / 12, law.exponent * (value - 12) / (12 * reynolds)};
}

// The flow away from an orifice goes in all directions: the geometric mean of both resistances.
Valued FilmFlow::Work::around_hole(std::size_t k, double p) const {
  if (!turbulent) return {1, 0};
  const double per_pressure = at_hole[k].reynolds;
  const Valued x = resist(law_around, per_pressure * p), z = resist(law_along, per_pressure * p);
  const double value = 1 / std::sqrt(x.value * z.value);
  return {value, -0.5 * value * (x.slope / x.value + z.slope / z.value) * per_pressure};
}

// Reichardt's eddies at the shear of the Couette flow, where the fluid has the column's mean properties.
void FilmFlow::Work::mix(Flow& flow) const {
  const Fluid& fluid = options.fluid;
  if (!turbulent || !(fluid.conductivity > 0)) return;
  const int l = mesh.across;
  const double surface = std::abs(options.speed) * mesh.radius;
  flow.mixing.reserve(flow.across.size());
  for (int q = rows.begin(); q < rows.end(); ++q)
    for (int i = 0; i < n; ++i) {
      const std::size_t node = halo(i, q);
      double viscous = 0, warm = 0, dense = 0;
      for (std::size_t k = node * at(l); k < (node + 1) * at(l); ++k) {
        viscous += mu[k] / l;
        warm += temperature[k] / l;
        dense += fluid.rho(pressure[at(rows.node(i, q))], temperature[k]) / l;
      }
      const double re = dense * surface * h[node] / viscous;
      // y+ = y sqrt(tau rho)/mu with tau = s mu U/h
      const double half = 0.5 * std::sqrt(couette_factor(options.turbulence, re) * re);
      const double prandtl = viscous * fluid.c(warm) / fluid.k(warm);
      for (int k = 0; k <= l; ++k)
        flow.mixing.push_back(eddy_conduction(half, prandtl, k == 0 ? 0 : (k - 0.5) / l, k == l ? 1 : (k + 0.5) / l));
    }
}

}  // namespace whirl::thermal
