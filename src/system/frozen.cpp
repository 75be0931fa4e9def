#include "frozen.hpp"

#include <Eigen/SparseLU>
#include <algorithm>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"

namespace whirl::system {

using core::check;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// y += four columns times u.
void add(const std::array<std::vector<double>, 4>& columns, const std::array<double, 4>& u, double* __restrict y) {
  const double *__restrict c0 = columns[0].data(), *__restrict c1 = columns[1].data(),
                           *__restrict c2 = columns[2].data(), *__restrict c3 = columns[3].data();
  const double u0 = u[0], u1 = u[1], u2 = u[2], u3 = u[3];
  for (std::size_t k = 0; k < columns[0].size(); ++k) y[k] += c0[k] * u0 + c1[k] * u1 + c2[k] * u2 + c3[k] * u3;
}

// This rank's share of weights times states.
Eigen::Vector2d sum(const std::array<std::vector<double>, 2>& weights, const double* states) {
  Eigen::Vector2d f;
  const auto n = static_cast<Index>(weights[0].size());
  for (Index i = 0; i < 2; ++i)
    f(i) = Map<const VectorXd>(weights[static_cast<std::size_t>(i)].data(), n).dot(Map<const VectorXd>(states, n));
  return f;
}

}  // namespace

// One set of linearised equations.
class RotorSystem::FilmSolver::Equations final : public problem::Frozen {
public:
  Equations(FilmSolver& solver, Vec x, Vec xdot, double alpha, double sigma, const Equations* similar);
  void multiply(Vec v, Vec y) const override;
  void multiply_rates(Vec v, Vec y) const override;
  void solve(Vec r, Vec y, double tolerance) const override;
  void precondition(Vec r, Vec y) const;

private:
  // Of the share of a film on this rank.
  struct Linear {
    std::vector<double> a, rates;                    // D at FilmSolver::Film::places, dg/ds' at its own
    std::array<std::vector<double>, 4> driven;       // alpha G
    std::array<std::vector<double>, 2> force;        // F = df/ds + sigma/alpha df/ds'
    std::array<std::vector<double>, 2> force_rates;  // df/ds'; empty if zero
  };
  // Approximate inverses of the films and of what they leave of the rotor. Good for similar equations too.
  struct Preconditioner {
    struct Film {
      std::unique_ptr<film::StatePreconditioner> inverse;  // on the ranks that hold it
      std::array<std::vector<double>, 4> driven;           // D^-1 G, per input
      std::vector<double> rhs;
    };
    std::vector<Film> films;
    Eigen::SparseLU<Eigen::SparseMatrix<double>> rest;  // S, on the first rank
    MatrixXd by_force;                                  // alpha S^-1 B: rotor per force, on the first rank
    MatrixXd to_force;                                  // C alpha S^-1 B: inputs per force
  };
  [[nodiscard]] bool first() const { return solver_.state_.size() > 0; }
  void take_film(const Film& film, film::StateResponse& own, double sigma);
  void take_rotor(const std::vector<film::Response>& journals, double sigma);
  void eliminate();
  void invert(std::size_t film, const double* r, double* x) const;
  template <class Multiply>
  [[nodiscard]] VectorXd multiply_films(Vec v, Vec y, const Multiply& rows) const;
  [[nodiscard]] VectorXd at_first(VectorXd shares) const;

  FilmSolver& solver_;
  double alpha_;
  Sparse rotor_;  // A_rr, on the first rank
  std::vector<Linear> films_;
  std::shared_ptr<Preconditioner> preconditioner_;
};

std::unique_ptr<problem::Frozen> RotorSystem::FilmSolver::freeze(Vec x, Vec xdot, double alpha, double sigma,
                                                                 const problem::Frozen* similar) {
  return std::make_unique<Equations>(*this, x, xdot, alpha, sigma, static_cast<const Equations*>(similar));
}

