// The families of beam elements: their shapes, their order, and the frequencies of the trial rotor.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/rotor/trial_rotor.hpp"
#include "rotor/shafts.hpp"
#include "support/dense.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/codecs.hpp"
#include "whirl/rotor/alignment.hpp"
#include "whirl/rotor/critical_speeds.hpp"
#include "whirl/rotor/describe.hpp"
#include "whirl/rotor/element.hpp"
#include "whirl/rotor/frequencies.hpp"
#include "whirl/rotor/rotor.hpp"
#include "whirl/rotor/shaft.hpp"

using namespace whirl;
using rotor::BeamElement;
using std::numbers::pi;
namespace trial = whirl::reference::trial_rotor;

namespace {

constexpr std::array all_elements{BeamElement::rayleigh, BeamElement::timoshenko, BeamElement::timoshenko_linear,
                                  BeamElement::timoshenko_hermitian};

rotor::Options trial_shaft(BeamElement element, int elements, bool with_disc) {
  rotor::Options o = test::uniform_shaft(0.3, 0.015, elements, 2.05e11, 7860);
  o.element = element;
  rotor::Disc d;
  d.node = 1 + 3 * elements / 10;
  d.mass = 0.5;
  d.diametral_inertia = 7.81e-5;
  d.polar_inertia = 1.56e-4;
  if (with_disc) o.discs = {d};
  return o;
}

// Whirl of an undamped isotropic rotor on springs of 1e7 N/m at both ends. With x + i y = v exp(i w t) and v real,
// T(w) v = (K + Omega w G - w^2 M) v = 0. K > 0, so that v^T T v has one root of each sign for every v, and T(w) has as
// many negative eigenvalues as roots lie between 0 and w.
class Whirler {
public:
  Whirler(const rotor::Options& o, double speed) {
    const rotor::Rotor r(MPI_COMM_WORLD, o);
    const auto plane = [&](Mat from, Eigen::Index column) {
      const Eigen::MatrixXd a = test::dense(from);
      return Eigen::MatrixXd(a(Eigen::seqN(0, a.rows() / 2, 2), Eigen::seqN(column, a.cols() / 2, 2)));
    };
    m_ = plane(r.matrices().mass.get(), 0);
    g_ = speed * plane(r.matrices().gyroscopic.get(), 1);
    k_ = plane(r.matrices().stiffness.get(), 0);
    for (const int node : {1, r.n_nodes()}) {
      const Eigen::Index at = r.coordinate(node, rotor::Freedom::x) / 2;
      k_(at, at) += 1e7;
    }
  }

  int count(double w) const {
    const Eigen::LDLT<Eigen::MatrixXd> t(k_ + w * g_ - w * w * m_);
    return static_cast<int>((t.vectorD().array() < 0).count());
  }

  // Root number n (from 1) of a sign, by bisection.
  double root(int n, double sign, double below) const {
    double low = 0, high = below;
    for (int step = 0; step < 44; ++step) {
      const double middle = (low + high) / 2;
      (count(sign * middle) >= n ? high : low) = middle;
    }
    return (low + high) / 2;
  }

private:
  Eigen::MatrixXd m_, g_, k_;
};

rotor::Beam some_beam() {
  rotor::Segment s;
  s.length = 0.2;
  s.outer_mass_diameter = 0.1;
  rotor::Material m;
  m.modulus = {{293.15, 2.1e11}};
  return rotor::make_beam(s, m, rotor::Shear::cowper_solid);
}

}  // namespace

