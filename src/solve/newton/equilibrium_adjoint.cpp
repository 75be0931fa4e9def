// The transposed linearisation of equilibria and its change along a direction.

#include <petscksp.h>

#include <algorithm>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/plan.hpp"
#include "whirl/solve/newton/equilibrium.hpp"

namespace whirl::solve {

using core::check;

void EquilibriumProblem::solve_transposed(Vec rhs, Vec x) {
  if (ports_ && system_.size() > core::plan::whole_states())
    core::agree(comm(), [&] {
      throw core::NotConverged("approximate inverses of films have no transpose; " +
                               core::plan::too_large(system_.size()));
    });
  solve(true, rhs, x);
}

void EquilibriumProblem::curvature(Vec u, Vec v, Vec w, Vec out) {
  curvature(u, v, nullptr, w, out);
}

void EquilibriumProblem::curvature(Vec u, Vec v, Vec rate, Vec w, Vec out) {
  double largest = 0, of_rate = 0;
  check(VecNorm(v, NORM_INFINITY, &largest));
  if (rate) check(VecNorm(rate, NORM_INFINITY, &of_rate));
  const double h = difference_step(std::max(largest, of_rate));
  core::Vector at = core::duplicate(u), xdot = core::duplicate(x_.get()), weight = core::duplicate(x_.get()),
               seen = core::duplicate(x_.get());
  check(VecSet(xdot.get(), 0.0));
  const auto scaled = [&](Vec from, Vec scale, bool divide, double factor, Vec to) {
    const core::ReadArray a(from), s(scale);
    const core::WriteArray b(to);
    for (PetscInt i = 0; i < b.size(); ++i) b[i] = factor * (divide ? a[i] / s[i] : a[i] * s[i]);
  };
  scaled(w, residual_scale_.get(), true, 1, weight.get());
  check(VecSet(out, 0.0));
  double by_parameter = 0;
  for (const double sign : {1.0, -1.0}) {
    check(VecWAXPY(at.get(), sign * h, v, u));
    prepare(at.get());
    if (rate) scaled(rate, state_scale_.get(), false, sign * h, xdot.get());
    if (!jacobian_) jacobian_ = system_.make_jacobian();
    system_.jacobian(0, x_.get(), xdot.get(), 1, 0, jacobian_.get());
    system_.parameter_derivative(0, x_.get(), xdot.get(), f_.get());
    check(MatMultTranspose(jacobian_.get(), weight.get(), seen.get()));
    by_parameter += sign / (2 * h) * dot(f_.get(), weight.get()) * parameter_scale_;
    const core::ReadArray a(seen.get()), s(state_scale_.get());
    const core::WriteArray b(out);
    for (PetscInt i = 0; i < a.size(); ++i) b[i] += sign / (2 * h) * a[i] * s[i];
  }
  set_last_entry(comm(), out, by_parameter);
  prepare(u);
}

}  // namespace whirl::solve