RotorSystem::FilmSolver::Equations::Equations(FilmSolver& solver, Vec x, Vec xdot, double alpha, double sigma,
                                              const Equations* similar)
    : solver_(solver), alpha_(alpha) {
  RotorSystem& s = solver.system_;
  Films films = s.films_at(x, xdot, film::Need::tangents);
  if (similar) {
    preconditioner_ = similar->preconditioner_;
  } else {
    preconditioner_ = std::make_shared<Preconditioner>();
    for (const Film& film : solver.films_) {
      auto& to = preconditioner_->films.emplace_back();
      if (film.comm == MPI_COMM_NULL) continue;
      const film::StateResponse& own = films.own[film.bearing];
      to.inverse = film.part->film().preconditioner(film.comm, film.part->share());
      to.inverse->set(own.d_states, own.d_rates, alpha, sigma);
      to.rhs.resize(own.residual.size());
    }
  }
  for (const Film& film : solver.films_) take_film(film, films.own[film.bearing], sigma);
  if (first()) take_rotor(films.journal, sigma);
  if (!similar) eliminate();
}

void RotorSystem::FilmSolver::Equations::take_film(const Film& film, film::StateResponse& own, double sigma) {
  Linear& out = films_.emplace_back();
  const film::Share& share = film.part->share();
  const auto n = static_cast<std::size_t>(share.rows());
  if (n == 0) return;
  out.a = std::move(own.d_states);
  out.rates = std::move(own.d_rates);
  for (double& value : out.a) value *= alpha_;
  out.a.resize(film.places.size(), 0.0);
  const double* rate = out.rates.data();
  for (std::size_t piece = 0; piece < film.rates_at.size(); ++piece) {
    double* to = out.a.data() + film.rates_at[piece];
    const int count = share.d_rates.pieces()[piece].count;
    for (int i = 0; i < count; ++i) to[i] += sigma * rate[i];
    rate += count;
  }
  for (const auto& [places, values] : {std::pair{&film.places, &out.a}, std::pair{&share.d_rates, &out.rates}}) {
    double* value = values->data();
    for (const film::Diagonal& d : places->pieces()) {
      for (int i = 0; i < d.count; ++i) value[i] *= film.seen(d.column + i) / film.residual(d.row + i);
      value += d.count;
    }
  }
  const bool by_rates = !own.force_d_rates.empty();
  const auto thin = [n](const std::vector<double>& v) {
    return Map<const Eigen::ArrayXd>(v.data(), static_cast<Index>(n));
  };
  const auto fill = [n](std::vector<double>& v) {
    v.resize(n);
    return Map<Eigen::ArrayXd>(v.data(), static_cast<Index>(n));
  };
  for (std::size_t i = 0; i < 2; ++i) {
    fill(out.force[i]) = thin(own.force_d_states[i]) * film.state.array();
    if (by_rates) {
      fill(out.force_rates[i]) = thin(own.force_d_rates[i]) * film.state.array();
      fill(out.force[i]) += sigma / alpha_ * thin(out.force_rates[i]);
    }
    fill(out.driven[i]) = alpha_ * thin(own.d_position[i]) / film.residual.array();
    fill(out.driven[2 + i]) = alpha_ * thin(own.d_velocity[i]) / film.residual.array();
  }
}

void RotorSystem::FilmSolver::Equations::take_rotor(const std::vector<film::Response>& journals, double sigma) {
  const RotorSystem& s = solver_.system_;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t b = 0; b < s.bearings_.size(); ++b) {
    const std::vector<PortEnds>& ports = s.bearings_[b].ports;
    for (std::size_t d = 0; d < ports.size(); ++d)
      for (const auto& [q, to] : ports[d])
        for (std::size_t e = 0; e < ports.size(); ++e)
          for (const auto& [p, side] : ports[e]) {
            const Index row = 2 * q, position = 2 * p, velocity = position + 1;
            const double factor = -alpha_ * to * side / solver_.residual_(row);
            entries.emplace_back(row, position, factor * journals[b].d_position[d][e] * solver_.state_(position));
            entries.emplace_back(row, velocity, factor * journals[b].d_velocity[d][e] * solver_.state_(velocity));
          }
  }
  Sparse by_films(solver_.state_.size(), solver_.state_.size());
  by_films.setFromTriplets(entries.begin(), entries.end());
  rotor_ = solver_.rotor_block(alpha_, sigma) + by_films;
}

