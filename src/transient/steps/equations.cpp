#include "transient/steps/equations.hpp"

#include "whirl/core/error.hpp"
#include "whirl/core/local_part.hpp"
#include "whirl/core/plan.hpp"
#include "whirl/core/shell.hpp"

namespace whirl::transient {
namespace {

using core::check;

// Sparse factors of a film on one rank: beyond, MUMPS is quicker than Eigen.
constexpr PetscInt most_own_states = 50000;

bool is_thin(problem::System& system, Algebra algebra) {
  if (algebra == Algebra::assembled || core::size_of(system.comm()) > 1) return false;
  const problem::BlockStructure* s = system.structure();
  return s && system.size() - s->size() <= most_own_states;
}

// The Jacobian of a system whose dense factors are cheaper than MUMPS's; null of others.
core::Matrix small_matrix(problem::System& system) {
  if (core::size_of(system.comm()) > 1) return {};
  MatInfo info;
  core::Matrix jacobian = system.make_jacobian();
  check(MatGetInfo(jacobian.get(), MAT_LOCAL, &info));
  const auto way = core::plan::step(system.size(), static_cast<std::int64_t>(info.nz_allocated));
  core::plan::note(way);
  return way == core::plan::StepWay::dense ? std::move(jacobian) : core::Matrix();
}

}  // namespace

Equations::Equations(problem::System& system, const problem::Drive& drive, Algebra algebra)
    : system_(system), drive_(drive), gate_(system.comm()), thin_(is_thin(system, algebra)) {
  core::require(drive.acceleration == 0 || system.parameter_is_speed(),
                "an accelerated shaft needs the speed as parameter");
  if (system.parameter_is_speed()) system.set_parameter(drive.speed);
  turned_ = system.parameter();
  state_scale_ = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  residual_scale_ = core::duplicate(state_scale_.get());
  inverse_ = core::duplicate(state_scale_.get());
  system.scales(state_scale_.get(), residual_scale_.get());
  check(VecCopy(residual_scale_.get(), inverse_.get()));
  check(VecReciprocal(inverse_.get()));
  x_ = core::duplicate(state_scale_.get());
  xdot_ = core::duplicate(state_scale_.get());
  if (thin_) {
    point_ = std::make_unique<problem::ScaledPoint>(system, system.structure(), true);
    point_->refresh();
    f_.resize(system.size());
  } else {
    sparse_ = small_matrix(system);
  }
}

ThinOperator& Equations::operator_of(Mat m) {
  for (const auto& [matrix, meaning] : operators_)
    if (matrix == m) return *meaning;
  throw core::Bug("a matrix that these equations did not make");
}

core::Matrix Equations::make_matrix() {
  if (thin_) {
    auto a = std::make_shared<ThinOperator>();
    core::Matrix m = core::make_shell(PETSC_COMM_SELF, system_.size(), gate_, [this, a](Vec x, Vec y) {
      Eigen::VectorXd v, out(system_.size());
      core::get(x, v);
      point_->times(a->at, a->alpha * v, a->sigma * v, out);
      core::put(out, y);
    });
    operators_.emplace_back(m.get(), std::move(a));
    return m;
  }
  if (!sparse_) return system_.make_jacobian();
  core::Matrix m;
  check(MatCreateSeqDense(PETSC_COMM_SELF, system_.size(), system_.size(), nullptr, m.put()));
  check(MatAssemblyBegin(m.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(m.get(), MAT_FINAL_ASSEMBLY));
  return m;
}

void Equations::configure(KSP ksp) {
  check(KSPSetType(ksp, KSPPREONLY));
  PC pc = nullptr;
  check(KSPGetPC(ksp, &pc));
  if (thin_) {
    auto inverse = std::make_shared<ThinInverse>(*point_, *system_.structure());
    inverses_.push_back(inverse);
    core::set_shell(pc, gate_,
                    [this, ksp, inverse, y = Eigen::VectorXd(), x = Eigen::VectorXd()](Vec in, Vec out) mutable {
                      Mat a = nullptr;
                      check(KSPGetOperators(ksp, &a, nullptr));
                      core::get(in, y);
                      inverse->solve(operator_of(a), y, x);
                      core::put(x, out);
                    });
    return;
  }
  check(PCSetType(pc, PCLU));
  if (!sparse_) check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
}

void Equations::forget() {
  std::erase_if(inverses_, [](const auto& i) { return i.expired(); });
  for (const auto& i : inverses_)
    if (const auto inverse = i.lock()) inverse->forget();
}

void Equations::scale(Vec x, Vec u) const {
  check(VecPointwiseDivide(u, x, state_scale_.get()));
}

void Equations::unscale(Vec u, Vec x) const {
  check(VecPointwiseMult(x, u, state_scale_.get()));
}

void Equations::turn(double t) {
  if (drive_.acceleration == 0) return;
  const double speed = drive_.speed_at(t);
  // Others may have turned the system meanwhile.
  if (speed != system_.parameter()) system_.set_parameter(speed);
  if (speed == turned_) return;
  turned_ = speed;
  if (point_) point_->refresh_speed();
}

// With tangents where they cost little: those of films without own states come with their forces.
void Equations::thin_residual(double t, Vec u, Vec udot) {
  core::get(u, u_);
  core::get(udot, udot_);
  time_ = t;
  tangents_ = false;
  const bool cheap = point_->own_states() == 0;
  residual(t, u_, udot_, f_, cheap ? &at_ : nullptr);
  tangents_ = cheap;
}

void Equations::residual(double t, Vec u, Vec udot, Vec f) {
  if (thin_) {
    f_.resize(system_.size());
    thin_residual(t, u, udot);
    return core::put(f_, f);
  }
  free_residual(t, u, udot, f);
  if (forces_) forces_->subtract(t, inverse_.get(), f);
}

void Equations::free_residual(double t, Vec u, Vec udot, Vec f) {
  ++residuals_;
  turn(t);
  const double angle = drive_.angle_at(t);
  unscale(u, x_.get());
  unscale(udot, xdot_.get());
  system_.residual(angle, x_.get(), xdot_.get(), f);
  check(VecPointwiseMult(f, f, inverse_.get()));
}

void Equations::residual(double t, const Eigen::VectorXd& u, const Eigen::VectorXd& udot, Eigen::VectorXd& f,
                         problem::PointState* keep) {
  ++residuals_;
  turn(t);
  if (keep)
    point_->residual(drive_.angle_at(t), u, udot, f, *keep);
  else
    point_->residual(drive_.angle_at(t), u, udot, f);
  if (!forces_) return;
  const core::ReadArray factor(inverse_.get());
  const auto n = static_cast<std::size_t>(f.size());
  forces_->subtract(t, 0, {factor.data(), n}, {f.data(), n});
}

void Equations::jacobian(double t, Vec u, Vec udot, double alpha, double sigma, Mat j) {
  ++jacobians_;
  turn(t);
  const double angle = drive_.angle_at(t);
  if (thin_) {
    const core::ReadArray a(u), b(udot);
    const Eigen::Map<const Eigen::VectorXd> value(a.data(), a.size()), rate(b.data(), b.size());
    if (!tangents_ || t != time_ || u_ != value || udot_ != rate) {
      u_ = value;
      udot_ = rate;
      time_ = t;
      tangents_ = false;
      f_.resize(system_.size());
      point_->residual(angle, u_, udot_, f_, at_);
      tangents_ = true;
    }
    ThinOperator& of = operator_of(j);
    of.alpha = alpha;
    of.sigma = sigma;
    of.parameter = system_.parameter();
    of.at = at_;
    ++of.version;
    check(MatAssemblyBegin(j, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(j, MAT_FINAL_ASSEMBLY));
    return;
  }
  unscale(u, x_.get());
  unscale(udot, xdot_.get());
  Mat to = sparse_ ? sparse_.get() : j;
  system_.jacobian(angle, x_.get(), xdot_.get(), alpha, sigma, to);
  check(MatDiagonalScale(to, inverse_.get(), state_scale_.get()));
  if (to != j) check(MatConvert(to, MATSEQDENSE, MAT_REUSE_MATRIX, &j));
}

core::LinearSolver Equations::make_solver(const std::string& prefix) {
  core::LinearSolver out;
  check(KSPCreate(system_.comm(), out.put()));
  check(KSPSetOptionsPrefix(out.get(), prefix.c_str()));
  configure(out.get());
  check(KSPSetFromOptions(out.get()));
  return out;
}

bool Equations::solve(KSP ksp, Mat matrix, Vec b, Vec x) {
  check(KSPSetOperators(ksp, matrix, matrix));
  gate_.rethrow(KSPSolve(ksp, b, x));
  return core::reason_of(ksp) > 0;
}

void Equations::rate(double t, Vec u, Vec udot) {
  if (!rates_) {
    rates_ = make_matrix();
    rate_solver_ = make_solver("rates_");
    f_rate_ = make_state();
    change_ = make_state();
  }
  check(VecSet(udot, 0));
  // The first pass finds the rates of films' states, the second one the forces that are cut off at these.
  const int passes = thin_ && point_->own_states() == 0 ? 1 : 2;
  for (int pass = 0; pass < passes; ++pass) {
    residual(t, u, udot, f_rate_.get());
    jacobian(t, u, udot, 0, 1, rates_.get());
    if (!solve(rate_solver_.get(), rates_.get(), f_rate_.get(), change_.get()))
      throw core::NotConverged("the rates do not follow from the states: dF/d(dx/dt) is singular");
    check(VecAXPY(udot, -1, change_.get()));
  }
}

std::string Equations::why_singular(double t, Vec u) {
  turn(t);
  const core::Matrix m = system_.make_jacobian();
  unscale(u, x_.get());
  check(VecSet(xdot_.get(), 0));
  system_.jacobian(drive_.angle_at(t), x_.get(), xdot_.get(), 0, 1, m.get());
  const core::Vector largest = core::duplicate(x_.get());
  check(MatGetRowMaxAbs(m.get(), largest.get(), nullptr));
  const std::vector<problem::Field> fields = system_.fields();
  int field = 0;  // number of the first one with such a row, from 1
  {
    const core::ReadArray a(largest.get());
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
