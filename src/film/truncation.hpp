#pragma once
// Exact integral of max(p, 0) over a cell for pressure that is piecewise linear on triangles.

#include <algorithm>
#include <array>

namespace whirl::film {

/// Integral of max(p, 0) over a triangle divided by its area, p linear with vertex values a, b, c; adds `weight` times
/// the gradient to ga, gb, gc. Continuously differentiable unless a = b = c = 0.
inline double truncated_triangle(double a, double b, double c, double weight, double& ga, double& gb, double& gc) {
  // Reduced to one vertex whose sign differs from the other two: the cut-off corner has the integral
  // a^3/(3 (a-b)(a-c)).
  const auto corner = [weight](double p, double q, double r, double& gp, double& gq, double& gr) {
    const double u = p / (p - q), v = p / (p - r);
    const double third = weight / 3.0;
    gp += third * u * v * (3.0 - u - v);
    gq += third * u * u * v;
    gr += third * u * v * v;
    return p * u * v / 3.0;
  };
  const bool pa = a > 0.0, pb = b > 0.0, pc = c > 0.0;
  const int positive = pa + pb + pc;
  if (positive == 0) return 0.0;
  if (positive == 1) {
    if (pa) return corner(a, b, c, ga, gb, gc);
    if (pb) return corner(b, c, a, gb, gc, ga);
    return corner(c, a, b, gc, ga, gb);
  }
  const double third = weight / 3.0;
  ga += third, gb += third, gc += third;
  const double full = (a + b + c) / 3.0;
  if (positive == 3) return full;
  // With one vertex at or below zero, its (negative) corner is taken off again.
  double na = 0.0, nb = 0.0, nc = 0.0, cut = 0.0;
  if (!pa) cut = a < 0.0 ? corner(a, b, c, na, nb, nc) : 0.0;
  if (!pb) cut = b < 0.0 ? corner(b, c, a, nb, nc, na) : 0.0;
  if (!pc) cut = c < 0.0 ? corner(c, a, b, nc, na, nb) : 0.0;
  ga -= na, gb -= nb, gc -= nc;
  return full - cut;
}

/// Integral of max(p, 0) over a rectangular cell divided by its area, and its gradient in the corner values
/// {left-low, left-high, right-low, right-high}. The cell is cut into four triangles that meet in its centre, where p
/// is the mean of the corners: symmetric in both directions.
inline double truncated_cell(const std::array<double, 4>& p, std::array<double, 4>& gradient) {
  gradient = {};
  const double low = std::min(std::min(p[0], p[1]), std::min(p[2], p[3]));
  const double mean = 0.25 * (p[0] + p[1] + p[2] + p[3]);
  if (low >= 0.0) {
    gradient = {0.25, 0.25, 0.25, 0.25};
    return mean;
  }
  if (std::max(std::max(p[0], p[1]), std::max(p[2], p[3])) <= 0.0) return 0.0;
  double centre = 0.0;
  double value = truncated_triangle(p[0], p[1], mean, 0.25, gradient[0], gradient[1], centre);
  value += truncated_triangle(p[1], p[3], mean, 0.25, gradient[1], gradient[3], centre);
  value += truncated_triangle(p[3], p[2], mean, 0.25, gradient[3], gradient[2], centre);
  value += truncated_triangle(p[2], p[0], mean, 0.25, gradient[2], gradient[0], centre);
  for (double& g : gradient) g += 0.25 * centre;
  return 0.25 * value;
}

}  // namespace whirl::film
