// Mass-conserving cavitation: closed forms, balances and limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "film/cases.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film::testing {
namespace {

Reynolds conserving(std::array<int, 2> cells, bool tilt = false) {
  Reynolds o;
  o.cavitation = Reynolds::Cavitation::mass_conserving;
  o.cells = cells;
  o.tilt = tilt;
  return o;
}

Reynolds with(Reynolds o, Reynolds::Cavitation cavitation) {
  o.cavitation = cavitation;
  return o;
}

const NodalField& field(const std::vector<NodalField>& fields, const std::string& name) {
  return *std::find_if(fields.begin(), fields.end(), [&](const NodalField& f) { return f.name == name; });
}

// A long bearing that is fed with too little oil at the widest gap, h = c (1 + e cos t), fill f at t = 0. The oil fills
// the gap again at t = a < pi, carries, and ruptures at t = b > pi. Between them dp/dt = 6 mu Omega R^2/c^2 (h -
// h*)/h^3 with h* = f (1 + e) from the mass balance; p = dp/dt = 0 at b, so h(b) = h*, and p(a) = 0 gives a.
struct Starved {
  double e, f, from = 0.0, to = 0.0, area = 0.0, peak = 0.0;
  explicit Starved(double eccentricity, double fill) : e(eccentricity), f(fill) {
    to = 2.0 * std::numbers::pi - std::acos((f * (1.0 + e) - 1.0) / e);
    // The pressure at `a` if it vanishes at `b` falls through zero once between the peak and the inlet.
    double low = 0.0, high = 2.0 * std::numbers::pi - to;
    for (int k = 0; k < 60; ++k) {
      from = 0.5 * (low + high);
      (integral(from, [](double) { return 1.0; }) > 0.0 ? low : high) = from;
    }
    area = -integral(from, [&](double t) { return t; });  // int p dt = - int t dp
    peak = integral(2.0 * std::numbers::pi - to, [](double) { return -1.0; });
  }
  // int of weight(t) dp/dt from a to b, over 6 mu Omega R^2/c^2, by Simpson's rule.
  [[nodiscard]] double integral(double a, const std::function<double(double)>& weight) const {
    constexpr int n = 4000;
    double sum = 0.0;
    for (int i = 0; i <= n; ++i) {
      const double t = a + (to - a) * i / n, h = 1.0 + e * std::cos(t);
      sum += (i == 0 || i == n ? 1.0 : i % 2 ? 4.0 : 2.0) * weight(t) * (h - f * (1.0 + e)) / (h * h * h);
    }
    return sum * (to - a) / (3.0 * n);
  }
};

TEST(MassConserving, StarvedLongBearingFillsAndRupturesWhereTheBalanceSays) {
  const Starved exact(0.6, 0.28);
  Geometry g = cylinder();
  g.length = 80.0 * g.radius;  // the mid-plane does not feel the sides
  std::array<double, 4> area{}, place{}, worst{};
  for (std::size_t level = 0; level < 4; ++level) {
    const int n = 60 << level;
    Reynolds o = conserving({n, 16});
    o.inlet = {Inlet::Type::line, 0.0};
    o.edge_fill = exact.f;
    const JournalMotion m = motion(g, {-exact.e, 0.0, 0.0, 0.0}, {}, 377.0);
    const auto fields = make_film(g, o, oil())->fields(m, {});
    const NodalField &p = field(fields, "pressure"), &fill = field(fields, "fill");
    const double scale = 6.0 * oil().viscosity * m.speed * std::pow(g.radius / g.clearance, 2),
                 step = 2.0 * std::numbers::pi / n;
    const auto middle = [&](const NodalField& q, int i) { return q.values[static_cast<std::size_t>(i * 17 + 8)]; };
    for (int i = 0; i <= n; ++i) {
      area[level] += step * middle(p, i) / scale;
      const double t = i * step;
      // In the cavity the fill times the gap at the face downstream is what enters by the first face.
      if (i > 0 && t < exact.from - 2.0 * step) {
        const double flow = middle(fill, i) * (1.0 + exact.e * std::cos(t + 0.5 * step));
        worst[level] = std::max(worst[level], std::abs(flow - exact.f * (1.0 + exact.e * std::cos(0.5 * step))));
      }
      if (place[level] == 0.0 && middle(p, i) > 0.0) place[level] = t;
    }
    EXPECT_LT(worst[level], 1e-9);
    EXPECT_NEAR(place[level], exact.from, 1.5 * step);
  }
  for (auto& a : area) a = std::abs(a / exact.area - 1.0);
  EXPECT_LT(area[3], 0.01);
  EXPECT_GT(std::log2(area[0] / area[3]) / 3.0, 0.9) << area[0] << " " << area[1] << " " << area[2] << " " << area[3];
}

// What enters leaves, to rounding, in whatever motion; the other conditions make or lose oil.
TEST(MassConserving, BalancesToRounding) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Reynolds grooved = conserving({48, 12}), starved = conserving({40, 10}, true);
  grooved.grooves = {{90.0 * kDegree, 20.0 * kDegree, 3e5}, {-50.0 * kDegree, 0.0, 1e5}};
  starved.edge_fill = 0.6;
  for (const auto& [g, o] : {std::pair{lemon(), conserving({40, 10})}, {arc(), starved}, {cylinder(), grooved}}) {
    auto film = make_film(g, o, oil());
    for (int sample = 0; sample < 20; ++sample) {
      const double tilt = o.tilt ? 0.3 : 0.0;
      const JournalMotion m =
          motion(g, {0.5 * uniform(engine), 0.5 * uniform(engine), tilt * uniform(engine), tilt * uniform(engine)},
                 {0.3 * uniform(engine), 0.3 * uniform(engine), 0.0, 0.0}, sample % 3 == 0 ? -377.0 : 377.0);
      const FilmReport s = film->summary(m, {});
      EXPECT_LT(std::abs(s.imbalance), 1e-12 * (std::abs(s.inlet_flow) + std::abs(s.side_flow)));
    }
  }
}

