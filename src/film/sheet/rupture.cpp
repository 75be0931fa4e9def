// Reynolds cavitation of a pad: the rupture moves through the cells by Newton's method in its distance from the nodes.
#include "film/sheet/rupture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "film/sheet/banded_pad.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {

void BandedPad::enter_ruptured() {
  u_.assign(source_.size(), std::numeric_limits<double>::infinity());
  more_.assign(source_.size(), 0.0);
  by_source_.assign(source_.size(), Quad::zero());
  by_mobility_.assign(source_.size(), Quad::zero());
}

// A p + src at a node.
double BandedPad::residual(int i, int j) const {
  const double p = pressure_at(i, j);
  double r = source_[at(i, j)] + b_.value[along(i, j)] * (p - pressure_at(i, j - 1));
  r += share(j) * (a_.value[around(wrap(i - 1), j)] * (p - pressure_at(i - 1, j)) +
                   a_.value[around(i, j)] * (p - pressure_at(i + 1, j)));
  if (j + 1 < z_faces_) r += b_.value[along(i, j + 1)] * (p - pressure_at(i, j + 1));
  return r;
}

// One step of Newton's method in u. Of p, only that of cut nodes is not linear in u:
// (A + a m'/p') p = -src (1 + u)/2 there, -src at full nodes, p = 0 in the cavity, whose u follows from its neighbours.
// Returns the largest move of the rupture, in steps of the mesh; nodes that stay full or in the cavity have none.
double BandedPad::move_rupture() {
  double moved = 0.0;
  for (int i = first_; i < grid_.n_theta; ++i) {
    if (wall(i)) continue;
    for (int j = 0; j < rows_; ++j) {
      const std::size_t k = at(i, j);
      const double u = u_[k], source = source_[k];
      if (cavitated_[k] || u == std::numeric_limits<double>::infinity()) continue;
      const double p = x_[k], scale = source / (share(j) * mobility_at(i, j));
      const double next = rupture::in_cavity(u) ? 0.5 - residual(i, j) / source
                          : rupture::cut(u)     ? 0.5 * u + p / (scale * u)
                                                : p / scale + 0.5;
      const bool stays = (u >= 1.0 && next >= 1.0) || (u <= 0.0 && next <= 0.0);
      // Once not a number, it stays so.
      if (!stays && !std::isnan(moved)) moved = std::isnan(next) ? next : std::max(moved, std::abs(next - u));
      u_[k] = next;
    }
  }
  return moved;
}

// Rows in front of the rupture stay as they are while it moves: `mark_` tells from where on they change.
void BandedPad::factor_ruptured() {
  constexpr double kOut = std::numeric_limits<double>::infinity();
  stale_ = false;
  ++factorisations_;
  int first = static_cast<int>(u_.size()), changed = first;
  for (int i = first_; i < grid_.n_theta; ++i) {
    if (wall(i)) continue;
    for (int j = 0; j < rows_; ++j) {
      const std::size_t k = at(i, j);
      if (cavitated_[k]) continue;
      const double u = u_[k];
      const double more = rupture::in_cavity(u) ? kOut
                          : rupture::cut(u)     ? share(j) * mobility_at(i, j) * rupture::slope(u)
                                                : 0.0;
      if (more != 0.0) first = std::min(first, static_cast<int>(k));
      if (more != more_[k]) changed = std::min(changed, static_cast<int>(k));
      more_[k] = more;
    }
  }
  if (changed >= mark_) return band_.factor(base_, more_, mark_, mark_);
  constexpr int steps = core::BandLu::at_once;
  mark_ = std::max(1, (first - 2 * rows_) / steps) * steps;
  band_.factor(base_, more_, 0, mark_);
}

