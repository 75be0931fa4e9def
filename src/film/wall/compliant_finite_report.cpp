// What the film of finite length says of itself, and its states on another mesh.
#include <algorithm>
#include <utility>

#include "film/wall/compliant_finite.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {

using core::at;

// Deflections, periodic around and zero at the edges, are interpolated linearly in both directions.
void FiniteFilm::resample(const JournalMotion& motion, const Film& other, std::span<const double> from,
                          std::span<double> to) const {
  const auto* mesh = dynamic_cast<const FiniteFilm*>(&other);
  core::require(mesh != nullptr && from.size() == mesh->states(), "states of another film of finite length");
  const auto deflection = [&](int i, int j) {
    if (j == 0 || j == mesh->cells_) return 0.0;
    const int line = i % mesh->ring_.nodes();
    return from[at(line * mesh->inner() + j - 1)] - g_.clearance * mesh->rigid(motion, line);
  };
  const auto place = [](int k, int n, int m) {  // node k of n in cells of m
    const double x = static_cast<double>(k) * m / n;
    const int cell = std::min(static_cast<int>(x), m - 1);
    return std::pair{cell, x - cell};
  };
  for (int i = 0; i < ring_.nodes(); ++i) {
    const auto [a, s] = place(i, ring_.nodes(), mesh->ring_.nodes());
    for (int j = 1; j < cells_; ++j) {
      const auto [b, t] = place(j, cells_, mesh->cells_);
      to[at(i * inner() + j - 1)] = rigid(motion, i) * g_.clearance +
                                    (1.0 - s) * ((1.0 - t) * deflection(a, b) + t * deflection(a, b + 1)) +
                                    s * ((1.0 - t) * deflection(a + 1, b) + t * deflection(a + 1, b + 1));
    }
  }
}

// Side flow (H^3/12 mu) dp/dz through both edges with one-sided slopes of second order; friction mu U/H on the whole
// circumference and half the pressure flow, -U/(2 R) int p dH/dtheta.
FilmReport FiniteFilm::summary(const JournalMotion& motion, std::span<const double> states) {
  const Lines all{0, ring_.nodes()};
  set_settled(motion, states);
  FilmReport s;
  s.min_thickness = g_.clearance * *std::min_element(h_.begin(), h_.end());
  const double U = motion.speed * g_.radius, area = ring_.step() * g_.radius * g_.length / cells_;
  const std::size_t stride = node(1, 0);
  for (int i = 0; i < all.end; ++i)
    for (int j = 0; j <= cells_; ++j) {
      const bool edge = j == 0 || j == cells_;
      const std::size_t k = node(i + reach(), j);
      const double p = scales_.pressure * std::max(carried_.p[k], 0.0), h = g_.clearance * h_[k];
      s.max_pressure = std::max(s.max_pressure, p);
      const double slope = g_.clearance * (h_[k + stride] - h_[k - stride]) / (2.0 * ring_.step());
      s.power_loss += (edge ? 0.5 : 1.0) * area * U * (viscosity_ * U / h - 0.5 * p * slope / g_.radius);
      if (!edge) continue;
      const std::size_t first = j == 0 ? k + 1 : k - 1, second = j == 0 ? k + 2 : k - 2;
      const double rise =
          scales_.pressure * (4.0 * std::max(carried_.p[first], 0.0) - std::max(carried_.p[second], 0.0)) / 2.0;
      s.side_flow += ring_.step() * g_.radius * h * h * h / (12.0 * viscosity_) * rise * cells_ / g_.length;
    }
  return s;
}

std::vector<NodalField> FiniteFilm::fields(const JournalMotion& motion, std::span<const double> states) {
  const Lines all{0, ring_.nodes()};
  set_settled(motion, states);
  auto [theta, z, pressure, h] = empty_fields(at(cells_ + 1));
  for (int i = 0; i <= all.end; ++i)
    for (int j = 0; j <= cells_; ++j) {
      pressure.values.push_back(scales_.pressure * carried_.p[node(i + reach(), j)]);
      h.values.push_back(g_.clearance * h_[node(i + reach(), j)]);
    }
  return {theta, z, pressure, h};
}

}  // namespace whirl::film
