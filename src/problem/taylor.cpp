#include "whirl/problem/taylor.hpp"

#include <cmath>

namespace whirl::problem {
namespace {

using core::check;

// A fixed "random" direction that is the same on any number of ranks.
void direction(Vec v, double seed) {
  PetscInt begin = 0;
  check(VecGetOwnershipRange(v, &begin, nullptr));
  const core::WriteArray a(v);
  for (PetscInt i = 0; i < a.size(); ++i) a[i] = std::sin(seed + 12.9898 * static_cast<double>(begin + i + 1));
}

double scaled_norm(Vec f, Vec scale) {
  core::Vector work = core::duplicate(f);
  check(VecPointwiseDivide(work.get(), f, scale));
  double norm = 0;
  check(VecNorm(work.get(), NORM_2, &norm));
  return norm;
}

double order(double coarse, double fine, double round_off) {
  if (coarse < round_off) return 2;
  return std::log2(coarse / std::max(fine, 1e-300));
}

}  // namespace

TaylorReport taylor_test(System& system, double angle, Vec x, Vec xdot, double h) {
  core::Vector xs = core::duplicate(x), fs = core::duplicate(x), dx = core::duplicate(x), f0 = core::duplicate(x),
               f1 = core::duplicate(x), jd = core::duplicate(x), moved = core::duplicate(x);
  system.scales(xs.get(), fs.get());
  core::Matrix j = system.make_jacobian();
  system.residual(angle, x, xdot, f0.get());
  TaylorReport report;
  const double base = scaled_norm(f0.get(), fs.get());

  const auto remainder = [&](Vec at, Vec rate, double step) {
    system.residual(angle, at, rate, f1.get());
    check(VecAXPY(f1.get(), -1, f0.get()));
    report.first_difference = std::max(report.first_difference, scaled_norm(f1.get(), fs.get()));
    check(VecAXPY(f1.get(), -step, jd.get()));
    return scaled_norm(f1.get(), fs.get());
  };
  direction(dx.get(), 1);
  check(VecPointwiseMult(dx.get(), dx.get(), xs.get()));
  for (const bool rate : {false, true}) {
    system.jacobian(angle, x, xdot, rate ? 0 : 1, rate ? 1 : 0, j.get());
    check(MatMult(j.get(), dx.get(), jd.get()));
    double size[2];
    for (int k = 0; k < 2; ++k) {
      const double step = h / (k + 1);
      check(VecWAXPY(moved.get(), step, dx.get(), rate ? xdot : x));
      size[k] = rate ? remainder(x, moved.get(), step) : remainder(moved.get(), xdot, step);
    }
    const double round_off = 1e-12 * (base + report.first_difference);
    (rate ? report.rate_order : report.state_order) = order(size[0], size[1], round_off);
  }
  const double p = system.parameter(), unit = h * (p != 0 ? std::abs(p) : 1.0);
  system.parameter_derivative(angle, x, xdot, jd.get());
  double size[2];
  for (int k = 0; k < 2; ++k) {
    const double step = unit / (k + 1);
    system.set_parameter(p + step);
    size[k] = remainder(x, xdot, step);
  }
  system.set_parameter(p);
  report.parameter_order = order(size[0], size[1], 1e-12 * (base + report.first_difference));
  return report;
}

}  // namespace whirl::problem
