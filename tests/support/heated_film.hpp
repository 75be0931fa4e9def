#pragma once
// Films with flows that keep mass cell by cell, made up for tests of heat.

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "whirl/thermal/energy.hpp"

namespace whirl::test {

/// A film whose mass flows through faces are given as integrals; the flow across follows from continuity.
struct HeatedFilm {
  using Thickness = std::function<double(double x, double z)>;
  /// kg/s around through a face at x, from z0 to z1, zeta0 to zeta1 / along through one at z, from x0 to x1.
  using Around = std::function<double(double x, double z0, double z1, double zeta0, double zeta1)>;
  using Along = std::function<double(double z, double x0, double x1, double zeta0, double zeta1)>;

  /// x runs from 0 at node 0, m; z from the mid-plane.
  HeatedFilm(const thermal::Mesh& m, MPI_Comm comm, const Thickness& h, const Around& around, const Along& along)
      : mesh(m), rows(m, comm) {
    const int n = m.nodes_around(), l = m.across;
    const auto size = [&](int layers, int more) {
      return static_cast<std::size_t>(rows.count() + more) * static_cast<std::size_t>(n) *
             static_cast<std::size_t>(layers);
    };
    flow.around.resize(size(l, 0));
    flow.along.resize(size(l, 1));
    flow.across.resize(size(l + 1, 0));
    flow.inflow.resize(size(l, 0));
    flow.heat.resize(size(l, 0));
    if (!m.closed) flow.entry.resize(static_cast<std::size_t>(rows.count() * l));
    thickness.resize(size(1, 0));
    for (int j = rows.begin(); j <= rows.end(); ++j)
      for (int i = 0; i < n; ++i)
        for (int k = 0; k < l; ++k) flow.along[cell(k, i, j)] = along(near(j), left(i), right(i), zeta(k), zeta(k + 1));
    for (int j = rows.begin(); j < rows.end(); ++j)
      for (int i = 0; i < n; ++i) {
        thickness[cell(0, i, j) / static_cast<std::size_t>(l)] = h(x(i), m.z(j));
        for (int k = 0; k < l; ++k) {
          flow.around[cell(k, i, j)] = around(right(i), near(j), far(j), zeta(k), zeta(k + 1));
          if (i == 0 && !m.closed)
            flow.entry[static_cast<std::size_t>((j - rows.begin()) * l + k)] =
                around(left(i), near(j), far(j), zeta(k), zeta(k + 1));
        }
      }
    for (int j = rows.begin(); j < rows.end(); ++j)
      for (int i = 0; i < n; ++i)
        for (int k = 0; k + 1 < l; ++k) layer(k + 1, i, j) = layer(k, i, j) - sides(k, i, j);
  }

