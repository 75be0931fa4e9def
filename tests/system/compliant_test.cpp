// A rigid rotor in compliant bearings: derivatives, and the speeds at which half-speed whirl begins (Hopf) against an
// independent reference computation (see the errata kept by this project to van de Vrande (2001), chapter 5).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "support/film_of.hpp"
#include "support/petsc_options.hpp"
#include "support/stage_equations.hpp"
#include "system/start.hpp"
#include "whirl/core/error.hpp"
#include "whirl/problem/taylor.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;
using film::testing::Kind;

namespace {

// Half the rotor on one bearing, L/D = 1, with F0* = 1 (short) or 2 (long) of the whole rotor; Omega_0 = 1.
struct Bench {
  Kind kind = Kind::compliant_short;
  double compliance = 0.1;
  int cells = 50;
  bool as_source = true;
};

system::Train train(const Bench& b) {
  system::Train t;
  t.gravity = 0;
  t.rotor.type = rotor::Options::Type::rigid;
  const double load = b.kind == Kind::compliant_long ? 2.56 : 0.64;  // N, whole rotor of 1 kg, c = 25 um
  t.rotor.mass = 0.5;
  t.rotor.load = load / 2;
  system::Support s;
  s.node = 1;
  s.geometry = {film::Geometry::Bore::cylindrical, 0.005, 0.01, 25e-6, 0, 0, 0};
  film::testing::Elastic film;
  film.kind = b.kind;
  film.compliance = b.compliance;
  film.reference_speed = std::sqrt(load / 25e-6);
  film.cells = {b.cells, b.kind == Kind::compliant_finite ? b.cells / 5 : 4};
  if (b.as_source) {
    film.quadrature = film::Compliant::Quadrature::simpson;
    film.differences = film::Compliant::Differences::upwind;
  }
  s.film = film;
  s.lubricant = {0.001, 1000};
  t.supports = {s};
  return t;
}

// A liner of damped rubber around a film that is differenced at third order.
void damp(system::Support& s) {
  auto& film = film::as<film::Compliant>(s.film);
  film.liner_damping = 1e-3;
  film.rubber_thickness = 1e-4;
  film.quadrature = film::Compliant::Quadrature::sub_cell;
  film.differences = film::Compliant::Differences::third_order;
}

double reference_speed(const system::Train& t) {
  return film::find<film::Compliant>(t.supports[0].film)->reference_speed;
}

struct Hopf {
  double speed = 0;      // in Omega_0
  double frequency = 0;  // rad/s
  std::vector<double> state;
};

// Secant on the real part of the least stable pair, along equilibria from `low` to beyond `high` (in Omega_0).
Hopf hopf(system::RotorSystem& s, double scale, double low, double high) {
  core::Vector x;
  Hopf out;
  const auto growth = [&](double speed) {
    s.set_parameter(speed * scale);
    if (!x) x = system::static_guess(s);
    solve::NewtonOptions o;
    o.max_iterations = 40;
    const auto r = solve::find_equilibrium(s, x.get(), o);
    EXPECT_TRUE(r.converged) << speed << ": " << r.reason;
    double most = -1e300;
    for (const auto& m : spectral::modes(s, x.get(), {}))
      if (m.lambda.imag() > 1e-6 * scale && m.lambda.real() > most) {
        most = m.lambda.real();
        out.frequency = m.lambda.imag();
      }
    return most / scale;
  };
  double a = low, b = high, ga = growth(a), gb = growth(b);
  EXPECT_LT(ga, 0);
  EXPECT_GT(gb, 0);
  for (int k = 0; k < 60 && std::abs(b - a) > 1e-9; ++k) {
    // False position, with a bisection now and then because the force has kinks.
    const double middle = k % 3 == 2 ? 0.5 * (a + b) : b - gb * (b - a) / (gb - ga), g = growth(middle);
    (g < 0 ? a : b) = middle;
    (g < 0 ? ga : gb) = g;
    out.speed = middle;
    if (std::abs(g) < 1e-10) break;
  }
  (void)growth(out.speed);
  out.state = s.gather(x.get());
  return out;
}

Hopf hopf(const Bench& b, double expected, MPI_Comm comm = MPI_COMM_WORLD) {
  const auto t = train(b);
  system::RotorSystem s(comm, t, 0.8 * expected * reference_speed(t));
  return hopf(s, reference_speed(t), 0.95 * expected, 1.05 * expected);
}

}  // namespace

