// What flows through a film at the pressure that was found, and what it does.
#include <algorithm>
#include <cmath>

#include "thermal/film_flow_work.hpp"
#include "thermal/profile.hpp"
#include "thermal/row_halo.hpp"
#include "whirl/thermal/truncation.hpp"

namespace whirl::thermal {
namespace {

// Mass flow and heat of a face, layer by layer.
struct Layers {
  explicit Layers(int layers) : flow(static_cast<std::size_t>(layers)), heat(flow.size()) {}
  std::vector<double> flow;  // kg/s
  std::vector<double> heat;  // W per m^2 of face area
};

}  // namespace

Flow FilmFlow::flow() const {
  Work& w = *w_;
  const Mesh& mesh = w.mesh;
  const Rows& rows = w.rows;
  const int n = w.n, l = mesh.across, begin = rows.begin(), end = rows.end();
  const auto at = [](std::ptrdiff_t k) { return static_cast<std::size_t>(k); };
  const auto cells = at(static_cast<std::ptrdiff_t>(rows.count()) * n * l);
  const std::vector<double> p = with_halo(rows, w.pressure, at(n)), fill = with_halo(rows, w.filled, at(n));
  Flow out;
  out.around.assign(cells, 0);
  out.along.assign(cells + at(n * l), 0);
  out.across.assign(at(static_cast<std::ptrdiff_t>(rows.count()) * n * (l + 1)), 0);
  out.inflow.assign(cells, 0);
  out.heat.assign(cells, 0);
  if (!mesh.closed) out.entry.assign(at(rows.count() * l), 0);

  Profile profile(l);
  Layers layers(l);
  // tau u at the borders of the layers, from one to the next: of a gas that is dissipation and the work of pressure. A
  // liquid turns what pressure does into motion and back, and keeps the dissipation.
  // In turbulence each part of the velocity has a resistance of its own. The column's dissipation G^2/k + s U^2 is that
  // of G/sqrt(k) and U sqrt(s) in laminar flow, which no layer has below zero.
  const auto through = [&](std::size_t a, std::size_t b, double step, double width, double surface,
                           const Resistance& law) {
    w.face(a, b, profile);
    const double gradient = (p[b] - p[a]) / step, dense = w.options.fluid.gas ? 0.5 * (p[a] + p[b]) : 1.0;
    const double d = 0.5 * (w.h[a] + w.h[b]) / l;
    double less = 1, more = 1;
    if (w.turbulent) {
      const double reynolds = w.reynolds(a, b) * dense;
      less = w.resist(law, reynolds).value;
      more = couette_factor(w.options.turbulence, reynolds);
    }
    const double slope = gradient / less, steep = gradient / std::sqrt(less), share = fill[surface > 0 ? a : b],
                 dragged = surface * std::sqrt(more * share);
    double before = 0;
    for (int k = 0; k < l; ++k) {
      const double moved = profile.by_pressure[at(k)] * slope + profile.by_drag[at(k)] * surface * share;
      const double lost = (profile.by_pressure[at(k)] * steep + profile.by_drag[at(k)] * dragged) * steep;
      layers.flow[at(k)] = w.density(a, b, at(k)) * dense * moved * width;
      const double u = profile.pressure[at(k + 1)] * steep + profile.drag[at(k + 1)] * dragged;
      const double tau = steep * (d * (k + 1) - profile.neutral) + dragged * profile.pull;
      layers.heat[at(k)] = tau * u - before - (w.options.fluid.gas ? lost - moved * gradient : lost);
      before = tau * u;
    }
  };
  const auto heat = [&](int i, int q, int k, double area) {
    if (q >= begin && q < end) out.heat[at(rows.cell(k, i, q))] += 0.5 * area * layers.heat[at(k)];
  };
  const double surface = w.options.speed * mesh.radius;
  for (int q = begin; q < end; ++q)
    for (int i = 0; i < (mesh.closed ? n : n - 1); ++i) {
      const int next = (i + 1) % n;
      through(w.halo(i, q), w.halo(next, q), mesh.dx(), mesh.depth(q), surface, w.law_around);
      for (int k = 0; k < l; ++k) {
        out.around[at(rows.cell(k, i, q))] = layers.flow[at(k)];
        heat(i, q, k, mesh.dx() * mesh.depth(q));
        heat(next, q, k, mesh.dx() * mesh.depth(q));
      }
    }
  for (int q = std::max(begin, 1); q <= std::min(end, mesh.along); ++q)
    for (int i = 0; i < n; ++i) {
      through(w.halo(i, q - 1), w.halo(i, q), mesh.dz(), mesh.width(i), 0, w.law_along);
      for (int k = 0; k < l; ++k) {
        out.along[at(((static_cast<std::ptrdiff_t>(q) - begin) * n + i) * l + k)] = layers.flow[at(k)];
        heat(i, q - 1, k, mesh.dz() * mesh.width(i));
        heat(i, q, k, mesh.dz() * mesh.width(i));
      }
    }

  const std::vector<double> holes = [&] {
    std::vector<double> in(at(n * rows.count()), 0.0);
    for (std::size_t k = 0; k < w.here.size(); ++k) {
      const Orifice& o = w.options.orifices[w.here[k]];
      in[at(rows.node(o.i, o.j))] += w.through_hole(k, w.hole[k]).value;
    }
    return in;
  }();
  for (int q = begin; q < end; ++q)
    for (int i = 0; i < n; ++i) {
      const auto along = [&](int row, int k) -> double& {
        return out.along[at(((static_cast<std::ptrdiff_t>(row) - begin) * n + i) * l + k)];
      };
      const bool start = !mesh.closed && i == 0, stop = !mesh.closed && i == n - 1;
      double left = 0, sum = 0;
      std::vector<double> leaves(at(l));
      for (int k = 0; k < l; ++k) {
        const double from = start ? 0 : out.around[at(rows.cell(k, (i + n - 1) % n, q))];
        const double to = stop ? 0 : out.around[at(rows.cell(k, i, q))];
        leaves[at(k)] = to - from + (q == mesh.along ? 0 : along(q + 1, k)) - (q == 0 ? 0 : along(q, k));
        sum += leaves[at(k)];
      }
      if (w.fixed[at(rows.node(i, q))] && (start || stop || q == 0 || q == mesh.along)) {
        // What the layers of an end do not pass on leaves the film, layer by layer.
        for (int k = 0; k < l; ++k) {
          if (q == 0)
            along(0, k) = leaves[at(k)];
          else if (q == mesh.along)
            along(q + 1, k) = -leaves[at(k)];
          else if (start)
            out.entry[at((q - begin) * l + k)] = leaves[at(k)];
          else
            out.around[at(rows.cell(k, i, q))] = -leaves[at(k)];
        }
        continue;
      }
      // An orifice gives what its law says, a groove or a cavity what is wanted.
      const auto node = at(rows.node(i, q));
      const bool ruptured = w.options.cavitation == FilmFlowOptions::Cavitation::reynolds && w.pressure[node] <= 0;
      out.inflow[node * at(l)] = w.fixed[node] || ruptured ? sum : holes[node];
      left = out.inflow[node * at(l)];
      for (int k = 0; k < l; ++k) {
        left -= leaves[at(k)];
        out.across[node * at(l + 1) + at(k + 1)] = left;
      }
    }
  w.mix(out);
  return out;
}

std::vector<double> FilmFlow::orifice_flows() const {
  std::vector<double> all(w_->options.orifices.size(), 0.0);
  for (std::size_t k = 0; k < w_->here.size(); ++k) all[w_->here[k]] = w_->through_hole(k, w_->hole[k]).value;
  MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_DOUBLE, MPI_SUM, w_->rows.comm());
  return all;
}