// Where the film is full everywhere there is nothing to conserve.
TEST(MassConserving, IsTheUncavitatedFilmWhereTheGapIsFull) {
  Geometry g = arc();
  g.arc = 40.0 * kDegree;
  const JournalMotion m = motion(g, {0.6, -0.3, 0.0, 0.0}, {0.0, -0.2, 0.0, 0.0}, 377.0);
  const Response a = evaluate(*make_film(g, conserving({40, 10}), oil()), m),
                 b = evaluate(*make_film(g, with(conserving({40, 10}), Reynolds::Cavitation::none), oil()), m);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(a.force[i], b.force[i],
                3e-3 * std::abs(b.force[i]));  // its force counts the nodes, the other the edges
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_NEAR(a.d_position[i][j], b.d_position[i][j], 2e-2 * std::abs(b.d_position[0][0]));
      EXPECT_NEAR(a.d_velocity[i][j], b.d_velocity[i][j], 1e-2 * std::abs(b.d_velocity[0][0]));
    }
  }
}

// Fed at the widest gap a plain bearing carries nearly what Reynolds' condition says, whose balance does not close.
TEST(MassConserving, FedAtTheWidestGapItIsNearReynolds) {
  Geometry g = cylinder();
  g.length = 2.0 * g.radius;
  for (const double e : {0.2, 0.5, 0.8}) {
    Reynolds o = conserving({120, 24});
    o.inlet = {Inlet::Type::maximum_gap, 0.0};
    auto a = make_film(g, o, oil()), b = make_film(g, with(o, Reynolds::Cavitation::reynolds), oil());
    const JournalMotion m = motion(g, {0.0, -e, 0.0, 0.0}, {}, 377.0);
    const Response ra = evaluate(*a, m), rb = evaluate(*b, m);
    const double load = std::hypot(ra.force[0], ra.force[1]), other = std::hypot(rb.force[0], rb.force[1]);
    EXPECT_NEAR(load, other, 0.01 * other) << e;
    const FilmReport sa = a->summary(m, {}), sb = b->summary(m, {});
    EXPECT_LT(std::abs(sa.imbalance), 1e-12 * sa.inlet_flow);
    EXPECT_GT(std::abs(sb.imbalance), 0.02 * sb.side_flow) << e;
    RecordProperty("imbalance", std::to_string(sb.imbalance / sb.side_flow));
  }
}

// Turning the other way is the mirror image.
TEST(MassConserving, TurnsBothWays) {
  Reynolds o = conserving({40, 10});
  o.edge_fill = 0.8;
  auto film = make_film(lemon(), o, oil());
  const Response a = evaluate(*film, motion(lemon(), {0.4, -0.5, 0.0, 0.0}, {0.05, 0.1, 0.0, 0.0}, 300.0));
  JournalMotion mirrored = motion(lemon(), {-0.4, -0.5, 0.0, 0.0}, {-0.05, 0.1, 0.0, 0.0}, 300.0);
  mirrored.speed = -300.0;
  const Response b = evaluate(*film, mirrored);
  const double size = std::abs(a.force[0]) + std::abs(a.force[1]);
  EXPECT_NEAR(a.force[0], -b.force[0], 1e-11 * size);
  EXPECT_NEAR(a.force[1], b.force[1], 1e-11 * size);
  EXPECT_NEAR(a.d_speed[1], -b.d_speed[1], 1e-9 * std::abs(a.d_speed[1]));
  EXPECT_NEAR(a.d_position[0][1], -b.d_position[0][1], 1e-9 * std::abs(a.d_position[1][1]));
}

TEST(MassConserving, TheAnswerDoesNotDependOnTheStart) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  auto film = make_film(lemon(), conserving({40, 10}), oil());
  for (int sample = 0; sample < 30; ++sample) {
    const JournalMotion m = motion(lemon(), {0.7 * uniform(engine), 0.7 * uniform(engine), 0.0, 0.0},
                                   {0.5 * uniform(engine), 0.5 * uniform(engine), 0.0, 0.0}, 377.0);
    auto fresh = make_film(lemon(), conserving({40, 10}), oil());
    const Response a = evaluate(*film, m), b = evaluate(*fresh, m);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(a.force[i], b.force[i], 1e-10 * std::abs(b.force[1]) + 1e-9);
  }
}

// Closed to the outside a bore would run dry.
TEST(MassConserving, MustBeFed) {
  EXPECT_THROW((void)make_film(cylinder(), conserving({40, 10}), oil()), core::InputError);
  Reynolds grooved = conserving({40, 10});
  grooved.grooves = {{90.0 * kDegree, 0.0}};
  EXPECT_NO_THROW((void)make_film(cylinder(), grooved, oil()));
  grooved.edge_fill = 0.5;  // which nothing would read
  EXPECT_THROW((void)make_film(cylinder(), grooved, oil()), core::InputError);
}

}  // namespace
}  // namespace whirl::film::testing
