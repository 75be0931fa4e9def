#include "frozen.hpp"

#include <algorithm>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"

namespace whirl::system {

using core::check;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// The rows of a matrix that stands as a whole on the first rank.
MatrixXd dense(Mat m, PetscInt n) {
  MatrixXd out = MatrixXd::Zero(n, n);
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(m, &begin, &end));
  for (PetscInt i = begin; i < end; ++i) {
    PetscInt k = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    check(MatGetRow(m, i, &k, &columns, &values));
    for (PetscInt e = 0; e < k; ++e) out(i, columns[e]) = values[e];
    check(MatRestoreRow(m, i, &k, &columns, &values));
  }
  return out;
}

// y = rows of a stencil times x, which has the neighbouring lines in front of it and behind it.
void multiply(const film::Stencil& a, int lines, int line, int reach, const double* x, double* __restrict y) {
  using enum film::Stencil::Place;
  const std::array<int, film::Stencil::n_places> offset = {0, -line, line, -1, 1, -2 * line};
  // In runs short enough for y and x to stay in the nearest cache while the places add up.
  constexpr int run = 512;
  const int n = lines * line;
  std::fill_n(y, n, 0.0);
  for (int begin = 0; begin < n; begin += run)
    for (const auto place : {centre, before, after, below, above, second_before}) {
      if (a.at[place].empty()) continue;
      const double* __restrict value = a.at[place].data(), * __restrict from = x + reach * line + offset[place];
      for (int k = begin; k < std::min(n, begin + run); ++k) y[k] += value[k] * from[k];
    }
}

// y += four columns times u.
void add(const std::array<std::vector<double>, 4>& columns, const std::array<double, 4>& u, double* __restrict y) {
  const double *__restrict c0 = columns[0].data(), *__restrict c1 = columns[1].data(),
                           *__restrict c2 = columns[2].data(), *__restrict c3 = columns[3].data();
  const double u0 = u[0], u1 = u[1], u2 = u[2], u3 = u[3];
  for (std::size_t k = 0; k < columns[0].size(); ++k) y[k] += c0[k] * u0 + c1[k] * u1 + c2[k] * u2 + c3[k] * u3;
}

}  // namespace

// One set of linearised equations.
class RotorSystem::FilmSolver::Equations final : public problem::Frozen {
public:
  // Approximate inverse of the film and of what it leaves of the rotor. Good for similar equations too.
  struct Preconditioner {
    Preconditioner(MPI_Comm comm, const film::StateModel& film, film::Lines part)
        : ring(comm, film.ring().lines, static_cast<int>(film.line()), part) {}
    film::RingPreconditioner ring;
    std::array<std::vector<double>, 4> driven;  // D^-1 G, per input
    Eigen::PartialPivLU<MatrixXd> rest;         // S, on the first rank
    Eigen::Matrix<double, 4, 2> to_force;       // inputs per force, with the film eliminated
  };

  Equations(FilmSolver& solver, Vec x, Vec xdot, double alpha, double sigma, const Equations* similar);
  void multiply(Vec v, Vec y) const override;
  void multiply_rates(Vec v, Vec y) const override;
  void solve(Vec r, Vec y, double tolerance) const override;
  void precondition(Vec r, Vec y) const;

private:
  [[nodiscard]] const Bearing& film() const { return solver_.system_.bearings_[solver_.film_]; }
  [[nodiscard]] bool first() const { return solver_.state_.size() > 0; }
  [[nodiscard]] Eigen::Vector2d force(const double* states) const { return sum(force_, states); }
  [[nodiscard]] static Eigen::Vector2d sum(const std::array<std::vector<double>, 2>& weights, const double* states);
  [[nodiscard]] Eigen::Vector2d at_first(const Eigen::Vector2d& share) const;

  FilmSolver& solver_;
  double alpha_;
  MatrixXd rotor_;                                  // A_rr, on the first rank
  film::Stencil a_, rates_;                         // D, dg/ds'
  std::array<std::vector<double>, 4> driven_;       // alpha G
  std::array<std::vector<double>, 2> force_;        // F = df/ds + sigma/alpha df/ds'
  std::array<std::vector<double>, 2> force_rates_;  // df/ds', or empty
  std::shared_ptr<Preconditioner> preconditioner_;
};

std::unique_ptr<RotorSystem::FilmSolver> RotorSystem::FilmSolver::make(RotorSystem& system) {
  int films = 0;
  for (const Bearing& b : system.bearings_) films += b.states != nullptr;
  int enough = 1;
  for (const Bearing& b : system.bearings_)
    if (b.states && (b.states->ring().lines == 1 || b.part.count() < 2)) enough = 0;
  MPI_Allreduce(MPI_IN_PLACE, &enough, 1, MPI_INT, MPI_MIN, system.comm_);
  if (system.train_.rotor.type != rotor::Options::Type::rigid || films != 1 || enough == 0) return nullptr;
  return std::make_unique<FilmSolver>(system);
}

