// Cycles of rotors in films with own states: the condensed intervals against dense ones, the ways to join them, any
// number of ranks, derivatives in the speed and in other parameters.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "solve/cycle/linear_part.hpp"
#include "support/film_of.hpp"
#include "support/petsc_options.hpp"
#include "whirl/core/error.hpp"
#include "whirl/problem/scaled_point.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"
#include "whirl/solve/newton/newton.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using film::testing::Kind;
using Joining = solve::CycleOptions::Joining;

namespace {

constexpr double clearance = 25e-6, speed = 4 * 160;

system::Support support(Kind kind, bool as_source, double compliance, int cells) {
  system::Support s;
  s.node = 1;
  s.geometry = {film::Geometry::Bore::cylindrical, 0.005, 0.01, clearance, 0, 0, 0};
  film::testing::Elastic film;
  film.kind = kind;
  film.compliance = compliance;
  film.reference_speed = 160;
  film.cells = {cells, 4};
  if (as_source) {
    film.quadrature = film::Compliant::Quadrature::simpson;
    film.differences = film::Compliant::Differences::upwind;
  }
  s.film = film;
  s.lubricant = {0.001, 1000};
  return s;
}

system::Train train(std::vector<system::Support> supports) {
  system::Train t;
  t.gravity = 0;
  t.rotor.type = rotor::Options::Type::rigid;
  t.rotor.mass = 0.5 * static_cast<double>(supports.size());
  t.rotor.load = 0.32 * static_cast<double>(supports.size());
  t.unbalance = {{1, 0.2 * clearance * t.rotor.mass, 0.4}};
  t.supports = std::move(supports);
  return t;
}

enum class Mix { plain, as_source, damped };

film::Compliant& liner_of(system::Support& s) {
  return film::as<film::Compliant>(s.film);
}

void damp(system::Support& s) {
  liner_of(s).liner_damping = 0.3 / 160;
  liner_of(s).rubber_thickness = 4 * clearance;
  liner_of(s).differences = film::Compliant::Differences::third_order;
}

// A short film beside a short rigid one, a long film on a pedestal and one with a mesh of lines.
system::Train mixed(Mix mix) {
  const bool as_source = mix == Mix::as_source;
  system::Support rigid = support(Kind::compliant_short, false, 0.1, 8),
                  on_pedestal = support(Kind::compliant_long, as_source, 0.3, 14);
  rigid.film = film::Short{};
  on_pedestal.has_pedestal = true;
  on_pedestal.mass = {0.1, 0.1};
  on_pedestal.stiffness = {1e6, 2e6};
  on_pedestal.damping = {50, 60};
  system::Support lines = support(Kind::compliant_finite, false, 0.2, 10),
                  first = support(Kind::compliant_short, as_source, 0.1, 12);
  if (mix == Mix::damped) {
    for (auto* film : {&lines, &first, &on_pedestal}) damp(*film);
    liner_of(lines).grooves = {{2.0, 0.0}};
    for (auto* film : {&lines, &on_pedestal}) liner_of(*film).contact = film::Contact{0.25 * clearance, 1e7};
  }
  return train({first, rigid, on_pedestal, lines});
}

double apart(const MatrixXd& a, const MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / std::max(1e-3, b.cwiseAbs().maxCoeff());
}

// A whirl of half a clearance with films that carry something, scaled.
VectorXd state_at(const system::RotorSystem& s, double angle) {
  VectorXd x = VectorXd::Zero(s.size());
  x(0) = 0.3 * std::cos(angle);
  x(1) = -0.3 * 2 * std::sin(angle);
  x(2) = -0.2 + 0.3 * std::sin(angle);
  x(3) = 0.3 * 2 * std::cos(angle);
  for (PetscInt k = s.size() - s.own_states(); k < s.size(); ++k)
    x(k) = 1 + 0.4 * std::sin(angle + 0.2 * static_cast<double>(k));
  return x;
}

}  // namespace

