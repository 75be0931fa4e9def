// The element and the shaft: exact statements about one beam, the material and the options.

#include "whirl/rotor/element.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <functional>
#include <numbers>

#include "rotor/shafts.hpp"
#include "whirl/core/error.hpp"
#include "whirl/rotor/shaft.hpp"

using namespace whirl;
using std::numbers::pi;

namespace {

rotor::Beam some_beam() {
  rotor::Segment s;
  s.length = 0.3;
  s.outer_mass_diameter = 0.2;
  s.inner_mass_diameter = 0.05;
  s.outer_stiffness_diameter = 0.17;
  s.added_mass = 12;
  s.added_mass_inner_diameter = 0.2;
  s.added_mass_outer_diameter = 0.5;
  rotor::Material m;
  m.modulus = {{293.15, 2.1e11}};
  return rotor::make_beam(s, m, rotor::Shear::cowper_solid);
}

}  // namespace

TEST(Element, RigidMotionsNeedNoForceAndCarryTheRigidInertia) {
  const rotor::Beam b = some_beam();
  const double l = b.length;
  const Eigen::Vector4d shift(1, 0, 1, 0), turn(-l / 2, 1, l / 2, 1);
  const Eigen::Matrix4d k = rotor::stiffness(b), mt = rotor::translational_mass(b), mr = rotor::rotary_mass(b);
  EXPECT_LT((k * shift).norm(), 1e-14 * k.norm());
  EXPECT_LT((k * turn).norm(), 1e-14 * k.norm());
  const double mass = b.mass_per_length * l;
  EXPECT_NEAR(shift.dot(mt * shift) / mass, 1, 1e-14);
  EXPECT_NEAR(turn.dot(mt * turn) / (mass * l * l / 12), 1, 1e-13);
  EXPECT_NEAR(turn.dot(mr * turn) / (b.inertia_per_length * l), 1, 1e-13);
  EXPECT_LT((mr * shift).norm(), 1e-13 * mr.norm());
  for (const Eigen::Matrix4d& a : {k, mt, mr}) EXPECT_LT((a - a.transpose()).norm(), 1e-15 * a.norm());
}

TEST(Element, CantileverTipIsExact) {
  const rotor::Beam b = some_beam();
  const double l = b.length, ei = b.bending_stiffness, phi = b.shear_parameter;
  const Eigen::Matrix2d k = rotor::stiffness(b).bottomRightCorner<2, 2>();
  const Eigen::Vector2d tip = k.inverse() * Eigen::Vector2d(1000, 0);
  EXPECT_NEAR(tip(0) / (1000 * l * l * l / (3 * ei) * (1 + phi / 4)), 1, 1e-12);  // bending and shear P L/(kappa G A)
  EXPECT_NEAR(tip(1) / (1000 * l * l / (2 * ei)), 1, 1e-12);
}

TEST(Element, WeightIsTheLoadOfRigidMotions) {
  const rotor::Beam b = some_beam();
  const double l = b.length;
  const Eigen::Vector4d f = rotor::weight(b), shift(1, 0, 1, 0), turn(-l / 2, 1, l / 2, 1);
  EXPECT_NEAR(f.dot(shift), b.mass_per_length * l, 1e-12);
  EXPECT_NEAR(f.dot(turn), 0, 1e-12);
}

TEST(Element, ConstantsFollowTheirDefinitions) {
  const rotor::Beam b = some_beam();
  const double area_s = pi / 4 * 0.17 * 0.17, i_s = pi / 64 * std::pow(0.17, 4);
  EXPECT_NEAR(b.bending_stiffness, 2.1e11 * i_s, 1e-6 * b.bending_stiffness);
  const double kappa = 6 * 1.3 / 8.8, g = 2.1e11 / 2.6;
  EXPECT_NEAR(b.shear_parameter, 12 * 2.1e11 * i_s / (kappa * g * area_s * 0.09), 1e-12);
  EXPECT_NEAR(b.mass_per_length, 7850 * pi / 4 * (0.04 - 0.0025) + 40, 1e-10);
  EXPECT_NEAR(b.inertia_per_length, 7850 * pi / 64 * (0.0016 - 6.25e-6) + 40 * 0.29 / 16, 1e-12);
}

