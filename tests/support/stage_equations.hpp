#pragma once
// The equations of a Runge-Kutta stage of a system of parts, in blocks, against its assembled Jacobian.

#include <gtest/gtest.h>

#include <cmath>

#include "solve/newton/port_krylov.hpp"
#include "support/dense.hpp"

namespace whirl::test {

/// dF/d(dx/dt) + own dF/dx of a system at rest, scaled, with what solves it.
class StageEquations {
public:
  StageEquations(problem::System& system, Vec x) : system_(system) {
    x_ = core::duplicate(x);
    core::check(VecCopy(x, x_.get()));
    for (core::Vector* v : {&rest_, &scale_, &rows_}) *v = core::duplicate(x);
    core::check(VecSet(rest_.get(), 0));
    system.scales(scale_.get(), rows_.get());
    core::check(VecReciprocal(rows_.get()));
  }
  /// alpha dF/dx + sigma dF/d(dx/dt), assembled.
  core::Matrix matrix(double alpha, double sigma) {
    core::Matrix j = system_.make_jacobian();
    system_.jacobian(0, x_.get(), rest_.get(), alpha, sigma, j.get());
    core::check(MatDiagonalScale(j.get(), rows_.get(), scale_.get()));
    return j;
  }
  solve::PortMatrix blocks(Mat a) {
    if (!layout_) layout_ = std::make_shared<const solve::PortLayout>(a, system_.fields());
    solve::PortMatrix out(layout_);
    out.take(a);
    return out;
  }
  /// Of such a matrix, by the parts' own preconditioners unless options ask for factors.
  std::unique_ptr<solve::PortElimination> elimination(double alpha, double sigma) {
    auto inverse = solve::own_inverse(system_);
    auto out = std::make_unique<solve::PortElimination>(system_.fields(), std::move(inverse));
    if (out->inverse()) out->inverse()->set({0, x_.get(), rest_.get()}, alpha, sigma);
    const core::Matrix a = matrix(alpha, sigma);
    out->factorise(blocks(a.get()));
    return out;
  }
  core::Vector some(double factor) {
    core::Vector v = core::duplicate(x_.get());
    PetscInt begin = 0;
    core::check(VecGetOwnershipRange(v.get(), &begin, nullptr));
    const core::WriteArray a(v.get());
    for (PetscInt i = 0; i < a.size(); ++i) a[i] = std::sin(factor * static_cast<double>((begin + i) * (begin + i)));
    return v;
  }

private:
  problem::System& system_;
  core::Vector x_, rest_, scale_, rows_;
  std::shared_ptr<const solve::PortLayout> layout_;
};

/// Products in blocks are those of the Jacobian; the solution with the preconditioner of another length of step is
/// exact to `error`.
inline void expect_stage_is_solved(problem::System& system, Vec x, double own, double error) {
  StageEquations equations(system, x);
  const core::Vector v = equations.some(1.3);
  core::Vector a = core::duplicate(v.get()), b = core::duplicate(v.get());
  for (const double alpha : {0.0, own}) {
    const core::Matrix m = equations.matrix(alpha, 1);
    core::check(MatMult(m.get(), v.get(), b.get()));
    solve::PortKrylov::multiply(equations.blocks(m.get()), v.get(), a.get());
    const Eigen::VectorXd expected = dense(b.get());
    EXPECT_GT(expected.lpNorm<Eigen::Infinity>(), 0);
    EXPECT_LE((dense(a.get()) - expected).lpNorm<Eigen::Infinity>(), 1e-13 * expected.lpNorm<Eigen::Infinity>())
        << alpha;
  }
  const core::Matrix m = equations.matrix(own, 1);
  const solve::PortMatrix blocks = equations.blocks(m.get());
  const auto near = equations.elimination(0.7 * own, 1);
  solve::PortKrylov krylov(*blocks.layout(), "stage_");
  krylov.solve(blocks, *near, b.get(), a.get(), 1e-12);
  EXPECT_LE((dense(a.get()) - dense(v.get())).lpNorm<Eigen::Infinity>(), error);
}

/// Krylov iterations to 1e-9 of alpha dF/dx + sigma dF/d(dx/dt).
inline int iterations(problem::System& system, Vec x, double alpha, double sigma) {
  StageEquations equations(system, x);
  const core::Matrix m = equations.matrix(alpha, sigma);
  const solve::PortMatrix blocks = equations.blocks(m.get());
  const auto elimination = equations.elimination(alpha, sigma);
  const core::Vector b = equations.some(0.7);
  core::Vector y = core::duplicate(b.get());
  solve::PortKrylov krylov(*blocks.layout(), "stage_");
  return krylov.solve(blocks, *elimination, b.get(), y.get(), 1e-9);
}

}  // namespace whirl::test