TEST(OwnStates, CondensedIntervalsAreTheDenseMatrix) {
  std::srand(3);
  for (const Mix mix : {Mix::plain, Mix::as_source, Mix::damped}) {
    system::RotorSystem s(PETSC_COMM_SELF, mixed(mix), speed);
    EXPECT_EQ(s.constant_rates(), mix != Mix::damped);
    problem::BlockStructure* structure = s.structure();
    ASSERT_NE(structure, nullptr);
    ASSERT_EQ(structure->own().size(), 3U);
    problem::ScaledPoint point(s, structure), plain(s, nullptr);
    const Eigen::Index n = s.size(), core = structure->size();
    EXPECT_EQ(core + s.own_states(), n);
    EXPECT_GT(s.own_states(), 12 + 13 + 10);
    for (const auto points : {solve::Points::radau, solve::Points::gauss})
      for (const int m : {1, 2, 3, 4, 5}) {
        const solve::Scheme scheme = solve::make_scheme(m, points);
        const double length = 1e-3;
        std::vector<problem::PointState> kept(static_cast<std::size_t>(m));
        std::vector<const problem::PointState*> at;
        std::vector<MatrixXd> jx(kept.size()), jxdot(jx);
        for (int j = 0; j < m; ++j) {
          const auto k = static_cast<std::size_t>(j);
          const VectorXd x = state_at(s, 0.3 * j), xdot = VectorXd::Random(n);
          VectorXd f(n), f_plain(n), rates(n);
          point.residual(0.3, x, xdot, f, kept[k]);
          plain.residual(0.3, x, xdot, f_plain);
          EXPECT_LE(apart(f, f_plain), 1e-12);
          MatrixXd jx_plain, jxdot_plain;
          VectorXd dp_plain, dp(n);
          plain.linearise(0.3, x, xdot, jx_plain, jxdot_plain, &dp_plain);
          point.matrices(kept[k], jx[k], jxdot[k]);
          EXPECT_LE(apart(jx[k], jx_plain), 1e-12);
          EXPECT_LE(apart(jxdot[k], jxdot_plain), 1e-12);
          point.parameter_derivative(0.3, kept[k], dp);
          EXPECT_LE(apart(dp, dp_plain), 1e-12);
          point.times_rates(kept[k], xdot, rates);
          EXPECT_LE(apart(rates, jxdot_plain * xdot), 1e-12);
          at.push_back(&kept[k]);
        }
        const auto part = std::make_shared<solve::LinearPart>(scheme, length, point.blocks());
        const auto own = solve::make_own_interval(part, structure->own(), point, at),
                   dense = solve::make_dense_interval(scheme, length, jx, jxdot);
        const MatrixXd y = MatrixXd::Random(m * n, 3), x = MatrixXd::Random(n, 3), rows = MatrixXd::Random(2, m * n);
        const VectorXd states = VectorXd::Random(m * n);
        for (int j = 0; j < m; ++j)
          for (int l = 0; l <= m; ++l) EXPECT_LE(apart(own->block(j, l), dense->block(j, l)), 1e-12);
        MatrixXd a = y, b = y;
        own->solve(a);
        dense->solve(b);
        EXPECT_LE(apart(a, b), 1e-9) << m;
        a = b = y;
        own->solve_transposed(a);
        dense->solve_transposed(b);
        EXPECT_LE(apart(a, b), 1e-9) << m;
        EXPECT_LE(apart(own->start(x), dense->start(x)), 1e-12);
        EXPECT_LE(apart(own->start_transposed(y), dense->start_transposed(y)), 1e-12);
        EXPECT_LE(apart(own->multiply(x.col(0), states), dense->multiply(x.col(0), states)), 1e-12);
        for (const Eigen::Index columns : {Eigen::Index(1), n, n + 2}) {
          MatrixXd here = MatrixXd::Random(n, columns), there = here, sum_here = MatrixXd::Zero(2, columns),
                   sum_there = sum_here;
          own->carry(rows, here, sum_here);
          dense->carry(rows, there, sum_there);
          EXPECT_LE(apart(here, there), 1e-9);
          EXPECT_LE(apart(sum_here, sum_there), 1e-9);
        }
      }
  }
}

