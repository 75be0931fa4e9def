// Flexible couplings in the place of a segment.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "rotor/shafts.hpp"
#include "support/dense.hpp"
#include "whirl/core/error.hpp"
#include "whirl/rotor/alignment.hpp"
#include "whirl/rotor/critical_speeds.hpp"
#include "whirl/rotor/element.hpp"
#include "whirl/rotor/frequencies.hpp"
#include "whirl/rotor/hinges.hpp"
#include "whirl/rotor/rotor.hpp"
#include "whirl/rotor/shaft.hpp"

using namespace whirl;
using std::numbers::pi;

namespace {

constexpr double bar = 0.4, gap = 0.1, diameter = 0.08;

// Two bars and a coupling between them.
rotor::Options two_bars(double modulus, int elements = 1) {
  rotor::Options o = test::uniform_shaft(2 * bar, diameter, 2 * elements, modulus);
  rotor::Segment middle = o.segments[0];
  middle.length = gap;
  middle.outer_mass_diameter = 0.12;
  o.segments.insert(o.segments.begin() + elements, middle);
  rotor::Coupling c;
  c.segment = elements + 1;
  c.stiffness = 3e6;
  c.tilt_stiffness = 2e4;
  o.couplings = {c};
  return o;
}

}  // namespace

// Each body is a bar and half of the coupling, rigid: mass, moment and inertia about its outer end by integrals.
TEST(Coupling, TwoRigidBodiesOnSprings) {
  const rotor::Options o = two_bars(1e17);
  const double spring = 5e6;
  Eigen::Matrix2d body = Eigen::Matrix2d::Zero();
  const auto piece = [&](double from, double to, double d) {
    const double a = 7850 * pi / 4 * d * d, j = 7850 * pi / 64 * d * d * d * d;
    const double z1 = (to * to - from * from) / 2, z2 = (to * to * to - from * from * from) / 3;
    Eigen::Matrix2d m{{a * (to - from), a * z1}, {a * z1, a * z2 + j * (to - from)}};
    body += m;
  };
  piece(0, bar, diameter);
  piece(bar, bar + gap / 2, 0.12);
  // Freedoms (u1, s1, u2, s2) at the outer ends; z of the second one against the shaft.
  Eigen::Matrix4d mass = Eigen::Matrix4d::Zero(), stiffness = mass;
  const Eigen::Matrix2d mirror = Eigen::Vector2d(1, -1).asDiagonal();
  mass.topLeftCorner<2, 2>() = body;
  mass.bottomRightCorner<2, 2>() = mirror * body * mirror;
  const double reach = bar + gap / 2;
  const auto add = [&](double k, const Eigen::Vector4d& by) { stiffness += k * by * by.transpose(); };
  add(spring, {1, 0, 0, 0});
  add(spring, {1, bar, 0, 0});
  add(spring, {0, 0, 1, -bar});
  add(spring, {0, 0, 1, 0});
  add(3e6, {-1, -reach, 1, -reach});
  add(2e4, {0, -1, 0, 1});
  const Eigen::Vector4d exact =
      Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix4d>(stiffness, mass).eigenvalues().cwiseSqrt();
  const auto found = test::whirl_modes(o, {{1, spring}, {2, spring}, {3, spring}, {4, spring}}, 0);
  for (Eigen::Index k = 0; k < 4; ++k)
    EXPECT_NEAR(std::abs(found[static_cast<std::size_t>(2 * k)].frequency) / exact(k), 1, 1e-7) << k;
}

TEST(Coupling, RigidMotionsStrainNothingAndMassIsThatOfTheOutline) {
  for (const auto element : {rotor::BeamElement::timoshenko, rotor::BeamElement::timoshenko_hermitian}) {
    rotor::Options o = two_bars(2.1e11, 3);
    o.element = element;
    const rotor::Rotor r(MPI_COMM_WORLD, o);
    const std::vector<double> z = rotor::node_positions(o);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(r.size()), tilt = x;
    for (std::size_t k = 0; k < z.size(); ++k) {
      x(4 * static_cast<Eigen::Index>(k)) = 1;
      tilt(4 * static_cast<Eigen::Index>(k)) = z[k];
      tilt(4 * static_cast<Eigen::Index>(k) + 2) = 1;
    }
    const Eigen::MatrixXd stiffness = test::dense(r.matrices().stiffness.get());
    EXPECT_LE((stiffness * x).norm(), 1e-12 * stiffness.norm());
    EXPECT_LE((stiffness * tilt).norm(), 1e-12 * stiffness.norm());
    EXPECT_NEAR(x.dot(test::dense(r.matrices().mass.get()) * x) / rotor::total_mass(o), 1, 1e-12);
    // Free of bearings: two bars that bend, on a spring between them.
    const auto f = rotor::natural_frequencies(MPI_COMM_WORLD, o, {}, 3);
    ASSERT_EQ(f.size(), 3u);
    o.couplings[0].tilt_stiffness *= 4;
    EXPECT_GT(rotor::natural_frequencies(MPI_COMM_WORLD, o, {}, 3)[0], 1.2 * f[0]);
  }
}