std::vector<char> FilmFlow::ruptured() const {
  const Work& w = *w_;
  const auto at = [](PetscInt k) { return static_cast<std::size_t>(k); };
  const bool reynolds = w.options.cavitation == FilmFlowOptions::Cavitation::reynolds && !w.options.fluid.gas;
  std::vector<char> out(w.pressure.size(), 0);
  for (std::size_t c = 0; c < out.size(); ++c)
    out[c] = !w.fixed[c] && (w.filled[c] < 1 || (reynolds && w.pressure[c] <= 0)) ? 1 : 0;
  // Ends last: two or more rows are on each rank.
  for (int i = 0; i < w.n; ++i) {
    if (w.rows.begin() == 0) out[at(w.rows.node(i, 0))] = out[at(w.rows.node(i, 1))];
    if (w.rows.end() == w.mesh.nodes_along())
      out[at(w.rows.node(i, w.mesh.along))] = out[at(w.rows.node(i, w.mesh.along - 1))];
  }
  for (int q = w.rows.begin(); q < w.rows.end() && !w.mesh.closed; ++q) {
    out[at(w.rows.node(0, q))] = out[at(w.rows.node(1, q))];
    out[at(w.rows.node(w.n - 1, q))] = out[at(w.rows.node(w.n - 2, q))];
  }
  return out;
}

std::vector<double> FilmFlow::expansion(const Flow& flow) const {
  const Work& w = *w_;
  const Mesh& mesh = w.mesh;
  const int n = w.n, l = mesh.across, begin = w.rows.begin(), end = w.rows.end();
  const auto at = [](std::ptrdiff_t k) { return static_cast<std::size_t>(k); };
  const std::vector<double> p = with_halo(w.rows, w.pressure, at(n));
  std::vector<double> out(w.pressure.size(), 0.0);
  // Volume flow times the difference of pressure, of one face.
  const auto work = [&](std::size_t a, std::size_t b, const double* mass) {
    const double dense = w.options.fluid.gas ? 0.5 * (p[a] + p[b]) : 1.0;
    double volume = 0;
    for (int k = 0; k < l; ++k) volume += mass[k] / (w.density(a, b, at(k)) * dense);
    return volume * (p[b] - p[a]);
  };
  const auto share = [&](int i, int q, double watts) {
    if (q >= begin && q < end) out[at(w.rows.node(i, q))] += 0.5 * watts;
  };
  for (int q = begin; q < end; ++q)
    for (int i = 0; i < (mesh.closed ? n : n - 1); ++i) {
      const double watts = work(w.halo(i, q), w.halo((i + 1) % n, q), flow.around.data() + w.rows.cell(0, i, q));
      share(i, q, watts);
      share((i + 1) % n, q, watts);
    }
  for (int q = std::max(begin, 1); q <= std::min(end, mesh.along); ++q)
    for (int i = 0; i < n; ++i) {
      const double* mass = flow.along.data() + (static_cast<std::ptrdiff_t>(q - begin) * n + i) * l;
      const double watts = work(w.halo(i, q - 1), w.halo(i, q), mass);
      share(i, q - 1, watts);
      share(i, q, watts);
    }
  return out;
}

