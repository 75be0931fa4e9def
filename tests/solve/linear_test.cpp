// The linear algebra of cycles: derivatives, inverses, the three paths to a Newton step, any number of ranks.

#include <gtest/gtest.h>

#include <algorithm>

#include "cycle_systems.hpp"
#include "support/petsc_options.hpp"

using namespace whirl;
using test::Column;

namespace {

struct Load {
  bool forced;
  template <class T>
  Column<T> operator()(double angle, T p) const {
    Column<T> u = Column<T>::Zero(5);
    u(1) = forced ? 0.4 * p * p * std::cos(angle) : T(0.0);
    u(3) = 0.3 + (forced ? 0.2 * std::sin(2 * angle) : 0.0);
    return u;
  }
};
struct Forces {
  template <class T>
  Column<T> operator()(const Column<T>& w, T p) const {
    Column<T> f(2);
    f << p * (1.0 - w(0) * w(0)) * w(1), -0.1 * w(2) * w(2) * w(2) + 0.1 * sin(w(0)) * p;
    return f;
  }
};

// Van der Pol's oscillator with a damped neighbour and a first-order lag, as linear blocks and two forces.
std::unique_ptr<test::StructuredSystem> make_system(double p, double speed, bool forced) {
  test::Blocks blocks;
  blocks.l1 = Eigen::MatrixXd::Identity(5, 5);
  blocks.l1(4, 3) = 0.2;
  blocks.l0.resize(5, 5);
  blocks.l0 << 0, -1, 0, 0, 0,  //
      1.2, 0, -0.2, 0, 0.1,     //
      0, 0, 0, -1, 0,           //
      -0.2, 0, 2.2, 0.6, 0,     //
      -0.5, 0, 0, 0, 3;
  blocks.l0p = Eigen::MatrixXd::Zero(5, 5);
  blocks.l0p(3, 3) = 0.3;
  blocks.b = Eigen::MatrixXd::Zero(5, 2);
  blocks.b(1, 0) = blocks.b(3, 1) = 1;
  blocks.c = Eigen::MatrixXd::Zero(3, 5);
  blocks.c(0, 0) = blocks.c(1, 1) = 1;
  blocks.c(2, 2) = 1;
  blocks.c(2, 4) = 0.5;
  auto s = std::make_unique<test::StructuredSystem>(p, speed, blocks, Load{forced}, Forces{});
  Eigen::VectorXd scale(5), rows(5);
  scale << 2, 3, 0.5, 0.5, 1;
  rows << 1, 2, 0.5, 1, 3;
  s->set_scales(scale, rows);
  return s;
}

struct Case {
  const char* name;
  bool autonomous;
  double speed;  // 0: the parameter is the speed
};
constexpr Case cases[] = {{"speed", false, 0}, {"other parameter", false, 1.0}, {"autonomous", true, 1}};
constexpr double parameter = 1.1;

struct Prepared {
  std::unique_ptr<test::StructuredSystem> system;
  std::unique_ptr<solve::CycleProblem> problem;
  core::Vector u, row;
};

Prepared make(MPI_Comm comm, const Case& c, solve::Points points, bool structure) {
  Prepared s;
  s.system = make_system(parameter, c.speed, !c.autonomous);
  solve::CycleOptions o;
  o.degree = 3;
  o.points = points;
  o.autonomous = c.autonomous;
  o.parameter_scale = 0.5;
  o.state_weight = 0.7;
  o.use_structure = structure;
  s.problem = std::make_unique<solve::CycleProblem>(comm, *s.system, o, test::uneven_mesh(1));
  const auto guess =
      test::sampled(s.problem->scheme(), s.problem->mesh(), c.autonomous ? 6.3 : 0, parameter, [](double a) {
        Eigen::VectorXd x(5);
        x << 2 * std::sin(a), 2 * std::cos(a), 0.3 * std::cos(a + 1), 0.3 * std::sin(a), 0.2 * std::cos(a);
        return x;
      });
  if (c.autonomous) s.problem->set_phase_reference(guess);
  s.u = s.problem->scatter(guess);
  s.row = core::duplicate(s.u.get());
  solve::weighted_row(*s.problem, s.u.get(), s.row.get());
  return s;
}

// The same numbers on any number of ranks.
void fill(Vec v, double seed) {
  PetscInt begin = 0;
  core::check(VecGetOwnershipRange(v, &begin, nullptr));
  const core::WriteArray a(v);
  for (PetscInt i = 0; i < a.size(); ++i) a[i] = std::sin(seed + 78.233 * static_cast<double>(begin + i) * (1 + seed));
}

double norm(Vec v) {
  double n = 0;
  core::check(VecNorm(v, NORM_2, &n));
  return n;
}

}  // namespace

