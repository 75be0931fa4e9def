#include "whirl/study/bearing_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "common.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/system/groups.hpp"

namespace whirl::study {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// One bearing in nondimensional form: F* = (c/R)^2 F/(mu Omega L D), k* and b* alike (van de Vrande 2001, sec. 4.3).
class Bearing {
public:
  Bearing(const system::Support& support, double speed)
      : clearance_(support.geometry.clearance),
        speed_(speed),
        film_(film::make_model(support.geometry, support.film, support.lubricant)) {
    const film::Geometry& g = support.geometry;
    const double ratio = g.radius / g.clearance;
    unit_ = support.lubricant.viscosity * g.length * 2 * g.radius * ratio * ratio;
  }

  struct Equilibrium {
    double eccentricity = 0, attitude = nan, sommerfeld = nan;
    double k[2][2] = {{nan, nan}, {nan, nan}}, b[2][2] = {{nan, nan}, {nan, nan}};
    double speed_limit = nan, whirl_ratio = nan;
  };
  [[nodiscard]] std::optional<Equilibrium> carrying(double eccentricity, double attitude);

  // W along and across a squeeze velocity in +x with the shaft at rest, F* = -|v_s*| W; NaN where the film is closed.
  [[nodiscard]] std::array<double, 2> impedance(double along, double across) {
    film::Motion m;
    m.position = {along * clearance_, across * clearance_, 0, 0};
    m.velocity = {clearance_ * speed_, 0, 0, 0};
    try {
      film_->evaluate(m, film::Need::force, response_);
    } catch (const core::DomainError&) {
      return {nan, nan};
    }
    return {-response_.force[0] / (unit_ * speed_), -response_.force[1] / (unit_ * speed_)};
  }

private:
  double clearance_, speed_, unit_ = 0;
  std::unique_ptr<film::Model> film_;
  film::Response response_;
};

// The journal at this eccentricity whose film carries a load along -y; `attitude` is a guess. Turning the journal turns
// the force of a full film by as much, so that one step is exact; other bores take secants.
std::optional<Bearing::Equilibrium> Bearing::carrying(double eccentricity, double attitude) {
  film::Motion m;
  m.speed = speed_;
  const auto miss = [&](double angle) {
    m.position = {eccentricity * clearance_ * std::sin(angle), -eccentricity * clearance_ * std::cos(angle), 0, 0};
    film_->evaluate(m, film::Need::tangents, response_);
    return std::atan2(response_.force[0], response_.force[1]);
  };
  double before = attitude, d_before = 0, angle = attitude, d = 0;
  bool found = false;
  try {
    d_before = miss(before);
    angle = before + d_before;
    for (int i = 0; i < 40 && !found; ++i) {
      d = miss(angle);
      found = std::abs(d) < 1e-13;
      if (found || angle == before) break;
      const double slope = (d - d_before) / (angle - before);
      const double step = slope != 0 ? std::clamp(-d / slope, -0.3, 0.3) : d;
      if (std::abs(step) < 1e-14) found = true;
      before = angle;
      d_before = d;
      angle += step;
    }
  } catch (const core::DomainError&) {
    return std::nullopt;
  }
  if (!found && std::abs(d) > 1e-9) return std::nullopt;
  Equilibrium e;
  e.eccentricity = eccentricity;
  e.attitude = std::atan2(m.position[0], -m.position[1]);
  e.sommerfeld = response_.force[1] / (unit_ * speed_);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      e.k[i][j] = -response_.d_position[i][j] * clearance_ / (unit_ * speed_);
      e.b[i][j] = -response_.d_velocity[i][j] * clearance_ / unit_;
    }
  // Routh's border: whirl at (nu Omega) with effective stiffness k_e, m c Omega^2/load = k_e/(S nu^2).
  const auto &k = e.k, &b = e.b;
  const double k_e =
      (k[0][0] * b[1][1] + k[1][1] * b[0][0] - k[0][1] * b[1][0] - k[1][0] * b[0][1]) / (b[0][0] + b[1][1]);
  const double nu2 = ((k_e - k[0][0]) * (k_e - k[1][1]) - k[0][1] * k[1][0]) / (b[0][0] * b[1][1] - b[0][1] * b[1][0]);
  if (nu2 > 0 && k_e > 0) {
    e.whirl_ratio = std::sqrt(nu2);
    e.speed_limit = std::sqrt(k_e / (nu2 * e.sommerfeld));
  }
  return e;
}

}  // namespace

