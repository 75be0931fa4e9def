// Films that follow the slope of the shaft: forces and moments on x, y and both slopes of the journal.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/dense.hpp"
#include "support/overhung.hpp"
#include "whirl/core/error.hpp"
#include "whirl/film/sheet/thickness.hpp"
#include "whirl/problem/structure.hpp"
#include "whirl/problem/taylor.hpp"
#include "whirl/rotor/alignment.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/solve/newton/equilibrium.hpp"

using namespace whirl;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::equilibrium;
using test::overhung;
using test::pads;

namespace {

constexpr double speed = 300;

// Away from x, moving, the same on any number of ranks; displacements and slopes alike.
void disturb(Vec x, double size) {
  PetscInt begin = 0;
  core::check(VecGetOwnershipRange(x, &begin, nullptr));
  const core::WriteArray a(x);
  for (PetscInt i = 0; i < a.size(); ++i)
    a[i] += size * std::sin(3.7 * static_cast<double>(begin + i)) * ((begin + i) % 2 ? 300 : 1);
}

}  // namespace

TEST(Tilt, DerivativesPassTheTaylorTest) {
  for (const auto type : {rotor::Reduction::Type::none, rotor::Reduction::Type::guyan}) {
    system::Train t = overhung(true);
    t.rotor.reduction.type = type;
    t.rotor.reduction.masters = {1, 3, 5, 7};
    t.rotor.reduction.slopes = {1, 5};
    system::RotorSystem s(MPI_COMM_WORLD, t, speed);
    ASSERT_EQ(s.ports(0), 4);
    core::Vector x = s.guess(), rate = core::duplicate(x.get());
    disturb(x.get(), 3e-6);
    core::check(VecSet(rate.get(), 0.0));
    disturb(rate.get(), 1e-3);
    const auto r = problem::taylor_test(s, 0.7, x.get(), rate.get(), 1e-3);
    EXPECT_GT(r.first_difference, 1e-6);
    EXPECT_GE(r.state_order, 1.9);
    EXPECT_GE(r.rate_order, 1.9);
    EXPECT_GE(r.parameter_order, 1.9);
  }
}

// Parameters that move the axes of bearings: an elevation, with which the line of the shaft turns, and a slope given.
TEST(Tilt, AxesAsParameters) {
  for (const bool elevation : {true, false}) {
    system::Varying varying;
    varying.train = [elevation](double p) {
      system::Train t = overhung(true);
      if (elevation)
        t.supports[0].elevation = p;
      else
        t.supports[1].slope = {{1e-5, p}};
      return t;
    };
    varying.value = elevation ? 3e-5 : 4e-4;
    varying.magnitude = 1e-4;
    system::RotorSystem s(MPI_COMM_WORLD, varying, speed);
    const double before = s.axis(1)[1];
    core::Vector x = s.guess(), rate = core::duplicate(x.get());
    disturb(x.get(), 3e-6);
    core::check(VecSet(rate.get(), 0.0));
    disturb(rate.get(), 1e-3);
    const auto r = problem::taylor_test(s, 0.7, x.get(), rate.get(), 1e-3);
    EXPECT_GE(r.state_order, 1.9);
    EXPECT_GE(r.parameter_order, 1.9);
    s.set_parameter(elevation ? 8e-5 : -1e-4);
    const system::RotorSystem anew(MPI_COMM_WORLD, varying.train(s.parameter()), speed);
    EXPECT_EQ(s.axis(1), anew.axis(1));
    EXPECT_NE(s.axis(1)[1], before);
  }
}