TEST(CompliantRotor, DerivativesPassTheTaylorTest) {
  for (const Kind kind : {Kind::compliant_short, Kind::compliant_long, Kind::compliant_finite})
    for (const int way : {0, 1, 2}) {
      auto t = train({kind, 1, kind == Kind::compliant_finite ? 20 : 24, way == 1});
      if (way == 2) damp(t.supports[0]);
      t.unbalance = {{1, 1e-6, 0.3}};
      system::Support other = t.supports[0];  // a second one on a pedestal, and one without own states between them
      other.has_pedestal = true;
      other.mass = {0.1, 0.2};
      other.stiffness = {2e4, 3e4};
      other.damping = {2, 3};
      system::Support rigid = t.supports[0];
      rigid.film = film::Short{};
      t.supports = {other, rigid, t.supports[0]};
      system::RotorSystem s(MPI_COMM_WORLD, t, 300);
      ASSERT_EQ(s.own_states(), kind == Kind::compliant_short ? 48 : kind == Kind::compliant_long ? 46 : 120);
      ASSERT_EQ(s.size(), s.coordinates() * 2 + s.own_states());
      core::Vector x = system::static_guess(s), rate = core::duplicate(x.get());
      PetscInt begin = 0;
      core::check(VecGetOwnershipRange(x.get(), &begin, nullptr));
      {
        const core::WriteArray a(x.get()), r(rate.get());
        for (PetscInt i = 0; i < r.size(); ++i) {
          const double wave = std::sin(3.7 * static_cast<double>(begin + i));
          r[i] = 1e-4 * wave;
          if (begin + i >= 2 * s.coordinates()) a[i] += 2e-7 * wave;
        }
      }
      const auto r = problem::taylor_test(s, 0.7, x.get(), rate.get(), 1e-4);
      EXPECT_GT(r.first_difference, 1e-7);
      EXPECT_GE(r.state_order, 1.9);
      EXPECT_GE(r.rate_order, 1.9);
      EXPECT_GE(r.parameter_order, 1.9);
    }
}

// The mesh and the quadrature of the source: van de Vrande prints 2.72, 2.71, 2.22 and .413, .494, 1.10.
TEST(CompliantRotor, HopfSpeedsOfTheSourcesMesh) {
  const std::array<double, 3> b = {0.01, 0.1, 1};
  const std::array<double, 3> is_short = {2.72111, 2.70835, 2.21693}, is_long = {0.41280, 0.49409, 1.09544};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(hopf({Kind::compliant_short, b[k], 50, true}, is_short[k]).speed, is_short[k], 1e-5) << b[k];
    EXPECT_NEAR(hopf({Kind::compliant_long, b[k], 50, true}, is_long[k]).speed, is_long[k], 1e-5) << b[k];
  }
}

TEST(CompliantRotor, HopfSpeedsApproachTheMeshFreeOnesAtSecondOrder) {
  const std::array<double, 3> b = {0.01, 0.1, 1};
  const std::array<double, 3> is_short = {2.736456, 2.732563, 2.214669}, is_long = {0.412772, 0.498391, 1.098215};
  for (std::size_t k = 0; k < 3; ++k)
    for (const bool inlet : {false, true}) {
      const Kind kind = inlet ? Kind::compliant_long : Kind::compliant_short;
      const double limit = inlet ? is_long[k] : is_short[k];
      const double coarse = std::abs(hopf({kind, b[k], 40, false}, limit, MPI_COMM_SELF).speed - limit),
                   fine = std::abs(hopf({kind, b[k], 120, false}, limit, MPI_COMM_SELF).speed - limit);
      EXPECT_LT(fine, 6e-4 * limit + 1e-4) << "B = " << b[k] << (inlet ? " long" : " short");
      EXPECT_GE(std::log(coarse / fine) / std::log(3.0), 1.6) << "B = " << b[k] << (inlet ? " long" : " short");
    }
}

