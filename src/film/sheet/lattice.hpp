#pragma once
// Where a source on a mesh reads its own potential.

namespace whirl::film {

/// ln of the radius [m] at which the field ln(r) of a point source equals what a mesh of five points, spacings dx and
/// dz, has for it i nodes along x and j nodes along z away: near the logarithm of that distance, and at the source
/// itself that of exp(-gamma)/4 hypot(dx, dz). One of the integrals of the mesh's Green function is taken in closed
/// form:
///
///     u(0) - u(i, j) = int_0^pi (1 - exp(-i s) cos(j k))/(2 pi a sinh s) dk,   cosh s = 1 + (1 - cos k)/a^2,  a =
///     dz/dx
///
/// (the conductances are a and 1/a). Source: van der Pol and Bremmer (1959) sec. XV.5 for a = 1.
[[nodiscard]] double log_distance(double dx, double dz, int i, int j);

}  // namespace whirl::film