// Nothing but one film holds the shaft. By itself it moves as a rigid body without a force, so that the matrix of the
// shaft has no inverse; with the film's part eliminated into it there is one.
TEST(Tilt, AFreeShaftOnOneFilmIsSolvedAtRest) {
  system::Train t = test::overhung_with_states();
  t.supports.erase(t.supports.begin());
  t.supports[0].slope = {{0, 0}};
  system::RotorSystem s(MPI_COMM_WORLD, t, speed);
  core::Vector x = core::make_vector(MPI_COMM_WORLD, s.local_size(), PETSC_DETERMINE);
  s.displace(x.get(), {0.2, -0.5});
  solve::EquilibriumProblem problem(s, speed, 1);
  core::Vector u = problem.make_unknown(), row = core::duplicate(u.get()), right = core::duplicate(u.get()),
               answer = core::duplicate(u.get()), back = core::duplicate(u.get());
  problem.from_state(x.get(), speed, u.get());
  solve::parameter_row(problem, row.get());
  problem.linearise(u.get(), row.get());
  core::check(VecSet(right.get(), 0.0));
  disturb(right.get(), 1e-3);
  problem.solve(right.get(), answer.get());
  problem.multiply(answer.get(), back.get());
  core::check(VecAXPY(back.get(), -1, right.get()));
  ASSERT_TRUE(std::isfinite(core::norm(answer.get())));
  EXPECT_LE(core::norm(back.get()), 1e-9 * core::norm(right.get()));

  if (core::size_of(MPI_COMM_WORLD) > 1) return;
  const MatrixXd shaft = s.structure()->l0();
  VectorXd rigid = VectorXd::Zero(shaft.cols());
  for (int node = 1; node <= 7; ++node) rigid(2 * s.rotor().coordinate(node, rotor::Freedom::x)) = 1;
  EXPECT_LE((shaft * rigid).norm(), 1e-9 * shaft.norm());
}

// Machines whose films have no states are solved on their ports, by one factorisation at several speeds and places:
// that is the inverse of the matrix entry by entry, of a shaft with a dense inverse and of one with sparse factors.
TEST(Tilt, EquilibriaOnPortsSolveTheAssembledMatrix) {
  system::Train slender = overhung(true);
  const auto cut = [](std::vector<rotor::Segment>& segments) {
    std::vector<rotor::Segment> out;
    for (rotor::Segment s : segments) {
      s.length /= 8;
      out.insert(out.end(), 8, s);
    }
    segments = out;
  };
  cut(slender.rotor.segments);
  const auto move = [](auto& all) {
    for (auto& one : all) one.node = 8 * (one.node - 1) + 1;
  };
  move(slender.supports);
  move(slender.rotor.discs);
  move(slender.unbalance);
  for (const system::Train& t : {overhung(true), slender}) {
    system::RotorSystem s(PETSC_COMM_SELF, t, speed);
    core::Vector x = s.guess();
    solve::EquilibriumProblem problem(s, speed, 1);
    core::Vector u = problem.make_unknown(), row = core::duplicate(u.get()), right = core::duplicate(u.get()),
                 answer = core::duplicate(u.get());
    core::check(VecSet(row.get(), 0.0));
    disturb(row.get(), 1);
    disturb(right.get(), 1e-3);
    const VectorXd y = test::dense(right.get());
    for (const double at : {1.1 * speed, 1.2 * speed, 0.7 * speed, 0.7 * speed}) {
      if (at == s.speed()) {  // the last one, by the problem: another machine at the same speed
        system::Train softer = t;
        softer.supports[0].stiffness = {1e8, 2e8};
        s.set_train(softer);
        problem.equations_changed();
      }
      disturb(x.get(), 1e-6);
      problem.from_state(x.get(), at, u.get());
      problem.linearise(u.get(), row.get());
      // Rounding grows with the stiffness of short elements.
      const MatrixXd a = test::dense(problem.matrix());
      const auto close = [&](const VectorXd& b, const VectorXd& c, double size) {
        EXPECT_LE((b - c).norm(), 1e-10 * c.norm() + 1e-14 * a.norm() * size) << s.size() << " states at " << at;
      };
      problem.multiply(right.get(), answer.get());
      close(test::dense(answer.get()), a * y, y.norm());
      problem.solve(right.get(), answer.get());
      const VectorXd forth = test::dense(answer.get());
      close(a * forth, y, forth.norm());
      problem.solve_transposed(right.get(), answer.get());
      const VectorXd back = test::dense(answer.get());
      close(a.transpose() * back, y, back.norm());
    }
  }
}