// Dissertation, appendix A with its errata: u = (P - beta P'') c and s = P' c with P = (1, z, z^2, z^3) and
// beta = E I/(kappa G A), so that the shear angle u' - s = -beta s'' is that of equilibrium without load. Strain energy
// and kinetic energy by quadrature are the closed forms of the train's element.
TEST(Families, TheQuasistaticElementIsTheOneInClosedForm) {
  const rotor::Beam b = some_beam();
  const double l = b.length, beta = b.shear_parameter * l * l / 12;
  const auto u = [&](double z) { return Eigen::RowVector4d(1, z, z * z - 2 * beta, z * z * z - 6 * beta * z); };
  const auto s = [](double z) { return Eigen::RowVector4d(0, 1, 2 * z, 3 * z * z); };
  Eigen::Matrix4d nodes;
  nodes << u(0), s(0), u(l), s(l);
  const Eigen::Matrix4d c = nodes.inverse();
  Eigen::Matrix4d k = Eigen::Matrix4d::Zero(), mt = k, mr = k;
  const double a = std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(1.2)), far = std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(1.2)),
               w = std::sqrt(30.0) / 36;
  for (const auto& [x, weight] : {std::pair{-far, 0.5 - w}, {-a, 0.5 + w}, {a, 0.5 + w}, {far, 0.5 - w}}) {
    const double z = (1 + x) * l / 2, dz = weight * l / 2;
    const Eigen::RowVector4d un = u(z) * c, sn = s(z) * c, bend = Eigen::RowVector4d(0, 0, 2, 6 * z) * c,
                             shear = Eigen::RowVector4d(0, 0, 0, -6 * beta) * c;
    k += dz * b.bending_stiffness * (bend.transpose() * bend + shear.transpose() * shear / beta);
    mt += dz * b.mass_per_length * un.transpose() * un;
    mr += dz * b.inertia_per_length * sn.transpose() * sn;
  }
  EXPECT_LT((k - rotor::stiffness(b)).norm(), 1e-12 * k.norm());
  EXPECT_LT((mt - rotor::translational_mass(b)).norm(), 1e-13 * mt.norm());
  EXPECT_LT((mr - rotor::rotary_mass(b)).norm(), 1e-12 * mr.norm());
}

// At rest, inner freedoms condensed: nodal forces meet the stiffness in closed form, and they do no work in rigid
// motions.
TEST(Families, ElementsWithInnerFreedomsAreExactAtRest) {
  const rotor::Beam b = some_beam();
  for (const BeamElement e : {BeamElement::timoshenko_linear, BeamElement::timoshenko_hermitian}) {
    const rotor::ElementMatrices m = rotor::element_matrices(b, e);
    const Eigen::Index inner = rotor::n_inner(e);
    const Eigen::MatrixXd coupling = m.stiffness.bottomLeftCorner(inner, 4);
    const Eigen::LDLT<Eigen::MatrixXd> own(m.stiffness.bottomRightCorner(inner, inner));
    const Eigen::Matrix4d condensed =
        m.stiffness.topLeftCorner(4, 4) - coupling.transpose() * Eigen::MatrixXd(own.solve(coupling));
    EXPECT_LT((condensed - rotor::stiffness(b)).norm(), 1e-11 * condensed.norm());
    const Eigen::Vector4d load = m.weight.head(4) - coupling.transpose() * own.solve(m.weight.tail(inner));
    EXPECT_LT((load - rotor::weight(b)).norm(), 1e-12 * load.norm());

    Eigen::VectorXd shift = Eigen::VectorXd::Zero(4 + inner), turn = shift;
    shift.head(4) << 1, 0, 1, 0;
    turn.head(4) << -b.length / 2, 1, b.length / 2, 1;
    EXPECT_LT((m.stiffness * shift).norm() + (m.stiffness * turn).norm(), 1e-12 * m.stiffness.norm());
    const double mass = b.mass_per_length * b.length;
    EXPECT_NEAR(shift.dot(m.translational_mass * shift) / mass, 1, 1e-13);
    EXPECT_NEAR(turn.dot(m.translational_mass * turn) / (mass * b.length * b.length / 12), 1, 1e-12);
    EXPECT_NEAR(turn.dot(m.rotary_mass * turn) / (b.inertia_per_length * b.length), 1, 1e-12);
  }
}

TEST(TrialRotor, EveryReferenceFrequencyLiesWithinItsUncertainty) {
  struct Mesh {
    BeamElement element;
    int elements;
  };
  for (const trial::Case& c : trial::read().cases)
    for (const auto& [element, elements] :
         c.shear ? std::vector<Mesh>{{BeamElement::timoshenko_linear, 100}, {BeamElement::timoshenko_hermitian, 40}}
                 : std::vector<Mesh>{{BeamElement::rayleigh, 150}}) {
      const Whirler whirler(trial_shaft(element, elements, c.disc), c.speed);
      for (std::size_t i = 0; i < 10; ++i) {
        const int n = static_cast<int>(i) / 2 + 1;
        const double size = std::abs(c.frequency[i]), sign = i % 2 == 0 ? -1 : 1;
        if (c.speed > 0) {
          EXPECT_EQ(c.frequency[i] < 0, i % 2 == 0);
        }
        EXPECT_EQ(whirler.count(sign * (size - c.uncertainty[i])), n - 1) << c.name << ", " << elements << ", " << i;
        EXPECT_EQ(whirler.count(sign * (size + c.uncertainty[i])), n) << c.name << ", " << elements << ", " << i;
      }
    }
}

