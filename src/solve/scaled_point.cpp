#include "whirl/solve/scaled_point.hpp"

#include <Eigen/LU>

#include "whirl/core/error.hpp"

namespace whirl::solve {
namespace {

using core::check;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd to_eigen(Vec v) {
  const core::ReadArray a(v);
  return Map<const VectorXd>(a.data(), a.size());
}

MatrixXd to_dense(Mat m, Index n) {
  MatrixXd out = MatrixXd::Zero(n, n);
  for (PetscInt i = 0; i < n; ++i) {
    PetscInt count = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    check(MatGetRow(m, i, &count, &columns, &values));
    for (PetscInt k = 0; k < count; ++k) out(i, columns[k]) = values[k];
    check(MatRestoreRow(m, i, &count, &columns, &values));
  }
  return out;
}

}  // namespace

ScaledPoint::ScaledPoint(problem::System& system, problem::Structure* structure)
    : system_(system), structure_(structure) {
  core::require(core::size_of(system.comm()) == 1, "a dense point needs the whole system on one rank");
  x_ = core::make_vector(system.comm(), system.size(), PETSC_DETERMINE);
  xdot_ = core::duplicate(x_.get());
  f_ = core::duplicate(x_.get());
  system.scales(x_.get(), f_.get());
  state_scale_ = to_eigen(x_.get());
  load_.resize(size());
  residual_scale_ = to_eigen(f_.get());
  if (structure_) {
    l1_ = scaled(structure_->l1());
    b_ = residual_scale_.cwiseInverse().asDiagonal() * structure_->b();
    c_ = structure_->c() * state_scale_.asDiagonal();
  } else {
    matrix_ = system.make_jacobian();
  }
}

MatrixXd ScaledPoint::scaled(const MatrixXd& block) const {
  return residual_scale_.cwiseInverse().asDiagonal() * block * state_scale_.asDiagonal();
}

void ScaledPoint::refresh() {
  if (!structure_) return;
  l0_ = scaled(structure_->l0());
  dl0_ = scaled(structure_->dl0());
}

void ScaledPoint::put(const VectorXd& x, const VectorXd& xdot) {
  const core::WriteArray xa(x_.get()), da(xdot_.get());
  Map<VectorXd>(xa.data(), size()) = x.cwiseProduct(state_scale_);
  Map<VectorXd>(da.data(), size()) = xdot.cwiseProduct(state_scale_);
}

void ScaledPoint::residual(double angle, const VectorXd& x, const VectorXd& xdot, Eigen::Ref<VectorXd> out) {
  if (structure_) {
    structure_->load(angle, load_, nullptr);
    structure_->forces(c_ * x, forces_, nullptr, nullptr);
    out.noalias() = l0_ * x;
    out.noalias() += l1_ * xdot;
    out -= load_.cwiseQuotient(residual_scale_);
    out.noalias() -= b_ * forces_;
    return;
  }
  put(x, xdot);
  system_.residual(angle, x_.get(), xdot_.get(), f_.get());
  out = to_eigen(f_.get()).cwiseQuotient(residual_scale_);
}

void ScaledPoint::linearise(double angle, const VectorXd& x, const VectorXd& xdot, MatrixXd& jx, MatrixXd& jxdot,
                            VectorXd* d_parameter) {
  if (structure_) {
    VectorXd d_load(size()), d_forces;
    MatrixXd tangent;
    structure_->load(angle, load_, &d_load);
    structure_->forces(c_ * x, forces_, &tangent, &d_forces);
    jx = l0_;
    jx.noalias() -= b_ * (tangent * c_);
    jxdot = l1_;
    if (d_parameter) *d_parameter = dl0_ * x - d_load.cwiseQuotient(residual_scale_) - b_ * d_forces;
    return;
  }
  put(x, xdot);
  system_.jacobian(angle, x_.get(), xdot_.get(), 1, 0, matrix_.get());
  jx = scaled(to_dense(matrix_.get(), size()));
  system_.jacobian(angle, x_.get(), xdot_.get(), 0, 1, matrix_.get());
  jxdot = scaled(to_dense(matrix_.get(), size()));
  if (!d_parameter) return;
  system_.parameter_derivative(angle, x_.get(), xdot_.get(), f_.get());
  *d_parameter = to_eigen(f_.get()).cwiseQuotient(residual_scale_);
}

VectorXd ScaledPoint::rate(double angle, const VectorXd& x) {
  VectorXd f(size());
  const VectorXd rest = VectorXd::Zero(size());
  MatrixXd jx, jxdot;
  residual(angle, x, rest, f);
  linearise(angle, x, rest, jx, jxdot, nullptr);
  return -jxdot.partialPivLu().solve(f);
}

}  // namespace whirl::solve
