#include "transient/steps/equations.hpp"

#include <cmath>

#include "whirl/core/error.hpp"
#include "whirl/core/local_part.hpp"
#include "whirl/core/plan.hpp"

namespace whirl::transient {
namespace {

using core::check;
using Eigen::VectorXd;

// Sparse factors of a film on one rank: beyond, MUMPS is quicker.
constexpr PetscInt most_own_states = 50000;

bool is_thin(problem::System& system, Algebra algebra) {
  if (algebra == Algebra::assembled || core::size_of(system.comm()) > 1) return false;
  const problem::BlockStructure* s = system.structure();
  return s && system.size() - s->size() <= most_own_states;
}

bool is_dense(problem::System& system) {
  if (core::size_of(system.comm()) > 1) return false;
  MatInfo info;
  const core::Matrix jacobian = system.make_jacobian();
  check(MatGetInfo(jacobian.get(), MAT_LOCAL, &info));
  const auto way = core::plan::step(system.size(), static_cast<std::int64_t>(info.nz_allocated));
  core::plan::note(way);
  return way == core::plan::StepWay::dense;
}

}  // namespace

Equations::Equations(problem::System& system, const problem::Drive& drive, Algebra algebra)
    : system_(system), drive_(drive), thin_(is_thin(system, algebra)) {
  core::require(drive.acceleration == 0 || system.parameter_is_speed(),
                "an accelerated shaft needs the speed as parameter");
  if (system.parameter_is_speed()) system.set_parameter(drive.speed);
  turned_ = system.parameter();
  state_scale_ = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  check(VecGetOwnershipRange(state_scale_.get(), &begin_, nullptr));
  const core::Vector residual_scale = make_state();
  system.scales(state_scale_.get(), residual_scale.get());
  inverse_ = core::get(residual_scale.get()).cwiseInverse();
  if (thin_) {
    stages_ = solve::thin_stages(system);
  } else if (is_dense(system)) {
    point_ = std::make_unique<problem::ScaledPoint>(system, nullptr);
    stages_ = solve::dense_stages(*point_);
  } else {
    stages_ = solve::sparse_stages(system, false, true);
  }
  group_ = {VectorXd::Zero(1), Eigen::MatrixXd::Zero(1, 1)};
  forget();
}

void Equations::scale(Vec x, Vec u) const {
  check(VecPointwiseDivide(u, x, state_scale_.get()));
}

void Equations::unscale(Vec u, Vec x) const {
  check(VecPointwiseMult(x, u, state_scale_.get()));
}

double Equations::root_mean(double squares) const {
  if (core::size_of(system_.comm()) > 1) MPI_Allreduce(MPI_IN_PLACE, &squares, 1, MPI_DOUBLE, MPI_SUM, system_.comm());
  return std::sqrt(squares / static_cast<double>(system_.size()));
}

void Equations::turn(double t) {
  if (drive_.acceleration == 0) return;
  const double speed = drive_.speed_at(t);
  // Others may have turned the system meanwhile.
  if (speed != system_.parameter()) system_.set_parameter(speed);
  if (speed == turned_) return;
  turned_ = speed;
  stages_->refresh();
}

void Equations::residual(solve::Stage& stage, double t, const VectorXd& u, const VectorXd& udot, VectorXd& f,
                         bool ready) {
  ++residuals_;
  turn(t);
  group_.angle(0) = drive_.angle_at(t);
  f.resize(u.size());
  stage.residual(group_, u, udot, f, ready);
  const auto n = static_cast<std::size_t>(f.size());
  if (forces_) forces_->subtract(t, begin_, {inverse_.data(), n}, {f.data(), n});
}

void Equations::factorise(solve::Stage& stage, double own, const VectorXd& u, const VectorXd& udot, bool lagging) {
  ++jacobians_;
  group_.own(0, 0) = own;
  group_.lagging = lagging;
  stages_->begin_step();
  stage.factorise(group_, u, udot);
}

void Equations::keep(solve::Stage& stage, double t, double own, const VectorXd& u, const VectorXd& udot) {
  ++jacobians_;
  turn(t);
  group_.angle(0) = drive_.angle_at(t);
  group_.own(0, 0) = own;
  group_.lagging = false;
  stages_->begin_step();
  stage.keep(group_, u, udot);
}

void Equations::rate(double t, const VectorXd& u, VectorXd& udot) {
  udot.setZero(u.size());
  // The first pass finds the rates of films' states, the second one the forces that are cut off at these.
  for (int pass = 0; pass < (thin_ && stages_->derivative_is_free() ? 1 : 2); ++pass) {
    residual(*rates_, t, u, udot, f_, true);
    factorise(*rates_, 0, u, udot);
    rates_->solve(f_, tolerance());
    if (!std::isfinite(root_mean(f_.squaredNorm())))
      throw core::NotConverged("the rates do not follow from the states: dF/d(dx/dt) is singular");
    udot -= f_;
  }
}

std::string Equations::why_singular(double t, Vec u) {
  turn(t);
  const core::Matrix m = system_.make_jacobian();
  const core::Vector x = make_state(), rest = make_state();
  check(VecSet(rest.get(), 0));
  unscale(u, x.get());
  system_.jacobian(drive_.angle_at(t), x.get(), rest.get(), 0, 1, m.get());
  check(MatGetRowMaxAbs(m.get(), x.get(), nullptr));
  const std::vector<problem::Field> fields = system_.fields();
  int field = 0;  // number of the first one with such a row, from 1
  {
    const core::ReadArray a(x.get());
    for (std::size_t k = fields.size(); k-- > 0;)
      fields[k].each([&](PetscInt row) {
        if (a[row] == 0) field = static_cast<int>(k) + 1;
      });
  }
  MPI_Allreduce(MPI_IN_PLACE, &field, 1, MPI_INT, MPI_MAX, system_.comm());
  if (field == 0) return {};
  const problem::Field& f = fields[static_cast<std::size_t>(field - 1)];
  return f.quantity.empty() ? f.name : f.quantity + " of " + f.name;
}

}  // namespace whirl::transient
