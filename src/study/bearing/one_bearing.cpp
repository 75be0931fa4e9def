#include "study/bearing/one_bearing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "study/bars/summary_bars.hpp"
#include "whirl/core/error.hpp"

namespace whirl::study {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
// Angle of the force from the vertical [rad] below which it counts as vertical; a relaxed film is less exact than a
// closed form.
constexpr double vertical = 1e-13, vertical_relaxed = 1e-11;

}  // namespace

OneBearing::OneBearing(const system::Support& support, double speed)
    : clearance_(support.geometry.clearance),
      speed_(speed),
      soft_(film::facts(support.film).gives_way),
      film_(film::make_film(support.geometry, support.film, support.lubricant)),
      rest_(film_->states()) {
  const film::Geometry& g = support.geometry;
  const double ratio = g.radius / g.clearance, shear = support.lubricant.viscosity * ratio * ratio * speed;
  load_ = shear * g.length * 2 * g.radius;
  pressure_ = 6 * shear;
  motion_.speed = speed;
}

BearingEquilibrium OneBearing::centred() const {
  BearingEquilibrium e{0, 0.5 * std::numbers::pi, 0, nan, nan, {}};
  film::JournalMotion m;
  m.speed = speed_;
  e.states.resize(film_->states());
  film_->unloaded(m, e.states);
  return e;
}

// F* at the position of motion_, the film at rest.
std::array<double, 2> OneBearing::force() {
  film::relax(*film_, motion_, states_);
  film_->evaluate(motion_, states_, rest_, film::Need::force, response_);
  return {response_.journal.force[0] / load_, response_.journal.force[1] / load_};
}

// Turning the journal turns the force of a full film by as much, so that one step is exact; other bores take secants.
std::optional<BearingEquilibrium> OneBearing::carrying(double eccentricity, const BearingEquilibrium& near) {
  BearingEquilibrium e;
  states_ = near.states;
  e.eccentricity = eccentricity;
  const auto miss = [&](double angle) {
    motion_.position = {eccentricity * clearance_ * std::sin(angle), -eccentricity * clearance_ * std::cos(angle), 0,
                        0};
    const auto f = force();
    e.sommerfeld = f[1];
    return std::atan2(f[0], f[1]);
  };
  return answer_of([&]() -> std::optional<BearingEquilibrium> {
    double before = near.attitude, d = 0, angle = before;
    bool found = false;
    double d_before = miss(before);
    angle = before + d_before;
    for (int i = 0; i < 40 && !found; ++i) {
      d = miss(angle);
      found = std::abs(d) < (rigid() ? vertical : vertical_relaxed);
      if (found || angle == before) break;
      const double slope = (d - d_before) / (angle - before);
      const double step = slope != 0 ? std::clamp(-d / slope, -0.3, 0.3) : d;
      if (std::abs(step) < 1e-14) found = true;
      before = angle;
      d_before = d;
      angle += step;
    }
    if (!found && std::abs(d) > 1e-9) return std::nullopt;
    e.attitude = std::atan2(motion_.position[0], -motion_.position[1]);
    e.states = states_;
    set_border(e);
    return e;
  });
}

std::optional<BearingEquilibrium> OneBearing::carrying(const JournalLocus::Node& node) {
  return answer_of([&] {
    BearingEquilibrium e;
    states_ = node.states;
    motion_.position = {node.place[0] * clearance_, node.place[1] * clearance_, 0, 0};
    film_->evaluate(motion_, states_, rest_, film::Need::force, response_);
    e.eccentricity = node.eccentricity();
    e.attitude = std::atan2(node.place[0], -node.place[1]);
    e.sommerfeld = response_.journal.force[1] / load_;
    e.states = states_;
    set_border(e);
    return std::optional(e);
  });
}

// The border of stability of a rigid rotor: it whirls freely at nu Omega, det(k - k_e + i nu b) = 0 with the effective
// stiffness k_e = nu^2 m c Omega^2/(load of F* = 1). Coefficients that depend on the frequency are those at nu.
void OneBearing::set_border(BearingEquilibrium& e) {
  e.speed_limit = e.whirl_ratio = nan;
  double nu = 0.5;
  for (int i = 0; i < 100; ++i) {
    const auto [k, b] = coefficients(nu);
    const double k_e = (k[0] * b[3] + k[3] * b[0] - k[1] * b[2] - k[2] * b[1]) / (b[0] + b[3]);
    const double nu2 = ((k_e - k[0]) * (k_e - k[3]) - k[1] * k[2]) / (b[0] * b[3] - b[1] * b[2]);
    if (!(nu2 > 0 && k_e > 0)) return;
    const double last = std::exchange(nu, std::sqrt(nu2));
    if (std::abs(nu - last) > 1e-12) continue;
    e.whirl_ratio = nu;
    e.speed_limit = std::sqrt(k_e / (nu2 * e.sommerfeld));
    return;
  }
}

BearingCoefficients OneBearing::coefficients(double ratio) {
  const film::Coefficients c = film::coefficients(*film_, motion_, states_, ratio * speed_);
  BearingCoefficients out{};
  for (std::size_t i = 0; i < 4; ++i) {
    out.k[i] = c.stiffness[i] * clearance_ / load_;
    out.b[i] = c.damping[i] * clearance_ * speed_ / load_;
  }
  return out;
}

BearingProfile OneBearing::profile() {
  BearingProfile out;
  for (const film::NodalField& f : film_->fields(motion_, states_)) {
    if (f.name == "theta") out.theta.insert(out.theta.end(), f.values.begin(), f.values.end());
    const bool pressure = f.name == "pressure";
    if (!pressure && f.name != "thickness") continue;
    const std::size_t along = f.shape.at(1);
    for (std::size_t i = 0; i < f.shape.at(0); ++i) {
      // An even number of nodes along the bearing has none in the middle.
      const double* row = f.values.data() + i * along;
      const double middle = 0.5 * (row[(along - 1) / 2] + row[along / 2]);
      (pressure ? out.pressure : out.thickness).push_back(middle / (pressure ? pressure_ : clearance_));
    }
  }
  return out;
}

std::array<double, 2> OneBearing::impedance(double along, double across) {
  film::JournalMotion m;
  m.position = {along * clearance_, across * clearance_, 0, 0};
  m.velocity = {clearance_ * speed_, 0, 0, 0};
  try {
    film_->evaluate(m, states_, rest_, film::Need::force, response_);
  } catch (const core::DomainError&) {
    return {nan, nan};
  }
  return {-response_.journal.force[0] / load_, -response_.journal.force[1] / load_};
}

}  // namespace whirl::study
