// Exact solutions and published tables.
#include <gtest/gtest.h>

#include "film/cases.hpp"
#include "whirl/film/contract/turbulence.hpp"

namespace whirl::film::testing {
namespace {

using C = Reynolds::Cavitation;
using T = Turbulence;
constexpr double kPi = std::numbers::pi;

Reynolds options(C cavitation, T turbulence, std::array<int, 2> cells) {
  Reynolds o;
  o.cavitation = cavitation;
  o.turbulence = turbulence;
  o.cells = cells;
  return o;
}

// A full journal bearing split where the film is thickest for a journal displaced straight down.
Geometry full(double length_to_diameter) {
  return {Geometry::Bore::partial_arc, 0.05, 0.1 * length_to_diameter, 0.0001, 2.0 * kPi, 0.0, 0.0};
}

// c_xx, c_yy of a centred pad, where h = c_b is constant: with k_x, k_z constant, sine modes in z and the pad angle
// phi in [-alpha, alpha], A P''/R^2 - B (k pi/L)^2 P = 4/(k pi) (y' cos phi - x' sin phi), A = c^3/(mu k_x), B =
// c^3/(mu k_z).
std::array<double, 2> squeeze_damping(const Geometry& g, double kx, double kz, double viscosity) {
  const double alpha = 0.5 * g.arc, s = std::sin(alpha), c = std::cos(alpha), R = g.radius;
  const double A = std::pow(g.clearance, 3) / (viscosity * kx);
  std::array<double, 2> damping{};
  for (int k = 1; k < 4000; k += 2) {
    const double kappa = R * k * kPi / g.length * std::sqrt(kx / kz), t = std::tanh(kappa * alpha),
                 n = 1.0 + kappa * kappa;
    const double mode = 4.0 / (k * kPi) * R * R / (A * n) * R * 2.0 * g.length / (k * kPi);
    damping[0] += mode * (alpha - s * c - s * 2.0 * (kappa * s / t - c) / n);
    damping[1] += mode * (alpha + s * c - c * 2.0 * (kappa * t * c + s) / n);
  }
  return damping;
}

class Squeeze : public ::testing::TestWithParam<T> {};

TEST_P(Squeeze, DampingConvergesWithOrderTwo) {
  const double speed = 377.0;
  const Geometry g = arc();
  const double Re = oil().density * speed * g.radius * g.clearance / oil().viscosity;
  const auto exact = squeeze_damping(g, evaluate(resistance_around(GetParam()), Re),
                                     evaluate(resistance_along(GetParam()), Re), oil().viscosity);
  std::array<double, 2> previous{};
  for (int level = 0; level < 4; ++level) {
    auto model = make_film(g, options(C::none, GetParam(), {12 << level, 10 << level}), oil());
    const Response r = evaluate(*model, motion(g, {}, {}, speed));
    for (std::size_t i = 0; i < 2; ++i) {
      const double error = -r.d_velocity[i][i] / exact[i] - 1.0;
      if (level > 0) {
        EXPECT_NEAR(std::log2(previous[i] / error), 2.0, 0.1) << "component " << i;
      }
      previous[i] = error;
    }
    EXPECT_NEAR(r.d_velocity[0][1], 0.0, 1e-10 * exact[1]);
    EXPECT_NEAR(r.d_velocity[1][0], 0.0, 1e-10 * exact[1]);
  }
  EXPECT_LT(std::abs(previous[0]), 1.5e-3);
  EXPECT_LT(std::abs(previous[1]), 1.5e-3);
}

INSTANTIATE_TEST_SUITE_P(Both, Squeeze, ::testing::Values(T::laminar, T::constantinescu));

// Force and tangents of an eccentric journal: differences between three grids fall by four.
TEST(Order, ForceAndTangentsOfEccentricJournalConvergeWithOrderTwo) {
  for (const C cavitation : {C::none, C::half_sommerfeld}) {
    std::vector<std::vector<double>> values;
    for (int level = 0; level < 3; ++level) {
      auto model = make_film(lemon(), options(cavitation, T::constantinescu, {90 << level, 20 << level}), oil());
      const Response r = evaluate(*model, motion(lemon(), {0.6, -0.3, 0.0, 0.0}, {0.05, -0.08, 0.0, 0.0}, 377.0));
      values.push_back({r.force[0], r.force[1], r.d_position[0][0], r.d_position[1][1], r.d_velocity[0][0],
                        r.d_velocity[1][1], r.d_speed[1]});
    }
    for (std::size_t i = 0; i < values[0].size(); ++i) {
      const double order = std::log2((values[0][i] - values[1][i]) / (values[1][i] - values[2][i]));
      EXPECT_NEAR(order, 2.0, 0.1) << "value " << i;
    }
  }
}

// Sommerfeld 1904, per unit length, p = 0 where the film is thickest; the ends cancel between two lengths.
TEST(Long, SommerfeldForces) {
  const double e = 0.5, speed = 150.0, length = 10.0;
  const Lubricant oil{0.02, 0.0};
  for (const C cavitation : {C::none, C::half_sommerfeld}) {
    std::array<std::array<double, 2>, 2> force{};
    for (std::size_t k = 0; k < 2; ++k) {
      const int times = static_cast<int>(k) + 1;
      const Geometry g = full(length * times);
      auto model = make_film(g, options(cavitation, T::laminar, {720, 40 * times}), oil);
      const Response r = evaluate(*model, motion(g, {0.0, -e, 0.0, 0.0}, {}, speed), Need::force);
      force[k] = {r.force[0], r.force[1]};
    }
    const Geometry g = full(length);
    const double unit =
        oil.viscosity * speed * g.radius * std::pow(g.radius / g.clearance, 2) * g.length / (2.0 + e * e);
    const double tangential = 12.0 * kPi * unit * e / std::sqrt(1.0 - e * e);
    const double x = force[1][0] - force[0][0], y = force[1][1] - force[0][1];
    if (cavitation == C::none) {
      EXPECT_NEAR(x / tangential, 1.0, 1e-4);
      EXPECT_NEAR(y / tangential, 0.0, 1e-9);
    } else {
      EXPECT_NEAR(x / (0.5 * tangential), 1.0, 1e-4);
      EXPECT_NEAR(y / (12.0 * unit * e * e / (1.0 - e * e)), 1.0, 1e-4);
    }
  }
}

// Ocvirk's short bearing with half a film: the length shrinks, viscosity rises so that mu L^3 stays.
TEST(Short, OcvirkForces) {
  const double e = 0.6, speed = 150.0;
  const Geometry g = full(0.01);
  const Lubricant oil{10.0, 0.0};
  auto model = make_film(g, options(C::half_sommerfeld, T::laminar, {1440, 128}), oil);
  const Response r = evaluate(*model, motion(g, {0.0, -e, 0.0, 0.0}, {}, speed), Need::force);
  const double unit = oil.viscosity * speed * g.radius * std::pow(g.length, 3) / (g.clearance * g.clearance);
  EXPECT_NEAR(r.force[1] / (unit * e * e / std::pow(1.0 - e * e, 2)), 1.0, 1e-3);
  EXPECT_NEAR(r.force[0] / (unit * kPi / 4.0 * e / std::pow(1.0 - e * e, 1.5)), 1.0, 1e-3);
}

// Friswell, Penny, Garvey and Lees (2010), example 5.5.1, with mu L^3 kept while L is divided by 30.
TEST(Short, FriswellExample551) {
  const double thin = 30.0, speed = 1500.0 * kPi / 30.0, load = 525.0, e = 0.266298;
  const Geometry g{Geometry::Bore::partial_arc, 0.05, 0.03 / thin, 0.0001, 2.0 * kPi, 0.0, 0.0};
  auto model = make_film(g, options(C::half_sommerfeld, T::laminar, {1440, 128}), {0.1 * thin * thin * thin, 0.0});
  const double attitude = std::atan(kPi * std::sqrt(1.0 - e * e) / (4.0 * e));
  EXPECT_NEAR(attitude / kDegree, 70.62, 0.005);
  const Response r =
      evaluate(*model, motion(g, {e * std::sin(attitude), -e * std::cos(attitude), 0.0, 0.0}, {}, speed));
  EXPECT_NEAR(r.force[0], 0.0, 1e-3 * load);
  EXPECT_NEAR(r.force[1], load, 1e-3 * load);
  const double K[2][2] = {{12.80796e6, 16.393593e6}, {-25.060393e6, 8.815303e6}};
  const double D[2][2] = {{232.89693e3, -81.924371e3}, {-81.924371e3, 294.911619e3}};
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_NEAR(-r.d_position[i][j], K[i][j], 2e-3 * 25e6) << i << j;
      EXPECT_NEAR(-r.d_velocity[i][j], D[i][j], 2e-3 * 295e3) << i << j;
    }
  }
}

