// Closed forms of films that conserve their mass: sliders and grooves at rest, a rupture that moves in time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "film/content_cases.hpp"

namespace whirl::film::testing {
namespace {

double simpson(double a, double b, const std::function<double(double)>& f) {
  constexpr int n = 2000;
  double sum = 0.0;
  for (int i = 0; i <= n; ++i) sum += (i == 0 || i == n ? 1.0 : i % 2 ? 4.0 : 2.0) * f(a + (b - a) * i / n);
  return sum * (b - a) / (3.0 * n);
}

// The zero of f between a and b, where it has different signs.
double zero(double a, double b, const std::function<double(double)>& f) {
  const bool rising = f(b) > 0.0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (a + b);
    ((f(middle) > 0.0) == rising ? b : a) = middle;
  }
  return 0.5 * (a + b);
}

// A long film with h = c (1 + e cos t), full at pressure `feed` at t = from, carries oil towards larger t. Where it is
// full dp/dt = (h - h1)/h^3 in units of 6 mu Omega R^2/c^2, with the flow Omega R c h1/2, the same everywhere. It
// ruptures at b, where p = dp/dt = 0: h(b) = h1 and feed + int_from^b (h - h1)/h^3 dt = 0. The cavity carries theta h =
// h1. Where the film ends at t = to under the same pressure, it is full again from a on, int_a^to (h - h1)/h^3 dt =
// feed.
struct LongFilm {
  double e, from, to, feed, h1 = 0.0, rupture = 0.0, reform = 0.0;
  LongFilm(double eccentricity, double first, double last, double pressure)
      : e(eccentricity), from(first), to(last), feed(pressure) {
    rupture = zero(M_PI + 1e-6, 2.0 * M_PI - 1e-6, [&](double b) { return feed + rise(from, b, h(b)); });
    h1 = h(rupture);
    reform = feed > 0.0 ? zero(rupture, to, [&](double a) { return feed - rise(a, to, h1); }) : to;
  }
  [[nodiscard]] double h(double t) const { return 1.0 + e * std::cos(t); }
  [[nodiscard]] double rise(double a, double b, double flow) const {
    return simpson(a, b, [&](double t) { return (h(t) - flow) / std::pow(h(t), 3); });
  }
  // int p dt of both full parts; p vanishes at b and at a.
  [[nodiscard]] double area() const {
    const auto moment = [&](double a, double b, double about) {
      return simpson(a, b, [&](double t) { return (about - t) * (h(t) - h1) / std::pow(h(t), 3); });
    };
    return feed * (rupture - from) + moment(from, rupture, rupture) + moment(reform, to, to);
  }
};

struct Measured {
  double area = 0.0, rupture = 0.0, reform = 0.0, fill_error = 0.0;
};

// Of the mid-plane of a film so long that it does not feel its sides; t = theta + `turn`.
Measured measure(const LongFilm& exact, const Geometry& g, const Reynolds& o, const JournalMotion& m, double turn) {
  const auto fields = make_film(g, o, oil())->fields(m, {});
  const auto values = [&](const std::string& name) -> const std::vector<double>& {
    return std::find_if(fields.begin(), fields.end(), [&](const NodalField& f) { return f.name == name; })->values;
  };
  const std::vector<double>&p = values("pressure"), &fill = values("fill"), &theta = values("theta");
  const double scale = 6.0 * oil().viscosity * m.speed * std::pow(g.radius / g.clearance, 2),
               step = theta[1] - theta[0];
  const auto along = static_cast<std::size_t>(o.cells[1] + 1), half = static_cast<std::size_t>(o.cells[1] / 2);
  Measured out;
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const double t = theta[i] + turn, here = p[i * along + half];
    const bool end = i == 0 || i + 1 == theta.size(), next = !end && p[(i + 1) * along + half] > 0.0;
    out.area += step * here / scale * (end ? 0.5 : 1.0);
    if (!end && here > 0.0 && !next && t > exact.from + step && out.rupture == 0.0) out.rupture = t;
    if (!end && here == 0.0 && next) out.reform = t;
    if (t > exact.rupture + 2.0 * step && t < exact.reform - 2.0 * step)
      out.fill_error =
          std::max(out.fill_error, std::abs(fill[i * along + half] * exact.h(t + 0.5 * step) / exact.h1 - 1.0));
  }
  return out;
}