// The quasistatic element: h^2, so that the two finest meshes are extrapolated.
TEST(TrialRotor, TheQuasistaticElementTendsToTheSameFrequencies) {
  for (const trial::Case& c : trial::read().cases) {
    if (!c.shear || c.speed == 0) continue;
    const Whirler coarse(trial_shaft(BeamElement::timoshenko, 40, c.disc), c.speed),
        fine(trial_shaft(BeamElement::timoshenko, 80, c.disc), c.speed);
    for (std::size_t i = 0; i < 6; ++i) {
      const int n = static_cast<int>(i) / 2 + 1;
      const double sign = i % 2 == 0 ? -1 : 1, high = 5e4;
      const double f = fine.root(n, sign, high), limit = (4 * f - coarse.root(n, sign, high)) / 3;
      EXPECT_NEAR(limit / std::abs(c.frequency[i]), 1, 5e-7) << c.name << ", " << i;
      EXPECT_GT(f, std::abs(c.frequency[i]));
    }
  }
}

// Against the exact Timoshenko beam on pins, E I b^4 - m w^2 - (j + E I m/S) b^2 w^2 + (j m/S) w^4 = 0.
TEST(Families, OrderOfTheFrequencies) {
  const double diameter = 0.12, e = 2.1e11, rho = 7850, area = pi / 4 * diameter * diameter,
               i = pi / 64 * std::pow(diameter, 4), shear = 7.8 / 8.8 * e / 2.6 * area, j = rho * i, m = rho * area;
  const auto exact = [&](int n, bool with_shear) {
    const double b2 = std::pow(n * pi, 2), give = with_shear ? 1 / shear : 0;
    const double a = j * m * give, b = -(m + (j + e * i * m * give) * b2), c = e * i * b2 * b2;
    return std::sqrt(2 * c / (-b + std::sqrt(b * b - 4 * a * c)));
  };
  struct Expected {
    BeamElement element;
    double order;
    int elements;  // of the coarser mesh: elements no longer than the diameter for order six
  };
  for (const auto& [element, order, coarse] :
       {Expected{BeamElement::rayleigh, 4, 8}, Expected{BeamElement::timoshenko, 2, 8},
        Expected{BeamElement::timoshenko_linear, 4, 8}, Expected{BeamElement::timoshenko_hermitian, 6, 20}}) {
    std::vector<std::array<double, 3>> error;
    for (const int elements : {coarse, 2 * coarse}) {
      rotor::Options o = test::uniform_shaft(1, diameter, elements, e, rho);
      o.element = element;
      const auto found = rotor::natural_frequencies(MPI_COMM_WORLD, o, {1, elements + 1}, 3);
      error.emplace_back();
      for (int n = 1; n <= 3; ++n)
        error.back()[static_cast<std::size_t>(n - 1)] =
            found[static_cast<std::size_t>(n - 1)] / exact(n, element != BeamElement::rayleigh) - 1;
    }
    for (std::size_t n = 1; n < 3; ++n) {
      EXPECT_GT(error[1][n], 0) << "a conforming element is too stiff";
      EXPECT_GE(std::log2(error[0][n] / error[1][n]), order - 0.15) << static_cast<int>(element) << ", mode " << n + 1;
      if (element == BeamElement::timoshenko) {
        EXPECT_LE(std::log2(error[0][n] / error[1][n]), order + 0.3);
      }
    }
  }
}

// Shear force and bending moment jump at the disc. Freedoms of shear angle and curvature that run through are wrong to
// first order there; those that end at the disc are not.
TEST(Families, HermitianElementsAreSplitAtDiscsStepsAndJoints) {
  const auto size = [](const rotor::Options& o) { return rotor::Rotor(MPI_COMM_WORLD, o).size(); };
  rotor::Options o = trial_shaft(BeamElement::timoshenko_hermitian, 10, false);
  EXPECT_EQ(size(o), 4 * 11 + 4 * 11);
  o.joints = {3, 3, 6};
  EXPECT_EQ(size(o), 4 * 11 + 4 * 13);
  o.discs = trial_shaft(BeamElement::timoshenko, 10, true).discs;  // node 4
  EXPECT_EQ(size(o), 4 * 11 + 4 * 14);
  o.segments[8].outer_mass_diameter *= 1.1;  // steps at nodes 9 and 10
  EXPECT_EQ(size(o), 4 * 11 + 4 * 16);
  o.element = BeamElement::timoshenko_linear;
  EXPECT_EQ(size(o), 4 * 11 + 4 * 10);
}

