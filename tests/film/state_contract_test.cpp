// What every film with own states has to keep: exact derivatives in all arguments, shares that add up to the whole, no
// memory, no direction of its own.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <limits>
#include <random>
#include <string>

#include "film/compliant_cases.hpp"
#include "film/content_cases.hpp"
#include "film/gas_cases.hpp"
#include "film/thd_cases.hpp"

namespace whirl::film::testing {
namespace {

// A film off equilibrium, with directions of its states and rates along which it has no kinks within `step`.
struct Case {
  std::string name;
  Geometry geometry;
  Options options;
  std::function<JournalMotion()> motion;
  std::function<void(const Film&, std::vector<double>&, std::vector<double>&)> states, directions;
  double step;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const CompliantCase& c : compliant_films())
    all.push_back({c.name, cylinder(), c.options, [] { return kMoving; },
                   [c](const Film&, std::vector<double>& s, std::vector<double>& rates) {
                     CompliantPoint p = point(c.options);
                     s = p.states;
                     rates = p.rates;
                   },
                   [](const Film& film, std::vector<double>& s, std::vector<double>& rates) {
                     for (std::size_t k = 0; k < s.size(); ++k) {
                       s[k] = scale_of(film) * std::sin(1.0 + 2.3 * static_cast<double>(k));
                       rates[k] = kSpeed * s[k];
                     }
                   },
                   1e-4});
  for (const ContentCase& c : content_films())
    all.push_back({c.name, c.geometry, c.options, [c] { return motion(c.geometry, c.position, c.velocity, kSpeed); },
                   // Away from q = 0, where a node becomes full.
                   [](const Film& film, std::vector<double>& s, std::vector<double>& rates) {
                     std::mt19937 engine(7);
                     std::uniform_real_distribution<double> uniform(0.2, 1.0);
                     for (std::size_t k = 0; k < s.size(); ++k) {
                       s[k] = uniform(engine) * (engine() % 2 ? 1e-3 : -0.5) * scale_of(film);
                       rates[k] = uniform(engine) * scale_of(film) * 100.0;
                     }
                   },
                   [](const Film& film, std::vector<double>& s, std::vector<double>& rates) {
                     std::mt19937 engine(11);
                     std::uniform_real_distribution<double> uniform(-0.4, 0.4);
                     for (std::size_t k = 0; k < s.size(); ++k) {
                       s[k] *= uniform(engine);
                       rates[k] = uniform(engine) * scale_of(film) * 100.0;
                     }
                   },
                   2e-3});
  // Around a film at rest in its states, each field by its own measure.
  for (const HeatedCase& c : heated_films()) {
    const auto waves = [](const Film& film, double size, double phase, std::vector<double>& to) {
      for (const StateField& f : film.state_fields())
        f.each([&](int k) { to[static_cast<std::size_t>(k)] = size * f.scale * std::sin(phase + 2.3 * k); });
    };
    all.push_back({c.name, c.geometry, c.options, [c] { return motion(c.geometry, c.position, c.velocity, kSpeed); },
                   [c, waves](const Film& film, std::vector<double>& s, std::vector<double>& rates) {
                     waves(film, 0.3, 1.0, s);
                     std::vector<double> rest(s.size());
                     film.unloaded({}, rest);
                     for (std::size_t k = 0; k < s.size(); ++k) s[k] += rest[k];
                     waves(film, 100.0, 2.0, rates);
                   },
                   [waves](const Film& film, std::vector<double>& s, std::vector<double>& rates) {
                     waves(film, 1.0, 0.3, s);
                     waves(film, 100.0, 0.7, rates);
                   },
                   1e-6});
  }
  // Around a film in the closed form of parallel plates.
  for (const GasCase& c : gas_films()) {
    const auto waves = [](const Film& film, double size, double phase, std::vector<double>& to) {
      for (const StateField& f : film.state_fields())
        f.each([&](int k) { to[static_cast<std::size_t>(k)] = size * f.scale * std::sin(phase + 2.3 * k); });
    };
    all.push_back({c.name, c.geometry, c.options, [c] { return motion(c.geometry, c.position, c.velocity, kSpeed); },
                   [c, waves](const Film& film, std::vector<double>& s, std::vector<double>& rates) {
                     film.unloaded(motion(c.geometry, c.position, c.velocity, kSpeed), s);
                     for (std::size_t k = 0; k < s.size(); ++k)
                       s[k] *= 1.0 + 0.1 * std::sin(0.1 * static_cast<double>(k));
                     waves(film, 100.0, 2.0, rates);
                   },
                   [waves](const Film& film, std::vector<double>& s, std::vector<double>& rates) {
                     waves(film, 1.0, 0.3, s);
                     waves(film, 100.0, 0.7, rates);
                   },
                   1e-4});
  }
  return all;
}

// A case made: film, motion, states with rates, and their directions.
struct Made {
  std::unique_ptr<Film> film;
  JournalMotion motion;
  std::vector<double> states, rates, along, along_rates;
};

Made make(const Case& c) {
  Made m{make_film(c.geometry, c.options, oil()), c.motion(), {}, {}, {}, {}};
  const std::size_t n = m.film->states();
  m.states.resize(n);
  m.rates.resize(n);
  c.states(*m.film, m.states, m.rates);
  m.along = m.states;
  m.along_rates = m.rates;
  c.directions(*m.film, m.along, m.along_rates);
  return m;
}

class StateContract : public ::testing::TestWithParam<Case> {};

// |g(z + e d) - g(z) - e dg d| must fall as e^2 along every port and its rate, the speed, the states and their rates;
// and that of the force alike.
TEST_P(StateContract, TaylorRemainderIsSecondOrder) {
  const Case& c = GetParam();
  const Made base = make(c);
  const std::size_t n = base.states.size(), ports = base.film->ports().size();
  const Share& all = base.film->whole();
  StateResponse at, there;
  base.film->evaluate(base.motion, base.states, base.rates, Need::tangents, at);
  ASSERT_EQ(at.residual.size(), n);
  double size = 0.0;
  for (const double g : at.residual) size += std::abs(g);
  const double load = std::hypot(at.journal.force[0], at.journal.force[1]);
  for (std::size_t direction = 0; direction < 2 * ports + 3; ++direction) {
    const std::size_t port = direction % ports;
    const bool moves = direction < ports, velocity = !moves && direction < 2 * ports;
    const bool speed = direction == 2 * ports, states = direction == 2 * ports + 1, rates = direction > 2 * ports + 1;
    const auto component = static_cast<std::size_t>(base.film->ports()[port]);
    std::array<double, 2> by_rows{}, by_force{};
    double rows = 0.0, forces = 0.0;
    for (std::size_t half = 0; half < 2; ++half) {
      const double e = half == 0 ? c.step : 0.5 * c.step,
                   step = step_of(c.geometry, speed ? 8 : static_cast<int>(component) + (velocity ? 4 : 0), e);
      Made moved = make(c);
      if (moves) moved.motion.position[component] += step;
      if (velocity) moved.motion.velocity[component] += step;
      if (speed) moved.motion.speed += step;
      Eigen::VectorXd g = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n));
      std::array<double, 4> f{};
      for (std::size_t k = 0; k < n; ++k) {
        double& to = g(static_cast<Eigen::Index>(k));
        if (states) moved.states[k] += e * base.along[k];
        if (rates) moved.rates[k] += e * base.along_rates[k];
        if (moves) to = step * at.inputs(static_cast<Eigen::Index>(port), static_cast<Eigen::Index>(k));
        if (velocity)
          to = step * at.inputs(at.forces.rows() + static_cast<Eigen::Index>(port), static_cast<Eigen::Index>(k));
        if (speed) to = step * at.d_speed[k];
        for (std::size_t i = 0; i < ports; ++i) {
          if (states) f[i] += e * base.along[k] * at.forces(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
          if (rates && at.force_rates.rows() > 0)
            f[i] +=
                e * base.along_rates[k] * at.force_rates(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
        }
      }
      const auto add = [&](const Places& places, const std::vector<double>& values, const std::vector<double>& v) {
        for_entries(all, places, values,
                    [&](int i, int j, double value) { g(i) += e * value * v[static_cast<std::size_t>(j)]; });
      };
      if (states) add(all.d_states, at.d_states, base.along);
      if (rates) add(all.d_rates, at.d_rates, base.along_rates);
      for (std::size_t i = 0; i < 4; ++i) {
        if (moves) f[i] += step * at.journal.d_position[i][component];
        if (velocity) f[i] += step * at.journal.d_velocity[i][component];
        if (speed) f[i] += step * at.journal.d_speed[i];
      }
      base.film->evaluate(moved.motion, moved.states, moved.rates, Need::force, there);
      EXPECT_TRUE(there.d_states.empty() && there.d_speed.empty());
      rows = forces = 0.0;
      for (std::size_t k = 0; k < n; ++k) {
        const double change = g(static_cast<Eigen::Index>(k));
        by_rows[half] += std::abs(there.residual[k] - at.residual[k] - change);
        rows += std::abs(change);
      }
      for (std::size_t i = 0; i < 4; ++i) {
        by_force[half] += std::abs(there.journal.force[i] - at.journal.force[i] - f[i]);
        forces += std::abs(f[i]);
      }
    }
    // Only a damped liner, or a line that follows the journal in a groove, feels velocities.
    if (const Facts like = facts(c.options); !velocity || like.force_by_rates || !like.gives_way) {
      EXPECT_GT(rows, 0.0) << direction;
    }
    for (const auto& [r, slope, rounding] :
         {std::tuple(by_rows, rows, 1e-11 * size), std::tuple(by_force, forces, 1e-11 * load)}) {
      if (r[1] < rounding) continue;
      EXPECT_GE(std::log2(r[0] / r[1]), 1.9) << "direction " << direction;
      EXPECT_LT(r[1], 0.1 * slope) << "direction " << direction;
    }
  }
}

// Rows, thin blocks and matrices of 1, 2 and 3 shares are those of the whole, and their forces add up.
TEST_P(StateContract, SharesAddUpToTheWhole) {
  const Made m = make(GetParam());
  const int n = static_cast<int>(m.film->states());
  const bool may_be_cut = m.film->cut(n / 2) % n != 0;
  StateResponse whole, part;
  m.film->evaluate(m.motion, m.states, m.rates, Need::tangents, whole);
  const auto dense = [&](const Share& share, const StateResponse& r) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(2 * share.rows(), n);
    for_entries(share, share.d_states, r.d_states, [&](int i, int j, double v) { out(i, j) += v; });
    for_entries(share, share.d_rates, r.d_rates, [&](int i, int j, double v) { out(share.rows() + i, j) += v; });
    return out;
  };
  const Eigen::MatrixXd all = dense(m.film->whole(), whole);
  const auto expect_near = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double scale, const char* what) {
    EXPECT_LE((a - b).cwiseAbs().maxCoeff(), 1e-13 * scale) << what;
  };
  using Row = Eigen::Map<const Eigen::RowVectorXd>;
  for (int parts = 1; parts <= (may_be_cut ? 3 : 1); ++parts) {
    Response sum;
    sum.min_thickness = std::numeric_limits<double>::infinity();
    int next = 0;
    for (int p = 0; p < parts; ++p) {
      const int begin = m.film->cut(n * p / parts), end = m.film->cut(n * (p + 1) / parts);
      ASSERT_EQ(begin, next);
      ASSERT_LT(begin, end);
      next = end;
      const Share share = m.film->share(begin, end);
      m.film->evaluate(m.motion, share, seen_of(share, m.states), seen_of(share, m.rates), Need::tangents, part);
      const auto rows = static_cast<Eigen::Index>(share.rows());
      const auto compare = [&](const std::vector<double>& a, const std::vector<double>& b, const char* what) {
        ASSERT_EQ(a.size(), static_cast<std::size_t>(rows)) << what;
        const Row of(b.data(), n);
        expect_near(Row(a.data(), rows), of.segment(begin, rows), of.cwiseAbs().maxCoeff(), what);
      };
      compare(part.residual, whole.residual, "residual");
      compare(part.d_speed, whole.d_speed, "d_speed");
      const auto compare_rows = [&](const core::ThinRows& a, const core::ThinRows& b, const char* what) {
        ASSERT_EQ(a.rows(), b.rows()) << what;
        for (Eigen::Index i = 0; i < a.rows(); ++i)
          expect_near(a.row(i), b.row(i).segment(begin, rows), b.row(i).cwiseAbs().maxCoeff(), what);
      };
      compare_rows(part.inputs, whole.inputs, "inputs");
      compare_rows(part.forces, whole.forces, "forces");
      compare_rows(part.force_rates, whole.force_rates, "force_rates");
      const Eigen::MatrixXd here = dense(share, part);
      for (const bool rates : {false, true}) {
        const Eigen::MatrixXd of = all.middleRows((rates ? n : 0) + begin, rows);
        expect_near(here.middleRows(rates ? rows : 0, rows), of, of.cwiseAbs().maxCoeff(), "matrices");
      }
      for (std::size_t i = 0; i < 4; ++i) {
        sum.force[i] += part.journal.force[i];
        sum.d_speed[i] += part.journal.d_speed[i];
        for (std::size_t j = 0; j < 4; ++j) {
          sum.d_position[i][j] += part.journal.d_position[i][j];
          sum.d_velocity[i][j] += part.journal.d_velocity[i][j];
        }
      }
      sum.min_thickness = std::min(sum.min_thickness, part.journal.min_thickness);
    }
    ASSERT_EQ(next, n);
    EXPECT_EQ(sum.min_thickness, whole.journal.min_thickness);
    double stiffness = 0.0, damping = 0.0;
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j) {
        stiffness = std::max(stiffness, std::abs(whole.journal.d_position[i][j]));
        damping = std::max(damping, std::abs(whole.journal.d_velocity[i][j]));
      }
    const double load = std::hypot(whole.journal.force[0], whole.journal.force[1]);
    EXPECT_GT(load, 0.0);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(sum.force[i], whole.journal.force[i], 1e-12 * load);
      for (std::size_t j = 0; j < 2; ++j) {
        EXPECT_NEAR(sum.d_position[i][j], whole.journal.d_position[i][j], 1e-12 * stiffness);
        EXPECT_NEAR(sum.d_velocity[i][j], whole.journal.d_velocity[i][j], 1e-12 * damping);
      }
    }
  }
}

