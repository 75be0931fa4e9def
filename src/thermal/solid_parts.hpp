#pragma once
// The faces of a cell of a solid: conductances to its neighbours and through free surfaces.

#include <cmath>

#include "whirl/thermal/solid.hpp"

namespace whirl::thermal {

/// visit(k, i, q) of all cells of this rank in the order of their numbers.
template <class Visit>
void each_cell(const Solid& solid, const Visit& visit) {
  for (int q = solid.begin(); q < solid.end(); ++q)
    for (int i = 0; i < solid.shape().columns(); ++i)
      for (int k = 0; k < solid.shape().layers(); ++k) visit(k, i, q);
}

/// visit(k, i, q, W/K) of the cells that share a face with one, if anything is conducted through it.
template <class Visit>
void Solid::each_neighbour(int k, int i, int q, const Visit& visit) const {
  const Cylinder& c = shape_;
  const double conductivity = material_.conductivity, angle = c.angle(i), depth = c.depth(q);
  const auto node = [](const std::vector<double>& of, int at) { return of[static_cast<std::size_t>(at)]; };
  const auto along = [&](int other) {
    const double g = conductivity * c.sector(k) * angle / std::abs(node(c.z, other) - node(c.z, q));
    if (g > 0) visit(k, i, other, g);
  };
  const auto around = [&](int other, double step) {
    const double g = conductivity * depth * (node(c.r, k + 1) - node(c.r, k)) / (c.centre(k) * step);
    if (g > 0) visit(k, other, q, g);
  };
  const auto across = [&](int other) {
    visit(other, i, q, conductivity * angle * depth / std::abs(std::log(c.centre(other) / c.centre(k))));
  };
  constexpr double turn = 2 * std::numbers::pi;
  const int n = c.columns(), last = n - 1;
  if (q > 0) along(q - 1);
  if (n > 1 && i > 0) around(i - 1, node(c.theta, i) - node(c.theta, i - 1));
  if (n > 1 && i == 0 && c.closed) around(last, c.theta.front() + turn - c.theta.back());
  if (k > 0) across(k - 1);
  if (k + 1 < c.layers()) across(k + 1);
  if (n > 1 && i < last) around(i + 1, node(c.theta, i + 1) - node(c.theta, i));
  if (n > 1 && i == last && c.closed) around(0, c.theta.front() + turn - c.theta.back());
  if (q + 1 < c.rows()) along(q + 1);
}

/// visit(surface) of the free surfaces of a cell, but for ends of prescribed temperature.
template <class Visit>
void Solid::each_surface(int k, int i, int q, const Visit& visit) const {
  const Cylinder& c = shape_;
  // Through the rest of the layer and the boundary layer outside it.
  const auto radial = [&](const Surface& s, double Heats::*to, int layer, double radius, bool wall) {
    if (k != layer || s.kind == Surface::Kind::adiabatic || radius <= 0) return;
    const double whole = radius * c.angle(i) * c.depth(q), area = whole - (wall ? covered(i, q) : 0);
    if (area <= 1e-12 * whole) return;
    double resistance = std::abs(std::log(radius / c.centre(k))) * radius / (material_.conductivity * area);
    if (s.kind == Surface::Kind::convection) {
      if (s.coefficient <= 0) return;
      resistance += 1 / (s.coefficient * area);
    }
    visit(Exposed{to, 1 / resistance, s.temperature});
  };
  radial(surfaces_.inner, &Heats::inner, 0, c.r.front(), c.outside);
  radial(surfaces_.outer, &Heats::outer, c.layers() - 1, c.r.back(), !c.outside);
  // The node lies on the surface.
  const auto end = [&](const Surface& s, double Heats::*to, int row) {
    const double g = s.coefficient * c.sector(k) * c.angle(i);
    if (q == row && s.kind == Surface::Kind::convection && g > 0) visit(Exposed{to, g, s.temperature});
  };
  end(surfaces_.begin, &Heats::begin, 0);
  end(surfaces_.end, &Heats::end, c.rows() - 1);
}

}  // namespace whirl::thermal
