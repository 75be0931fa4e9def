// Cycles by collocation with the states spread over ranks: the numbers of collocation on one rank, on any number.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/cycle_rows.hpp"
#include "support/finite_rotor.hpp"
#include "support/solved_cycle.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"
#include "whirl/solve/cycle/spread_collocation.hpp"
#include "whirl/solve/newton/newton.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;

namespace {

constexpr double scale = test::finite_speed_scale;

struct Case {
  system::Train train;
  double speed;
  std::vector<double> parts;  // of the speed, on the way to rest
  bool liner = true;
};

// Half a rotor on a liner of finite length, a* = 0.2.
Case liner() {
  return {test::finite_rotor(12, 4), 4.5 * scale, {0.1, 0.25, 0.5, 1}, true};
}

// The same in a bore whose film carries its content along, a* = 0.1, with a groove at the top under 20 kPa.
Case content(int around = 8, int along = 2) {
  Case out{test::finite_rotor(around, along), 2.2 * scale, {4, 2, 1}, false};
  film::Reynolds film;
  film.cavitation = film::Reynolds::Cavitation::mass_conserving;
  film.states = film::Reynolds::States::dynamic;
  film.cells = {around, along};
  film.grooves = {{std::numbers::pi / 2, std::numbers::pi / 6, 20e3}};
  out.train.supports[0].film = film;
  out.train.unbalance = {{1, 0.5 * 2.5e-6, 0}};
  return out;
}

solve::Cycle at_rest(system::RotorSystem& s, const Case& c) {
  s.set_forcing(false);
  core::Vector x = system::static_guess(s);
  for (const double part : c.parts) {
    s.set_parameter(part * c.speed);
    solve::NewtonOptions newton;
    newton.max_iterations = 40;
    EXPECT_TRUE(solve::find_equilibrium(s, x.get(), newton).converged) << part;
  }
  s.set_forcing(true);
  const std::vector<double> whole = s.gather(x.get());
  return {{0, 1},
          Eigen::Map<const Eigen::VectorXd>(whole.data(), static_cast<Eigen::Index>(whole.size())),
          2 * std::numbers::pi / c.speed,
          c.speed};
}

using Answer = test::SolvedCycle;

template <class Problem>
Answer solved(Problem& problem, const Case& c, const solve::Cycle& rest, const problem::System& system) {
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  newton.tolerance = 1e-11;
  Answer out = test::solved(problem, test::rows_of(rest, system), c.speed / scale, newton);
  out.cycle = test::whole_of(std::move(out.cycle), system);
  return out;
}

double least_film(const solve::Cycle& cycle, const system::RotorSystem& s) {
  double least = 1;
  for (Eigen::Index k = 0; k < cycle.x.cols(); ++k)
    least = std::min(least, s.film_thickness(cycle.x.col(k).data()).front());
  return least;
}

// All ranks share a machine, or each holds one and they share the intervals.
class Ranks {
public:
  explicit Ranks(bool in_time) {
    const int rank = core::rank_of(MPI_COMM_WORLD), size = core::size_of(MPI_COMM_WORLD), each = in_time ? 1 : size;
    MPI_Comm_split(MPI_COMM_WORLD, rank / each, rank, &space_);
    MPI_Comm_split(MPI_COMM_WORLD, rank % each, rank, &time_);
  }
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  ~Ranks() {
    MPI_Comm_free(&space_);
    MPI_Comm_free(&time_);
  }
  [[nodiscard]] MPI_Comm space() const { return space_; }
  [[nodiscard]] solve::TimeGroups groups() const { return {MPI_COMM_WORLD, time_}; }

private:
  MPI_Comm space_ = MPI_COMM_NULL, time_ = MPI_COMM_NULL;
};

solve::SpreadCollocationOptions options(int degree) {
  solve::SpreadCollocationOptions o;
  o.parameter_scale = scale;
  o.degree = degree;
  o.radius = 0.2;
  return o;
}

// The map over one period: motions of multipliers, and second derivatives along a motion.
void expect_the_same_map(solve::CycleProblem& dense, const Answer& expected, solve::SpreadCollocation& spread,
                         const Answer& found, const problem::System& s, double radius) {
  const Eigen::Index n = s.size();
  const auto rows = [&](const Eigen::VectorXd& v) { return Eigen::VectorXd(test::rows_of({{0, 1}, v, 1, 1}, s).x); };
  const auto whole = [&](const Eigen::VectorXd& v) { return Eigen::VectorXd(test::whole_of({{0, 1}, v, 1, 1}, s).x); };
  const Eigen::MatrixXd m = dense.monodromy();
  for (const auto& mu : found.multipliers) {
    if (std::abs(mu) < radius) continue;
    const Eigen::VectorXcd q = spread.multiplier_vector(mu);
    const Eigen::VectorXd re = whole(q.real()), im = whole(q.imag());
    const double size = std::hypot(re.norm(), im.norm());
    EXPECT_LE((m * re - mu.real() * re + mu.imag() * im).norm(), 1e-6 * size) << mu;
    EXPECT_LE((m * im - mu.real() * im - mu.imag() * re).norm(), 1e-6 * size) << mu;
  }
  EXPECT_EQ(spread.multiplier_vector(3).size(), 0);
  const auto second = [](solve::PeriodicProblem& problem, const solve::Cycle& cycle, const Eigen::VectorXd& start) {
    const core::Vector u = problem.scatter(cycle);
    const solve::Path path = problem.forward(start);
    constexpr double step = 1e-4;
    const Eigen::MatrixXd ahead = problem.tangents(u.get(), step, path, {&path})[0],
                          behind = problem.tangents(u.get(), -step, path, {&path})[0];
    Eigen::VectorXd end;
    (void)problem.forced((ahead - behind) / (2 * step), end);
    return end;
  };
  const Eigen::VectorXd start = Eigen::VectorXd::LinSpaced(n, 1, 7).array().sin();
  const Eigen::VectorXd a = second(dense, expected.cycle, start),
                        b = whole(second(spread, test::rows_of(found.cycle, s), rows(start)));
  EXPECT_LE((a - b).norm(), 1e-6 * a.norm());
}

void compare(const Case& c, int degree, const std::vector<double>& mesh, const solve::SpreadCollocationOptions& o,
             bool in_time = false) {
  const Ranks ranks(in_time);
  system::RotorSystem alone(PETSC_COMM_SELF, c.train, c.speed), s(ranks.space(), c.train, c.speed);
  const solve::Cycle rest = at_rest(alone, c);
  solve::CycleOptions one;
  one.parameter_scale = scale;
  one.degree = degree;
  solve::CycleProblem dense(PETSC_COMM_SELF, alone, one, mesh);
  const Answer expected = solved(dense, c, rest, alone);
  solve::SpreadCollocation spread(s, o, mesh, ranks.groups());
  const Answer found = solved(spread, c, rest, s);
  EXPECT_LE(found.iterations, expected.iterations + 2);
  const Eigen::VectorXd unit = dense.state_scale();
  const Eigen::MatrixXd a = unit.cwiseInverse().asDiagonal() * expected.cycle.x,
                        b = unit.cwiseInverse().asDiagonal() * found.cycle.x;
  EXPECT_LE((a - b).cwiseAbs().maxCoeff(), 1e-8 * a.cwiseAbs().maxCoeff());
  EXPECT_GT((a.colwise() - a.rowwise().mean()).cwiseAbs().maxCoeff(), 0.01);  // it moves
  int large = 0;
  for (const auto& mu : spectral::eigenvalues(dense.monodromy())) {
    if (std::abs(mu) < o.radius) continue;
    ++large;
    double nearest = 1;
    for (const auto& nu : found.multipliers) nearest = std::min(nearest, std::abs(mu - nu));
    EXPECT_LE(nearest, 1e-8) << mu;
  }
  EXPECT_GT(large, 0);
  expect_the_same_map(dense, expected, spread, found, s, o.radius);
  EXPECT_EQ(large, std::count_if(found.multipliers.begin(), found.multipliers.end(),
                                 [&](auto z) { return std::abs(z) >= o.radius; }));
  EXPECT_NEAR(least_film(found.cycle, alone), least_film(expected.cycle, alone),
              1e-8 * c.train.supports[0].geometry.clearance);
}

std::vector<double> uneven(int intervals) {
  std::vector<double> mesh = solve::uniform_mesh(intervals);
  mesh.insert(mesh.begin() + 3, (mesh[2] + mesh[3]) / 2);
  return mesh;
}

}  // namespace