// What an evaluation gives depends neither on those before it nor on what is asked for beside it; fields cover the
// states, and along what is no port there is no force.
TEST_P(StateContract, HasNoMemory) {
  const Made m = make(GetParam());
  const auto fresh = make_film(GetParam().geometry, GetParam().options, oil());
  StateResponse a, b;
  const int n = static_cast<int>(m.states.size()), cut = m.film->cut(n / 3);
  if (cut > 0 && cut < n) {  // another share before
    const Share share = m.film->share(cut, n);
    m.film->evaluate(m.motion, share, seen_of(share, m.states), seen_of(share, m.rates), Need::tangents, a);
  }
  m.film->evaluate(m.motion, m.states, m.rates, Need::tangents, a);
  fresh->evaluate(m.motion, m.states, m.rates, Need::force, b);
  EXPECT_EQ(a.journal.force, b.journal.force);
  EXPECT_EQ(a.residual, b.residual);
  EXPECT_EQ(a.d_states.size(), m.film->whole().d_states.size());
  EXPECT_EQ(a.d_rates.size(), m.film->whole().d_rates.size());
  std::vector<int> covered(static_cast<std::size_t>(n), 0);
  for (const StateField& f : m.film->state_fields()) {
    f.each([&](int k) { ++covered.at(static_cast<std::size_t>(k)); });
    EXPECT_GT(f.scale, 0.0);
    EXPECT_GT(f.row_scale(), 0.0);
    EXPECT_FALSE(f.name.empty() || f.unit.empty());
  }
  EXPECT_EQ(covered, std::vector<int>(static_cast<std::size_t>(n), 1));
  const auto ports = m.film->ports();
  for (const Port port : {Port::x, Port::y, Port::tilt_x, Port::tilt_y})
    EXPECT_EQ(a.journal.force[static_cast<std::size_t>(port)] != 0.0,
              std::find(ports.begin(), ports.end(), port) != ports.end());
}