// S = A_rr + alpha B F D^-1 G C
void RotorSystem::FilmSolver::Equations::eliminate() {
  Preconditioner& p = *preconditioner_;
  const auto films = static_cast<Index>(films_.size());
  MatrixXd through = MatrixXd::Zero(2 * films, 4 * films);
  for (std::size_t k = 0; k < films_.size(); ++k) {
    if (!p.films[k].inverse) continue;
    const auto at = static_cast<Index>(k);
    for (std::size_t u = 0; u < 4; ++u) {
      std::vector<double>& driven = p.films[k].driven[u];
      driven.resize(films_[k].driven[u].size());
      invert(k, films_[k].driven[u].data(), driven.data());
      through.col(4 * at + static_cast<Index>(u)).segment<2>(2 * at) = sum(films_[k].force, driven.data());
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, through.data(), static_cast<int>(through.size()), MPI_DOUBLE, MPI_SUM,
                solver_.system_.comm_);
  p.to_force.resize(4 * films, 2 * films);
  core::agree(solver_.system_.comm_, [&] {
    if (!first()) return;
    const Sparse thin = through.sparseView(), by_films = solver_.outputs_ * thin * solver_.inputs_;
    const Eigen::SparseMatrix<double> rest = rotor_ + alpha_ * by_films;
    p.rest.compute(rest);
    if (p.rest.info() != Eigen::Success) throw core::DomainError("the rotor in its linearised films is singular");
    p.by_force = alpha_ * p.rest.solve(MatrixXd(solver_.outputs_));
    p.to_force = solver_.inputs_ * p.by_force;
  });
  MPI_Bcast(p.to_force.data(), static_cast<int>(p.to_force.size()), MPI_DOUBLE, 0, solver_.system_.comm_);
}

// The film's own preconditioner knows no scales.
void RotorSystem::FilmSolver::Equations::invert(std::size_t k, const double* r, double* x) const {
  const Film& film = solver_.films_[k];
  Preconditioner::Film& p = preconditioner_->films[k];
  const Index n = film.residual.size();
  Map<Eigen::ArrayXd>(p.rhs.data(), n) = film.residual.array() * Map<const Eigen::ArrayXd>(r, n);
  p.inverse->apply(p.rhs, {x, p.rhs.size()});
  Map<Eigen::ArrayXd>(x, n) /= film.state.array();
}

// The sum of all shares, known to the first rank.
VectorXd RotorSystem::FilmSolver::Equations::at_first(VectorXd shares) const {
  MPI_Reduce(first() ? MPI_IN_PLACE : shares.data(), shares.data(), static_cast<int>(shares.size()), MPI_DOUBLE,
             MPI_SUM, 0, solver_.system_.comm_);
  return shares;
}

// Rows of the films by `rows(film, its number, seen states, inputs, rows)`, which gives this rank's share of its force.
template <class Multiply>
VectorXd RotorSystem::FilmSolver::Equations::multiply_films(Vec v, Vec y, const Multiply& rows) const {
  RotorSystem& s = solver_.system_;
  s.scatter_inputs(v);
  const core::ReadArray inputs(s.inputs_.get()), va(v);
  const core::WriteArray ya(y);
  VectorXd forces = VectorXd::Zero(2 * static_cast<Index>(films_.size()));
  for (std::size_t k = 0; k < films_.size(); ++k) {
    const FilmPart& part = *solver_.films_[k].part;
    const auto n = static_cast<std::size_t>(part.rows());
    if (n == 0) continue;
    const std::span<double> to(ya.data() + part.row(), n);
    std::fill(to.begin(), to.end(), 0.0);
    forces.segment<2>(2 * static_cast<Index>(k)) =
        rows(k, inputs.data() + s.journal_inputs_ + part.gathered(), inputs.data(), va.data() + part.row(), to);
  }
  return forces;
}

void RotorSystem::FilmSolver::Equations::multiply(Vec v, Vec y) const {
  const VectorXd forces = at_first(multiply_films(
      v, y, [&](std::size_t k, const double* seen, const double* inputs, const double* held, std::span<double> to) {
        film::multiply_add(solver_.films_[k].places, films_[k].a, seen, to);
        add(films_[k].driven, solver_.motion_of(k, inputs), to.data());
        return sum(films_[k].force, held);
      }));
  if (!first()) return;
  const core::ReadArray va(v);
  const core::WriteArray ya(y);
  Map<VectorXd> out(ya.data(), rotor_.rows());
  out = rotor_ * Map<const VectorXd>(va.data(), rotor_.rows());
  out -= alpha_ * (solver_.outputs_ * forces);
}

void RotorSystem::FilmSolver::Equations::multiply_rates(Vec v, Vec y) const {
  const bool rates = !solver_.system_.constant_rates();
  VectorXd forces = multiply_films(
      v, y, [&](std::size_t k, const double* seen, const double*, const double* held, std::span<double> to) {
        film::multiply_add(solver_.films_[k].part->share().d_rates, films_[k].rates, seen, to);
        return Eigen::Vector2d(films_[k].force_rates[0].empty() ? Eigen::Vector2d::Zero()
                                                                : sum(films_[k].force_rates, held));
      });
  if (rates) forces = at_first(std::move(forces));
  if (!first()) return;
  const core::ReadArray va(v);
  const core::WriteArray ya(y);
  Map<VectorXd> out(ya.data(), solver_.rates_.rows());
  out = solver_.rates_ * Map<const VectorXd>(va.data(), out.size());
  if (rates) out -= solver_.outputs_ * forces;
}

void RotorSystem::FilmSolver::Equations::precondition(Vec r, Vec y) const {
  const Preconditioner& p = *preconditioner_;
  const core::ReadArray ra(r);
  const core::WriteArray ya(y);
  const auto films = static_cast<Index>(films_.size());
  // The forces of all ranks and what the first one knows of the inputs, in one message.
  VectorXd sums = VectorXd::Zero(6 * films);
  for (std::size_t k = 0; k < films_.size(); ++k) {
    if (!p.films[k].inverse) continue;
    const PetscInt row = solver_.films_[k].part->row();
    invert(k, ra.data() + row, ya.data() + row);
    sums.segment<2>(2 * static_cast<Index>(k)) = sum(films_[k].force, ya.data() + row);
  }
  VectorXd z;
  if (first()) {
    z = p.rest.solve(Map<const VectorXd>(ra.data(), rotor_.rows()));
    sums.tail(4 * films) = solver_.inputs_ * z;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, solver_.system_.comm_);
  const VectorXd u = sums.tail(4 * films) + p.to_force * sums.head(2 * films);
  if (first()) {
    z.noalias() += p.by_force * sums.head(2 * films);
    Map<VectorXd>(ya.data(), rotor_.rows()) = z;
  }
  for (std::size_t k = 0; k < films_.size(); ++k) {
    if (!p.films[k].inverse) continue;
    const Index at = 4 * static_cast<Index>(k);
    add(p.films[k].driven, {-u(at), -u(at + 1), -u(at + 2), -u(at + 3)}, ya.data() + solver_.films_[k].part->row());
  }
}

void RotorSystem::FilmSolver::Equations::solve(Vec r, Vec y, double tolerance) const {
  KSP ksp = solver_.krylov_.get();
  solver_.current_ = this;
  check(KSPSetTolerances(ksp, tolerance, 1e-300, PETSC_DEFAULT, 100));
  solver_.gate_.rethrow(KSPSolve(ksp, r, y));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(ksp, &reason));
  if (reason < 0)
    core::agree(solver_.system_.comm_, [] { throw core::DomainError("the linearised films were not solved"); });
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

}  // namespace whirl::system
