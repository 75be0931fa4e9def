// Short, long and approximate finite-length films of a full cylindrical bore in closed form.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "film/closed/impedance.hpp"
#include "whirl/core/error.hpp"
#include "whirl/film/contract/closed_form.hpp"
#include "whirl/film/contract/describe.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film {
namespace {

using std::numbers::pi;

class RigidFilm final : public Film {
public:
  RigidFilm(const Geometry& geometry, ClosedForm kind, const Lubricant& lubricant)
      : g_(geometry), kind_(kind), viscosity_(lubricant.viscosity), ld_(0.5 * g_.length / g_.radius) {
    const double ratio = g_.radius / g_.clearance;
    force_ = viscosity_ * g_.length * 2.0 * g_.radius * ratio * ratio;
    pressure_ = 6.0 * viscosity_ * ratio * ratio;
  }

  using Film::evaluate;
  void evaluate(const JournalMotion& motion, const Share& /*share*/, std::span<const double> /*states*/,
                std::span<const double> /*rates*/, Need need, StateResponse& all) override {
    Response& response = all.without_states();
    const auto [e, v] = state(motion);
    const Impedance f = impedance(kind_, ld_, e, v);
    response.min_thickness = g_.clearance * (1.0 - std::hypot(e[0], e[1]));
    for (std::size_t i = 0; i < 2; ++i) {
      response.force[i] = force_ * f.force[i];
      if (need == Need::force) continue;
      const double half = 0.5 * motion.speed, per_length = force_ / g_.clearance;
      response.d_position[i][0] = per_length * (f.d_eccentricity[i][0] - half * f.d_squeeze[i][1]);
      response.d_position[i][1] = per_length * (f.d_eccentricity[i][1] + half * f.d_squeeze[i][0]);
      for (std::size_t j = 0; j < 2; ++j) response.d_velocity[i][j] = per_length * f.d_squeeze[i][j];
      response.d_speed[i] = 0.5 * force_ * (f.d_squeeze[i][0] * e[1] - f.d_squeeze[i][1] * e[0]);
    }
  }

  FilmReport summary(const JournalMotion& motion, std::span<const double> states) override;
  std::vector<NodalField> fields(const JournalMotion& motion, std::span<const double> states) override;
  [[nodiscard]] double least_thickness(const JournalMotion& motion, std::span<const double> /*states*/) override {
    return g_.clearance - std::hypot(motion.position[0], motion.position[1]);
  }

private:
  struct State {
    Pair eccentricity, squeeze;
  };
  [[nodiscard]] State state(const JournalMotion& m) const {
    const Pair e = {m.position[0] / g_.clearance, m.position[1] / g_.clearance};
    return {e,
            {m.velocity[0] / g_.clearance + 0.5 * m.speed * e[1], m.velocity[1] / g_.clearance - 0.5 * m.speed * e[0]}};
  }
  [[nodiscard]] bool has_pressure() const { return kind_ != ClosedForm::finite_approximate; }

