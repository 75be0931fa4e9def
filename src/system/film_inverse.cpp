// The preconditioners of a machine's films, in the scales of its states and rows.

#include <Eigen/Core>

#include "film_part.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

using core::check;
using Map = Eigen::Map<Eigen::ArrayXd>;
using ConstMap = Eigen::Map<const Eigen::ArrayXd>;

class RotorSystem::FilmInverse final : public problem::PartInverse {
public:
  explicit FilmInverse(RotorSystem& system);
  ~FilmInverse() override;
  /// Whether all films with states have a preconditioner. Collective.
  [[nodiscard]] bool complete() const;
  void set(double angle, Vec x, Vec xdot, double alpha, double sigma) override;
  void apply(const double* r, double* y) override;

private:
  struct Film {
    std::size_t bearing = 0;
    MPI_Comm comm = MPI_COMM_NULL;  // of the ranks that hold it; null elsewhere. Owned
    std::unique_ptr<film::StatePreconditioner> inverse;
    Eigen::ArrayXd state, residual;  // scales of its states and rows here
    std::vector<double> rhs;
  };
  RotorSystem& system_;
  std::vector<Film> films_;
};

std::unique_ptr<problem::PartInverse> RotorSystem::make_part_inverse() {
  if (n_own_ == 0) return nullptr;
  auto inverse = std::make_unique<FilmInverse>(*this);
  return inverse->complete() ? std::move(inverse) : nullptr;
}

RotorSystem::FilmInverse::FilmInverse(RotorSystem& s) : system_(s) {
  core::Vector state = core::make_vector(s.comm_, s.local_size(), PETSC_DETERMINE),
               residual = core::duplicate(state.get());
  s.scales(state.get(), residual.get());
  const core::ReadArray sa(state.get()), ra(residual.get());
  for (std::size_t b = 0; b < s.bearings_.size(); ++b) {
    const FilmPart* part = s.bearings_[b].part.get();
    if (part->count() == 0) continue;
    Film& film = films_.emplace_back();
    film.bearing = b;
    MPI_Comm_split(s.comm_, part->rows() > 0 ? 0 : MPI_UNDEFINED, core::rank_of(s.comm_), &film.comm);
    if (film.comm == MPI_COMM_NULL) continue;
    film.inverse = part->film().preconditioner(film.comm, part->share());
    film.state = ConstMap(sa.data() + part->row(), part->rows());
    film.residual = ConstMap(ra.data() + part->row(), part->rows());
    film.rhs.resize(static_cast<std::size_t>(part->rows()));
  }
}

RotorSystem::FilmInverse::~FilmInverse() {
  for (Film& film : films_) {
    film.inverse.reset();
    if (film.comm != MPI_COMM_NULL) MPI_Comm_free(&film.comm);
  }
}

bool RotorSystem::FilmInverse::complete() const {
  bool all = true;
  for (const Film& film : films_)
    if (film.comm != MPI_COMM_NULL && !film.inverse) all = false;
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_CXX_BOOL, MPI_LAND, system_.comm_);
  return all;
}

void RotorSystem::FilmInverse::set(double /*angle*/, Vec x, Vec xdot, double alpha, double sigma) {
  const Films at = system_.films_at(x, xdot, film::Need::tangents);
  for (Film& film : films_) {
    if (!film.inverse) continue;
    const film::StateResponse& own = at.own[film.bearing];
    film.inverse->set(own.d_states, own.d_rates, alpha, sigma);
  }
}

// A film's own preconditioner knows no scales.
void RotorSystem::FilmInverse::apply(const double* r, double* y) {
  for (Film& film : films_) {
    if (!film.inverse) continue;
    const Eigen::Index n = film.state.size();
    Map(film.rhs.data(), n) = film.residual * ConstMap(r, n);
    film.inverse->apply(film.rhs, {y, film.rhs.size()});
    Map(y, n) /= film.state;
    r += n;
    y += n;
  }
}

}  // namespace whirl::system