// The blocks that structured solvers see give F and J of the matrices, with films with and without states.
TEST(Tilt, BlocksAreTheSameEquations) {
  for (const bool states : {false, true}) {
    const system::Train t = states ? test::overhung_with_states() : overhung(true, {12, 6});
    system::RotorSystem s(PETSC_COMM_SELF, t, speed);
    core::Vector x = s.guess(), rate = core::duplicate(x.get()), f = core::duplicate(x.get());
    const Index n = 2 * s.coordinates(), all = s.size();
    disturb(rate.get(), 1e-3);
    {
      const core::WriteArray a(x.get());
      for (Index i = 0; i < n; ++i) a[i] += 3e-6 * std::sin(3.7 * static_cast<double>(i)) * (i % 2 ? 300 : 1);
    }
    const VectorXd at = test::dense(x.get()), dot = test::dense(rate.get());
    problem::BlockStructure& structure = *s.structure();
    ASSERT_EQ(structure.n_forces(), 8);
    ASSERT_EQ(structure.n_inputs(), 16);
    problem::Films films;
    VectorXd load;
    structure.films(structure.c() * at.head(n), at.data() + n, dot.data() + n, true, films);
    structure.load(0.7, load);
    VectorXd expected(all);
    expected << structure.l1() * dot.head(n) + structure.l0() * at.head(n) - load - structure.b() * films.forces,
        films.residual;
    s.residual(0.7, x.get(), rate.get(), f.get());
    const VectorXd residual = test::dense(f.get());
    EXPECT_LE((residual - expected).norm(), 1e-11 * residual.norm());
    core::Matrix j = s.make_jacobian();
    s.jacobian(0.7, x.get(), rate.get(), 1, 0, j.get());
    MatrixXd jx = MatrixXd::Zero(all, all);
    jx.topLeftCorner(n, n) =
        MatrixXd(structure.l0()) - MatrixXd(structure.b()) * films.d_inputs * MatrixXd(structure.c());
    for (std::size_t k = 0; k < structure.own().size(); ++k) {
      const problem::OwnStates& own = structure.own()[k];
      const core::PartResponse& tangents = films.own[k];
      EXPECT_EQ(own.inputs, 8);
      EXPECT_EQ(own.forces, 4);
      const Index first = n + own.first;
      jx.block(first, 0, own.count, n) =
          tangents.inputs.transpose() * MatrixXd(structure.c()).middleRows(own.first_input, own.inputs);
      jx.block(0, first, n, own.count) =
          -MatrixXd(structure.b()).middleCols(own.first_force, own.forces) * tangents.forces;
      for (std::size_t e = 0; e < own.states.size(); ++e)
        jx(first + own.states[e].row, first + own.states[e].column) += tangents.d_states[e];
    }
    const MatrixXd found = test::dense(j.get());
    for (Index row = 0; row < all; ++row)
      EXPECT_LE((found.row(row) - jx.row(row)).norm(), 1e-11 * found.row(row).norm()) << row;
    core::Vector dp = core::duplicate(x.get());
    s.parameter_derivative(0.7, x.get(), rate.get(), dp.get());
    VectorXd by_blocks;
    structure.parameter_derivative(0.7, at, dot, films, by_blocks);
    EXPECT_LE((test::dense(dp.get()) - by_blocks).norm(), 1e-11 * by_blocks.norm());
  }
}