TEST(SpreadCollocation, IsCollocationOnLiners) {
  const Case c = liner();
  compare(c, 2, uneven(10), options(2));
}

TEST(SpreadCollocation, IsCollocationOfHigherDegree) {
  const Case c = liner();
  compare(c, 3, uneven(6), options(3));
}

TEST(SpreadCollocation, IsCollocationOnContents) {
  const Case c = content();
  auto o = options(2);
  o.radius = 0.05;  // oil that a groove renews forgets
  compare(c, 2, solve::uniform_mesh(5), o);
}

TEST(SpreadCollocation, RanksShareIntervals) {
  compare(liner(), 2, uneven(10), options(2), true);
  auto o = options(2);
  o.radius = 0.05;
  compare(content(), 2, solve::uniform_mesh(5), o, true);
}

// One group has a journal outside its bearing.
TEST(SpreadCollocation, ErrorsOfOneGroupAreThoseOfAll) {
  const Case c = liner();
  const Ranks ranks(true);
  system::RotorSystem alone(PETSC_COMM_SELF, c.train, c.speed), s(ranks.space(), c.train, c.speed);
  solve::SpreadCollocation spread(s, options(2), solve::uniform_mesh(6), ranks.groups());
  solve::Cycle cycle = at_rest(alone, c);
  cycle.mesh = spread.mesh();
  cycle.x = cycle.x.replicate(1, 12).eval();
  core::Vector u = spread.scatter(test::rows_of(cycle, s)), row = core::duplicate(u.get()),
               y = core::duplicate(u.get());
  EXPECT_NO_THROW(spread.residual(u.get(), y.get()));
  cycle.x(0, 11) = 10 * c.train.supports[0].geometry.clearance;
  u = spread.scatter(test::rows_of(cycle, s));
  solve::parameter_row(spread, row.get());
  for (const bool derivatives : {false, true}) try {
      derivatives ? spread.linearise(u.get(), row.get()) : spread.residual(u.get(), y.get());
      ADD_FAILURE() << "no error";
    } catch (const core::DomainError& e) {
      EXPECT_TRUE(e.agreed() || core::size_of(MPI_COMM_WORLD) == 1) << e.what();
    }
  EXPECT_FALSE(spread.settle(u.get()));
}