// Films spread over the ranks are the films of one rank: residual, products and dF/dp of every row, in natural order.
TEST(CompliantRotor, AFilmSpreadOverRanksIsThatOfOneRank) {
  auto t = train({Kind::compliant_finite, 0.1, 26, false});
  t.unbalance = {{1, 1e-6, 0.3}};
  system::Support other = t.supports[0];  // on a pedestal, reaching two lines back
  other.has_pedestal = true;
  other.mass = {0.1, 0.2};
  other.stiffness = {2e4, 3e4};
  other.damping = {2, 3};
  film::as<film::Compliant>(other.film).cells = {15, 6};
  film::as<film::Compliant>(other.film).differences = film::Compliant::Differences::upwind;
  t.supports.push_back(other);
  damp(other);
  other.has_pedestal = false;
  film::as<film::Compliant>(other.film).grooves = {{1.0, 0.9}};
  t.supports.push_back(other);
  t.supports.push_back(train({Kind::compliant_short, 0.1, 24, false}).supports[0]);
  const auto evaluated = [&](MPI_Comm comm, double thinner) {
    system::RotorSystem s(comm, t, 300);
    core::Vector x = core::make_vector(comm, s.local_size(), PETSC_DETERMINE), rate = core::duplicate(x.get()),
                 f = core::duplicate(x.get());
    PetscInt begin = 0;
    core::check(VecGetOwnershipRange(x.get(), &begin, nullptr));
    {
      const core::WriteArray a(x.get()), r(rate.get());
      for (PetscInt i = 0; i < a.size(); ++i) {
        const PetscInt g = begin + i;
        const double wave = std::sin(0.37 * static_cast<double>(g * g));
        a[i] = g < 2 * s.coordinates() ? 3e-6 * wave : 25e-6 * (1 + 0.3 * wave);
        r[i] = 1e-3 * std::cos(2.1 * static_cast<double>(g));
        if (g == 2 * s.coordinates() + s.own_states() - 30) a[i] -= thinner;
      }
    }
    std::vector<std::vector<double>> out;
    s.residual(0.7, x.get(), rate.get(), f.get());
    out.push_back(s.gather(f.get()));
    s.parameter_derivative(0.7, x.get(), rate.get(), f.get());
    out.push_back(s.gather(f.get()));
    core::Matrix j = s.make_jacobian();
    s.jacobian(0.7, x.get(), rate.get(), 0.3, 2, j.get());
    core::check(MatMult(j.get(), rate.get(), f.get()));
    out.push_back(s.gather(f.get()));
    const auto films = s.film_responses(s.gather(x.get()).data(), film::Need::force);
    for (const auto& film : films) out.push_back({film.force[0], film.force[1], film.min_thickness});
    s.relax_films(x.get());
    out.push_back(s.gather(x.get()));
    return out;
  };
  const auto all = evaluated(MPI_COMM_WORLD, 0), one = evaluated(MPI_COMM_SELF, 0);
  for (std::size_t k = 0; k < one.size(); ++k) {
    ASSERT_EQ(all[k].size(), one[k].size());
    double size = 0;
    for (const double v : one[k]) size = std::max(size, std::abs(v));
    EXPECT_GT(size, 0);
    for (std::size_t i = 0; i < one[k].size(); ++i) EXPECT_NEAR(all[k][i], one[k][i], 1e-13 * size) << k << " " << i;
  }
  // Contact in the lines of one rank is an error of all.
  EXPECT_THROW(evaluated(MPI_COMM_WORLD, 1e-4), core::DomainError);
}