RotorSystem::FilmSolver::FilmSolver(RotorSystem& s) : system_(s), gate_(s.comm_) {
  while (!s.bearings_[film_].states) ++film_;
  const PetscInt n = s.n_;
  mass_ = dense(s.mass_.get(), n);
  damping_ = dense(s.damping_.get(), n);
  gyroscopic_ = dense(s.gyroscopic_.get(), n);
  stiffness_ = dense(s.stiffness_.get(), n);
  inputs_ = MatrixXd::Zero(4, 2 * n);
  outputs_ = MatrixXd::Zero(2 * n, 2);
  const Bearing& b = s.bearings_[film_];
  core::Vector state = core::make_vector(s.comm_, s.local_size(), PETSC_DETERMINE),
               residual = core::duplicate(state.get());
  s.scales(state.get(), residual.get());
  {
    const core::ReadArray sa(state.get()), ra(residual.get());
    film_state_ = sa[b.row];
    film_residual_ = ra[b.row];
    const Eigen::Index rows = s.owns(0) ? 2 * n : 0;
    state_ = Map<const VectorXd>(sa.data(), rows);
    residual_ = Map<const VectorXd>(ra.data(), rows);
  }
  s.scatter_inputs(state.get());
  const core::ReadArray of_inputs(s.inputs_.get());
  std::copy_n(of_inputs.data() + 8 * film_, 8, journal_scale_.begin());
  for (Eigen::Index d = 0; d < 2; ++d)
    for (const auto& [q, side] : {std::pair{b.journal[static_cast<std::size_t>(d)], 1.0},
                                  std::pair{b.pedestal[static_cast<std::size_t>(d)], -1.0}}) {
      if (q < 0) continue;
      inputs_(d, 2 * q) = inputs_(2 + d, 2 * q + 1) = side;
      outputs_(2 * q, d) = side;
    }
  if (state_.size() > 0) {
    inputs_ *= state_.asDiagonal();
    outputs_ = residual_.cwiseInverse().asDiagonal() * outputs_;
  }
  check(MatCreateShell(s.comm_, s.local_size(), s.local_size(), s.size(), s.size(), this, shell_.put()));
  check(MatShellSetOperation(shell_.get(), MATOP_MULT, reinterpret_cast<void (*)()>(shell_multiply)));
  check(KSPCreate(s.comm_, krylov_.put()));
  check(KSPSetOptionsPrefix(krylov_.get(), "stage_"));
  check(KSPSetOperators(krylov_.get(), shell_.get(), shell_.get()));
  check(KSPSetType(krylov_.get(), KSPFGMRES));
  check(KSPSetPCSide(krylov_.get(), PC_RIGHT));
  PC pc = nullptr;
  check(KSPGetPC(krylov_.get(), &pc));
  check(PCSetType(pc, PCSHELL));
  check(PCShellSetContext(pc, this));
  check(PCShellSetApply(pc, shell_precondition));
  check(KSPSetFromOptions(krylov_.get()));
}

PetscErrorCode RotorSystem::FilmSolver::shell_multiply(Mat m, Vec v, Vec y) {
  void* raw = nullptr;
  PetscCall(MatShellGetContext(m, &raw));
  auto& solver = *static_cast<FilmSolver*>(raw);
  return solver.gate_.run([&] { solver.current_->multiply(v, y); });
}

PetscErrorCode RotorSystem::FilmSolver::shell_precondition(PC pc, Vec r, Vec y) {
  void* raw = nullptr;
  PetscCall(PCShellGetContext(pc, &raw));
  auto& solver = *static_cast<FilmSolver*>(raw);
  return solver.gate_.run([&] { solver.current_->precondition(r, y); });
}

// Rows (momentum, velocity) of the pairs, without films.
MatrixXd RotorSystem::FilmSolver::rotor_block(double alpha, double sigma) const {
  const Eigen::Index n = mass_.rows();
  MatrixXd a = MatrixXd::Zero(2 * n, 2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      a(2 * i, 2 * j) = alpha * stiffness_(i, j);
      a(2 * i, 2 * j + 1) = alpha * (damping_(i, j) + system_.speed_ * gyroscopic_(i, j)) + sigma * mass_(i, j);
    }
    a(2 * i + 1, 2 * i) = sigma;
    a(2 * i + 1, 2 * i + 1) = -alpha;
  }
  return residual_.cwiseInverse().asDiagonal() * a * state_.asDiagonal();
}

std::unique_ptr<problem::Frozen> RotorSystem::FilmSolver::freeze(Vec x, Vec xdot, double alpha, double sigma,
                                                                 const problem::Frozen* similar) {
  return std::make_unique<Equations>(*this, x, xdot, alpha, sigma, static_cast<const Equations*>(similar));
}