TEST(SpreadCollocation, RefusesMoreGroupsThanIntervals) {
  if (core::size_of(MPI_COMM_WORLD) == 1) GTEST_SKIP() << "one group";
  const Case c = liner();
  const Ranks ranks(true);
  system::RotorSystem s(ranks.space(), c.train, c.speed);
  EXPECT_THROW(solve::SpreadCollocation(s, options(2), {0, 1}, ranks.groups()), core::InputError);
}

// The radius of the search for multipliers stands in checkpoints: another object looks for the same ones.
TEST(SpreadCollocation, GoesOnWithItsRadius) {
  const Case c = liner();
  system::RotorSystem s(MPI_COMM_WORLD, c.train, c.speed);
  auto o = options(2);
  o.radius = 0.05;
  solve::SpreadCollocation first(s, o, solve::uniform_mesh(5));
  o.radius = 0.2;
  solve::SpreadCollocation second(s, o, solve::uniform_mesh(5));
  second.take_warm_start(std::vector<double>(9, 0.7));  // of a cycle that one rank held
  EXPECT_EQ(second.warm_start(), std::vector<double>{0.2});
  second.take_warm_start(first.warm_start());
  EXPECT_EQ(second.warm_start(), std::vector<double>{0.05});
}

// Whatever the films hold at first, the motion of the hub decides what becomes of them.
TEST(SpreadCollocation, SettlesFilmsWithTheHubHeld) {
  for (const Case& c : {liner(), content()}) {
    // Newton's method on contents settles them on any number of ranks, see above; three ranks on two cores are slow.
    if (core::size_of(MPI_COMM_WORLD) > 1 && !c.liner) continue;
    system::RotorSystem alone(PETSC_COMM_SELF, c.train, c.speed), s(MPI_COMM_WORLD, c.train, c.speed);
    solve::SpreadCollocation spread(s, options(2), solve::uniform_mesh(5));
    const Answer found = solved(spread, c, at_rest(alone, c), s);
    solve::Cycle other = found.cycle;
    constexpr int hub = 4;
    other.x.bottomRows(other.x.rows() - hub) *= 0.99;
    core::Vector u = spread.scatter(test::rows_of(other, s));
    ASSERT_TRUE(spread.settle(u.get()));
    const solve::Cycle settled = test::whole_of(spread.gather(u.get()), s);
    const double size = found.cycle.x.bottomRows(other.x.rows() - hub).cwiseAbs().maxCoeff();
    EXPECT_LE((settled.x - found.cycle.x).cwiseAbs().maxCoeff(), 1e-7 * size);
    EXPECT_LE((settled.x - other.x).topRows(hub).cwiseAbs().maxCoeff(), 1e-12 * size);
  }
}