// Turned by a quarter, a machine without a direction of its own gives the turned residual.
TEST(Tilt, TurnsWithItsFrame) {
  system::Train t = overhung(true);
  t.gravity = 0;
  t.unbalance.clear();
  for (system::Support& s : t.supports) {
    s.geometry.type = film::Geometry::Bore::cylindrical;
    s.geometry.arc = 0;
    s.film = pads(true, {32, 10});
    s.elevation = 0;
    s.has_pedestal = false;
    s.slope = {{0, 0}};
  }
  system::RotorSystem s(MPI_COMM_WORLD, t, speed);
  core::Vector x = core::make_vector(s.comm(), s.local_size(), PETSC_DETERMINE), rate = core::duplicate(x.get()),
               f = core::duplicate(x.get());
  disturb(x.get(), 2e-5);
  disturb(rate.get(), 1e-3);
  // Pairs (x, y), (dx/dz, dy/dz), each a pair of value and rate.
  const auto turned = [](const VectorXd& v) {
    VectorXd out(v.size());
    for (Index i = 0; i < v.size(); i += 4)
      for (Index k = 0; k < 2; ++k) {
        out(i + k) = -v(i + 2 + k);
        out(i + 2 + k) = v(i + k);
      }
    return out;
  };
  const auto residual = [&](const VectorXd& at, const VectorXd& dot) {
    core::fill(x.get(), {at.begin(), at.end()});
    core::fill(rate.get(), {dot.begin(), dot.end()});
    s.residual(0, x.get(), rate.get(), f.get());
    return test::dense(f.get());
  };
  const VectorXd at = test::dense(x.get()), dot = test::dense(rate.get());
  const VectorXd here = residual(at, dot), there = residual(turned(at), turned(dot));
  EXPECT_LE((there - turned(here)).norm(), 1e-9 * here.norm());
  // It feels the tilt: without it the moments are missing.
  for (system::Support& bearing : t.supports) bearing.film = pads(false, {32, 10});
  system::RotorSystem without(MPI_COMM_WORLD, t, speed);
  core::fill(x.get(), {at.begin(), at.end()});
  core::fill(rate.get(), {dot.begin(), dot.end()});
  without.residual(0, x.get(), rate.get(), f.get());
  EXPECT_GT((test::dense(f.get()) - here).norm(), 1e-6 * here.norm());
}

// Forces and moments of the films hold the weight: sum of F_y and of z F_y + M_y. Their values are integrals of the
// pressure.
TEST(Tilt, ForcesAndMomentsCarryTheShaft) {
  const system::Train t = overhung(true, {80, 40});
  system::RotorSystem s(MPI_COMM_WORLD, t, speed);
  const core::Vector x = equilibrium(s);
  const std::vector<double> whole = s.gather(x.get());
  const auto films = s.film_responses(whole.data(), film::Need::force);
  const auto journals = s.journals(whole.data());
  const std::vector<double> z = rotor::node_positions(t.rotor), mass = rotor::node_masses(t.rotor);
  double force = 0, moment = 0, weight = 0, lever = 0;
  for (std::size_t k = 0; k < z.size(); ++k) {
    weight += t.gravity * mass[k];
    lever += t.gravity * mass[k] * z[k];
  }
  for (std::size_t b = 0; b < films.size(); ++b) {
    force += films[b].force[1];
    moment += films[b].force[1] * z[static_cast<std::size_t>(t.supports[b].node - 1)] + films[b].force[3];
    EXPECT_GT(std::abs(films[b].force[3]), 1e-3 * films[b].force[1] * t.supports[b].geometry.length) << "no moment";
    EXPECT_GT(std::abs(journals[b].tilt[1]), 1e-6);
    // The tilt turns the journal against the moment.
    EXPECT_LT(films[b].force[3] * journals[b].tilt[1], 0.0);
  }
  EXPECT_NEAR(force, weight, 1e-6 * weight);
  EXPECT_NEAR(moment, lever, 1e-6 * lever);
  for (std::size_t b = 0; b < films.size(); ++b) {
    const auto fields = s.film_fields(static_cast<int>(b), whole.data());
    const auto field = [&](const char* name) -> const film::NodalField& {
      for (const film::NodalField& f : fields)
        if (f.name == name) return f;
      throw core::Bug("no such field");
    };
    const film::NodalField &theta = field("theta"), &along = field("z"), &p = field("pressure");
    const std::size_t m = along.values.size();
    const double area =
        t.supports[b].geometry.radius * (theta.values[1] - theta.values[0]) * (along.values[1] - along.values[0]);
    std::array<double, 4> sum{};
    for (std::size_t i = 0; i < theta.values.size(); ++i)
      for (std::size_t j = 0; j < m; ++j) {
        const double each = -area * p.values[i * m + j], at = along.values[j];
        sum[0] += each * std::cos(theta.values[i]);
        sum[1] += each * std::sin(theta.values[i]);
        sum[2] += each * at * std::cos(theta.values[i]);
        sum[3] += each * at * std::sin(theta.values[i]);
      }
    const double load = std::hypot(sum[0], sum[1]), moments = std::hypot(sum[2], sum[3]);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(sum[k], films[b].force[k], 5e-3 * (k < 2 ? load : moments)) << k;
    // Thickness over the whole length: least at an end.
    const auto at_mid =
        film::minimum_thickness(t.supports[b].geometry, {journals[b].position[0], journals[b].position[1], 0, 0});
    const auto& h = field("thickness").values;
    const double least = *std::min_element(h.begin(), h.end()), found = s.film_thickness(whole.data())[b];
    EXPECT_LT(found, at_mid);
    EXPECT_LE(found, least * (1 + 1e-12));
    EXPECT_NEAR(found, least, 1e-3 * least);
  }
}