// Of a rigid rotor in one film and in two bearings with a pedestal and a damped liner.
TEST(CompliantRotor, StagesAreSolvedByPreconditionersOfTheFilms) {
  for (const auto& [pedestal, damped] : {std::pair{false, false}, std::pair{true, false}, std::pair{true, true}}) {
    auto t = train({Kind::compliant_finite, 0.1, 45, pedestal});
    if (damped) damp(t.supports[0]);
    if (pedestal) {
      t.supports[0].has_pedestal = true;
      t.supports[0].mass = {0.1, 0.2};
      t.supports[0].stiffness = {2e4, 3e4};
      t.supports[0].damping = {2, 3};
      film::as<film::Compliant>(t.supports[0].film).cells = {46, 8};
      auto rigid = t.supports[0];
      rigid.film = film::Short{};
      t.supports.insert(t.supports.begin(), rigid);
    }
    system::RotorSystem s(MPI_COMM_WORLD, t, 700);
    core::Vector x = system::static_guess(s);
    test::expect_stage_is_solved(s, x.get(), 3e-4, 1e-9);
  }
}

// Krylov iterations of stages and of equilibria do not grow with the mesh of the film, and an option of PETSc takes the
// film's own preconditioner away.
TEST(CompliantRotor, IterationsDoNotGrowWithTheMesh) {
  for (const auto& [alpha, sigma] : {std::pair{3e-4, 1.0}, std::pair{1.0, 0.0}}) {
    std::vector<int> iterations;
    for (const int cells : {30, 60, 120}) {
      auto t = train({Kind::compliant_finite, 0.1, cells, false});
      film::as<film::Compliant>(t.supports[0].film).cells = {cells, cells / 5};
      system::RotorSystem s(MPI_COMM_WORLD, t, 700);
      core::Vector x = system::static_guess(s);
      iterations.push_back(test::iterations(s, x.get(), alpha, sigma));
      const test::WithOptions::List by_lu = {{"-parts_by", "factors"}};
      const test::WithOptions chosen(by_lu);
      EXPECT_LE(test::iterations(s, x.get(), alpha, sigma), 2) << cells;
    }
    EXPECT_GT(iterations[0], 2);
    for (const int n : iterations) EXPECT_LE(n, iterations[0] + 2);
  }
}

// The Hopf speed with films of finite length, L/D = 1, approaches its limit at second order in the mesh.
TEST(CompliantRotor, HopfSpeedsOfFiniteFilmsAreOfSecondOrder) {
  std::array<double, 3> speed{};
  for (std::size_t k = 0; k < 3; ++k) speed[k] = hopf({Kind::compliant_finite, 0.1, 15 << k, false}, 2.5).speed;
  EXPECT_NEAR(std::log2((speed[0] - speed[1]) / (speed[1] - speed[2])), 2, 0.3);
  EXPECT_NEAR(speed[2] + (speed[2] - speed[1]) / 3, 2.4996, 5e-4);
}

// At the Hopf point the rotor on the film's coefficients at the whirl frequency swings freely:
// det(-m w^2 + K(w) + i w C(w)) = 0.
TEST(CompliantRotor, CoefficientsAtTheWhirlFrequencyGiveTheHopfPoint) {
  for (const Kind kind : {Kind::compliant_short, Kind::compliant_long}) {
    const auto t = train({kind, 0.1, 60, false});
    const double scale = reference_speed(t), guess = kind == Kind::compliant_short ? 2.7326 : 0.4984;
    system::RotorSystem s(MPI_COMM_WORLD, t, 0.8 * guess * scale);
    const Hopf h = hopf(s, scale, 0.95 * guess, 1.05 * guess);
    const auto film = film::make_film(t.supports[0].geometry, t.supports[0].film, t.supports[0].lubricant);
    film::JournalMotion motion;
    motion.speed = s.speed();
    for (std::size_t d = 0; d < 2; ++d) motion.position[d] = s.journals(h.state.data())[0].position[d];
    const auto first = h.state.end() - static_cast<std::ptrdiff_t>(film->states());
    const auto c = film::coefficients(*film, motion, {&*first, film->states()}, h.frequency);
    using Complex = std::complex<double>;
    const auto entry = [&](std::size_t k) { return c.stiffness[k] + Complex(0, h.frequency * c.damping[k]); };
    const double inertia = t.rotor.mass * h.frequency * h.frequency;
    const Complex det = (entry(0) - inertia) * (entry(3) - inertia) - entry(1) * entry(2);
    const double size = std::abs(entry(0) * entry(3)) + std::abs(entry(1) * entry(2));
    EXPECT_LT(std::abs(det), 1e-6 * size);
  }
}
