#include "transient/equations.hpp"

#include "whirl/core/cost.hpp"
#include "whirl/core/error.hpp"

namespace whirl::transient {
namespace {

using core::check;

bool dense_is_cheaper(problem::System& system) {
  if (core::size_of(system.comm()) > 1) return false;
  MatInfo info;
  const core::Matrix jacobian = system.make_jacobian();
  check(MatGetInfo(jacobian.get(), MAT_LOCAL, &info));
  return core::cost::dense_step(system.size()) < core::cost::sparse_step(static_cast<std::int64_t>(info.nz_allocated));
}

void to_eigen(Vec v, Eigen::VectorXd& out) {
  const core::ReadArray a(v);
  out = Eigen::Map<const Eigen::VectorXd>(a.data(), a.size());
}

}  // namespace

Equations::Equations(problem::System& system, const problem::Drive& drive) : system_(system), drive_(drive) {
  core::require(drive.acceleration == 0 || system.parameter_is_speed(),
                "an accelerated shaft needs the speed as parameter");
  if (system.parameter_is_speed()) system.set_parameter(drive.speed);
  state_scale_ = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  residual_scale_ = core::duplicate(state_scale_.get());
  inverse_ = core::duplicate(state_scale_.get());
  system.scales(state_scale_.get(), residual_scale_.get());
  check(VecCopy(residual_scale_.get(), inverse_.get()));
  check(VecReciprocal(inverse_.get()));
  x_ = core::duplicate(state_scale_.get());
  xdot_ = core::duplicate(state_scale_.get());
  if (dense_is_cheaper(system)) {
    point_ = std::make_unique<solve::ScaledPoint>(system, system.structure());
    point_->refresh();
    f_.resize(system.size());
  }
}

core::Matrix Equations::make_matrix() const {
  if (!dense()) return system_.make_jacobian();
  core::Matrix m;
  check(MatCreateSeqDense(PETSC_COMM_SELF, system_.size(), system_.size(), nullptr, m.put()));
  check(MatAssemblyBegin(m.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(m.get(), MAT_FINAL_ASSEMBLY));
  return m;
}

void Equations::configure(KSP ksp) const {
  check(KSPSetType(ksp, KSPPREONLY));
  PC pc = nullptr;
  check(KSPGetPC(ksp, &pc));
  check(PCSetType(pc, PCLU));
  if (!dense()) check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
}

void Equations::scale(Vec x, Vec u) const {
  check(VecPointwiseDivide(u, x, state_scale_.get()));
}

void Equations::unscale(Vec u, Vec x) const {
  check(VecPointwiseMult(x, u, state_scale_.get()));
}

void Equations::turn(double t) {
  if (drive_.acceleration == 0) return;
  system_.set_parameter(drive_.speed_at(t));
  if (point_) point_->refresh();
}

void Equations::residual(double t, Vec u, Vec udot, Vec f) {
  turn(t);
  const double angle = drive_.angle_at(t);
  if (point_) {
    to_eigen(u, u_);
    to_eigen(udot, udot_);
    const core::WriteArray out(f);
    point_->residual(angle, u_, udot_, f_);
    Eigen::Map<Eigen::VectorXd>(out.data(), out.size()) = f_;
    return;
  }
  unscale(u, x_.get());
  unscale(udot, xdot_.get());
  system_.residual(angle, x_.get(), xdot_.get(), f);
  check(VecPointwiseMult(f, f, inverse_.get()));
}

void Equations::jacobian(double t, Vec u, Vec udot, double alpha, double sigma, Mat j) {
  turn(t);
  const double angle = drive_.angle_at(t);
  if (point_) {
    to_eigen(u, u_);
    to_eigen(udot, udot_);
    point_->linearise(angle, u_, udot_, jx_, jxdot_, nullptr);
    PetscScalar* out = nullptr;
    check(MatDenseGetArrayWrite(j, &out));
    Eigen::Map<Eigen::MatrixXd>(out, jx_.rows(), jx_.cols()) = alpha * jx_ + sigma * jxdot_;
    check(MatDenseRestoreArrayWrite(j, &out));
    check(MatAssemblyBegin(j, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(j, MAT_FINAL_ASSEMBLY));
    return;
  }
  unscale(u, x_.get());
  unscale(udot, xdot_.get());
  system_.jacobian(angle, x_.get(), xdot_.get(), alpha, sigma, j);
  check(MatDiagonalScale(j, inverse_.get(), state_scale_.get()));
}

}  // namespace whirl::transient