TEST(Element, ShearCoefficients) {
  rotor::Segment s;
  s.length = 1;
  s.outer_mass_diameter = 0.2;
  rotor::Material m;
  m.modulus = {{0, 2e11}};
  const auto phi = [&](rotor::Shear shear) { return rotor::make_beam(s, m, shear).shear_parameter; };
  EXPECT_EQ(phi(rotor::Shear::rigid), 0);
  EXPECT_DOUBLE_EQ(phi(rotor::Shear::cowper_hollow), phi(rotor::Shear::cowper_solid));
  s.inner_mass_diameter = 0.2 - 1e-6;  // thin tube: kappa = 2 (1 + nu)/(4 + 3 nu)
  const double solid = 6 * 1.3 / 8.8, thin = 2 * 1.3 / 4.9;
  EXPECT_NEAR(phi(rotor::Shear::cowper_hollow) / phi(rotor::Shear::cowper_solid), solid / thin, 1e-5);
}

TEST(Shaft, ModulusIsLinearBetweenPointsAndRefusedOutside) {
  rotor::Material m;
  m.modulus = {{300, 2e11}, {400, 1.9e11}, {600, 1.5e11}};
  EXPECT_DOUBLE_EQ(rotor::modulus(m, 300), 2e11);
  EXPECT_DOUBLE_EQ(rotor::modulus(m, 350), 1.95e11);
  EXPECT_DOUBLE_EQ(rotor::modulus(m, 400), 1.9e11);
  EXPECT_DOUBLE_EQ(rotor::modulus(m, 550), 1.6e11);
  EXPECT_DOUBLE_EQ(rotor::modulus(m, 600), 1.5e11);
  EXPECT_THROW((void)rotor::modulus(m, 299.9), core::DomainError);
  EXPECT_THROW((void)rotor::modulus(m, 600.1), core::DomainError);
  m.modulus.resize(1);
  EXPECT_DOUBLE_EQ(rotor::modulus(m, 1000), 2e11);
}

TEST(Shaft, DiscGeometryAddsToGivenInertias) {
  rotor::Material m;
  rotor::Disc d;
  d.mass = 1;
  d.outer_diameter = 0.28;
  d.inner_diameter = 0.05;
  d.thickness = 0.07;
  d.density = 7810;
  const rotor::Disc r = rotor::resolved(d, m);
  EXPECT_NEAR(r.mass, 1 + 32.5897, 1e-3);  // Friswell et al. (2010), example 5.9.1: 32.590 kg, 0.17809, 0.32956 kg m^2
  EXPECT_NEAR(r.diametral_inertia, 0.17809, 1e-5);
  EXPECT_NEAR(r.polar_inertia, 0.32956, 1e-5);
}

TEST(Shaft, WrongOptionsAreRefusedWithTheirPlace) {
  const auto refuses = [](const std::function<void(rotor::Options&)>& spoil, const std::string& text) {
    rotor::Options o = test::stepped_shaft();
    o.reduction = {rotor::Reduction::Type::craig_bampton, {2, 9}, 3};
    EXPECT_NO_THROW(rotor::validate(o));
    spoil(o);
    try {
      rotor::validate(o);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const core::InputError& e) {
      EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
    }
  };
  refuses([](auto& o) { o.segments.clear(); }, "no segments");
  refuses([](auto& o) { o.segments[2].length = 0; }, "segment 3: the length");
  refuses([](auto& o) { o.segments[2].length = std::nan(""); }, "segment 3: the length");
  refuses([](auto& o) { o.segments[0].inner_mass_diameter = 0.06; }, "segment 1: mass diameters");
  refuses([](auto& o) { o.segments[4].inner_stiffness_diameter = 1; }, "segment 5: stiffness diameters");
  refuses([](auto& o) { o.segments[4].outer_stiffness_diameter = -1; }, "segment 5: stiffness diameters");
  refuses([](auto& o) { o.segments[4].added_mass = -1; }, "segment 5: the added mass");
  refuses([](auto& o) { o.segments[11].temperature = 900; }, "segment 12: temperature 900 K is outside");
  refuses([](auto& o) { o.material.modulus.clear(); }, "modulus is missing");
  refuses([](auto& o) { std::swap(o.material.modulus[0], o.material.modulus[1]); }, "modulus 2: temperatures");
  refuses([](auto& o) { o.material.density = 0; }, "density");
  refuses([](auto& o) { o.discs[0].node = 14; }, "disc 1: node 14 is not in 1..13");
  refuses([](auto& o) { o.discs[0].thickness = 0; }, "disc 1: geometry");
  refuses([](auto& o) { o.reduction.masters = {2}; }, "at least two");
  refuses([](auto& o) { o.reduction.masters = {2, 2}; }, "master node 2 is listed twice");
  refuses([](auto& o) { o.reduction.masters = {0, 2}; }, "master node 0");
  refuses([](auto& o) { o.reduction.modes = 25; }, "25 fixed-interface modes");
  refuses([](auto& o) { o.stiffness_damping = -1; }, "damping");
}