// Which nodes are full differs from point to point of an interval, and no two points have similar matrices.
static void settle_fronts(bool in_time) {
  const Case c = content(48, 6);
  const Ranks ranks(in_time);
  system::RotorSystem alone(PETSC_COMM_SELF, c.train, c.speed), s(ranks.space(), c.train, c.speed);
  solve::SpreadCollocation spread(s, options(2), solve::uniform_mesh(8), ranks.groups());
  solve::CycleOptions one;
  one.parameter_scale = scale;
  one.degree = 2;
  solve::CycleProblem dense(PETSC_COMM_SELF, alone, one, spread.mesh());
  solve::Cycle orbit = at_rest(alone, c);
  orbit.mesh = spread.mesh();
  orbit.x = orbit.x.replicate(1, 16).eval();
  for (Eigen::Index k = 0; k < 16; ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k + 1) / 16;
    orbit.x(0, k) += 5e-6 * std::cos(angle);
    orbit.x(2, k) += 5e-6 * std::sin(angle);
  }
  core::Vector u = spread.scatter(test::rows_of(orbit, s)), v = dense.scatter(orbit);
  ASSERT_TRUE(spread.settle(u.get()));
  ASSERT_TRUE(dense.settle(v.get()));
  const Eigen::MatrixXd found = test::whole_of(spread.gather(u.get()), s).x, expected = dense.gather(v.get()).x;
  EXPECT_GT((expected - orbit.x).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LE((found - expected).cwiseAbs().maxCoeff(), 1e-8 * 25e-6);
}

TEST(SpreadCollocation, SettlesWhereFrontsMoveWithinAnInterval) {
  settle_fronts(false);
  if (core::size_of(MPI_COMM_WORLD) > 1) settle_fronts(true);
}

static void adapt_mesh(bool in_time) {
  const Case c = liner();
  const Ranks ranks(in_time);
  system::RotorSystem alone(PETSC_COMM_SELF, c.train, c.speed), s(ranks.space(), c.train, c.speed);
  auto o = options(2);
  o.mesh_tolerance = 1e-4;
  o.base_intervals = 8;
  solve::SpreadCollocation spread(s, o, solve::uniform_mesh(8), ranks.groups());
  solve::CycleOptions one;
  one.parameter_scale = scale;
  one.mesh_tolerance = o.mesh_tolerance;
  one.base_intervals = o.base_intervals;
  solve::CycleProblem dense(PETSC_COMM_SELF, alone, one, solve::uniform_mesh(8));
  const Answer first = solved(dense, c, at_rest(alone, c), alone);
  const auto adapted = [&](auto& problem, const problem::System& system) {
    core::Vector u = problem.scatter(test::rows_of(first.cycle, system)), tangent = problem.make_unknown();
    EXPECT_TRUE(problem.adapt(u, tangent));
    core::Vector row = core::duplicate(u.get());
    solve::parameter_row(problem, row.get());
    EXPECT_TRUE(solve::newton(problem, u.get(), row.get(), c.speed / scale, {}).converged);
    return test::whole_of(problem.gather(u.get()), system);
  };
  const solve::Cycle a = adapted(dense, alone), b = adapted(spread, s);
  ASSERT_EQ(a.mesh, b.mesh);
  EXPECT_GT(a.intervals(), 8);
  EXPECT_LE((a.x - b.x).cwiseAbs().maxCoeff(), 1e-7 * a.x.cwiseAbs().maxCoeff());
}

