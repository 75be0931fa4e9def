#include "study/bearing/journal_place.hpp"

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "whirl/core/error.hpp"

namespace whirl::study {
namespace {

using Pair = std::array<double, 2>;

constexpr int newton_steps = 40, step_halvings = 12;
constexpr double longest_newton_step = 0.3;  // in clearances
constexpr double shortest_rise = 1e-3;       // of the load, at which its rise from nothing gives up
constexpr double slow_ratio = 1e-6;          // of the speed: a frequency at which stiffness is static

double length_of(const Pair& a) {
  return std::hypot(a[0], a[1]);
}

// Stiffness that a slow motion meets; a shaft at rest has no frequency to go by.
film::PortCoefficients slow_coefficients(film::Film& film, const JournalPlace& at) {
  return film::port_coefficients(film, at.motion, at.states, slow_ratio * at.motion.speed);
}

// K^-1 f.
Pair newton_step(const film::PortCoefficients& k, const Pair& f) {
  const auto& s = k.stiffness;
  const double det = s[0][0] * s[1][1] - s[0][1] * s[1][0];
  return {(s[1][1] * f[0] - s[0][1] * f[1]) / det, (s[0][0] * f[1] - s[1][0] * f[0]) / det};
}

std::optional<JournalPlace> rested(film::Film& film, const film::JournalMotion& motion,
                                   const std::vector<double>& states) {
  try {
    return rest_at(film, motion, states);
  } catch (const core::DomainError&) {
  } catch (const core::NotConverged&) {
  }
  return std::nullopt;
}

// Empty where Newton's method does not get there. Of no load the measure is that of `scale`.
std::optional<JournalPlace> balanced(film::Film& film, double clearance, const Pair& load, double scale,
                                     const JournalPlace& start) {
  std::optional<JournalPlace> at = rested(film, start.motion, start.states);
  if (!at) return std::nullopt;
  const auto left = [&](const JournalPlace& p) { return Pair{p.force[0] + load[0], p.force[1] + load[1]}; };
  for (int i = 0; i < newton_steps; ++i) {
    const Pair f = left(*at);
    if (length_of(f) <= place_tolerance * scale) return at;
    const Pair step = newton_step(slow_coefficients(film, *at), f);
    if (!std::isfinite(length_of(step))) return std::nullopt;
    double part = std::min(1.0, longest_newton_step * clearance / length_of(step));
    std::optional<JournalPlace> next;
    for (int k = 0; k < step_halvings; ++k, part /= 2) {
      film::JournalMotion motion = at->motion;
      for (std::size_t d = 0; d < 2; ++d) motion.position[d] += part * step[d];
      next = rested(film, motion, at->states);
      if (next && length_of(left(*next)) < length_of(f)) break;
      next.reset();
    }
    if (!next) return std::nullopt;
    at = std::move(next);
  }
  return std::nullopt;
}

}  // namespace

JournalPlace rest_at(film::Film& film, const film::JournalMotion& motion, std::vector<double> states) {
  JournalPlace out{motion, std::move(states), {}};
  if (out.states.size() != film.states()) {
    out.states.assign(film.states(), 0.0);
    film.unloaded(motion, out.states);
  }
  film::relax(film, motion, out.states);
  film::StateResponse response;
  const std::vector<double> rest(out.states.size(), 0.0);
  film.evaluate(motion, out.states, rest, film::Need::force, response);
  out.force = {response.journal.force[0], response.journal.force[1]};
  return out;
}

JournalPlace carry(film::Film& film, double clearance, const std::array<double, 2>& load, const JournalPlace& start) {
  const double whole = length_of(load);
  if (auto found = balanced(film, clearance, load, whole, start)) return *found;
  // The load rises from a twentieth, near the centre; what fails halves the rise.
  JournalPlace last;
  last.motion.speed = start.motion.speed;
  for (std::size_t d = 0; d < 2; ++d) last.motion.position[d] = 0.05 * clearance * load[d] / whole;
  double carried = 0;
  for (double rise = 0.05; rise > shortest_rise && carried < 1;) {
    const double part = std::min(1.0, carried + rise);
    const auto found = balanced(film, clearance, {part * load[0], part * load[1]}, whole, last);
    if (found) {
      last = *found;
      carried = part;
      rise *= 1.5;
    } else {
      rise /= 2;
    }
  }
  if (carried >= 1) return last;
  const double e = length_of({last.motion.position[0], last.motion.position[1]}) / clearance;
  throw core::NotConverged(
      fmt::format("no equilibrium at {:.6g} rad/s: the bearing carries {:.4g} N of the load of {:.4g} N, then at "
                  "eccentricity {:.3g}",
                  start.motion.speed, carried * whole, whole, e));
}

}  // namespace whirl::study