void BandedPad::solve_ruptured() {
  constexpr int kMost = 200;
  constexpr double kNone = 1e-13;  // of the largest source: nothing that could rupture a film
  constexpr double kNear = 1e-4;   // steps of the mesh; the next ones would be its square
  constexpr double kExact = 1e-9;
  double largest = 0.0;
  for (double s : source_) largest = std::max(largest, std::abs(s));
  for (std::size_t k = 0; k < u_.size(); ++k) {
    if (source_[k] <= kNone * largest)
      u_[k] = std::numeric_limits<double>::infinity();
    else if (u_[k] == std::numeric_limits<double>::infinity())
      u_[k] = 1.0;
  }
  assemble();
  mark_ = static_cast<int>(u_.size()) + 1;  // nothing is factorised yet
  double moved = 0.0;
  int iteration = 0;
  do {
    if (++iteration > kMost) {
      enter_ruptured();  // the next one shall not start from here
      throw core::NotConverged("the cavitated region of a film did not settle");
    }
    factor_ruptured();
    for (std::size_t k = 0; k < x_.size(); ++k) {
      const double filled = rupture::cut(u_[k]) ? 0.5 * (1.0 + u_[k]) : 1.0;
      x_[k] = cavitated_[k] ? 0.0 : -filled * source_[k];
    }
    band_.solve(false, x_.data(), x_.data(), 1);
    moved = move_rupture();
  } while (!(moved <= kNear));
  stale_ = moved > kExact;
}

// Force, and its derivatives in the nodal pressures into load_.
void BandedPad::integrate_ruptured(Need need, Response& response) {
  // A cell's share of the trapezoidal rule with exact means of cos and sin.
  const double area = pad_.radius * grid_.dtheta * grid_.dz * grid_.mean * std::cos(0.5 * grid_.dtheta);
  std::fill(load_.begin(), load_.end(), Quad::zero());
  Quad force = Quad::zero();
  for (int i = first_; i < grid_.n_theta; ++i) {
    if (wall(i)) continue;
    const auto node = static_cast<std::size_t>(i);
    const double cosine = -area * grid_.node_cos[node], sine = -area * grid_.node_sin[node];
    for (int j = 0; j < rows_; ++j) {
      const std::size_t k = at(i, j);
      if (cavitated_[k] || rupture::in_cavity(u_[k])) continue;
      const double times = whole_ ? 1.0 : 2.0 * share(j), z = tilt_ ? row_z(j) : 0.0;
      const Quad weight = {Quad::Vector{times * cosine, times * sine, times * z * cosine, times * z * sine}};
      const double a = mobility_at(i, j), scale = source_[k] / (share(j) * a);
      if (rupture::cut(u_[k])) x_[k] = 0.5 * scale * u_[k] * u_[k];
      const rupture::Counted c = rupture::counted(u_[k], x_[k], scale);
      force += c.pressure * weight;
      if (need == Need::force) continue;
      load_[k] = c.by_pressure * weight;
      by_source_[k] = (-c.by_scale / a) * weight;
      by_mobility_[k] = (c.by_scale * scale / a) * weight;
    }
  }
  for (int f = 0; f < 4; ++f) response.force[static_cast<std::size_t>(f)] += force[f];
}

// Adds the parts that go through the pressure, lambda in load_.
void BandedPad::weigh_ruptured() {
  for (int i = first_; i < grid_.n_theta; ++i) {
    if (wall(i)) continue;
    for (int j = 0; j < rows_; ++j) {
      const std::size_t k = at(i, j);
      if (cavitated_[k]) continue;
      if (rupture::in_cavity(u_[k])) {
        by_source_[k] = by_mobility_[k] = Quad::zero();
        continue;
      }
      const double scale = source_[k] / (share(j) * mobility_at(i, j));
      const rupture::Counted c = rupture::counted(u_[k], x_[k], scale);
      by_source_[k] += (share(j) * c.by_pressure) * load_[k];
      by_mobility_[k] += (share(j) * c.by_mobility * scale) * load_[k];
    }
  }
}

}  // namespace whirl::film