RotorSystem::FilmSolver::Equations::Equations(FilmSolver& solver, Vec x, Vec xdot, double alpha, double sigma,
                                              const Equations* similar)
    : solver_(solver), alpha_(alpha) {
  RotorSystem& s = solver.system_;
  Films films = s.films_at(x, xdot, film::Need::tangents);
  film::StateResponse& own = films.own[solver.film_];
  a_ = std::move(own.by_states);
  rates_ = std::move(own.by_rates);
  for (std::size_t p = 0; p < film::Stencil::n_places; ++p) {
    for (double& value : a_.at[p]) value *= alpha;
    if (rates_.at[p].empty()) continue;
    a_.at[p].resize(rates_.at[p].size());
    for (std::size_t k = 0; k < rates_.at[p].size(); ++k) a_.at[p][k] += sigma * rates_.at[p][k];
  }
  const double rows = solver.film_state_ / solver.film_residual_;
  for (auto* stencil : {&a_, &rates_})
    for (auto& place : stencil->at)
      for (double& value : place) value *= rows;
  const std::size_t n = own.residual.size();
  for (std::size_t i = 0; i < 2; ++i) {
    force_[i].resize(n);
    driven_[i].resize(n);
    driven_[2 + i].resize(n);
    force_rates_[i].resize(own.force_d_rates.empty() ? 0 : n);
    for (std::size_t k = 0; k < n; ++k) {
      force_[i][k] = own.force_d_states[k][i] * solver.film_state_;
      if (!own.force_d_rates.empty()) {
        force_rates_[i][k] = own.force_d_rates[k][i] * solver.film_state_;
        force_[i][k] += sigma / alpha * force_rates_[i][k];
      }
      driven_[i][k] = alpha * own.d_position[k][i] / solver.film_residual_;
      driven_[2 + i][k] = alpha * own.d_velocity[k][i] / solver.film_residual_;
    }
  }
  if (first()) {
    rotor_ = solver.rotor_block(alpha, sigma);
    for (std::size_t b = 0; b < s.bearings_.size(); ++b)
      for (std::size_t d = 0; d < 2; ++d)
        for (const auto& [row, sign] :
             {std::pair{s.bearings_[b].journal[d], -alpha}, std::pair{s.bearings_[b].pedestal[d], alpha}})
          for (std::size_t e = 0; e < 2; ++e)
            for (const auto& [column, side] :
                 {std::pair{s.bearings_[b].journal[e], 1.0}, std::pair{s.bearings_[b].pedestal[e], -1.0}}) {
              if (row < 0 || column < 0) continue;
              const double factor = sign * side / solver.residual_(2 * row);
              rotor_(2 * row, 2 * column) += factor * films.journal[b].d_position[d][e] * solver.state_(2 * column);
              rotor_(2 * row, 2 * column + 1) +=
                  factor * films.journal[b].d_velocity[d][e] * solver.state_(2 * column + 1);
            }
  }
  if (similar) {
    preconditioner_ = similar->preconditioner_;
    return;
  }
  preconditioner_ = std::make_shared<Preconditioner>(s.comm_, *film().states, film().part);
  preconditioner_->ring.set(a_);
  Eigen::Matrix<double, 2, 4> through = Eigen::Matrix<double, 2, 4>::Zero();
  for (std::size_t u = 0; u < 4; ++u) {
    preconditioner_->driven[u].resize(n);
    preconditioner_->ring.apply(driven_[u], preconditioner_->driven[u]);
    through.col(static_cast<Eigen::Index>(u)) = force(preconditioner_->driven[u].data());
  }
  MPI_Allreduce(MPI_IN_PLACE, through.data(), 8, MPI_DOUBLE, MPI_SUM, s.comm_);
  auto& to_force = preconditioner_->to_force;
  if (first()) {
    preconditioner_->rest.compute(rotor_ + alpha * solver.outputs_ * through * solver.inputs_);
    to_force = alpha * solver.inputs_ * preconditioner_->rest.solve(solver.outputs_);
  }
  MPI_Bcast(to_force.data(), 8, MPI_DOUBLE, 0, s.comm_);
}

// This rank's share of weights times states.
Eigen::Vector2d RotorSystem::FilmSolver::Equations::sum(const std::array<std::vector<double>, 2>& weights,
                                                        const double* states) {
  Eigen::Vector2d f;
  const auto n = static_cast<Eigen::Index>(weights[0].size());
  for (Eigen::Index i = 0; i < 2; ++i)
    f(i) = Map<const VectorXd>(weights[static_cast<std::size_t>(i)].data(), n).dot(Map<const VectorXd>(states, n));
  return f;
}