// Raimondi and Boyd (1958), L/D = 1, Reynolds cavitation; S, attitude, side flow and P/p_max recomputed independently.
TEST(Published, RaimondiBoyd) {
  struct Row {
    double e, S, attitude, side, peak;
  };
  for (const Row& row : {Row{0.2, 0.6318, 73.86, 1.005, 0.528}, Row{0.6, 0.1210, 50.53, 2.948, 0.415},
                         Row{0.8, 0.04456, 36.23, 3.897, 0.320}}) {
    const Geometry g = full(1.0);
    const Lubricant oil{0.02, 0.0};
    const double speed = 100.0, N = speed / (2.0 * kPi);
    auto model = make_film(g, options(C::reynolds, T::laminar, {240, 40}), oil);
    const JournalMotion m = motion(g, {0.0, -row.e, 0.0, 0.0}, {}, speed);
    const Response r = evaluate(*model, m, Need::force);
    const double load = std::hypot(r.force[0], r.force[1]), ratio = g.radius / g.clearance;
    const double S = oil.viscosity * N * g.length * 2.0 * g.radius * ratio * ratio / load;
    const double attitude = std::atan2(r.force[0], r.force[1]);
    EXPECT_NEAR(S, row.S, 3e-3 * row.S);
    EXPECT_NEAR(attitude / kDegree, row.attitude, 0.15);
    const FilmReport s = model->summary(m, {});
    EXPECT_NEAR(s.side_flow / (g.radius * g.clearance * N * g.length), row.side, 0.02 * row.side);
    EXPECT_NEAR(load / (g.length * 2.0 * g.radius) / s.max_pressure, row.peak, 0.01 * row.peak);
    EXPECT_NEAR(s.min_thickness, g.clearance * (1.0 - row.e), 1e-3 * g.clearance);
    const double friction = 2.0 * kPi * kPi * S / std::sqrt(1.0 - row.e * row.e) + 0.5 * row.e * std::sin(attitude);
    EXPECT_NEAR(s.power_loss / (speed * g.radius) * ratio / load, friction, 5e-3 * friction);
  }
}

