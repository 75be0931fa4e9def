#pragma once
// Integrals of max(p, 0) along one row of nodes, over the interval between two neighbours.
//
// Between inner nodes p is linear and the integral exact. Next to a pad edge, where p = 0 is prescribed, a straight
// line would give max(p_1, 0)/2, whose kink is felt whenever rupture reaches the edge (triangles have the same kink at
// edges and sides). There the integral passes from p_1/2 to 0 by a cubic, while the parabola through the edge and the
// next two nodes has a root near the first one. Both are continuously differentiable except where all their values
// vanish together, and are the trapezoidal rule over a positive film.

#include <cmath>

#include <algorithm>

namespace whirl::thermal {

inline double where_negative(double x, double a) {
  return x < 0.0 ? a : 0.0;
}
inline double positive_part(double x) {
  return std::max(x, 0.0);
}

template <class T>
struct IntervalIntegral {
  T integral;  // over the interval, divided by its length
  T d_left, d_right;
};

/// p linear from l to r; T is double or a pack of doubles.
template <class T>
IntervalIntegral<T> truncated_linear(T l, T r) {
  constexpr double kTiny = 1e-300;  // keeps 0/0 at 0
  const T lp = positive_part(l), rp = positive_part(r);
  const T u = lp / (kTiny + (lp + (rp - r))), v = rp / (kTiny + (rp + (lp - l)));
  const T both = 0.5 * (u + u - u * u), other = 0.5 * (v + v - v * v);
  return {0.5 * (lp * u + rp * v), both + where_negative(l, 0.5 * (v * v)), other + where_negative(r, 0.5 * (u * u))};
}

struct EdgeInterval {
  double integral;
  double d_near, d_far;
};

/// Next to an edge, p(0) = 0, p(1) = near, p(2) = far: near t (2 - t)/2 with t = near/|far/2 - near| held within [0,
/// 1].
inline EdgeInterval truncated_edge(double near, double far) {
  if (near <= 0.0) return {0.0, 0.0, 0.0};
  const double bend = 0.5 * far - near, size = std::abs(bend);
  if (near >= size) return {0.5 * near, 0.5, 0.0};
  const double t = near / size;
  const double by_size = bend > 0.0 ? t * t * (t - 1.0) : t * t * (1.0 - t);
  return {0.5 * near * t * (2.0 - t), t * (2.0 - 1.5 * t) - by_size, 0.5 * by_size};
}

}  // namespace whirl::thermal