TEST(CycleLinear, SolveIsTheInverseOfMultiply) {
  for (const Case& c : cases)
    for (const auto points : {solve::Points::radau, solve::Points::gauss})
      for (const bool structure : {true, false}) {
        const Prepared s = make(MPI_COMM_WORLD, c, points, structure);
        s.problem->linearise(s.u.get(), s.row.get());
        core::Vector r = core::duplicate(s.u.get()), x = core::duplicate(r.get()), back = core::duplicate(r.get());
        for (const double seed : {0.3, 1.7}) {
          fill(r.get(), seed);
          s.problem->solve(r.get(), x.get());
          s.problem->multiply(x.get(), back.get());
          core::check(VecAXPY(back.get(), -1, r.get()));
          EXPECT_LE(norm(back.get()), 1e-10 * norm(r.get())) << c.name << " " << structure;
        }
      }
}

// Of the second linearisation, too: the matrix is kept and filled again.
TEST(CycleLinear, MatrixMultipliesAlike) {
  for (const Case& c : cases)
    for (const bool structure : {true, false}) {
      const Prepared s = make(MPI_COMM_WORLD, c, solve::Points::radau, structure);
      EXPECT_EQ(s.problem->matrix(), nullptr);
      core::Vector v = core::duplicate(s.u.get()), y = core::duplicate(v.get()), z = core::duplicate(v.get());
      for (const double seed : {0.3, 1.7}) {
        core::check(VecScale(s.u.get(), 1 + 0.01 * seed));
        s.problem->linearise(s.u.get(), s.row.get());
        fill(v.get(), seed);
        s.problem->multiply(v.get(), y.get());
        core::check(MatMult(s.problem->matrix(), v.get(), z.get()));
        core::check(VecAXPY(z.get(), -1, y.get()));
        EXPECT_LE(norm(z.get()), 1e-12 * norm(y.get())) << c.name << " " << structure;
      }
    }
}

TEST(CycleLinear, MultiplyIsTheDerivativeOfTheResidual) {
  for (const Case& c : cases)
    for (const bool structure : {true, false}) {
      const Prepared s = make(MPI_COMM_WORLD, c, solve::Points::radau, structure);
      core::Vector r0 = core::duplicate(s.u.get()), r1 = core::duplicate(r0.get()), d = core::duplicate(r0.get()),
                   jd = core::duplicate(r0.get()), moved = core::duplicate(r0.get());
      core::check(VecSet(r0.get(), 0.0));
      core::check(VecSet(r1.get(), 0.0));
      s.problem->residual(s.u.get(), r0.get());
      s.problem->linearise(s.u.get(), s.row.get());
      fill(d.get(), 0.9);
      double remainder[2];
      for (int k = 0; k < 2; ++k) {
        const double h = 1e-3 / (k + 1);
        core::check(VecWAXPY(moved.get(), h, d.get(), s.u.get()));
        // Elsewhere the residual has other linear blocks; the linearisation must keep its own.
        s.problem->residual(moved.get(), r1.get());
        s.problem->multiply(d.get(), jd.get());
        solve::set_last_entry(MPI_COMM_WORLD, jd.get(), 0);
        core::check(VecAXPY(r1.get(), -1, r0.get()));
        core::check(VecAXPY(r1.get(), -h, jd.get()));
        solve::set_last_entry(MPI_COMM_WORLD, r1.get(), 0);
        remainder[k] = norm(r1.get());
      }
      EXPECT_NEAR(std::log2(remainder[0] / remainder[1]), 2, 0.05) << c.name << " " << structure;
    }
}

