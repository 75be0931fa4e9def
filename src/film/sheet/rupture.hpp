#pragma once
// Where a cavitating film ruptures within a cell.
//
// Beyond the rupture p = dp/dn = 0, so that in front of it p = (p''/2) s^2 with the distance s. On a row of nodes with
// the step 1 and p'' = q_0 = src/a (a the mobility around the pad, per square of the step) the second difference of
// (q_0/2) max(s, 0)^2 is q_0 m, where m grows from 0 to 1 as the rupture passes: m is the part of the cell that is
// filled with film, weighted by the hat function of the node. With u the distance of the rupture from the node, in
// steps, positive where the node carries:
//
//     p = 0,             m = 1/2 + u               u <= 0          the node is in the cavity, m follows its neighbours
//     p = q_0 u^2/2,     m = 1/2 + u - u^2/2       0 < u < 1       cut: the rupture is less than a step away
//     p = q_0 (u - 1/2), m = 1                     1 <= u
//
// and the film obeys A p + m(p) src = 0 node by node. The pairs (p, m) form a monotone graph, so this is the minimum of
// p A p/2 + sum B(p, src), dB/dp = m src: it has one solution, whose first derivatives are continuous. The nodal
// complementarity (m = 1 where p > 0) has the same limit; its tangents jump whenever a node enters the cavity.
// The force counts dB/dsrc instead of p: it is the derivative of that minimum in the velocity of the journal, so that
// damping is symmetric, and its sum over the cells of a row does not feel where in a cell the rupture lies:
//
//     dB/dsrc = q_0 (u^2/4 + u^3/6) of a cut node, p - q_0/12 of a full one
//
// (the latter is the correction of Euler and Maclaurin to the trapezoidal rule).

namespace whirl::film::rupture {

inline bool in_cavity(double u) {
  return u <= 0.0;
}
inline bool cut(double u) {
  return u > 0.0 && u < 1.0;
}

/// dm/dp of a cut node, times q_0.
inline double slope(double u) {
  return (1.0 - u) / u;
}

/// What a node outside the cavity adds to the force, p' = dB/dsrc, and how it varies: dp' = by_pressure dp + by_scale
/// dq_0, and d(m src) = (slope) a dp + by_pressure d src + by_mobility q_0 da.
struct Counted {
  double pressure, by_pressure, by_scale, by_mobility;
};
inline Counted counted(double u, double p, double q_0) {
  if (!cut(u)) return {p - q_0 / 12.0, 1.0, -1.0 / 12.0, 0.0};
  return {q_0 * u * u * (0.25 + u / 6.0), 0.5 * (1.0 + u), -u * u * u / 12.0, 0.5 * u * (1.0 - u)};
}

}  // namespace whirl::film::rupture
