#include "whirl/solve/newton/frequency_solver.hpp"

#include "solve/newton/eliminated_response.hpp"
#include "solve/newton/shifted_system.hpp"

namespace whirl::solve {

using core::check;

FrequencySolver::FrequencySolver(problem::System& system) : system_(system) {
  if (core::size_of(system.comm()) > 1) {
    shifted_ = std::make_unique<ShiftedSystem>(system);
    return;
  }
  eliminated_ = std::make_unique<EliminatedResponse>();
  rest_ = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  state_scale_ = core::duplicate(rest_.get());
  residual_scale_ = core::duplicate(rest_.get());
  system.scales(state_scale_.get(), residual_scale_.get());
  jx_ = system.make_jacobian();
  jd_ = system.make_jacobian();
}

FrequencySolver::~FrequencySolver() = default;

void FrequencySolver::linearise(Vec x) {
  if (shifted_) {
    shifted_->linearise(x);
    return;
  }
  system_.jacobian(0, x, rest_.get(), 1, 0, jx_.get());
  system_.jacobian(0, x, rest_.get(), 0, 1, jd_.get());
  const core::ReadArray rows(residual_scale_.get()), columns(state_scale_.get());
  eliminated_->linearise(jx_.get(), jd_.get(), rows.data(), columns.data());
}

void FrequencySolver::factorise(double omega) {
  if (shifted_)
    shifted_->factorise(omega);
  else
    eliminated_->factorise(omega);
}

void FrequencySolver::solve(Vec x, double omega, const std::vector<double>& right, std::vector<double>& amplitude) {
  linearise(x);
  factorise(omega);
  solve(right, amplitude);
}

void FrequencySolver::solve(const std::vector<double>& right, std::vector<double>& amplitude) {
  if (eliminated_) {
    eliminated_->solve(right, amplitude);
    return;
  }
  core::Vector b = shifted_->make_vector(), z = core::duplicate(b.get());
  {
    const core::ReadArray scale(shifted_->residual_scale());
    const core::WriteArray a(b.get());
    for (PetscInt i = 0; i < a.size(); ++i) a[i] = right[static_cast<std::size_t>(i)] / scale[i / 2];
  }
  shifted_->solve(b.get(), z.get());
  const core::ReadArray a(z.get()), scale(shifted_->state_scale());
  amplitude.resize(static_cast<std::size_t>(a.size()));
  for (PetscInt i = 0; i < a.size(); ++i) amplitude[static_cast<std::size_t>(i)] = a[i] * scale[i / 2];
}

}  // namespace whirl::solve