// The sum of all shares, known to the first rank.
Eigen::Vector2d RotorSystem::FilmSolver::Equations::at_first(const Eigen::Vector2d& share) const {
  Eigen::Vector2d all = Eigen::Vector2d::Zero();
  MPI_Reduce(share.data(), all.data(), 2, MPI_DOUBLE, MPI_SUM, 0, solver_.system_.comm_);
  return all;
}

void RotorSystem::FilmSolver::Equations::multiply(Vec v, Vec y) const {
  RotorSystem& s = solver_.system_;
  s.scatter_inputs(v);
  const core::ReadArray inputs(s.inputs_.get()), va(v);
  const core::WriteArray ya(y);
  const Bearing& b = film();
  const film::StateModel& model = *b.states;
  std::array<double, 4> u{};  // position, velocity
  for (std::size_t d = 0; d < 2; ++d)
    for (std::size_t rate = 0; rate < 2; ++rate) {
      const std::size_t j = 4 * d + rate, p = j + 2;
      const double *x = inputs.data() + 8 * solver_.film_, *scale = solver_.journal_scale_.data();
      u[2 * rate + d] = x[j] * scale[j] - (b.pedestal[d] >= 0 ? x[p] * scale[p] : 0.0);
    }
  double* rows = ya.data() + b.row;
  system::multiply(a_, b.part.count(), static_cast<int>(model.line()), model.ring().reach,
                   inputs.data() + 8 * s.bearings_.size() + b.gathered, rows);
  add(driven_, u, rows);
  const Eigen::Vector2d f = at_first(force(va.data() + b.row));
  if (!first()) return;
  Map<VectorXd>(ya.data(), rotor_.rows()) =
      rotor_ * Map<const VectorXd>(va.data(), rotor_.rows()) - alpha_ * (solver_.outputs_ * f);
}

void RotorSystem::FilmSolver::Equations::multiply_rates(Vec v, Vec y) const {
  RotorSystem& s = solver_.system_;
  const Bearing& b = film();
  const film::StateModel& model = *b.states;
  s.scatter_inputs(v);
  const core::ReadArray inputs(s.inputs_.get()), va(v);
  const core::WriteArray ya(y);
  system::multiply(rates_, b.part.count(), static_cast<int>(model.line()), model.ring().reach,
                   inputs.data() + 8 * s.bearings_.size() + b.gathered, ya.data() + b.row);
  const bool rates = !s.constant_rates();
  const Eigen::Vector2d f = rates ? at_first(sum(force_rates_, va.data() + b.row)) : Eigen::Vector2d::Zero();
  if (!first()) return;
  Map<VectorXd>(ya.data(), 2 * s.n_) = solver_.rotor_block(0, 1) * Map<const VectorXd>(va.data(), 2 * s.n_);
  if (rates) Map<VectorXd>(ya.data(), 2 * s.n_) -= solver_.outputs_ * f;
}

void RotorSystem::FilmSolver::Equations::precondition(Vec r, Vec y) const {
  const RotorSystem& s = solver_.system_;
  const Bearing& b = film();
  const core::ReadArray ra(r);
  const core::WriteArray ya(y);
  const auto n = static_cast<std::size_t>(b.rows());
  double* states = ya.data() + b.row;
  preconditioner_->ring.apply({ra.data() + b.row, n}, {states, n});
  // The forces of all ranks and what the first one knows of the inputs, in one message.
  Eigen::Vector<double, 6> sums = Eigen::Vector<double, 6>::Zero();
  sums.head<2>() = force(states);
  VectorXd z;
  if (first()) {
    z = preconditioner_->rest.solve(Map<const VectorXd>(ra.data(), 2 * s.n_));
    sums.tail<4>() = solver_.inputs_ * z;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), 6, MPI_DOUBLE, MPI_SUM, s.comm_);
  const Eigen::Vector4d u = sums.tail<4>() + preconditioner_->to_force * sums.head<2>();
  if (first())
    Map<VectorXd>(ya.data(), 2 * s.n_) =
        z + preconditioner_->rest.solve(VectorXd(alpha_ * (solver_.outputs_ * sums.head<2>())));
  add(preconditioner_->driven, {-u(0), -u(1), -u(2), -u(3)}, states);
}

void RotorSystem::FilmSolver::Equations::solve(Vec r, Vec y, double tolerance) const {
  KSP ksp = solver_.krylov_.get();
  solver_.current_ = this;
  check(KSPSetTolerances(ksp, tolerance, 1e-300, PETSC_DEFAULT, 100));
  solver_.gate_.rethrow(KSPSolve(ksp, r, y));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(ksp, &reason));
  if (reason < 0)
    core::agree(solver_.system_.comm_, [] { throw core::DomainError("the linearised film was not solved"); });
}

}  // namespace whirl::system