void BearingMap::run(Context& context) {
  const system::Train train = system::train_of(context.machine);
  const std::size_t which = options.bearing.empty() ? 0 : *system::find_bearing(context.machine, options.bearing);
  auto& results = context.results;
  auto& summary = results.summary();
  auto& group = results.group();
  const auto groups = system::groups_of(train);
  put_groups(summary, train);

  std::vector<Bearing::Equilibrium> locus;
  std::vector<double> axis, along, across;
  std::optional<Bearing::Equilibrium> threshold;
  core::agree(context.comm, [&] {
    Bearing bearing(train.supports[which], options.speed.value);
    double attitude = 0.5 * std::numbers::pi;
    for (int i = 1; i <= options.points; ++i) {
      const auto e = bearing.carrying(options.max_eccentricity * i / options.points, attitude);
      if (!e) continue;
      attitude = e->attitude;
      locus.push_back(*e);
    }
    // A rigid rotor of load F0* turns at Omega* = F0*/(n S); it is stable below the limit of its eccentricity.
    const auto margin = [&](const Bearing::Equilibrium& e) {
      return (std::isnan(e.speed_limit) ? 1e3 : e.speed_limit) - groups->load / (groups->bearings * e.sommerfeld);
    };
    for (std::size_t i = 0; groups && i + 1 < locus.size() && !threshold; ++i) {
      if (margin(locus[i]) * margin(locus[i + 1]) > 0) continue;
      Bearing::Equilibrium low = locus[i], high = locus[i + 1];
      for (int k = 0; k < 60; ++k) {
        const auto middle = bearing.carrying(0.5 * (low.eccentricity + high.eccentricity), low.attitude);
        if (!middle) break;
        (margin(*middle) * margin(low) > 0 ? low : high) = *middle;
      }
      threshold = low;
    }
    for (int i = 0; i < options.grid; ++i)
      axis.push_back(options.max_eccentricity * (2.0 * i / (options.grid - 1) - 1));
    for (const double a : axis)
      for (const double b : axis) {
        const bool inside = std::hypot(a, b) <= options.max_eccentricity * (1 + 1e-12);
        const auto w = inside ? bearing.impedance(a, b) : std::array<double, 2>{nan, nan};
        along.push_back(w[0]);
        across.push_back(w[1]);
      }
  });
  if (locus.empty()) throw core::NotConverged("no eccentricity carries a vertical load");

  const auto column = [&](const auto& value) {
    std::vector<double> out;
    for (const auto& e : locus) out.push_back(value(e));
    return out;
  };
  using E = Bearing::Equilibrium;
  auto& table = group.child("locus");
  table.put("eccentricity", column([](const E& e) { return e.eccentricity; }), "1", "eccentricity in clearances");
  table.put("attitude", column([](const E& e) { return e.attitude; }), "rad", "from the load to the journal");
  table.put("sommerfeld", column([](const E& e) { return e.sommerfeld; }), "1", "S = (c/R)^2 load/(mu Omega L D)");
  table.put("x", column([](const E& e) { return e.eccentricity * std::sin(e.attitude); }), "1", "in clearances");
  table.put("y", column([](const E& e) { return -e.eccentricity * std::cos(e.attitude); }), "1", "in clearances");
  const char* const direction[] = {"x", "y"};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      const std::string pair = std::string("_") + direction[i] + direction[j];
      table.put("k" + pair, column([i, j](const E& e) { return e.k[i][j]; }), "1", "stiffness c k/(load/S)");
      table.put("b" + pair, column([i, j](const E& e) { return e.b[i][j]; }), "1", "damping c Omega b/(load/S)");
    }
  table.put("speed_limit", column([](const E& e) { return e.speed_limit; }), "1",
            "Omega* = Omega sqrt(m c/load) of a rigid rotor at the border of stability; NaN: stable at every speed");
  table.put("whirl_ratio", column([](const E& e) { return e.whirl_ratio; }), "1", "whirl frequency there over Omega");
  auto& map = group.child("impedance");
  const std::size_t n = axis.size();
  map.put("along", axis, "1", "eccentricity along the squeeze velocity, in clearances");
  map.put("across", axis, "1", "eccentricity across it (turned counter-clockwise)");
  map.put("W_along", {n, n}, along, "1", "impedance [along][across], resisting the squeeze");
  map.put("W_across", {n, n}, across, "1", "impedance [along][across]");
  group.set("bearing", context.machine.bearings[which].name);
  group.set("speed", options.speed.value);
  if (threshold) {
    const double speed = groups->load / (groups->bearings * threshold->sommerfeld);
    summary.set("threshold.nondimensional_speed", speed, "1");
    summary.set("threshold.speed", speed * groups->speed_scale, "rad/s");
    summary.set("threshold.eccentricity", threshold->eccentricity, "1");
    summary.set("threshold.whirl_ratio", threshold->whirl_ratio, "1");
  }
  summary.points = static_cast<long>(locus.size());
  results.finish("completed", true);
}

}  // namespace whirl::study