  [[nodiscard]] double x(int i) const { return i * mesh.dx(); }
  [[nodiscard]] double zeta(int k) const { return static_cast<double>(k) / mesh.across; }
  [[nodiscard]] double middle(int k) const { return (k + 0.5) / mesh.across; }
  /// Faces of the volume of a node.
  [[nodiscard]] double left(int i) const { return !mesh.closed && i == 0 ? 0.0 : x(i) - mesh.dx() / 2; }
  [[nodiscard]] double right(int i) const { return !mesh.closed && i == mesh.around ? x(i) : x(i) + mesh.dx() / 2; }
  [[nodiscard]] double near(int j) const {
    return j == 0 ? mesh.z(0) : j > mesh.along ? mesh.z(mesh.along) : mesh.z(j) - mesh.dz() / 2;
  }
  [[nodiscard]] double far(int j) const { return near(j + 1); }
  [[nodiscard]] std::size_t cell(int k, int i, int j) const { return static_cast<std::size_t>(rows.cell(k, i, j)); }
  [[nodiscard]] std::size_t node(int i, int j) const { return static_cast<std::size_t>(rows.node(i, j)); }
  double& layer(int k, int i, int j) {
    return flow.across[node(i, j) * static_cast<std::size_t>(mesh.across + 1) + static_cast<std::size_t>(k)];
  }
  /// kg/s, out of a cell through its sides.
  [[nodiscard]] double sides(int k, int i, int j) const {
    const int n = mesh.nodes_around();
    const double in = !mesh.closed && i == 0
                          ? flow.entry[static_cast<std::size_t>((j - rows.begin()) * mesh.across + k)]
                          : flow.around[cell(k, (i + n - 1) % n, j)];
    return flow.around[cell(k, i, j)] - in + flow.along[cell(k, i, j + 1)] - flow.along[cell(k, i, j)];
  }
  template <class Of>
  void each(const Of& of) const {
    for (int j = rows.begin(); j < rows.end(); ++j)
      for (int i = 0; i < mesh.nodes_around(); ++i)
        for (int k = 0; k < mesh.across; ++k) of(k, i, j);
  }
  /// A wall whose surface has a temperature, K / an adiabatic one.
  [[nodiscard]] thermal::Wall isothermal(double conductivity, double temperature) const {
    return {thermal::Energy::half_layer(rows, conductivity, thickness),
            std::vector<double>(thickness.size(), temperature)};
  }
  [[nodiscard]] thermal::Wall adiabatic() const {
    return {std::vector<double>(thickness.size(), 0.0), std::vector<double>(thickness.size(), 300.0)};
  }
  [[nodiscard]] core::Vector temperature(double value) const {
    core::Vector out;
    core::check(DMCreateGlobalVector(rows.cells(), out.put()));
    core::check(VecSet(out.get(), value));
    return out;
  }

  thermal::Mesh mesh;
  thermal::Rows rows;
  thermal::Flow flow;
  std::vector<double> thickness;
};

/// An oil journal bearing, D 100 mm, L 80 mm, C 145 um, at 10 m/s: a flow like that of its film, around with the
/// journal and out at the ends, heated by shear. Flow around reverses near the ends at eccentricities above a half.
inline std::unique_ptr<HeatedFilm> heated_bearing(MPI_Comm comm, int around, int along, int across, double eccentricity,
                                                  double recirculation = 0) {
  const double clearance = 145e-6, speed = 10, rho = 860, mu = 0.02;
  thermal::Mesh m;
  m.around = around;
  m.along = along;
  m.across = across;
  m.radius = 0.05;
  m.length = 0.08;
  const auto gap = [=](double x) { return clearance * (1 + eccentricity * std::cos(x / 0.05)); };
  // What flows between the mid-plane and z, around at x.
  const auto stream = [=](double x, double z) {
    return rho * speed * clearance / 2 * (z + eccentricity * std::cos(x / 0.05) * (z - 4 * z * z * z / (3 * 0.0064)));
  };
  const auto sheared = [](double zeta) { return zeta * zeta; };                   // share of Couette flow below zeta
  const auto pressed = [](double zeta) { return zeta * zeta * (3 - 2 * zeta); };  // of Poiseuille flow
  auto film = std::make_unique<HeatedFilm>(
      m, comm, [=](double x, double) { return gap(x); },
      [=](double x, double z0, double z1, double a, double b) {
        const double couette = rho * speed * gap(x) / 2 * (z1 - z0), all = stream(x, z1) - stream(x, z0);
        const double turned = recirculation * couette;
        return (couette + turned) * (sheared(b) - sheared(a)) + (all - couette - turned) * (pressed(b) - pressed(a));
      },
      [=](double z, double x0, double x1, double a, double b) {
        return -(stream(x1, z) - stream(x0, z)) * (pressed(b) - pressed(a));
      });
  film->each([&](int k, int i, int j) {
    const double h = film->thickness[film->node(i, j)];
    film->flow.heat[film->cell(k, i, j)] = mu * speed * speed / h * m.width(i) * m.depth(j) / m.across;
  });
  return film;
}

}  // namespace whirl::test