void expect_convergence(const LongFilm& exact, const std::function<Measured(int)>& at, double order) {
  std::array<double, 3> error{};
  for (std::size_t level = 0; level < 3; ++level) {
    const int n = 90 << level;
    const Measured m = at(n);
    const double step = 2.0 * M_PI / n;
    error[level] = std::abs(m.area / exact.area() - 1.0);
    EXPECT_NEAR(m.rupture, exact.rupture, 2.0 * step) << n;
    if (exact.feed > 0.0) {
      EXPECT_NEAR(m.reform, exact.reform, 2.0 * step) << n;
    }
    EXPECT_LT(m.fill_error, 1.0 * step) << n;
  }
  EXPECT_LT(error[2], 4e-3);
  EXPECT_GT(0.5 * std::log2(error[0] / error[2]), order) << error[0] << " " << error[1] << " " << error[2];
  EXPECT_GT(error[0], 1e-9);
  ::testing::Test::RecordProperty("error_360", std::to_string(error[2]));
}

// A slider that narrows and widens: full at its first edge, it ruptures behind the narrowest place and leaves the pad
// in streamers.
TEST(LongSlider, ConvergentDivergentRupturesWhereTheBalanceSays) {
  Geometry g = arc();
  g.arc = 240.0 * kDegree;
  g.length = 200.0 * g.radius;
  const LongFilm exact(0.6, M_PI - 0.5 * g.arc, M_PI + 0.5 * g.arc, 0.0);
  ASSERT_LT(exact.rupture, exact.to - 0.2);
  expect_convergence(
      exact,
      [&](int n) {
        const JournalMotion m = motion(g, {0.0, -exact.e, 0.0, 0.0}, {}, 377.0);
        return measure(exact, g, without_states(dynamic({2 * n / 3, 16})), m, -0.5 * M_PI);
      },
      0.9);
}

// Around a whole bearing with one groove under pressure at the widest gap: the film ruptures, and is full again ahead
// of the groove, from where the pressure in it presses oil back against the flow.
TEST(LongSlider, GrooveUnderPressureFillsTheGapAheadOfIt) {
  Geometry g = cylinder();
  g.length = 200.0 * g.radius;
  const LongFilm exact(0.6, 0.0, 2.0 * M_PI, 0.1);
  ASSERT_GT(exact.reform, exact.rupture + 0.3);
  ASSERT_LT(exact.reform, exact.to - 0.1);
  expect_convergence(
      exact,
      [&](int n) {
        const JournalMotion m = motion(g, {0.0, -exact.e, 0.0, 0.0}, {}, 377.0);
        Reynolds o = without_states(dynamic({n, 16}));
        o.grooves = {
            {90.0 * kDegree, 0.0, exact.feed * 6.0 * oil().viscosity * m.speed * std::pow(g.radius / g.clearance, 2)}};
        return measure(exact, g, o, m, -0.5 * M_PI);
      },
      0.9);
}

// Where the gap is full everywhere the pressure is that of the film without cavitation, to rounding.
TEST(LongSlider, FullFilmHasThePressureWithoutCavitation) {
  Geometry g = arc();
  g.arc = 40.0 * kDegree;
  const JournalMotion m = motion(g, {0.6, -0.3, 0.0, 0.0}, {0.0, -0.2, 0.0, 0.0}, 377.0);
  const Reynolds o = dynamic({40, 10});
  Reynolds none = without_states(o);
  none.cavitation = Reynolds::Cavitation::none;
  auto film = make_film(g, o, oil());
  const auto q = settled(*film, m);
  EXPECT_TRUE(std::all_of(q.begin(), q.end(), [](double x) { return x > 0.0; }));
  const auto a = film->fields(m, q), b = make_film(g, none, oil())->fields(m, {});
  const double peak = *std::max_element(b[2].values.begin(), b[2].values.end());
  for (std::size_t k = 0; k < b[2].values.size(); ++k) ASSERT_NEAR(a[2].values[k], b[2].values[k], 1e-10 * peak);
}

