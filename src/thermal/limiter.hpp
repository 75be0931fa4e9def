#pragma once
// The temperature of a face from the cells around it.

namespace whirl::thermal {

/// Of squares of temperature steps: far below all that matter, its own square above underflow.
inline constexpr double smallest_square = 1e-150;

/// Face temperature beyond that of the cell upstream, T_f - T_U = phi(a, b)/2, from the steps a = T_U - T_UU and
/// b = T_D - T_U: phi = ab(a + b)/(a^2 + b^2) where ab > 0, else 0 (van Albada, van Leer and Roberts 1982). No new
/// extrema: phi/a and phi/b stay below 1.21, less than 2 (Spekreijse 1987). Without branches, for vector units.
inline double limited(double a, double b) {
  const double ab = a * b, positive = ab > 0 ? ab : 0.0;
  return 0.5 * positive * (a + b) / (a * a + b * b + smallest_square);
}

/// Derivatives of limited() to a and b. It is homogeneous: limited(a, b) = upstream a + downstream b.
struct Slopes {
  double upstream, downstream;
};
inline Slopes limited_slopes(double a, double b) {
  const double ab = a * b, aa = a * a, bb = b * b, once = 1 / (aa + bb + smallest_square);
  const double twice = ab > 0 ? 0.5 * once * once : 0.0;
  return {bb * (bb + 2 * ab - aa) * twice, aa * (aa + 2 * ab - bb) * twice};
}

}  // namespace whirl::thermal
