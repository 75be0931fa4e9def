#include "whirl/solve/newton/frequency_response.hpp"

#include <petscksp.h>

#include <algorithm>

#include "solve/newton/eliminated_response.hpp"
#include "whirl/core/direct_solver.hpp"

namespace whirl::solve {

using core::check;

FrequencyResponse::FrequencyResponse(problem::System& system) : system_(system) {
  rest_ = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  state_scale_ = core::duplicate(rest_.get());
  residual_scale_ = core::duplicate(rest_.get());
  system.scales(state_scale_.get(), residual_scale_.get());
  jx_ = system.make_jacobian();
  jd_ = system.make_jacobian();
  if (core::size_of(system.comm()) == 1) {
    eliminated_ = std::make_unique<EliminatedResponse>();
    return;
  }
  rhs_ = core::make_vector(system.comm(), 2 * system.local_size(), PETSC_DETERMINE);
  answer_ = core::duplicate(rhs_.get());
  whole_scale_ = core::gather(state_scale_.get());
}

FrequencyResponse::~FrequencyResponse() = default;

void FrequencyResponse::solve(Vec x, double omega, const std::vector<double>& right, std::vector<double>& amplitude) {
  system_.jacobian(0, x, rest_.get(), 1, 0, jx_.get());
  system_.jacobian(0, x, rest_.get(), 0, 1, jd_.get());
  if (eliminated_) {
    const core::ReadArray rows(residual_scale_.get()), columns(state_scale_.get());
    eliminated_->solve(jx_.get(), jd_.get(), omega, rows.data(), columns.data(), right, amplitude);
    return;
  }
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(jx_.get(), &begin, &end));
  const PetscInt rows = end - begin;
  const bool fresh = !matrix_;
  if (fresh) {
    std::vector<PetscInt> count(static_cast<std::size_t>(std::max<PetscInt>(2 * rows, 1)), 0);
    for (PetscInt i = begin; i < end; ++i) {
      PetscInt k = 0;
      check(MatGetRow(jx_.get(), i, &k, nullptr, nullptr));
      count[static_cast<std::size_t>(2 * (i - begin))] = count[static_cast<std::size_t>(2 * (i - begin) + 1)] = 2 * k;
      check(MatRestoreRow(jx_.get(), i, &k, nullptr, nullptr));
    }
    std::vector<PetscInt> local = count;
    for (auto& k : local) k = std::min(k, 2 * rows);
    check(MatCreate(system_.comm(), matrix_.put()));
    check(MatSetSizes(matrix_.get(), 2 * rows, 2 * rows, PETSC_DETERMINE, PETSC_DETERMINE));
    check(MatSetType(matrix_.get(), MATAIJ));
    check(MatSeqAIJSetPreallocation(matrix_.get(), 0, count.data()));
    check(MatMPIAIJSetPreallocation(matrix_.get(), 0, local.data(), 0, count.data()));
  }
  {
    const core::ReadArray rs(residual_scale_.get());
    std::vector<PetscInt> columns_to;
    std::vector<PetscScalar> upper, lower;
    for (PetscInt i = begin; i < end; ++i) {
      // Both Jacobians have the same pattern, so that their rows run in step.
      PetscInt k = 0, kd = 0;
      const PetscInt *columns = nullptr, *columns_d = nullptr;
      const PetscScalar *a = nullptr, *d = nullptr;
      check(MatGetRow(jx_.get(), i, &k, &columns, &a));
      check(MatGetRow(jd_.get(), i, &kd, &columns_d, &d));
      core::require(k == kd, "dF/dx and dF/d(dx/dt) have one pattern");
      columns_to.resize(static_cast<std::size_t>(2 * k));
      upper.resize(static_cast<std::size_t>(2 * k));
      lower.resize(static_cast<std::size_t>(2 * k));
      const double row = 1 / rs[i - begin];
      for (PetscInt e = 0; e < k; ++e) {
        const auto at = static_cast<std::size_t>(2 * e);
        const double s = row * whole_scale_[static_cast<std::size_t>(columns[e])];
        columns_to[at] = 2 * columns[e];
        columns_to[at + 1] = 2 * columns[e] + 1;
        upper[at] = lower[at + 1] = s * a[e];
        upper[at + 1] = -s * omega * d[e];
        lower[at] = s * omega * d[e];
      }
      const PetscInt first = 2 * i, second = 2 * i + 1;
      check(MatSetValues(matrix_.get(), 1, &first, 2 * k, columns_to.data(), upper.data(), INSERT_VALUES));
      check(MatSetValues(matrix_.get(), 1, &second, 2 * k, columns_to.data(), lower.data(), INSERT_VALUES));
      check(MatRestoreRow(jx_.get(), i, &k, &columns, &a));
      check(MatRestoreRow(jd_.get(), i, &kd, &columns_d, &d));
    }
    const core::WriteArray b(rhs_.get());
    for (PetscInt i = 0; i < rows; ++i)
      for (PetscInt part = 0; part < 2; ++part) b[2 * i + part] = right[static_cast<std::size_t>(2 * i + part)] / rs[i];
  }
  check(MatAssemblyBegin(matrix_.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix_.get(), MAT_FINAL_ASSEMBLY));
  if (fresh) solver_ = core::make_direct_solver(system_.comm(), "response_");
  check(KSPSetOperators(solver_.get(), matrix_.get(), matrix_.get()));
  check(KSPSolve(solver_.get(), rhs_.get(), answer_.get()));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(solver_.get(), &reason));
  if (reason < 0)
    throw core::NotConverged("the response at this frequency could not be solved: the matrix is singular");
  const core::ReadArray z(answer_.get()), scale(state_scale_.get());
  amplitude.resize(static_cast<std::size_t>(2 * rows));
  for (PetscInt i = 0; i < 2 * rows; ++i) amplitude[static_cast<std::size_t>(i)] = z[i] * scale[i / 2];
}

}  // namespace whirl::solve
