// Tapered segments.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <numbers>

#include "rotor/shafts.hpp"
#include "support/dense.hpp"
#include "whirl/core/error.hpp"
#include "whirl/rotor/element.hpp"
#include "whirl/rotor/frequencies.hpp"
#include "whirl/rotor/rotor.hpp"
#include "whirl/rotor/shaft.hpp"

using namespace whirl;
using rotor::BeamElement;
using std::numbers::pi;

namespace {

constexpr std::array all_elements{BeamElement::rayleigh, BeamElement::timoshenko, BeamElement::timoshenko_linear,
                                  BeamElement::timoshenko_hermitian};

}  // namespace

// A cone, held at its thick end, with a force at the thin one: E I w'' = P z, z from the free end. With d = d0 (1 + c
// z) the tip moves by P/(E I0) times the integral of z^2/(1 + c z)^4.
TEST(Tapered, ConeUnderATipForceConvergesToTheExactDeflection) {
  const double length = 0.5, thin = 0.04, thick = 0.08, e = 2.1e11, c = (thick / thin - 1) / length;
  const double k = 1 + c * length, i0 = pi / 64 * std::pow(thin, 4);
  // with t = 1 + c z: (t^-2 - 2 t^-3 + t^-4)/c^3
  const double integral = ((1 - 1 / k) - (1 - 1 / (k * k)) + (1 - 1 / (k * k * k)) / 3) / (c * c * c);
  std::vector<double> error;
  for (const int elements : {4, 8, 16}) {
    rotor::Options o = test::uniform_shaft(length, thin, elements, e);
    o.element = BeamElement::rayleigh;
    for (int n = 0; n < elements; ++n) {
      rotor::Segment& s = o.segments[static_cast<std::size_t>(n)];
      s.outer_mass_diameter = thin + (thick - thin) * n / elements;
      s.right_outer_diameter = thin + (thick - thin) * (n + 1) / elements;
    }
    const rotor::Rotor r(MPI_COMM_WORLD, o);
    const Eigen::MatrixXd both = test::dense(r.matrices().stiffness.get());
    const Eigen::Index free = 2 * elements;
    const Eigen::MatrixXd plane = both(Eigen::seqN(0, free, 2), Eigen::seqN(0, free, 2));
    const Eigen::VectorXd tip = plane.ldlt().solve(Eigen::VectorXd::Unit(free, 0));
    error.push_back(1 - tip(0) / (integral / (e * i0)));
  }
  EXPECT_GT(error[2], 0);
  EXPECT_GE(std::log2(error[0] / error[1]), 3.7);
  EXPECT_GE(std::log2(error[1] / error[2]), 3.9);
}

TEST(Tapered, MassAndRigidInertiaAreExact) {
  rotor::Options o = test::uniform_shaft(0.5, 0.04, 1, 2.1e11, 7850, 0.02);
  o.segments[0].right_outer_diameter = 0.1;
  o.segments[0].right_inner_diameter = 0.01;
  const auto moment = [](double d0, double d1, int power) {  // of the solid, about the left end, by fine quadrature
    double sum = 0;
    const int n = 20000;
    for (int i = 0; i < n; ++i) {
      const double x = (i + 0.5) / n, d = d0 + (d1 - d0) * x, z = 0.5 * x;
      sum += (pi / 4 * d * d * std::pow(z, power) + (power == 2 ? pi / 64 * std::pow(d, 4) : 0)) * 0.5 / n * 7850;
    }
    return sum;
  };
  const double mass = moment(0.04, 0.1, 0) - moment(0.02, 0.01, 0);
  EXPECT_NEAR(rotor::total_mass(o) / mass, 1, 1e-8);
  for (const BeamElement e : all_elements) {
    const rotor::ElementMatrices m = rotor::element_matrices(
        o.segments[0], o.material, e == BeamElement::rayleigh ? rotor::Shear::rigid : rotor::Shear::cowper_hollow, e);
    Eigen::VectorXd shift = Eigen::VectorXd::Zero(4 + rotor::n_inner(e)), turn = shift;
    shift.head(4) << 1, 0, 1, 0;
    turn.head(4) << 0, 1, 0.5, 1;
    EXPECT_NEAR(shift.dot(m.translational_mass * shift) / mass, 1, 1e-8);
    EXPECT_NEAR(m.weight.dot(shift) / mass, 1, 1e-8);
    EXPECT_NEAR(turn.dot(m.translational_mass * shift) / (moment(0.04, 0.1, 1) - moment(0.02, 0.01, 1)), 1, 1e-8);
    EXPECT_NEAR(
        turn.dot((m.translational_mass + m.rotary_mass) * turn) / (moment(0.04, 0.1, 2) - moment(0.02, 0.01, 2)), 1,
        1e-8);
    EXPECT_LT((m.stiffness * turn).norm() + (m.stiffness * shift).norm(), 1e-12 * m.stiffness.norm());
  }
}

// The families keep their orders and agree in the limit; a segment that is cut in two is the same cone.
TEST(Tapered, FamiliesConvergeToTheSameFrequencies) {
  const auto frequencies = [](BeamElement element, int elements) {
    rotor::Options o = test::uniform_shaft(0.6, 0.06, elements);
    o.element = element;
    for (int n = 0; n < elements; ++n) {
      rotor::Segment& s = o.segments[static_cast<std::size_t>(n)];
      s.outer_mass_diameter = 0.06 + 0.06 * n / elements;
      s.right_outer_diameter = 0.06 + 0.06 * (n + 1) / elements;
    }
    return rotor::natural_frequencies(MPI_COMM_WORLD, o, {1, elements + 1}, 2);
  };
  const auto limit = frequencies(BeamElement::timoshenko_hermitian, 64);
  for (const auto& [element, order] :
       {std::pair{BeamElement::timoshenko, 2.0}, {BeamElement::timoshenko_linear, 4.0}}) {
    const auto coarse = frequencies(element, 20), fine = frequencies(element, 40);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_GE(std::log2((coarse[k] - limit[k]) / (fine[k] - limit[k])), order - 0.15) << k;
      EXPECT_LT(fine[k] / limit[k] - 1, order > 2 ? 2e-6 : 1e-3);
    }
  }
}

TEST(Tapered, WrongOnesAreRefused) {
  rotor::Options o = test::uniform_shaft(1, 0.1, 2);
  o.segments[1].right_outer_diameter = 0.05;
  EXPECT_NO_THROW(rotor::validate(o));
  o.segments[1].right_inner_diameter = 0.06;
  EXPECT_THROW(rotor::validate(o), core::InputError);
  o.segments[1].right_inner_diameter.reset();
  o.segments[1].outer_stiffness_diameter = 0.1;
  EXPECT_THROW(rotor::validate(o), core::InputError);
}
