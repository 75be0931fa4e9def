// What all frozen equations of a system share: its films, the blocks of its rotor, the Krylov method.
#include <Eigen/SparseCore>
#include <algorithm>

#include "blocks.hpp"
#include "frozen.hpp"

namespace whirl::system {

using core::check;
using Eigen::Index;
using Eigen::Map;
using Eigen::VectorXd;

std::unique_ptr<RotorSystem::FilmSolver> RotorSystem::FilmSolver::make(RotorSystem& system) {
  if (system.n_own_ == 0) return nullptr;
  // It knows films along x and y.
  for (const Bearing& b : system.bearings_)
    if (b.part->count() > 0 && b.tilts()) return nullptr;
  std::unique_ptr<FilmSolver> out(new FilmSolver(system));
  bool offered = true;
  for (const Film& film : out->films_)
    if (film.comm != MPI_COMM_NULL && !film.part->film().preconditioner(film.comm, film.part->share())) offered = false;
  MPI_Allreduce(MPI_IN_PLACE, &offered, 1, MPI_CXX_BOOL, MPI_LAND, system.comm_);
  if (!offered) return nullptr;
  out->make_rotor();
  out->make_krylov();
  return out;
}

RotorSystem::FilmSolver::FilmSolver(RotorSystem& s) : system_(s), gate_(s.comm_) {
  make_films();
}

RotorSystem::FilmSolver::~FilmSolver() {
  for (Film& film : films_)
    if (film.comm != MPI_COMM_NULL) MPI_Comm_free(&film.comm);
}

void RotorSystem::FilmSolver::make_films() {
  RotorSystem& s = system_;
  core::Vector state = core::make_vector(s.comm_, s.local_size(), PETSC_DETERMINE),
               residual = core::duplicate(state.get());
  s.scales(state.get(), residual.get());
  s.scatter_inputs(state.get());
  const core::ReadArray sa(state.get()), ra(residual.get()), inputs(s.inputs_.get());
  const Index rows = s.owns(0) ? 2 * s.n_ : 0;
  state_ = Map<const VectorXd>(sa.data(), rows);
  residual_ = Map<const VectorXd>(ra.data(), rows);
  for (std::size_t b = 0; b < s.bearings_.size(); ++b) {
    const FilmPart* part = s.bearings_[b].part.get();
    if (part->count() == 0) continue;
    Film& film = films_.emplace_back();
    film.bearing = b;
    film.part = part;
    MPI_Comm_split(s.comm_, part->rows() > 0 ? 0 : MPI_UNDEFINED, core::rank_of(s.comm_), &film.comm);
    std::copy_n(inputs.data() + 8 * b, 8, film.journal_scale.begin());
    const film::Share& share = part->share();
    film.seen = Map<const VectorXd>(inputs.data() + s.journal_inputs_ + part->gathered(),
                                    static_cast<Index>(share.seen.size()));
    film.state = Map<const VectorXd>(sa.data() + part->row(), share.rows());
    film.residual = Map<const VectorXd>(ra.data() + part->row(), share.rows());
    film.places = share.d_states;
    for (const film::Diagonal& d : share.d_rates.pieces()) {
      std::size_t at = 0;
      const auto same = [&](const film::Diagonal& e) {
        if (e.row == d.row && e.column == d.column && e.count == d.count) return true;
        at += static_cast<std::size_t>(e.count);
        return false;
      };
      const auto& pieces = film.places.pieces();
      if (std::none_of(pieces.begin(), pieces.end(), same)) film.places.add(d);
      film.rates_at.push_back(at);
    }
  }
}

// Rows (momentum, velocity) of the pairs, without films.
void RotorSystem::FilmSolver::make_rotor() {
  const RotorSystem& s = system_;
  const Index n = state_.size(), films = static_cast<Index>(films_.size());
  std::vector<Eigen::Triplet<double>> rates, at_rest, gyroscopic, inputs, outputs;
  add_entries(s.matrices_.mass.get(), 1, rates);
  add_entries(s.matrices_.stiffness.get(), 0, at_rest);
  add_entries(s.matrices_.damping.get(), 1, at_rest);
  add_entries(s.matrices_.gyroscopic.get(), 1, gyroscopic);
  for (Index i = 0; i < n / 2; ++i) {
    rates.emplace_back(2 * i + 1, 2 * i, 1.0);
    at_rest.emplace_back(2 * i + 1, 2 * i + 1, -1.0);
  }
  for (Index k = 0; k < films && n > 0; ++k) {
    const std::vector<PortEnds>& ports = s.bearings_[films_[static_cast<std::size_t>(k)].bearing].ports;
    for (std::size_t d = 0; d < ports.size(); ++d)
      for (const auto& [q, side] : ports[d]) {
        const auto e = static_cast<Index>(d);
        inputs.emplace_back(4 * k + e, 2 * q, side * state_(2 * q));
        inputs.emplace_back(4 * k + 2 + e, 2 * q + 1, side * state_(2 * q + 1));
        outputs.emplace_back(2 * q, 2 * k + e, side / residual_(2 * q));
      }
  }
  const auto set = [&](Sparse& m, Index rows, Index columns, const std::vector<Eigen::Triplet<double>>& entries) {
    m.resize(rows, columns);
    m.setFromTriplets(entries.begin(), entries.end());
  };
  for (const auto& [m, entries] :
       {std::pair{&rates_, &rates}, std::pair{&at_rest_, &at_rest}, std::pair{&gyroscopic_, &gyroscopic}}) {
    set(*m, n, n, *entries);
    *m = residual_.cwiseInverse().asDiagonal() * *m * state_.asDiagonal();
  }
  set(inputs_, 4 * films, n, inputs);
  set(outputs_, n, 2 * films, outputs);
}

RotorSystem::FilmSolver::Sparse RotorSystem::FilmSolver::rotor_block(double alpha, double sigma) const {
  return alpha * at_rest_ + (alpha * system_.speed_) * gyroscopic_ + sigma * rates_;
}

std::array<double, 4> RotorSystem::FilmSolver::motion_of(std::size_t k, const double* inputs) const {
  const Film& film = films_[k];
  const std::vector<PortEnds>& ports = system_.bearings_[film.bearing].ports;
  std::array<double, 4> u{};  // position, velocity
  for (std::size_t d = 0; d < 2; ++d)
    for (std::size_t rate = 0; rate < 2; ++rate)
      for (std::size_t end = 0; end < ports[d].size(); ++end) {
        const std::size_t j = 4 * d + 2 * end + rate;
        u[2 * rate + d] += ports[d][end].second * inputs[8 * film.bearing + j] * film.journal_scale[j];
      }
  return u;
}

void RotorSystem::FilmSolver::make_krylov() {
  RotorSystem& s = system_;
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

}  // namespace whirl::system