namespace {

struct Answer {
  solve::NewtonResult newton;
  solve::Cycle cycle;
  std::vector<std::complex<double>> multipliers;
  MatrixXd monodromy;
};

Answer cycle_of(MPI_Comm comm, const system::Train& t, solve::CycleOptions options) {
  system::RotorSystem s(PETSC_COMM_SELF, t, speed);
  options.degree = 3;
  options.parameter_scale = 10;
  solve::CycleProblem p(comm, s, options, solve::uniform_mesh(30));
  solve::Cycle guess{p.mesh(), MatrixXd(s.size(), 90), 2 * M_PI / speed, speed};
  for (Eigen::Index k = 0; k < 90; ++k) {
    VectorXd x = VectorXd::Zero(s.size());
    x(2) = -0.2;
    x.tail(s.own_states()).setOnes();
    guess.x.col(k) = p.state_scale().cwiseProduct(x);
  }
  core::Vector u = p.scatter(guess), row = core::duplicate(u.get());
  solve::parameter_row(p, row.get());
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  Answer a;
  a.newton = solve::newton(p, u.get(), row.get(), speed / options.parameter_scale, newton);
  EXPECT_TRUE(a.newton.converged) << a.newton.reason;
  p.linearise(u.get(), row.get());
  a.cycle = p.gather(u.get());
  a.multipliers = p.multipliers();
  a.monodromy = p.monodromy();
  return a;
}

void expect_same(const Answer& a, const Answer& b, const char* what) {
  EXPECT_EQ(a.newton.iterations, b.newton.iterations) << what;
  EXPECT_LE((a.cycle.x - b.cycle.x).cwiseAbs().maxCoeff(), 1e-8 * b.cycle.x.cwiseAbs().maxCoeff()) << what;
  EXPECT_LE((a.monodromy - b.monodromy).cwiseAbs().maxCoeff(), 1e-6) << what;
  for (std::size_t k = 0; k < std::min(a.multipliers.size(), b.multipliers.size()) && k < 3; ++k)
    EXPECT_NEAR(std::abs(a.multipliers[k]), std::abs(b.multipliers[k]), 1e-7) << what << k;
}

}  // namespace

// Every way to the same cycle; the dense ones on one rank only, as a reference.
TEST(OwnStates, AllWaysLeadToTheSameCycle) {
  for (const bool damped : {false, true}) {
    system::Support film = support(Kind::compliant_short, false, 0.1, 16);
    if (damped) damp(film);
    const system::Train t = train({film});
    solve::CycleOptions o;
    o.joining = Joining::dense;
    const Answer own = cycle_of(MPI_COMM_WORLD, t, o);
    o.joining = Joining::sweeps;
    const Answer sweeps = cycle_of(MPI_COMM_WORLD, t, o);
    o.joining = Joining::cheapest;
    o.use_structure = false;
    const Answer dense = cycle_of(PETSC_COMM_SELF, t, o);
    const test::WithOptions chosen(test::by_mumps());
    const Answer assembled = cycle_of(MPI_COMM_WORLD, t, o);
    expect_same(own, dense, "condensed");
    expect_same(sweeps, dense, "sweeps");
    expect_same(assembled, dense, "assembled");
    EXPECT_GE(sweeps.multipliers.size(), 3U);
    EXPECT_GT(std::abs(dense.multipliers[0]), 0.3);
  }
}