// Lund and Thomsen (1978), two 160-degree lands, L/D = 0.5, Reynolds cavitation: x along the load, y in the direction
// of rotation from x, K C/W and C C omega/W.
TEST(Published, LundThomsen) {
  struct Row {
    double S, e, attitude, Kxx, Kxy, Kyx, Kyy, Bxx, Bxy, Byy;
  };
  for (const Row& row : {Row{2.030, 0.207, 68.75, 1.65, 5.67, -2.50, 1.93, 11.18, 2.07, 5.33},
                         Row{0.580, 0.477, 51.01, 2.67, 3.70, -0.78, 1.75, 6.96, 1.94, 2.40},
                         Row{0.194, 0.695, 37.72, 4.78, 3.84, 0.01, 1.62, 7.03, 1.80, 1.40}}) {
    const Geometry g{Geometry::Bore::lemon_bore, 0.1, 0.1, 0.0001, 160.0 * kDegree, 0.0, 0.0};
    const Lubricant oil{0.02, 0.0};
    const double speed = 100.0;
    auto model = make_film(g, options(C::reynolds, T::laminar, {160, 32}), oil);
    const double phi = row.attitude * kDegree;
    const Response r =
        evaluate(*model, motion(g, {row.e * std::sin(phi), -row.e * std::cos(phi), 0.0, 0.0}, {}, speed));
    const double W = r.force[1], k = g.clearance / W;
    EXPECT_NEAR(r.force[0] / W, 0.0, 0.01);
    const double S = oil.viscosity * speed / (2.0 * kPi) * g.length * 0.2 * 1e6 / W;
    EXPECT_NEAR(S, row.S, 0.01 * row.S);
    const auto &P = r.d_position, &V = r.d_velocity;
    const double tolerance = 0.02 * row.Kxy, damping = 0.02 * row.Bxx;
    EXPECT_NEAR(-k * P[1][1], row.Kxx, tolerance);
    EXPECT_NEAR(k * P[1][0], row.Kxy, tolerance);
    EXPECT_NEAR(k * P[0][1], row.Kyx, tolerance);
    EXPECT_NEAR(-k * P[0][0], row.Kyy, tolerance);
    EXPECT_NEAR(-k * speed * V[1][1], row.Bxx, damping);
    EXPECT_NEAR(k * speed * V[1][0], row.Bxy, damping);
    EXPECT_NEAR(k * speed * V[0][1], row.Bxy, damping);
    EXPECT_NEAR(-k * speed * V[0][0], row.Byy, damping);
  }
}

