#pragma once
// Bearings and motions that several film tests share.

#include <cmath>
#include <memory>
#include <numbers>

#include "film/closed/impedance.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film::testing {

inline constexpr double kDegree = std::numbers::pi / 180.0;

inline Geometry lemon() {
  return {Geometry::Bore::lemon_bore, 0.2, 0.36, 0.0004, 160.0 * kDegree, 0.5, 0.0};
}
inline Geometry arc() {
  return {Geometry::Bore::partial_arc, 0.1, 0.1, 0.0002, 60.0 * kDegree, 0.0, 0.0};
}
inline Geometry cylinder() {
  return {Geometry::Bore::cylindrical, 0.05, 0.08, 0.0001, 0.0, 0.0, 0.0};
}
inline Lubricant oil() {
  return {0.0067, 850.0};
}

/// A film with this closed form.
inline Options film_of(ClosedForm kind) {
  switch (kind) {
    case ClosedForm::short_bearing:
      return Short{};
    case ClosedForm::long_bearing:
      return Long{};
    case ClosedForm::long_inlet:
      return LongInlet{};
    case ClosedForm::finite_approximate:
      break;
  }
  return FiniteApproximate{};
}

/// Position in clearances, velocity in clearances times speed, tilt in clearances per length.
inline JournalMotion motion(const Geometry& g, std::array<double, 4> position, std::array<double, 4> velocity,
                            double speed) {
  const double tilt = g.clearance / g.length;
  JournalMotion m{position, velocity, speed};
  for (std::size_t i = 0; i < 4; ++i) {
    const double scale = i < 2 ? g.clearance : tilt;
    m.position[i] *= scale;
    m.velocity[i] *= scale * speed;
  }
  return m;
}

/// Typical magnitude of the states of a film with one field.
inline double scale_of(const Film& film) {
  return film.state_fields().front().scale;
}

inline Response evaluate(Film& film, const JournalMotion& m, Need need = Need::tangents) {
  Response r;
  film.evaluate(m, need, r);
  return r;
}

}  // namespace whirl::film::testing