FlowReport FilmFlow::report(const Flow& flow) const {
  Work& w = *w_;
  const Mesh& mesh = w.mesh;
  const int n = w.n, l = mesh.across;
  const auto at = [](std::ptrdiff_t k) { return static_cast<std::size_t>(k); };
  const std::vector<double> p = with_halo(w.rows, w.pressure, at(n)), fill = with_halo(w.rows, w.filled, at(n));
  Profile profile(l);
  // Force x, y, friction, heat, inflow, outflow, expansion; defect, highest pressure.
  double sums[7] = {}, most[2] = {};
  for (const double watts : expansion(flow)) sums[6] += watts;
  // Pressure times normal is linear between two nodes of a row, and acts where the pressure is above the ambient's: it
  // is cut off within cells, not by node, so that the force goes smoothly with the place of the journal. The
  // derivatives of the integral of max(p, 0) are the integrals of both hat functions where p > 0. A whole film is the
  // trapezoidal rule.
  const bool truncated = w.options.cavitation == FilmFlowOptions::Cavitation::half_sommerfeld;
  const auto press = [&](double left, double right, double angle, double next, double area) {
    double by_left = 0.5, by_right = 0.5;
    if (truncated) {
      const auto part = truncated_linear(left, right);
      by_left = part.d_left;
      by_right = part.d_right;
    }
    sums[0] -= (left * by_left * std::cos(angle) + right * by_right * std::cos(next)) * area;
    sums[1] -= (left * by_left * std::sin(angle) + right * by_right * std::sin(next)) * area;
  };
  for (int q = w.rows.begin(); q < w.rows.end(); ++q)
    for (int i = 0; i < n; ++i) {
      const auto node = at(w.rows.node(i, q));
      most[0] = std::max(most[0], std::abs(flow.across[node * at(l + 1) + at(l)]));
      most[1] = std::max(most[1], w.pressure[node]);
      for (int k = 0; k < l; ++k) {
        sums[3] += flow.heat[node * at(l) + at(k)];
        sums[4] += flow.inflow[node * at(l) + at(k)];
        if (q == 0) sums[5] -= flow.along[at(i * l + k)];
        if (q == mesh.along) sums[5] += flow.along[at(((q - w.rows.begin() + 1) * n + i) * l + k)];
      }
      if (!mesh.closed && i == n - 1) continue;
      const std::size_t a = w.halo(i, q), b = w.halo((i + 1) % n, q);
      press(p[a] - w.options.ambient, p[b] - w.options.ambient, mesh.theta(i), mesh.theta(i + 1),
            mesh.dx() * mesh.depth(q));
      w.face(a, b, profile);
      const double dense = w.options.fluid.gas ? 0.5 * (p[a] + p[b]) : 1.0;
      const double more = w.turbulent ? couette_factor(w.options.turbulence, w.reynolds(a, b) * dense) : 1.0;
      // Streamers of the share that is filled cross a gap that is not full.
      const double share = fill[w.options.speed > 0 ? a : b];
      const double tau = share * ((p[b] - p[a]) / mesh.dx() * (0.5 * (w.h[a] + w.h[b]) - profile.neutral) +
                                  w.options.speed * mesh.radius * profile.pull * more);
      sums[2] += tau * mesh.dx() * mesh.depth(q) * mesh.radius;
    }
  for (int q = w.rows.begin(); q < w.rows.end() && !mesh.closed; ++q)
    for (int k = 0; k < l; ++k) {
      if (q == 0 || q == mesh.along) continue;
      sums[5] += flow.around[at(w.rows.cell(k, n - 1, q))] - flow.entry[at((q - w.rows.begin()) * l + k)];
    }
  MPI_Allreduce(MPI_IN_PLACE, sums, 7, MPI_DOUBLE, MPI_SUM, w.rows.comm());
  MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, w.rows.comm());
  FlowReport out;
  out.force[0] = sums[0];
  out.force[1] = sums[1];
  out.friction = sums[2];
  out.power = sums[2] * w.options.speed + 0.0;  // no -0
  out.heat = sums[3];
  out.expansion = sums[6];
  out.inflow = sums[4];
  out.outflow = sums[5];
  out.defect = most[0];
  out.highest = most[1];
  return out;
}

}  // namespace whirl::thermal
