// What short and long compliant films say of themselves, and their states on another mesh.
#include <algorithm>

#include "film/wall/compliant_around.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {

// Deflections, which are periodic and zero in grooves, are interpolated linearly.
void CompliantFilm::resample(const JournalMotion& motion, const Film& other, std::span<const double> from,
                             std::span<double> to) const {
  const auto* mesh = dynamic_cast<const CompliantFilm*>(&other);
  core::require(mesh != nullptr && from.size() == mesh->states(), "states of another short or long film");
  const auto deflection = [&](int k) {
    return mesh->fixed(k) ? 0.0 : from[mesh->index(k)] - g_.clearance * mesh->rigid(motion, k);
  };
  for (int k = 0; k < n_; ++k) {
    if (fixed(k)) continue;
    const double place = static_cast<double>(k) * mesh->n_ / n_;
    const int j = std::min(static_cast<int>(place), mesh->n_ - 1);
    const double s = place - j;
    to[index(k)] = rigid(motion, k) * g_.clearance + (1.0 - s) * deflection(j) + s * deflection((j + 1) % mesh->n_);
  }
}

// Side flow of a short film from its parabola, (H^3/12 mu) 6 p/L out of each side; friction mu U/H on the whole
// circumference and half the pressure flow, -U/(2 R) int p dH/dtheta.
FilmReport CompliantFilm::summary(const JournalMotion& motion, std::span<const double> states) {
  set(motion, states, balanced_rates(motion, states));
  FilmReport s;
  s.min_thickness = g_.clearance * least_;
  const double U = motion.speed * g_.radius, *P = around(carried_.p), *H = around(h_);
  for (int k = 0; k < n_; ++k) {
    const double p = scales_.pressure * std::max(P[k], 0.0), h = g_.clearance * H[k];
    s.max_pressure = std::max(s.max_pressure, (long_ ? 1.0 : 1.5) * p);
    if (!long_) s.side_flow += step_ * g_.radius * h * h * h * p / (viscosity_ * g_.length);
    const double slope = g_.clearance * (H[k + 1] - H[k - 1]) / 2.0;
    s.power_loss += U * g_.length * (viscosity_ * U * g_.radius * step_ / h - 0.5 * p * slope);
  }
  return s;
}

std::vector<NodalField> CompliantFilm::fields(const JournalMotion& motion, std::span<const double> states) {
  set(motion, states, balanced_rates(motion, states));
  auto [theta, z, pressure, h] = empty_fields(long_ ? 2 : 17);
  for (int k = 0; k <= n_; ++k)
    for (const double place : z.values) {
      const double from_middle = 2.0 * place / g_.length, profile = 1.5 * (1.0 - from_middle * from_middle);
      pressure.values.push_back(scales_.pressure * around(carried_.p)[k] * (long_ ? 1.0 : profile));
      h.values.push_back(g_.clearance * around(h_)[k]);
    }
  return {theta, z, pressure, h};
}

}  // namespace whirl::film
