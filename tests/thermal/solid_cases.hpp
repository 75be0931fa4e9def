#pragma once
// Bushes and journals of bearing A and what their tests share.

#include <functional>

#include "thermal/bush.hpp"
#include "thermal/journal.hpp"

namespace whirl::thermal::test {

/// D 30 mm, L 30 mm.
inline Mesh film(int around, int along) {
  Mesh out;
  out.around = around;
  out.along = along;
  out.radius = 0.015;
  out.length = 0.03;
  return out;
}

inline Surface convection(double coefficient, double temperature = 300) {
  return {Surface::Kind::convection, coefficient, temperature};
}
inline Surface prescribed(double temperature) {
  return {Surface::Kind::prescribed, 0, temperature};
}

inline Bush bush() {
  Bush out;
  out.material = {45, 7800, 460};
  out.outer_radius = 0.025;
  out.surfaces = {{}, convection(50), convection(50), convection(50)};
  return out;
}

inline Journal journal() {
  Journal out;
  out.material = {16, 7800, 460};
  out.bore_radius = 0.005;
  out.length = 0.1;
  out.before = 0.02;
  out.surfaces = {convection(200), convection(200), convection(200), convection(200)};
  return out;
}

/// value(i, j) of every column of the film on this rank.
inline std::vector<double> columns(const Rows& rows, const std::function<double(int, int)>& value) {
  std::vector<double> out;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < rows.mesh().nodes_around(); ++i) out.push_back(value(i, j));
  return out;
}

/// W/K of every column, for `coefficient` [W/(m^2 K)].
inline std::vector<double> film_conductance(const Rows& rows, double coefficient) {
  return columns(rows, [&](int i, int j) { return coefficient * rows.mesh().width(i) * rows.mesh().depth(j); });
}

inline double sum(const Rows& rows, const std::vector<double>& values) {
  double out = 0;
  for (const double v : values) out += v;
  MPI_Allreduce(MPI_IN_PLACE, &out, 1, MPI_DOUBLE, MPI_SUM, rows.comm());
  return out;
}

/// visit(place on this rank, k, i, q) of all cells of this rank.
inline void each(const Solid& s, const std::function<void(PetscInt, int, int, int)>& visit) {
  PetscInt at = 0;
  for (int q = s.begin(); q < s.end(); ++q)
    for (int i = 0; i < s.shape().columns(); ++i)
      for (int k = 0; k < s.shape().layers(); ++k) visit(at++, k, i, q);
}

struct Solution {
  core::Vector temperature;
  int iterations = 0;
};

/// The solid beside a film of given temperatures [K] and conductances [W/K], with sources [W] in its cells.
inline Solution solve(Solid& solid, const std::vector<double>& conductance, const std::vector<double>& temperature,
                      Vec source = nullptr) {
  solid.join(conductance);
  const core::Vector rhs = solid.temperature(0);
  solid.load(temperature, rhs.get());
  if (source) core::check(VecAXPY(rhs.get(), 1, source));
  Solution out{solid.temperature(300), 0};
  out.iterations = solid.solve(rhs.get(), out.temperature.get());
  return out;
}

}  // namespace whirl::thermal::test