// Constantinescu's mixing-length form is the pair 12 + 0.0260 Re^0.8265, 12 + 0.0198 Re^0.741.
TEST(Turbulence, ShortForm) {  // the printed factors have three digits
  const double table[][3] = {{500, 16.42, 13.98},   {1000, 19.84, 15.31},   {2000, 25.91, 17.53},  {5000, 41.66, 22.90},
                             {10000, 64.60, 30.22}, {20000, 105.28, 42.46}, {50000, 210.92, 72.06}};
  for (const auto& row : table) {
    EXPECT_NEAR(evaluate(resistance_around(T::constantinescu), row[0]), row[1], 1.5e-3 * row[1]);
    EXPECT_NEAR(evaluate(resistance_along(T::constantinescu), row[0]), row[2], 1.5e-3 * row[2]);
  }
  EXPECT_EQ(couette_factor(T::constantinescu, 5000.0), couette_factor(T::ng_pan, 5000.0));
  EXPECT_EQ(couette_factor(T::laminar, 5000.0), 1.0);
  EXPECT_EQ(evaluate(resistance_around(T::laminar), 5000.0), 12.0);
  EXPECT_EQ(evaluate(resistance_along(T::laminar), 5000.0), 12.0);
}

// Ng and Pan's fit, with the shear of Couette flow; without speed the flow is laminar.
TEST(Turbulence, NgAndPansFit) {
  const double table[][4] = {{500, 15.65, 13.68, 1.413},     {1000, 18.82, 15.26, 1.793},
                             {2000, 24.72, 18.35, 2.521},    {5000, 41.01, 27.29, 4.599},
                             {10000, 66.14, 41.75, 7.905},   {20000, 113.03, 69.87, 14.248},
                             {50000, 242.47, 151.47, 32.348}};
  for (const auto& row : table) {
    EXPECT_NEAR(evaluate(resistance_around(T::ng_pan), row[0]), row[1], 0.0051);
    EXPECT_NEAR(evaluate(resistance_along(T::ng_pan), row[0]), row[2], 0.0051);
    EXPECT_NEAR(couette_factor(T::ng_pan, row[0]), row[3], 0.00051);
  }
  EXPECT_EQ(evaluate(resistance_around(T::ng_pan), 0.0), 12.0);
  EXPECT_EQ(couette_factor(T::ng_pan, 0.0), 1.0);
}

}  // namespace
}  // namespace whirl::film::testing