  Geometry g_;
  ClosedForm kind_;
  double viscosity_, ld_;
  double force_;     // N s, mu L D (R/c)^2
  double pressure_;  // Pa s, 6 mu (R/c)^2
};

// Shear mu U/h on the whole circumference and the force's arm about the bearing centre: U (2 pi mu U R L/(c r) + (e_x
// F_y
// - e_y F_x)/(2 R)), r^2 = 1 - eps^2. Side flow of the short film: 2 R c L |v_s| (Ocvirk and DuBois 1953: R c L Omega
// eps).
FilmReport RigidFilm::summary(const JournalMotion& motion, std::span<const double> /*states*/) {
  Response response;
  evaluate(motion, Need::force, response);
  const auto [e, v] = state(motion);
  FilmReport s;
  s.min_thickness = response.min_thickness;
  const double U = motion.speed * g_.radius, r = std::sqrt(1.0 - e[0] * e[0] - e[1] * e[1]);
  s.power_loss =
      U * (2.0 * pi * viscosity_ * U * g_.radius * g_.length / (g_.clearance * r) +
           (motion.position[0] * response.force[1] - motion.position[1] * response.force[0]) / (2.0 * g_.radius));
  if (kind_ == ClosedForm::short_bearing)
    s.side_flow = 2.0 * g_.radius * g_.clearance * g_.length * std::hypot(v[0], v[1]);
  if (!has_pressure()) {
    s.max_pressure = s.side_flow = std::numeric_limits<double>::quiet_NaN();
    return s;
  }
  // The pressure has one peak: the best of a circle of samples, then golden sections.
  const auto p = [&, e = e, v = v](double theta) { return mid_pressure(kind_, ld_, e, v, theta); };
  constexpr int kSamples = 720;
  int best = 0;
  for (int i = 1; i < kSamples; ++i)
    if (p(2.0 * pi * i / kSamples) > p(2.0 * pi * best / kSamples)) best = i;
  double left = 2.0 * pi * (best - 1) / kSamples, right = 2.0 * pi * (best + 1) / kSamples;
  for (int i = 0; i < 40; ++i) {
    const double step = (right - left) * 0.5 * (3.0 - std::sqrt(5.0));
    if (p(left + step) < p(right - step))
      left += step;
    else
      right -= step;
  }
  s.max_pressure = pressure_ * p(0.5 * (left + right));
  return s;
}

std::vector<NodalField> RigidFilm::fields(const JournalMotion& motion, std::span<const double> /*states*/) {
  if (!has_pressure()) return {};
  const auto [e, v] = state(motion);
  const bool is_short = kind_ == ClosedForm::short_bearing;
  constexpr std::size_t kAround = 181;
  const std::size_t along = is_short ? 17 : 2;
  NodalField theta{0, "theta", "rad", {kAround}, {}}, z{0, "z", "m", {along}, {}};
  NodalField pressure{0, "pressure", "Pa", {kAround, along}, {}}, h{0, "thickness", "m", {kAround, along}, {}};
  for (std::size_t j = 0; j < along; ++j)
    z.values.push_back(g_.length * (static_cast<double>(j) / static_cast<double>(along - 1) - 0.5));
  for (std::size_t i = 0; i < kAround; ++i) {
    const double at = 2.0 * pi * static_cast<double>(i) / static_cast<double>(kAround - 1);
    theta.values.push_back(at);
    const double mid = pressure_ * mid_pressure(kind_, ld_, e, v, at);
    const double thickness = g_.clearance * (1.0 - e[0] * std::cos(at) - e[1] * std::sin(at));
    for (std::size_t j = 0; j < along; ++j) {
      const double from_middle = 2.0 * z.values[j] / g_.length;
      pressure.values.push_back(is_short ? mid * (1.0 - from_middle * from_middle) : mid);
      h.values.push_back(thickness);
    }
  }
  return {theta, z, pressure, h};
}

std::unique_ptr<Film> make_rigid(const Geometry& g, ClosedForm kind, const Lubricant& lubricant) {
  if (g.type != Geometry::Bore::cylindrical)
    throw core::InputError("film: short, long and finite_approximate films need a cylindrical bore");
  if (!(g.radius > 0.0 && g.length > 0.0 && g.clearance > 0.0))
    throw core::InputError("film: radius, length and clearance must be positive");
  if (!(lubricant.viscosity > 0.0)) throw core::InputError("film: the viscosity must be positive");
  return std::make_unique<RigidFilm>(g, kind, lubricant);
}

constexpr CircleOnly circle{"type", "a film in closed form needs a cylindrical bore"};

}  // namespace

void describe(deck::Description<Short>& /*d*/) {}
Facts facts_of(const Short& /*options*/, const Geometry& /*geometry*/) {
  return {.circle_only = circle};
}
std::unique_ptr<Film> make(const Geometry& g, const Short& /*options*/, const Lubricant& lubricant) {
  return make_rigid(g, ClosedForm::short_bearing, lubricant);
}

void describe(deck::Description<Long>& /*d*/) {}
Facts facts_of(const Long& /*options*/, const Geometry& /*geometry*/) {
  return {.circle_only = circle};
}
std::unique_ptr<Film> make(const Geometry& g, const Long& /*options*/, const Lubricant& lubricant) {
  return make_rigid(g, ClosedForm::long_bearing, lubricant);
}

void describe(deck::Description<LongInlet>& /*d*/) {}
Facts facts_of(const LongInlet& /*options*/, const Geometry& /*geometry*/) {
  return {.circle_only = circle};
}
std::unique_ptr<Film> make(const Geometry& g, const LongInlet& /*options*/, const Lubricant& lubricant) {
  return make_rigid(g, ClosedForm::long_inlet, lubricant);
}

void describe(deck::Description<FiniteApproximate>& /*d*/) {}
Facts facts_of(const FiniteApproximate& /*options*/, const Geometry& /*geometry*/) {
  return {.circle_only = circle};
}
std::unique_ptr<Film> make(const Geometry& g, const FiniteApproximate& /*options*/, const Lubricant& lubricant) {
  return make_rigid(g, ClosedForm::finite_approximate, lubricant);
}

}  // namespace whirl::film
