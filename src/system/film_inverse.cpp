// The preconditioners of a machine's films, in the scales of its states and rows.

#include <Eigen/Core>

#include "film_part.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

using core::check;
using Map = Eigen::Map<Eigen::ArrayXd>;
using ConstMap = Eigen::Map<const Eigen::ArrayXd>;

/// The ranks that hold each film, with a communicator for them; null on others, and for films without states.
class RotorSystem::FilmComms {
public:
  /// Collective.
  FilmComms(MPI_Comm comm, const std::vector<Bearing>& bearings) {
    for (const Bearing& b : bearings) {
      MPI_Comm& made = comms_.emplace_back(MPI_COMM_NULL);
      if (b.part->count() > 0) MPI_Comm_split(comm, b.part->rows() > 0 ? 0 : MPI_UNDEFINED, core::rank_of(comm), &made);
    }
  }
  FilmComms(const FilmComms&) = delete;
  FilmComms& operator=(const FilmComms&) = delete;
  ~FilmComms() {
    for (MPI_Comm& comm : comms_)
      if (comm != MPI_COMM_NULL) MPI_Comm_free(&comm);
  }
  [[nodiscard]] MPI_Comm of(std::size_t bearing) const { return comms_[bearing]; }

private:
  std::vector<MPI_Comm> comms_;
};

class RotorSystem::FilmInverse final : public problem::PartInverse {
public:
  explicit FilmInverse(RotorSystem& system);
  /// Whether all films with states have a preconditioner. Collective.
  [[nodiscard]] bool complete() const;
  void set(double angle, Vec x, Vec xdot, double alpha, double sigma) override;
  void apply(const double* r, double* y) override;

private:
  struct Film {
    std::size_t bearing = 0;
    std::unique_ptr<film::StatePreconditioner> inverse;
    Eigen::ArrayXd state, residual;  // scales of its states and rows here
    std::vector<double> rhs;
  };
  RotorSystem& system_;
  std::shared_ptr<const FilmComms> comms_;  // outlives the inverses
  std::vector<Film> films_;                 // with rows on this rank
};

std::unique_ptr<problem::PartInverse> RotorSystem::make_part_inverse() {
  if (n_own_ == 0) return nullptr;
  if (!film_comms_) film_comms_ = std::make_shared<const FilmComms>(comm_, bearings_);
  auto inverse = std::make_unique<FilmInverse>(*this);
  return inverse->complete() ? std::move(inverse) : nullptr;
}

RotorSystem::FilmInverse::FilmInverse(RotorSystem& s) : system_(s), comms_(s.film_comms_) {
  core::Vector state = core::make_vector(s.comm_, s.local_size(), PETSC_DETERMINE),
               residual = core::duplicate(state.get());
  s.scales(state.get(), residual.get());
  const core::ReadArray sa(state.get()), ra(residual.get());
  for (std::size_t b = 0; b < s.bearings_.size(); ++b) {
    const FilmPart* part = s.bearings_[b].part.get();
    if (comms_->of(b) == MPI_COMM_NULL) continue;
    Film& film = films_.emplace_back();
    film.bearing = b;
    film.inverse = part->film().preconditioner(comms_->of(b), part->share());
    film.state = ConstMap(sa.data() + part->row(), part->rows());
    film.residual = ConstMap(ra.data() + part->row(), part->rows());
    film.rhs.resize(static_cast<std::size_t>(part->rows()));
  }
}

bool RotorSystem::FilmInverse::complete() const {
  bool all = true;
  for (const Film& film : films_)
    if (!film.inverse) all = false;
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_CXX_BOOL, MPI_LAND, system_.comm_);
  return all;
}

void RotorSystem::FilmInverse::set(double /*angle*/, Vec x, Vec xdot, double alpha, double sigma) {
  system_.evaluate_films(x, xdot, film::Need::tangents);
  for (Film& film : films_) {
    const film::StateResponse& own = system_.bearings_[film.bearing].part->response();
    film.inverse->set(own.d_states, own.d_rates, alpha, sigma);
  }
}

// A film's own preconditioner knows no scales.
void RotorSystem::FilmInverse::apply(const double* r, double* y) {
  for (Film& film : films_) {
    const Eigen::Index n = film.state.size();
    Map(film.rhs.data(), n) = film.residual * ConstMap(r, n);
    film.inverse->apply(film.rhs, {y, film.rhs.size()});
    Map(y, n) /= film.state;
    r += n;
    y += n;
  }
}

}  // namespace whirl::system
