#pragma once
// Systems with exactly known cycles, and a little ceremony around CycleProblem.

#include <cmath>
#include <numbers>

#include "support/small_system.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"
#include "whirl/solve/newton/newton.hpp"

namespace whirl::test {

inline constexpr double two_pi = 2 * std::numbers::pi;

/// x'' + 0.2 x' + x = cos(angle); p is the speed. x = Re(z exp(i angle)), z = 1/(1 - p^2 + 0.2 i p).
struct LinearOscillator {
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T) const {
    Column<T> f(2);
    f << xdot(0) - x(1), xdot(1) + 0.2 * x(1) + x(0) - std::cos(angle);
    return f;
  }
  static Eigen::Vector2d exact(double angle, double p) {
    const Complex z = std::polar(1.0, angle) / Complex(1 - p * p, 0.2 * p);
    return {z.real(), (Complex(0, p) * z).real()};
  }
};

/// x'' + 0.2 x' + x + x^3 = u(angle; p) with u made so that x = exp(sin(angle)); p is the speed.
struct ManufacturedDuffing {
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T p) const {
    const double s = std::sin(angle), c = std::cos(angle), e = std::exp(s);
    Column<T> f(2);
    f << xdot(0) - x(1),
        xdot(1) + 0.2 * x(1) + x(0) + x(0) * x(0) * x(0) - (p * p * (c * c - s) + 0.2 * p * c + 1.0 + e * e) * e;
    return f;
  }
  static Eigen::Vector2d exact(double angle, double p) {
    const double e = std::exp(std::sin(angle));
    return {e, p * std::cos(angle) * e};
  }
};

/// z' = (p + i) z - (1 + 0.5 i) |z|^2 z: radius sqrt(p), T = 2 pi/(1 - 0.5 p), multipliers 1 and exp(-2 p T).
struct HopfNormalForm {
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    const T q = x(0) * x(0) + x(1) * x(1);
    Column<T> f(2);
    f << xdot(0) - (p * x(0) - x(1) - q * (x(0) - 0.5 * x(1))), xdot(1) - (p * x(1) + x(0) - q * (x(1) + 0.5 * x(0)));
    return f;
  }
  static double period(double p) { return two_pi / (1 - 0.5 * p); }
  static Eigen::Vector2d exact(double angle, double p) {
    return std::sqrt(p) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
};

/// x'' - (1 - x^2) x' + x = 0 with p in place of the first 1.
struct VanDerPol {
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    Column<T> f(2);
    f << xdot(0) - x(1), xdot(1) - p * (1.0 - x(0) * x(0)) * x(1) + x(0);
    return f;
  }
};

/// The cycle whose nodes take the values of `state(angle)`.
template <class F>
solve::Cycle sampled(const solve::Scheme& scheme, const std::vector<double>& mesh, double period, double parameter,
                     F state) {
  solve::Cycle c{mesh, {}, period, parameter};
  const Eigen::Index m = scheme.degree;
  c.x.resize(state(0.0).size(), c.intervals() * m);
  for (Eigen::Index i = 0; i < c.intervals(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (Eigen::Index l = 1; l <= m; ++l)
      c.x.col(i * m + l - 1) = state(two_pi * (mesh[k] + (mesh[k + 1] - mesh[k]) * scheme.node(l)));
  }
  return c;
}

inline solve::NewtonOptions sharp() {
  solve::NewtonOptions o;
  o.tolerance = 1e-13;
  o.max_iterations = 25;
  return o;
}

/// Newton at fixed parameter; fails the test unless it converges.
inline solve::NewtonResult solve_at(solve::PeriodicProblem& problem, Vec u, double parameter,
                                    const solve::NewtonOptions& options = sharp()) {
  core::Vector row = core::duplicate(u);
  solve::parameter_row(problem, row.get());
  solve::set_last_entry(problem.comm(), u, parameter / problem.parameter_scale());
  return solve::newton(problem, u, row.get(), parameter / problem.parameter_scale(), options);
}

/// Four intervals of lengths 2 : 3 : 4 : 3, each split 2^doublings times.
inline std::vector<double> uneven_mesh(int doublings) {
  std::vector<double> mesh{0, 2.0 / 12, 5.0 / 12, 9.0 / 12, 1};
  for (int k = 0; k < doublings; ++k) mesh = solve::doubled(mesh);
  return mesh;
}

}  // namespace whirl::test