TEST(SpreadCollocation, AdaptsItsMesh) {
  adapt_mesh(false);
  if (core::size_of(MPI_COMM_WORLD) > 1) adapt_mesh(true);
}

static void products_are_derivatives(const Case& c, bool autonomous, bool in_time) {
  const Ranks ranks(in_time);
  system::RotorSystem alone(PETSC_COMM_SELF, c.train, c.speed), s(ranks.space(), c.train, c.speed);
  solve::Cycle cycle = at_rest(alone, c);
  s.set_forcing(!autonomous);
  auto o = options(3);
  o.autonomous = autonomous;
  solve::SpreadCollocation spread(s, o, uneven(6), ranks.groups());
  cycle.x = cycle.x.replicate(1, 3 * 7).eval();
  cycle.mesh = spread.mesh();
  for (Eigen::Index k = 0; k < cycle.x.cols(); ++k)
    for (Eigen::Index i = 0; i < cycle.x.rows(); ++i)
      cycle.x(i, k) *= 1 + 0.02 * std::sin(0.3 * static_cast<double>(k) + 1.7 * static_cast<double>(i));
  cycle = test::rows_of(cycle, s);
  if (autonomous) spread.set_phase_reference(cycle);
  core::Vector u = spread.scatter(cycle), row = core::duplicate(u.get()), v = core::duplicate(u.get()),
               y = core::duplicate(u.get()), above = core::duplicate(u.get()), below = core::duplicate(u.get());
  PetscInt begin = 0;
  core::check(VecGetOwnershipRange(v.get(), &begin, nullptr));
  {
    const core::WriteArray a(v.get());
    for (PetscInt k = 0; k < a.size(); ++k) a[k] = std::sin(1 + 0.37 * static_cast<double>(begin + k));
  }
  solve::set_last_entry(spread.comm(), v.get(), 0.5);
  solve::parameter_row(spread, row.get());
  spread.linearise(u.get(), row.get());
  spread.multiply(v.get(), y.get());
  constexpr double step = 1e-6;
  core::check(VecAXPY(u.get(), step, v.get()));
  spread.residual(u.get(), above.get());
  core::check(VecAXPY(u.get(), -2 * step, v.get()));
  spread.residual(u.get(), below.get());
  core::check(VecAXPY(above.get(), -1, below.get()));
  core::check(VecAXPBY(above.get(), 1, -1 / (2 * step), y.get()));
  solve::set_last_entry(spread.comm(), above.get(), 0);
  EXPECT_LE(core::norm(above.get()), 1e-6 * core::norm(y.get())) << autonomous;
  // And what is solved for comes back.
  core::Vector back = core::duplicate(v.get());
  EXPECT_LE(solve::solve_linear(spread, y.get(), back.get(), "tangent_"), 8);
  core::check(VecAXPY(back.get(), -1, v.get()));
  EXPECT_LE(core::norm(back.get()), 1e-6 * core::norm(v.get())) << autonomous;
}

// With the speed as the unknown of a forced cycle, and with the period beside it on a self-excited one.
TEST(SpreadCollocation, ProductsAreDerivativesOfTheResidual) {
  const Case c = liner();
  for (const bool in_time : {false, true})
    for (const bool autonomous : {false, true}) products_are_derivatives(c, autonomous, in_time);
}

// Time points times states outgrow what PETSc counts long before the states do.
TEST(SpreadCollocation, TooManyUnknownsAreRefused) {
  const Case c = content(80, 20);
  system::RotorSystem s(PETSC_COMM_WORLD, c.train, c.speed);
  std::vector<double> mesh(2'400'001);
  for (std::size_t i = 0; i < mesh.size(); ++i) mesh[i] = static_cast<double>(i) / static_cast<double>(mesh.size() - 1);
  try {
    const solve::SpreadCollocation cycle(s, {}, mesh);
    ADD_FAILURE() << "no error";
  } catch (const core::InputError& e) {
    EXPECT_TRUE(e.agreed());
    EXPECT_NE(std::string(e.what()).find("2147483647"), std::string::npos) << e.what();
  }
}
