#pragma once
// Runge-Kutta steps of a system distributed in space, and the products of their derivatives with vectors.

#include <memory>
#include <vector>

#include "whirl/problem/frozen.hpp"
#include "whirl/problem/system.hpp"
#include "whirl/solve/tableau.hpp"

namespace whirl::solve {

/// The derivative of one step at the point where it was taken: products only, no matrix of size n x n is formed.
class StepProduct {
public:
  /// v := G v, G = d phi/dx_0.
  void apply(Vec v) const;
  /// d phi/dH at fixed angles and d phi/dp.
  [[nodiscard]] Vec d_length() const { return d_length_.get(); }
  [[nodiscard]] Vec d_parameter() const { return d_parameter_.get(); }

private:
  friend class SparseRungeKutta;
  struct Stage {
    std::shared_ptr<const problem::Frozen>
        frozen;                                  // A = dF/d(dx/dt) + H a(j,j) dF/dx of a system that solves it itself
    core::Matrix jx;                             // of the others: dF/dx,
    std::shared_ptr<const core::Matrix> matrix;  // A
    std::shared_ptr<const core::LinearSolver> solver;
  };
  // Work space that the products of one scheme share.
  struct Work {
    std::vector<core::Vector> k;
    core::Vector start, w, rhs;
  };
  /// k_j for dF/dx (v + w_j + H sum_(l<j) a k_l) + (...) k_j + g_j = 0 at all stages, then out += H sum b k; `lift` and
  /// `load` may be empty.
  void stages(Vec v, const std::vector<core::Vector>& lift, const std::vector<core::Vector>& load, Vec out) const;
  const Tableau* tableau_ = nullptr;
  std::shared_ptr<Work> work_;
  double length_ = 0;
  std::vector<Stage> stages_;
  core::Vector d_length_, d_parameter_;
};

/// The same step as RungeKutta for schemes with sequential stages, in scaled states; each stage costs sparse solves on
/// system.comm(): those of System::freeze() if it has them; otherwise exact LU (on each rank, for small systems), GMRES
/// with block Jacobi for large ones on several ranks (PETSc prefix "stage_").
class SparseRungeKutta {
public:
  SparseRungeKutta(problem::System& system, Tableau tableau);

  /// Carries x over one step; fills `product` if not null. Collective; throws core::DomainError on all ranks.
  void step(double angle, double d_angle, double length, Vec x, StepProduct* product);
  /// xdot of F(angle, x, xdot) = 0.
  void rate(double angle, Vec x, Vec xdot);
  [[nodiscard]] Vec state_scale() const { return state_scale_.get(); }
  [[nodiscard]] const Tableau& tableau() const { return tableau_; }

private:
  void residual(double angle, Vec x, Vec k, Vec f);
  [[nodiscard]] core::Matrix jacobian(double angle, Vec x, Vec k, double alpha, double sigma);
  void factorise(core::Matrix matrix);
  void solve_stage(double angle, double own, Vec base, Vec k);
  bool solve_frozen_stage(double angle, double own, Vec base, Vec k);
  [[nodiscard]] std::shared_ptr<const problem::Frozen> freeze(double angle, Vec x, Vec k, double alpha);
  [[noreturn]] void fail() const;
  problem::System& system_;
  Tableau tableau_;
  core::Vector state_scale_, residual_inverse_, x_, k_, value_, base_, f_, d_;
  std::vector<core::Vector> slopes_;
  std::shared_ptr<const core::Matrix> matrix_;  // the last one factorised: constant mass matrices are so once
  std::shared_ptr<const core::LinearSolver> solver_;
  std::shared_ptr<const problem::Frozen> frozen_;  // the last one of this step
  std::shared_ptr<StepProduct::Work> work_;
};

}  // namespace whirl::solve
