// The Taylor test itself: it passes exact derivatives and fails wrong ones.

#include <gtest/gtest.h>

#include <cmath>

#include "support/small_system.hpp"
#include "whirl/problem/taylor.hpp"

using namespace whirl;
using test::Column;

namespace {

struct Formula {
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T p) const {
    Column<T> f(3);
    f << xdot(0) - x(1) * x(1), xdot(1) + p * p * sin(x(0)) - std::cos(angle), 2.0 * xdot(2) + x(2) * x(0) - exp(p);
    return f;
  }
};

// One derivative falsified by a tenth.
class Wrong : public test::SmallSystem {
public:
  Wrong(double p, int which) : SmallSystem(MPI_COMM_WORLD, 3, p, 1, Formula{}), which_(which) {}
  void jacobian(double angle, Vec x, Vec xdot, double alpha, double sigma, Mat j) override {
    SmallSystem::jacobian(angle, x, xdot, which_ == 0 ? 1.1 * alpha : alpha, which_ == 1 ? 1.1 * sigma : sigma, j);
  }
  void parameter_derivative(double angle, Vec x, Vec xdot, Vec f) override {
    SmallSystem::parameter_derivative(angle, x, xdot, f);
    if (which_ == 2) core::check(VecScale(f, 1.1));
  }

private:
  int which_;
};

problem::TaylorReport report(double p, int which) {
  Wrong s(p, which);
  const core::Vector x = s.vector(Eigen::Vector3d(0.3, -0.7, 1.1)), xdot = s.vector(Eigen::Vector3d(0.2, 0.5, -0.4));
  return problem::taylor_test(s, 0.9, x.get(), xdot.get(), 1e-3);
}

}  // namespace

TEST(Taylor, PassesExactDerivatives) {
  for (const double p : {1.3, -0.4, 0.0}) {
    const auto r = report(p, -1);
    EXPECT_NEAR(r.state_order, 2, 0.05);
    EXPECT_NEAR(r.rate_order, 2, 0.05);
    EXPECT_NEAR(r.parameter_order, 2, 0.05);
    EXPECT_GT(r.first_difference, 1e-4);
  }
}

TEST(Taylor, FailsWrongDerivativesAlsoAtParameterZero) {
  for (const double p : {1.3, 0.0}) {
    EXPECT_LT(report(p, 0).state_order, 1.5);
    EXPECT_LT(report(p, 1).rate_order, 1.5);
    EXPECT_LT(report(p, 2).parameter_order, 1.5);
  }
}