// The free rotor: K moves nothing in two shifts and two tilts (geometric multiplicity of the zero eigenvalue 4). The
// shifts have Jordan chains of two (v'' = 0), the tilts have not where the gyroscopic moment is regular on them, and
// precess at (I_p/I) Omega instead: algebraic multiplicity 6.
TEST(TrialRotor, FreeRotorHasADefectiveZeroEigenvalueAndPrecesses) {
  const double speed = 1e4;
  for (const BeamElement element : all_elements) {
    rotor::Options o = trial_shaft(element, 2, false);
    const rotor::Rotor r(MPI_COMM_WORLD, o);
    const Eigen::MatrixXd m = test::dense(r.matrices().mass.get()), g = test::dense(r.matrices().gyroscopic.get()),
                          k = test::dense(r.matrices().stiffness.get());
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> rest(k, m);
    const Eigen::Index n = m.rows();
    EXPECT_LT(std::sqrt(rest.eigenvalues().head(4).cwiseAbs().maxCoeff()), 0.1);
    EXPECT_GT(std::sqrt(rest.eigenvalues()(4)), 1e3);
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    const Eigen::MatrixXd& v = rest.eigenvectors();
    a.topRightCorner(n, n).setIdentity();
    a.bottomLeftCorner(n, n) = -Eigen::MatrixXd(rest.eigenvalues().asDiagonal());
    a.bottomRightCorner(n, n) = -speed * v.transpose() * g * v;
    const Eigen::VectorXcd s = a.eigenvalues();
    EXPECT_EQ((s.array().abs() < 1).count(), 6);
    const double precession = speed * (0.015 * 0.015 / 8) / (0.015 * 0.015 / 16 + 0.3 * 0.3 / 12);
    EXPECT_NEAR(precession, 37.43, 0.005);
    EXPECT_EQ(((s.array().abs() - precession).abs() < 1e-3 && s.array().real().abs() < 1e-3).count(), 4 - 2);
  }
}

// Internal damping opposes motion relative to the turning shaft. Without other damping the rotor becomes unstable where
// its speed passes the first forward critical speed; damped bearings move that up. Quasistatic element, as the
// reference.
TEST(TrialRotor, InternalDampingHasTheThresholdsOfTheReference) {
  rotor::Options o = trial_shaft(BeamElement::timoshenko, 20, true);
  const trial::Reference reference = trial::read();
  o.internal_damping = reference.internal_damping;
  const auto growth = [&](double damping, double speed) {
    double most = -INFINITY, frequency = 0;
    for (const test::Whirl& w : test::whirl_modes(o, {{1, 1e7, damping}, {21, 1e7, damping}}, speed))
      if (w.growth > most) {
        most = w.growth;
        frequency = w.frequency;
      }
    EXPECT_GT(frequency, 0) << "forward whirl";
    EXPECT_NEAR(frequency, 1265, 30);
    return most;
  };
  for (const auto& [damping, threshold] : reference.thresholds) {
    const double within = 2e-5 * threshold;
    EXPECT_LT(growth(damping, threshold - within), 0);
    EXPECT_GT(growth(damping, threshold + within), 0);
  }
}

// The same of other elements and of the shaft without its disc, and where the whirl without damping meets the speed.
TEST(TrialRotor, OtherElementsHaveTheThresholdsAndCriticalSpeedsOfTheReference) {
  const trial::Reference reference = trial::read();
  const auto shaft = [](const trial::OfElement& of) {
    const auto found = std::find_if(all_elements.begin(), all_elements.end(),
                                    [&](BeamElement e) { return deck::name_of(e) == of.element; });
    EXPECT_NE(found, all_elements.end()) << of.element;
    return trial_shaft(found == all_elements.end() ? BeamElement::timoshenko : *found, 10, of.disc);
  };
  EXPECT_EQ(reference.other_thresholds.size(), 12u);
  for (const trial::OfElement& t : reference.other_thresholds) {
    rotor::Options o = shaft(t);
    o.internal_damping = reference.internal_damping;
    const auto growth = [&](double speed) {
      double most = -INFINITY;
      for (const test::Whirl& w :
           test::whirl_modes(o, {{1, 1e7, t.bearing_damping}, {11, 1e7, t.bearing_damping}}, speed))
        most = std::max(most, w.growth);
      return most;
    };
    EXPECT_LT(growth(t.speed * (1 - 1e-5)), 0) << t.element << ' ' << t.disc << ' ' << t.bearing_damping;
    EXPECT_GT(growth(t.speed * (1 + 1e-5)), 0) << t.element << ' ' << t.disc << ' ' << t.bearing_damping;
  }
  EXPECT_EQ(reference.critical_speeds.size(), 5u);
  for (const trial::OfElement& c : reference.critical_speeds)
    EXPECT_NEAR(rotor::critical_speeds(shaft(c), {{1}, {11}}, 1e7, rotor::Whirl::forward, 1).at(0), c.speed,
                1e-8 * c.speed)
        << c.element << ' ' << c.disc;
}