// A bearing is bored in line with the shaft at rest, or stands as the deck says.
TEST(Tilt, BearingsAreAlignedToTheShaft) {
  system::Train t = overhung(true);
  const system::RotorSystem aligned(MPI_COMM_WORLD, t, speed);
  const auto line = rotor::rigid_static(MPI_COMM_WORLD, t.rotor, {{1, 3e-5}, {5, 0}}, t.gravity).slope;
  for (int b = 0; b < 2; ++b) {
    EXPECT_EQ(aligned.axis(b)[0], 0);
    EXPECT_EQ(aligned.axis(b)[1], line[b == 0 ? 0 : 4]);
    EXPECT_GT(std::abs(aligned.axis(b)[1]), 1e-5);
  }
  t.supports[1].slope = {{1e-4, -2e-4}};
  system::RotorSystem given(MPI_COMM_WORLD, t, speed);
  EXPECT_EQ(given.axis(1), *t.supports[1].slope);
  const core::Vector x = given.guess();
  const std::vector<double> whole = given.gather(x.get()), shaft = given.shaft(whole.data(), 0, true);
  const auto journal = given.journals(whole.data())[1];
  for (std::size_t d = 0; d < 2; ++d)
    EXPECT_DOUBLE_EQ(journal.tilt[d],
                     shaft[static_cast<std::size_t>(rotor::full_coordinate(5, rotor::Freedom::slope_x)) + d] -
                         (*t.supports[1].slope)[d]);
}

// Static condensation is exact where slopes of tilting films stay: loads, moments and tilts of the whole shaft.
TEST(Tilt, AReductionKeepsTheSlopes) {
  system::Train t = overhung(true);
  system::RotorSystem full(MPI_COMM_WORLD, t, speed);
  const std::vector<double> a = full.gather(equilibrium(full).get());
  t.rotor.reduction.type = rotor::Reduction::Type::guyan;
  t.rotor.reduction.masters = {1, 3, 5, 7};
  EXPECT_THROW(system::RotorSystem(MPI_COMM_WORLD, t, speed), core::InputError) << "without its slopes";
  t.rotor.reduction.slopes = {1, 5};
  system::RotorSystem small(MPI_COMM_WORLD, t, speed);
  EXPECT_EQ(small.coordinates(), 2 * (4 + 2) + 2);
  const std::vector<double> b = small.gather(equilibrium(small).get());
  const auto fa = full.film_responses(a.data(), film::Need::force),
             fb = small.film_responses(b.data(), film::Need::force);
  const auto ja = full.journals(a.data()), jb = small.journals(b.data());
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t d = 0; d < 2; ++d) {
      EXPECT_NEAR(fa[k].force[d], fb[k].force[d], 1e-6 * fa[k].force[1]);
      EXPECT_NEAR(fa[k].force[2 + d], fb[k].force[2 + d], 1e-6 * fa[k].force[1] * 0.08);
      EXPECT_NEAR(ja[k].tilt[d], jb[k].tilt[d], 1e-6 * std::abs(ja[k].tilt[1]));
    }
}