// A bearing that is turned with its journal by some cells turns the force and the coefficients.
TEST_P(StateContract, TurnsWithItsFrame) {
  const Case& c = GetParam();
  if (c.geometry.type != Geometry::Bore::cylindrical) GTEST_SKIP() << "a bore with a direction";
  Options turned = c.options;
  const double turn = 4.0 * 2.0 * std::numbers::pi / facts(turned).cells[0], cosine = std::cos(turn),
               sine = std::sin(turn);
  if (find<Compliant>(turned)) {
    std::vector<Groove>& grooves = as<Compliant>(turned).grooves;
    if (find<CompliantLong>(turned) && grooves.empty()) grooves = {{90.0 * kDegree, 0.0}};
    for (Groove& g : grooves) g.angle += turn;
  } else if (find<Gas>(turned)) {
    Gas& gas = as<Gas>(turned);
    for (OrificeRow& r : gas.orifices) r.angle += turn;
    for (Groove& g : gas.grooves) g.angle += turn;
    if (gas.lobes) gas.lobes->angle += turn;
  } else {
    auto& content = as<Reynolds>(turned);
    for (Groove& g : content.grooves) g.angle += turn;
    for (Hole& h : content.holes) h.angle += turn;
    if (content.inlet.type == Inlet::Type::line) content.inlet.angle += turn;
  }
  const auto rotated = [&](double x, double y) { return std::array{cosine * x - sine * y, sine * x + cosine * y}; };
  JournalMotion still = c.motion();
  still.position = {0.3 * c.geometry.clearance, -0.35 * c.geometry.clearance, 0.0, 0.0};
  still.velocity = {};
  JournalMotion other = still;
  const auto to = rotated(still.position[0], still.position[1]);
  other.position = {to[0], to[1], 0.0, 0.0};
  const auto solve = [&](const Options& o, const JournalMotion& m, Response& force) {
    const auto film = make_film(c.geometry, o, oil());
    std::vector<double> s(film->states());
    film->unloaded(m, s);
    relax(*film, m, s);
    StateResponse r;
    film->evaluate(m, s, std::vector<double>(s.size(), 0.0), Need::force, r);
    force = r.journal;
    return coefficients(*film, m, s, 0.45 * kSpeed);
  };
  Response f, g;
  const Coefficients a = solve(c.options, still, f), b = solve(turned, other, g);
  const double load = std::hypot(f.force[0], f.force[1]);
  const auto expected = rotated(f.force[0], f.force[1]);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(g.force[i], expected[i], 1e-8 * load);
  const Eigen::Matrix2d r{{cosine, -sine}, {sine, cosine}};
  using Square = Eigen::Map<const Eigen::Matrix<double, 2, 2, Eigen::RowMajor>>;
  for (const auto& [before, after] : {std::pair{&a.stiffness, &b.stiffness}, std::pair{&a.damping, &b.damping}}) {
    const Eigen::Matrix2d moved = r * Square(before->data()) * r.transpose(), found = Square(after->data());
    EXPECT_LE((moved - found).norm(), 1e-7 * moved.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(Films, StateContract, ::testing::ValuesIn(cases()),
                         [](const auto& which) { return which.param.name; });

}  // namespace
}  // namespace whirl::film::testing