// Where both shafts whirl with the speed of the shaft, forward, the coupling turns as a rigid body: C and N cancel.
TEST(Coupling, ItsDampingTurnsWithTheShaft) {
  rotor::Options o = two_bars(2.1e11, 2);
  o.couplings[0].damping = 400;
  o.couplings[0].tilt_damping = 7;
  for (const bool reduced : {false, true}) {
    if (reduced) o.reduction = {rotor::Reduction::Type::craig_bampton, {1, 6}, 3};
    const rotor::Rotor r(MPI_COMM_WORLD, o);
    ASSERT_TRUE(r.matrices().circulatory);
    const Eigen::MatrixXd c = test::dense(r.matrices().damping.get()), n = test::dense(r.matrices().circulatory.get());
    Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(c.rows(), c.cols());  // e_z x q
    for (Eigen::Index k = 0; k < c.rows(); k += 2) turn(k, k + 1) = -1, turn(k + 1, k) = 1;
    EXPECT_GT(c.norm(), 100);
    EXPECT_LE((c * turn + n).norm(), 1e-12 * c.norm());
    EXPECT_LE((c - c.transpose()).norm(), 1e-12 * c.norm());
  }
}

// Free, the plane has three motions without stiffness: as a rigid body and about the hinge.
TEST(Coupling, WithoutTiltStiffnessItIsAHinge) {
  for (const auto element : {rotor::BeamElement::timoshenko, rotor::BeamElement::timoshenko_linear}) {
    rotor::Options o = two_bars(2.1e11, 3);
    o.element = element;
    o.couplings[0].tilt_stiffness = 0;
    const Eigen::MatrixXd motions = rotor::free_motions(o, {});
    ASSERT_EQ(motions.cols(), 3);
    const rotor::Rotor r(MPI_COMM_WORLD, o);
    const Eigen::MatrixXd k = test::dense(r.matrices().stiffness.get())(Eigen::seq(0, Eigen::last, 2),
                                                                        Eigen::seq(0, Eigen::last, 2)),
                          m = test::dense(r.matrices().mass.get())(Eigen::seq(0, Eigen::last, 2),
                                                                   Eigen::seq(0, Eigen::last, 2));
    EXPECT_LE((k.leftCols(motions.rows()) * motions).norm(), 1e-12 * k.norm() * motions.norm());
    const Eigen::VectorXd exact =
        Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(k, m).eigenvalues().tail(k.rows() - 3).cwiseSqrt();
    const auto found = rotor::natural_frequencies(MPI_COMM_WORLD, o, {}, 2);
    ASSERT_EQ(found.size(), 2u);
    for (Eigen::Index i = 0; i < 2; ++i) EXPECT_NEAR(found[static_cast<std::size_t>(i)] / exact(i), 1, 1e-6) << i;
    // On two pins, one under each bar, both fold: one motion is left out.
    EXPECT_EQ(rotor::free_motions(o, {1, 8}).cols(), 1);
    EXPECT_GT(rotor::natural_frequencies(MPI_COMM_WORLD, o, {1, 8}, 1).at(0), 0.1 * exact(0));
  }
}

TEST(Coupling, PartsThatNothingHoldsAreRefused) {
  rotor::Options o = two_bars(2.1e11);  // nodes 1, 2 | 3, 4
  EXPECT_FALSE(rotor::loose_part(o, {1, 2}));
  o.couplings[0].tilt_stiffness = 0;
  const auto far = rotor::loose_part(o, {1, 2}), all = rotor::loose_part(o, {4, 1});
  ASSERT_TRUE(far && all);
  EXPECT_EQ(std::pair(far->from, far->to), std::pair(3, 4));
  EXPECT_EQ(std::pair(all->from, all->to), std::pair(1, 4));
  EXPECT_FALSE(rotor::loose_part(o, {1, 2, 4}));
  EXPECT_FALSE(rotor::loose_part(o, {1, 2}, {3}));
  EXPECT_EQ(rotor::words(*far, o, "so"),
            "held so, nodes 3 to 4 are free to move: the coupling of segment 2 has no 'tilt_stiffness'");
  using enum rotor::Reduction::Type;
  for (const auto type : {guyan, craig_bampton, craig_bampton_state, modal}) {
    o.reduction = {type, {1, 2}, 3, 1e6};
    EXPECT_THROW(rotor::Rotor(MPI_COMM_WORLD, o), core::InputError);
    o.reduction.masters = {1, 2, 4};
    EXPECT_NO_THROW(rotor::Rotor(MPI_COMM_WORLD, o));
  }
  o.reduction = {};
  EXPECT_THROW((void)rotor::rigid_static(MPI_COMM_WORLD, o, {{1, 0}, {2, 0}}, 9.81), core::InputError);
  EXPECT_THROW((void)rotor::critical_speeds(o, {{1}, {2}}, 1e7, rotor::Whirl::forward, 1), core::InputError);
  // The weight of what hangs on the hinge has a moment about it, which its support takes.
  const auto rest = rotor::rigid_static(MPI_COMM_WORLD, o, {{1, 0}, {2, 0}, {4, 0}}, 9.81);
  const double mass = 7850 * pi / 4 * diameter * diameter * bar, half = 7850 * pi / 4 * 0.12 * 0.12 * gap / 2,
               moment = 9.81 * (mass * (gap / 2 + bar / 2) + half * gap / 4);
  EXPECT_NEAR(rest.reactions[2] * (gap / 2 + bar) / moment, 1, 1e-9);
}

TEST(Coupling, WrongOnesAreRefused) {
  rotor::Options o = two_bars(2.1e11);
  o.couplings.push_back(o.couplings[0]);
  EXPECT_THROW(rotor::validate(o), core::InputError);
  o.couplings = {{4, 1e6, 1e4}};
  EXPECT_THROW(rotor::validate(o), core::InputError);
  o.couplings = {{2, 0, 1e4}};
  EXPECT_THROW(rotor::validate(o), core::InputError);
}
