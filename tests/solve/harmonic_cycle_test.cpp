// Cycles of a given amplitude near a Hopf point, by harmonic balance, against exact cycles and the normal form.

#include <gtest/gtest.h>

#include "cycle_systems.hpp"
#include "whirl/solve/bifurcation/harmonic_cycle.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"

using namespace whirl;
using test::Column;
using test::Complex;

namespace {

// z' = (slope p + 1.4 i) z + (re - 0.2 i) z |z|^2 about a rest that moves with the parameter, z = y0 + i y1, y = g(x -
// rest), beside a lag x2 that follows the square of the motion. `bend` 0: the cycles are circles, p = -re/slope A^2.
struct MovingHopf {
  double re = -0.7, bend = 0, slope = 2;
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    const T u = x(0) - 0.3 * p, v = x(1) + 0.2 * p;
    const T y0 = u + bend * (0.5 * u * u - 0.3 * u * v), y1 = v + bend * (0.4 * u * u + 0.2 * v * v);
    const T d0 = (1.0 + bend * (u - 0.3 * v)) * xdot(0) - bend * 0.3 * u * xdot(1),
            d1 = bend * 0.8 * u * xdot(0) + (1.0 + bend * 0.4 * v) * xdot(1), q = y0 * y0 + y1 * y1;
    Column<T> f(3);
    f << d0 - (slope * p * y0 - 1.4 * y1 + q * (re * y0 + 0.2 * y1)),
        d1 - (slope * p * y1 + 1.4 * y0 + q * (re * y1 - 0.2 * y0)), xdot(2) + x(2) - bend * y0 * y0;
    return f;
  }
};

solve::HarmonicCycle cycle_of(test::SmallSystem& s, Vec rest, int harmonics) {
  auto q = solve::critical_vector(s, rest, 1.4);
  const double size = std::abs(q[0]);
  for (Complex& e : q) e /= size;
  return {s, rest, 1.4, std::move(q), harmonics, 0.5};
}

}  // namespace

TEST(HarmonicCycle, CirclesAreExact) {
  for (const double re : {-0.7, 0.4}) {
    test::SmallSystem s(PETSC_COMM_SELF, 3, 0, 1, MovingHopf{re});
    const core::Vector rest = s.vector(Eigen::VectorXd::Zero(3));
    auto cycles = cycle_of(s, rest.get(), 2);
    for (const double a : {0.05, 0.1, 0.4}) {
      const auto [p, omega] = cycles.at_amplitude(a, {});
      EXPECT_NEAR(p, -re / 2 * a * a, 1e-9);
      EXPECT_NEAR(omega, 1.4 - 0.2 * a * a, 1e-9);
      s.set_parameter(0);
    }
  }
}

// p = -Re c_1/slope |z|^2 with c_1 of the normal form, x = z q + conj: A = 2 |z| |q_0|.
TEST(HarmonicCycle, BentCyclesAreBornWithTheCurvatureOfTheNormalForm) {
  for (const double re : {-0.7, 0.4}) {
    test::SmallSystem s(PETSC_COMM_SELF, 3, 0, 1, MovingHopf{re, 1});
    const core::Vector rest = s.vector(Eigen::VectorXd::Zero(3));
    auto cycles = cycle_of(s, rest.get(), 5);
    const double h = 0.02, one = cycles.at_amplitude(h, {})[0] / (h * h);
    s.set_parameter(0);
    const double two = cycles.at_amplitude(2 * h, {})[0] / (4 * h * h);
    s.set_parameter(0);
    EXPECT_NEAR((4 * one - two) / 3, -re / 2, 1e-5);
    EXPECT_GT(std::abs(two - one), 5e-5) << "the bend shows";
    const double length = std::abs(solve::critical_vector(s, rest.get(), 1.4)[0]);
    EXPECT_NEAR(-solve::hopf_coefficient(s, rest.get(), 1.4) / 2 / std::pow(2 * length, 2), (4 * one - two) / 3, 1e-5);
  }
}

TEST(HarmonicCycle, MoreHarmonicsConvergeToTheBentCycle) {
  test::SmallSystem s(PETSC_COMM_SELF, 3, 0, 1, MovingHopf{-0.7, 1});
  const core::Vector rest = s.vector(Eigen::VectorXd::Zero(3));
  std::vector<double> p;
  for (const int harmonics : {2, 4, 8, 16}) {
    auto cycles = cycle_of(s, rest.get(), harmonics);
    p.push_back(cycles.at_amplitude(0.2, {})[0]);
    s.set_parameter(0);
  }
  EXPECT_LT(std::abs(p[1] - p[3]), 0.2 * std::abs(p[0] - p[3]));
  EXPECT_LT(std::abs(p[2] - p[3]), 1e-7);
}