// Residual and linearisation fit each other for every kind of parameter: remainders of second order, on every way.
TEST(OwnStates, LinearisationIsTheDerivativeForAnyParameter) {
  struct Case {
    const char* name;
    std::function<system::Train(double)> train;
    double value, magnitude;
  };
  const Case cases[] = {
      {"speed", nullptr, speed, speed},
      {"compliance", [](double b) { return train({support(Kind::compliant_short, false, b, 12)}); }, 0.1, 0.1},
      {"mass",
       [](double mass) {
         auto t = train({support(Kind::compliant_short, false, 0.1, 12)});
         t.rotor.mass = mass;
         return t;
       },
       0.5, 0.5},
      {"liner damping",
       [](double tau) {
         auto t = mixed(Mix::damped);
         liner_of(t.supports[0]).liner_damping = tau;
         return t;
       },
       0.3 / 160, 0.3 / 160},
      {"unbalance",
       [](double u) {
         auto t = mixed(Mix::plain);
         t.unbalance[0].amount = u;
         return t;
       },
       2e-6, 2e-6}};
  for (const Case& k : cases) {
    const auto s = k.train ? std::make_unique<system::RotorSystem>(
                                 PETSC_COMM_SELF, system::Varying{k.train, k.value, k.magnitude}, speed)
                           : std::make_unique<system::RotorSystem>(PETSC_COMM_SELF, mixed(Mix::plain), speed);
    EXPECT_NE(s->structure(), nullptr);
    for (const auto joining : {Joining::dense, Joining::sweeps}) {
      solve::CycleOptions o;
      o.degree = 2;
      o.parameter_scale = k.magnitude;
      o.joining = joining;
      solve::CycleProblem p(MPI_COMM_WORLD, *s, o, solve::uniform_mesh(8));
      solve::Cycle guess{p.mesh(), MatrixXd(s->size(), 16), 2 * M_PI / speed, k.value};
      for (Eigen::Index c = 0; c < 16; ++c)
        guess.x.col(c) = p.state_scale().cwiseProduct(state_at(*s, 2 * M_PI * static_cast<double>(c + 1) / 16));
      core::Vector u = p.scatter(guess), row = core::duplicate(u.get()), d = core::duplicate(u.get()),
                   r0 = core::duplicate(u.get()), r1 = core::duplicate(u.get()), jd = core::duplicate(u.get());
      solve::parameter_row(p, row.get());
      core::check(VecSet(r0.get(), 0.0));
      core::check(VecSet(r1.get(), 0.0));
      PetscInt begin = 0;
      core::check(VecGetOwnershipRange(d.get(), &begin, nullptr));
      {
        const core::WriteArray a(d.get());
        for (PetscInt i = 0; i < a.size(); ++i) a[i] = std::sin(1 + 3.7 * static_cast<double>(begin + i));
      }
      p.residual(u.get(), r0.get());
      p.linearise(u.get(), row.get());
      p.multiply(d.get(), jd.get());
      solve::set_last_entry(MPI_COMM_WORLD, jd.get(), 0);
      double remainder[2], change = 0;
      for (int q = 0; q < 2; ++q) {
        const double h = 1e-3 / (q + 1);
        core::Vector moved = core::duplicate(u.get());
        core::check(VecWAXPY(moved.get(), h, d.get(), u.get()));
        p.residual(moved.get(), r1.get());
        core::check(VecAXPY(r1.get(), -1, r0.get()));
        solve::set_last_entry(MPI_COMM_WORLD, r1.get(), 0);
        core::check(VecNorm(r1.get(), NORM_2, &change));
        core::check(VecAXPY(r1.get(), -h, jd.get()));
        core::check(VecNorm(r1.get(), NORM_2, &remainder[q]));
      }
      EXPECT_GT(change, 1e-6);
      EXPECT_NEAR(std::log2(remainder[0] / remainder[1]), 2, 0.1) << k.name;

      // The inverse inverts, although other parameters have been looked at since.
      core::Vector back = core::duplicate(u.get()), x = core::duplicate(u.get());
      double error = 0, size = 0;
      p.solve(d.get(), x.get());
      p.multiply(x.get(), back.get());
      core::check(VecAXPY(back.get(), -1, d.get()));
      core::check(VecNorm(back.get(), NORM_2, &error));
      core::check(VecNorm(d.get(), NORM_2, &size));
      EXPECT_LE(error, 1e-6 * size) << k.name;
    }
  }
}

// Pressures of a damped liner depend on rates, and their cut-off makes the force bend in these: the rates of all states
// must be found together, at the state itself.
TEST(OwnStates, RatesOfDampedLinersSolveTheEquations) {
  system::Support one = support(Kind::compliant_short, false, 0.1, 20);
  damp(one);
  system::RotorSystem s(PETSC_COMM_SELF, train({one}), speed);
  problem::ScaledPoint point(s, nullptr);
  VectorXd x = VectorXd::Zero(s.size()), f(s.size());
  x.head(4) << 0.1, 0.3, -0.2, 0.2;
  for (Eigen::Index k = 4; k < x.size(); ++k) x(k) = 1.1 + 0.2 * std::sin(1.7 * static_cast<double>(k));
  point.residual(0, x, VectorXd::Zero(s.size()), f);
  const double at_rest = f.lpNorm<Eigen::Infinity>();
  point.residual(0, x, point.rate(0, x), f);
  EXPECT_LE(f.lpNorm<Eigen::Infinity>(), 1e-9 * at_rest);
}

// 1100 films of 2 million states: refused before any of them is made.
TEST(OwnStates, MoreThanPetscCountsAreRefused) {
  system::Support one = support(Kind::compliant_short, false, 0.1, 20);
  film::Reynolds film;
  film.cavitation = film::Reynolds::Cavitation::mass_conserving;
  film.states = film::Reynolds::States::dynamic;
  film.cells = {2000, 2000};
  one.film = film;
  const system::Train large = train(std::vector<system::Support>(1100, one));
  try {
    system::RotorSystem s(PETSC_COMM_WORLD, large, speed);
    ADD_FAILURE() << "no error";
  } catch (const core::InputError& e) {
    EXPECT_TRUE(e.agreed());
    EXPECT_NE(std::string(e.what()).find("own states of films: 2200000000"), std::string::npos) << e.what();
  }
}