// Any family, whole and reduced: N is the stiffness across the planes, C the stiffness, and in a frame that turns with
// the shaft a bent shape held there, q' = Omega e_z x q, meets no damping: C q' + Omega N q = 0.
TEST(Families, AShapeThatTurnsWithTheShaftIsNotDampedByIt) {
  for (const BeamElement e : all_elements)
    for (const bool reduced : {false, true}) {
      rotor::Options o = test::stepped_shaft();
      o.element = e;
      o.stiffness_damping = 0;
      o.internal_damping = 3e-5;
      if (reduced) o.reduction = {rotor::Reduction::Type::craig_bampton, {2, 12}, 3};
      rotor::Rotor r(MPI_COMM_WORLD, o);
      const Eigen::MatrixXd c = test::dense(r.matrices().damping.get()),
                            n = test::dense(r.matrices().circulatory.get()),
                            k = test::dense(r.matrices().stiffness.get());
      EXPECT_LT((c - 3e-5 * k).norm(), 1e-14 * c.norm());
      EXPECT_LT((n + n.transpose()).norm(), 1e-14 * n.norm());
      Eigen::VectorXd q(r.size()), turned(r.size());
      for (Eigen::Index i = 0; i < q.size(); i += 2) {
        q(i) = std::cos(3.0 * static_cast<double>(i));
        q(i + 1) = std::sin(1 + 5.0 * static_cast<double>(i));
        turned(i) = -q(i + 1);
        turned(i + 1) = q(i);
      }
      EXPECT_LT((c * turned + n * q).norm(), 1e-13 * (c * turned).norm());
      r.set_stiffness_damping(1e-5);
      EXPECT_LT((test::dense(r.matrices().damping.get()) - 4e-5 * k).norm(), 1e-14 * c.norm());
    }
}

// Statics do not depend on the family: nodal deflections of the beam are exact.
TEST(Families, AlignmentIsTheSame) {
  rotor::Options o = test::stepped_shaft();
  const std::vector<rotor::RigidSupport> supports{{2, 0}, {12, 0}};
  const rotor::RigidStatic usual = rotor::rigid_static(MPI_COMM_WORLD, o, supports, 9.81);
  for (const BeamElement e : {BeamElement::timoshenko_linear, BeamElement::timoshenko_hermitian}) {
    o.element = e;
    const rotor::RigidStatic other = rotor::rigid_static(MPI_COMM_WORLD, o, supports, 9.81);
    EXPECT_EQ(other.deflection, usual.deflection);
    EXPECT_EQ(other.moment, usual.moment);
  }
}

// Reductions see inner freedoms as slaves: with all modes of the shaft with its masters held they are exact.
TEST(Families, ReductionsTakeInnerFreedomsAway) {
  for (const BeamElement e : {BeamElement::timoshenko_linear, BeamElement::timoshenko_hermitian}) {
    rotor::Options o = test::stepped_shaft();
    o.element = e;
    o.stiffness_damping = 0;
    const std::vector<test::IsotropicBearing> bearings{{2, 1e8}, {12, 1e8}};
    const auto whole = test::whirl_modes(o, bearings, 500);
    o.reduction = {rotor::Reduction::Type::craig_bampton, {2, 12}, 24};
    const auto reduced = test::whirl_modes(o, bearings, 500);
    ASSERT_EQ(reduced.size(), 52u);
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(reduced[k].frequency / whole[k].frequency, 1, 2e-5) << k;
  }
}

TEST(Families, ElementsWithIndependentShearRefuseARigidOne) {
  rotor::Options o = test::uniform_shaft(1, 0.1, 4);
  o.shear = rotor::Shear::rigid;
  EXPECT_NO_THROW(rotor::validate(o));
  o.element = BeamElement::timoshenko_linear;
  EXPECT_THROW(rotor::validate(o), core::InputError);
}