// Two plates of width 2 a, parallel but for a part in 1e4, move apart and together, h = h0 (1 - e cos w t), between
// oil at pressure p0 (after Olsson 1965; Optasanu and Bonneau 2000). The film is full for |x| > b, with p'' = K = 12 mu
// h'/h^3, p(a) = p0, p(b) = 0. While the cavity spreads p'(b) = 0 too: b = a - (2 p0/K)^1/2. While it shrinks oil fills
// what is missing, (h - m(b)) db/dt = -h^3/(12 mu) p'(b), with m(x) = h at the time when the rupture passed x.
struct Plates {
  double mu, h0, e, w, a, p0;
  [[nodiscard]] double h(double t) const { return h0 * (1.0 - e * std::cos(w * t)); }
  [[nodiscard]] double rate(double t) const { return h0 * e * w * std::sin(w * t); }
  [[nodiscard]] double curvature(double t) const { return 12.0 * mu * rate(t) / std::pow(h(t), 3); }
  [[nodiscard]] double spreading(double t) const { return a - std::sqrt(2.0 * p0 / curvature(t)); }
  [[nodiscard]] double slope(double t, double b) const {  // p'(b)
    return p0 / (a - b) - 0.5 * curvature(t) * (a - b);
  }
  // int (p0 - p) dx, over the whole width, with p = p'(b) (x - b) + K/2 (x - b)^2.
  [[nodiscard]] double missing(double t, double b) const {
    const double l = a - b;
    return 2.0 * (p0 * a - slope(t, b) * l * l / 2.0 - curvature(t) * l * l * l / 6.0);
  }
};

// b at time `to`: the closed form up to the widest cavity, then its equation by the classical scheme.
double front(const Plates& s, double to) {
  const double quarter = 0.5 * M_PI / s.w;
  // The cavity is widest where K is.
  double widest = 0.0, peak = 0.0;
  for (int k = 1; k < 20000; ++k) {
    const double t = 2.0 * quarter * k / 20000;
    if (s.curvature(t) > peak) peak = s.curvature(widest = t);
  }
  if (to <= widest) return s.spreading(to);
  const double begins = zero(1e-9 * quarter, widest, [&](double t) { return s.curvature(t) * s.a * s.a - 2.0 * s.p0; });
  const auto content = [&](double b) {
    return s.h(zero(begins, widest, [&](double t) { return s.spreading(t) - b; }));
  };
  const auto speed = [&](double t, double b) {
    return -std::pow(s.h(t), 3) / (12.0 * s.mu) * s.slope(t, b) / (s.h(t) - content(b));
  };
  // Where the rupture turns round both sides of the equation vanish; a moment later it is as good as exact.
  double b = s.spreading(widest + 1e-3 * quarter), t = widest + 1e-3 * quarter;
  constexpr int n = 400;
  const double d = (to - t) / n;
  for (int k = 0; k < n; ++k, t += d) {
    const double k1 = speed(t, b), k2 = speed(t + 0.5 * d, b + 0.5 * d * k1), k3 = speed(t + 0.5 * d, b + 0.5 * d * k2),
                 k4 = speed(t + d, b + d * k3);
    b += d * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
  }
  return b;
}