TEST(CycleLinear, ThreePathsTakeTheSameNewtonSteps) {
  for (const Case& c : cases)
    for (int steps = 1; steps <= 4; ++steps) {
      Eigen::MatrixXd x[3];
      double period[3];
      for (const int path : {0, 1, 2}) {
        const Prepared s = make(MPI_COMM_WORLD, c, solve::Points::radau, path == 0);
        const test::WithOptions chosen(path == 2 ? test::by_mumps() : test::WithOptions::List{});
        solve::NewtonOptions o;
        o.max_iterations = steps;
        (void)test::solve_at(*s.problem, s.u.get(), parameter, o);
        const solve::Cycle cycle = s.problem->gather(s.u.get());
        x[path] = cycle.x;
        period[path] = cycle.period;
      }
      for (const int path : {1, 2}) {
        EXPECT_LE((x[path] - x[0]).cwiseAbs().maxCoeff(), 1e-8) << c.name << " step " << steps << " path " << path;
        EXPECT_NEAR(period[path], period[0], 1e-8);
      }
    }
}

TEST(CycleLinear, AnyNumberOfRanksSolvesTheSame) {
  for (const Case& c : cases) {
    const Prepared all = make(MPI_COMM_WORLD, c, solve::Points::radau, true),
                   one = make(PETSC_COMM_SELF, c, solve::Points::radau, true);
    solve::NewtonOptions o;
    o.max_iterations = 30;
    const auto a = test::solve_at(*all.problem, all.u.get(), parameter, o),
               b = test::solve_at(*one.problem, one.u.get(), parameter, o);
    EXPECT_TRUE(a.converged) << c.name << a.reason;
    EXPECT_EQ(a.iterations, b.iterations);
    const solve::Cycle ca = all.problem->gather(all.u.get()), cb = one.problem->gather(one.u.get());
    EXPECT_LE((ca.x - cb.x).cwiseAbs().maxCoeff(), 1e-11);
    EXPECT_NEAR(ca.period, cb.period, 1e-11);
    all.problem->linearise(all.u.get(), all.row.get());
    one.problem->linearise(one.u.get(), one.row.get());
    EXPECT_LE((all.problem->monodromy() - one.problem->monodromy()).cwiseAbs().maxCoeff(), 1e-10);
  }
}

// x'' + 0.2 x' + x = 0 from (1, 0): exp(-0.1 t) (cos w t + 0.1/w sin w t), w^2 = 0.99.
TEST(CycleLinear, PropagatesAStartOverThePeriod) {
  test::SmallSystem s(PETSC_COMM_SELF, 2, 1.3, 0, test::LinearOscillator{});
  solve::CycleOptions o;
  o.degree = 4;
  solve::CycleProblem problem(MPI_COMM_WORLD, s, o, test::uneven_mesh(2));
  const auto rest = [](double) { return Eigen::VectorXd(Eigen::Vector2d::Zero()); };
  core::Vector u = problem.scatter(test::sampled(problem.scheme(), problem.mesh(), 1, 1.3, rest)),
               row = core::duplicate(u.get());
  solve::parameter_row(problem, row.get());
  problem.linearise(u.get(), row.get());
  const Eigen::Vector2d start(1, 0);
  const Eigen::MatrixXd x = problem.propagate(start);
  EXPECT_LE((x.rightCols(1) - problem.monodromy() * start).cwiseAbs().maxCoeff(), 1e-13);
  const double w = std::sqrt(0.99), period = test::two_pi / 1.3;
  for (Eigen::Index i = 0; i + 1 < static_cast<Eigen::Index>(problem.mesh().size()); ++i) {
    const double t = period * problem.mesh()[static_cast<std::size_t>(i) + 1];
    EXPECT_NEAR(x(0, 4 * i + 3), std::exp(-0.1 * t) * (std::cos(w * t) + 0.1 / w * std::sin(w * t)), 1e-8);
  }
}
