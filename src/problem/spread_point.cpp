#include "whirl/problem/spread_point.hpp"

namespace whirl::problem {

using core::check;

SpreadPoint::SpreadPoint(System& system) : system_(system) {
  x_ = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  for (core::Vector* v : {&xdot_, &state_scale_, &residual_inverse_}) *v = core::duplicate(x_.get());
  system.scales(state_scale_.get(), residual_inverse_.get());
  check(VecReciprocal(residual_inverse_.get()));
}

void SpreadPoint::put(Vec x, Vec xdot) {
  check(VecPointwiseMult(x_.get(), x, state_scale_.get()));
  check(VecPointwiseMult(xdot_.get(), xdot, state_scale_.get()));
}

void SpreadPoint::residual(double angle, Vec x, Vec xdot, Vec f) {
  put(x, xdot);
  system_.residual(angle, x_.get(), xdot_.get(), f);
  check(VecPointwiseMult(f, f, residual_inverse_.get()));
}

void SpreadPoint::jacobian(double angle, Vec x, Vec xdot, double alpha, double sigma, core::Matrix& m) {
  put(x, xdot);
  if (!m) m = system_.make_jacobian();
  system_.jacobian(angle, x_.get(), xdot_.get(), alpha, sigma, m.get());
  check(MatDiagonalScale(m.get(), residual_inverse_.get(), state_scale_.get()));
}

void SpreadPoint::parameter_derivative(double angle, Vec x, Vec xdot, Vec f) {
  put(x, xdot);
  system_.parameter_derivative(angle, x_.get(), xdot_.get(), f);
  check(VecPointwiseMult(f, f, residual_inverse_.get()));
}

}  // namespace whirl::problem