// The same by a film, between grooves that leave an arc of 2 deg: int (p0 - p) dx at given times, by a scheme of two
// implicit stages and order two (L-stable), and what the content gains beside what flows in.
struct Squeezed {
  std::vector<double> missing;
  double unbalanced = 0.0;  // content gained less what flowed in, per content
};
Squeezed squeeze(const Plates& s, int cells, int steps, double bulk_modulus, const std::vector<double>& times) {
  Geometry g{Geometry::Bore::cylindrical, 1.0, 1e4, s.h0, 0.0, 0.0, 0.0};
  Reynolds o = dynamic({180 * cells, 2});
  o.bulk_modulus = bulk_modulus;
  o.grooves = {{270.0 * kDegree, 358.0 * kDegree, s.p0}};
  auto film = make_film(g, o, {s.mu, 0.0});
  EXPECT_EQ(film->states(), static_cast<std::size_t>(cells - 1));
  const auto at = [&](double t) {
    JournalMotion m;
    m.position[1] = s.h0 - s.h(t);
    m.velocity[1] = -s.rate(t);
    return m;
  };
  const std::size_t n = film->states();
  const double gamma = 1.0 - std::sqrt(0.5);
  std::vector<double> q = settled(*film, at(0.0)), k(n), begin;
  const double first = q[0];
  StateResponse r;
  // q + d gamma k at time t with g(q, k) = 0.
  const auto stage = [&](double t, double d, const std::vector<double>& from) {
    std::vector<double> to = q;
    for (int iteration = 0; iteration < 60; ++iteration) {
      for (std::size_t i = 0; i < n; ++i) k[i] = (to[i] - from[i]) / (gamma * d);
      film->evaluate(at(t), to, k, Need::tangents, r);
      const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(matrix_of(*film, r, 1.0 / (gamma * d)));
      const Eigen::VectorXd step =
          lu.solve(Eigen::Map<const Eigen::VectorXd>(r.residual.data(), static_cast<Eigen::Index>(n)));
      for (std::size_t i = 0; i < n; ++i) to[i] -= step[static_cast<Eigen::Index>(i)];
      if (step.norm() < 1e-13 * s.h0) break;
    }
    for (std::size_t i = 0; i < n; ++i) k[i] = (to[i] - from[i]) / (gamma * d);
    return to;
  };
  Squeezed out;
  double inflow = 0.0, t = 0.0;
  const double area = 2.0 * kDegree / cells * 0.5e4;
  double content = 0.0;
  for (const double x : q) content += area * x;
  for (const double to : times) {
    const double d = (to - t) / steps;
    for (int step = 0; step < steps; ++step, t += d) {
      begin = q;
      const std::vector<double> one = stage(t + gamma * d, d, begin);
      const FilmReport s1 = film->summary(at(t + gamma * d), one);
      std::vector<double> mixed = begin;
      for (std::size_t i = 0; i < n; ++i) mixed[i] += (1.0 - gamma) * d * k[i];
      q = stage(t + d, d, mixed);
      const FilmReport s2 = film->summary(at(t + d), q);
      inflow += d * ((1.0 - gamma) * s1.imbalance + gamma * s2.imbalance);
    }
    film->evaluate(at(to), q, k, Need::force, r);
    out.missing.push_back(r.journal.force[1] / 0.5e4);
  }
  double gained = -content;
  for (const double x : q) gained += area * x;
  out.unbalanced = std::abs(gained - inflow) / (area * static_cast<double>(n) * s.h0);
  EXPECT_GE(first, 0.0);
  return out;
}

const Plates plates{0.0067, 1e-4, 0.4, 600.0, kDegree, 1e5};

TEST(Squeeze, RuptureMovesAsTheClosedFormSays) {
  // Where K is largest the cavity is widest; one time before, one after it.
  const std::vector<double> times = {0.8e-3, 3.6e-3};
  const double early = front(plates, times[0]), late = front(plates, times[1]);
  ASSERT_GT(early, 0.2 * plates.a);
  ASSERT_GT(late, 0.1 * plates.a);
  std::array<std::array<double, 2>, 3> error{};
  for (std::size_t level = 0; level < 3; ++level) {
    const Squeezed s = squeeze(plates, 20 << level, 40 << level, 1e13, times);
    for (std::size_t k = 0; k < 2; ++k)
      error[level][k] = std::abs(s.missing[k] / plates.missing(times[k], k == 0 ? early : late) - 1.0);
    EXPECT_LT(s.unbalanced, 1e-11);
    RecordProperty("error_" + std::to_string(20 << level),
                   std::to_string(error[level][0]) + " " + std::to_string(error[level][1]));
  }
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_LT(error[2][k], 0.02);
    EXPECT_GT(0.5 * std::log2(error[0][k] / error[2][k]), 0.9)
        << error[0][k] << " " << error[1][k] << " " << error[2][k];
  }
}

// What the oil's compressibility changes falls with one over its bulk modulus.
TEST(Squeeze, StiffOilIsTheLimit) {
  const std::vector<double> times = {0.8e-3};
  const double limit = squeeze(plates, 20, 80, 1e14, times).missing[0];
  std::array<double, 3> error{};
  for (std::size_t k = 0; k < 3; ++k)
    error[k] = std::abs(squeeze(plates, 20, 80, 4e9 * std::pow(4.0, k), times).missing[0] / limit - 1.0);
  EXPECT_NEAR(0.5 * std::log2(error[0] / error[2]), 2.0, 0.15) << error[0] << " " << error[1] << " " << error[2];
  EXPECT_LT(error[2], 1e-2);
}

}  // namespace
}  // namespace whirl::film::testing
