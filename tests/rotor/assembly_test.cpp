// The assembled matrices of the whole rotor: frame, signs, damping, distribution, independence of the ranks.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "rotor/shafts.hpp"
#include "support/dense.hpp"
#include "support/turbine_train.hpp"
#include "whirl/rotor/rotor.hpp"
#include "whirl/rotor/shaft.hpp"

using namespace whirl;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Dense {
  MatrixXd m, g, k, c;
  VectorXd f;
};

Dense dense_of(const rotor::Rotor& r) {
  const rotor::Matrices& a = r.matrices();
  return {test::dense(a.mass.get()), test::dense(a.gyroscopic.get()), test::dense(a.stiffness.get()),
          test::dense(a.damping.get()), test::dense(a.gravity.get())};
}

// Turns the pair (x, y) of every node by 90 degrees or reflects it.
MatrixXd in_pairs(Index n, double xx, double xy, double yx, double yy) {
  MatrixXd t = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; i += 2) t.block<2, 2>(i, i) << xx, xy, yx, yy;
  return t;
}

void expect_equal(const MatrixXd& a, const MatrixXd& b, double tolerance, const char* what) {
  ASSERT_EQ(a.rows(), b.rows()) << what;
  EXPECT_LE((a - b).norm(), tolerance * b.norm()) << what;
}

}  // namespace

TEST(Assembly, FreedomsAreNodeMajor) {
  const rotor::Rotor r(MPI_COMM_WORLD, test::stepped_shaft());
  EXPECT_EQ(r.n_nodes(), 13);
  EXPECT_EQ(r.size(), 52);
  EXPECT_EQ(r.coordinate(1, rotor::Freedom::x), 0);
  EXPECT_EQ(r.coordinate(3, rotor::Freedom::slope_x), 10);
  EXPECT_EQ(r.coordinate(13, rotor::Freedom::slope_y), 51);
  EXPECT_FALSE(r.matrices().basis);
  PetscInt begin = 0, end = 0;
  core::check(MatGetOwnershipRange(r.matrices().mass.get(), &begin, &end));
  EXPECT_EQ(begin % 4, 0);
  EXPECT_EQ(end % 4, 0);
}

TEST(Assembly, RigidMotionsCostNothingAndCarryMassInertiaAndSpin) {
  const rotor::Options o = test::stepped_shaft();
  const rotor::Rotor r(MPI_COMM_WORLD, o);
  const Dense a = dense_of(r);
  const auto z = rotor::node_positions(o);
  VectorXd x = VectorXd::Zero(r.size()), y = x, tilt_x = x, tilt_y = x;
  for (int node = 1; node <= r.n_nodes(); ++node) {
    x(r.coordinate(node, rotor::Freedom::x)) = y(r.coordinate(node, rotor::Freedom::y)) = 1;
    tilt_x(r.coordinate(node, rotor::Freedom::x)) = tilt_y(r.coordinate(node, rotor::Freedom::y)) =
        z[static_cast<std::size_t>(node - 1)];
    tilt_x(r.coordinate(node, rotor::Freedom::slope_x)) = tilt_y(r.coordinate(node, rotor::Freedom::slope_y)) = 1;
  }
  for (const VectorXd& v : {x, y, tilt_x, tilt_y}) EXPECT_LT((a.k * v).norm(), 1e-13 * a.k.norm());
  const double mass = rotor::total_mass(o);
  const auto masses = rotor::node_masses(o);
  EXPECT_EQ(masses.size(), static_cast<std::size_t>(r.n_nodes()));
  EXPECT_NEAR(std::accumulate(masses.begin(), masses.end(), 0.0) / mass, 1, 1e-14);
  EXPECT_NEAR(x.dot(a.m * x) / mass, 1, 1e-13);
  EXPECT_NEAR(y.dot(a.m * y) / mass, 1, 1e-13);
  EXPECT_NEAR(a.f.dot(y) / -mass, 1, 1e-13);  // gravity pulls along -y with the whole mass
  EXPECT_EQ(a.f.dot(x), 0);

  // About z = 0: sum of m (z_c^2 + l^2/12) + J_d of segments and discs; spin of the polar inertia couples the tilts.
  double inertia = 0, polar = 0, moment = 0;
  for (std::size_t i = 0; i < o.segments.size(); ++i) {
    const rotor::Segment& s = o.segments[i];
    const double m = rotor::segment_mass(s, o.material), centre = (z[i] + z[i + 1]) / 2;
    const auto square = [](double d) { return d * d; };
    const double shaft = m - s.added_mass;
    const double j = shaft * (square(s.outer_mass_diameter) + square(s.inner_mass_diameter)) / 8 +
                     s.added_mass * (square(s.added_mass_outer_diameter) + square(s.added_mass_inner_diameter)) / 8;
    polar += j;
    inertia += m * (centre * centre + s.length * s.length / 12) + j / 2;
    moment += m * centre;
  }
  const rotor::Disc d = rotor::resolved(o.discs[0], o.material);
  const double zd = z[static_cast<std::size_t>(d.node - 1)];
  polar += d.polar_inertia;
  inertia += d.mass * zd * zd + d.diametral_inertia;
  moment += d.mass * zd;
  EXPECT_NEAR(tilt_x.dot(a.m * tilt_x) / inertia, 1, 1e-12);
  EXPECT_NEAR(x.dot(a.m * tilt_x) / moment, 1, 1e-12);
  EXPECT_NEAR(a.f.dot(tilt_y) / -moment, 1, 1e-12);
  EXPECT_NEAR(tilt_x.dot(a.g * tilt_y) / polar, 1, 1e-12);   // M x'' + Omega G_p y'
  EXPECT_NEAR(tilt_y.dot(a.g * tilt_x) / -polar, 1, 1e-12);  // M y'' - Omega G_p x'
  EXPECT_NEAR(x.dot(a.g * tilt_y), 0, 1e-12 * polar);
}

TEST(Assembly, TurningTheFrameChangesNothingAndAMirrorReversesTheSpin) {
  const Dense a = dense_of(rotor::Rotor(MPI_COMM_WORLD, test::stepped_shaft()));
  const MatrixXd turn = in_pairs(a.m.rows(), 0, -1, 1, 0), mirror = in_pairs(a.m.rows(), 1, 0, 0, -1);
  for (const MatrixXd* s : {&a.m, &a.k, &a.c, &a.g}) expect_equal(turn.transpose() * *s * turn, *s, 1e-15, "turned");
  for (const MatrixXd* s : {&a.m, &a.k, &a.c}) expect_equal(mirror * *s * mirror, *s, 1e-15, "mirrored");
  expect_equal(mirror * a.g * mirror, -a.g, 1e-15, "mirrored spin");
  expect_equal(a.g.transpose(), -a.g, 1e-15, "skew");
  EXPECT_GT(a.g.norm(), 0);
  expect_equal(a.m.transpose(), a.m, 1e-15, "symmetric");
  expect_equal(a.c, 2e-5 * a.k, 1e-15, "damping");
}

TEST(Assembly, ForwardWhirlRisesAndBackwardFallsWithSpeed) {
  const std::vector<test::IsotropicBearing> bearings{{2, 2e7}, {12, 2e7}};
  rotor::Options o = test::stepped_shaft();
  o.stiffness_damping = 0;
  double forward = 0, backward = 0;
  for (double speed : {0.0, 300.0, 600.0, 900.0}) {
    double lowest_forward = 0, lowest_backward = 0;
    for (const test::Whirl& w : test::whirl_modes(o, bearings, speed)) {
      if (w.frequency > 0 && lowest_forward == 0) lowest_forward = w.frequency;
      if (w.frequency < 0 && lowest_backward == 0) lowest_backward = -w.frequency;
    }
    if (speed > 0) {
      EXPECT_GT(lowest_forward, forward);
      EXPECT_LT(lowest_backward, backward);
    }
    forward = lowest_forward;
    backward = lowest_backward;
  }
}

TEST(Assembly, StationaryStiffnessDampingDampsEveryModeByHalfBetaOmegaSquared) {
  rotor::Options o = test::stepped_shaft();
  const double beta = o.stiffness_damping;
  o.stiffness_damping = 0;
  const double omega = std::abs(test::whirl_modes(o, {}, 0)[4].frequency);  // behind the four of the rigid body
  o.stiffness_damping = beta;
  const double growth = -beta * omega * omega / 2, frequency = std::sqrt(omega * omega - growth * growth);
  double nearest = omega;
  for (const test::Whirl& w : test::whirl_modes(o, {}, 0))
    nearest = std::min(nearest, std::hypot(w.growth - growth, w.frequency - frequency));
  EXPECT_LT(nearest, 1e-6 * omega);
  for (const test::Whirl& w : test::whirl_modes(o, {{2, 2e7, 100}, {12, 2e7, 100}}, 300)) EXPECT_LT(w.growth, 0);
}

TEST(Assembly, EveryRankCountGivesTheSerialMatrices) {
  for (const rotor::Options& o : {test::stepped_shaft(), test::uniform_shaft(1, 0.1, 1), test::train_rotor()}) {
    const Dense all = dense_of(rotor::Rotor(MPI_COMM_WORLD, o)), alone = dense_of(rotor::Rotor(MPI_COMM_SELF, o));
    expect_equal(all.m, alone.m, 1e-15, "mass");
    expect_equal(all.g, alone.g, 1e-15, "gyroscopic");
    expect_equal(all.k, alone.k, 1e-15, "stiffness");
    expect_equal(all.f, alone.f, 1e-15, "gravity");
  }
}

TEST(Assembly, PreallocationIsExact) {
  const rotor::Rotor r(MPI_COMM_WORLD, test::train_rotor());
  for (Mat m : {r.matrices().mass.get(), r.matrices().gyroscopic.get(), r.matrices().stiffness.get()}) {
    MatInfo info;
    core::check(MatGetInfo(m, MAT_GLOBAL_SUM, &info));
    EXPECT_EQ(info.mallocs, 0);
    EXPECT_EQ(info.nz_unneeded, 0);
    EXPECT_EQ(info.nz_used, 4 * (6 * 185 - 4));
  }
}

TEST(Assembly, WrongOptionsAreRefusedOnAllRanksTogether) {
  rotor::Options o = test::stepped_shaft();
  o.discs[0].node = 99;
  try {
    const rotor::Rotor r(MPI_COMM_WORLD, o);
    FAIL();
  } catch (const core::InputError& e) {
    EXPECT_TRUE(e.agreed());
  }
}
