// The inverses of a machine's films, in the scales of its states and rows.

#include <Eigen/Core>

#include "direct_inverse.hpp"
#include "film_comms.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

using core::check;
using Map = Eigen::Map<Eigen::ArrayXd>;
using ConstMap = Eigen::Map<const Eigen::ArrayXd>;

class RotorSystem::FilmInverse final : public problem::ExactPartInverse {
public:
  explicit FilmInverse(RotorSystem& system);
  /// Whether a film offers one; else there are none. The same on all ranks.
  [[nodiscard]] bool offered() const { return offered_; }
  void set(double angle, Vec x, Vec xdot, double alpha, double sigma) override;
  /// Exact if the inverses of all films are.
  [[nodiscard]] problem::ExactPartInverse* exact() override { return exact_ ? this : nullptr; }
  void apply(const double* r, double* y) override { apply_columns(r, y, 0, 1); }
  void apply_columns(const double* r, double* y, std::ptrdiff_t rows, int columns) override;
  void apply_transposed(const double* r, double* y) override;
  void set_at(Vec x, Vec rest, std::complex<double> lambda) override;
  void apply_at(const std::complex<double>* r, std::complex<double>* y, std::ptrdiff_t rows, int columns) override;

private:
  struct Film {
    std::size_t bearing = 0;
    Eigen::Index row = 0;  // among those of all films here
    std::unique_ptr<film::StatePreconditioner> inverse;
    Eigen::ArrayXd state, residual;  // scales of its states and rows here, which a parameter may change
    std::vector<double> rhs;
  };
  /// Columns of a film among those of all: y = answer(r) / its scales of states, r times those of its rows.
  template <class Scalar, class Answer>
  static void in_scales(const Film& film, const Scalar* r, Scalar* y, std::ptrdiff_t rows, int columns,
                        Answer&& answer);
  /// Its derivatives at the state that was evaluated last.
  const film::StateResponse& look(Film& film) const;

  RotorSystem& system_;
  std::shared_ptr<const FilmComms> comms_;  // outlives the inverses
  std::vector<Film> films_;                 // with rows on this rank
  bool offered_ = false, exact_ = true;
};

const RotorSystem::FilmComms& RotorSystem::film_comms() {
  if (!film_comms_) film_comms_ = std::make_shared<const FilmComms>(comm_, bearings_);
  return *film_comms_;
}

std::unique_ptr<problem::PartInverse> RotorSystem::make_part_inverse() {
  if (n_own_ == 0) return nullptr;
  (void)film_comms();
  auto inverse = std::make_unique<FilmInverse>(*this);
  return inverse->offered() ? std::move(inverse) : nullptr;
}

RotorSystem::FilmInverse::FilmInverse(RotorSystem& s) : system_(s), comms_(s.film_comms_) {
  const PetscInt machine = s.local_size() - s.own_here_;
  for (const std::size_t b : FilmComms::in_order(*comms_, s.bearings_, [](const FilmPart&) { return true; })) {
    const FilmPart* part = s.bearings_[b].part.get();
    Film& film = films_.emplace_back();
    film.bearing = b;
    film.row = part->row() - machine;
    film.inverse = part->film().preconditioner(comms_->of(b), part->share());
    offered_ = offered_ || film.inverse;
    film.state.resize(part->rows());
    film.residual.resize(part->rows());
    film.rhs.resize(static_cast<std::size_t>(part->rows()));
  }
  MPI_Allreduce(MPI_IN_PLACE, &offered_, 1, MPI_CXX_BOOL, MPI_LOR, s.comm_);
  if (!offered_) return;
  for (Film& film : films_) {
    if (!film.inverse)
      film.inverse = make_direct_inverse(comms_->of(film.bearing), s.bearings_[film.bearing].part->share());
    exact_ = exact_ && film.inverse->exact() != nullptr;
  }
  MPI_Allreduce(MPI_IN_PLACE, &exact_, 1, MPI_CXX_BOOL, MPI_LAND, s.comm_);
}

const film::StateResponse& RotorSystem::FilmInverse::look(Film& film) const {
  const FilmPart& part = *system_.bearings_[film.bearing].part;
  part.scales(film.state.data(), film.residual.data());
  return part.response();
}

void RotorSystem::FilmInverse::set(double /*angle*/, Vec x, Vec xdot, double alpha, double sigma) {
  system_.evaluate_films(x, xdot, film::Need::tangents);
  for (Film& film : films_) {
    const film::StateResponse& own = look(film);
    film.inverse->set(own.d_states, own.d_rates, alpha, sigma);
  }
}

// A film's own inverse knows no scales.
template <class Scalar, class Answer>
void RotorSystem::FilmInverse::in_scales(const Film& film, const Scalar* r, Scalar* y, std::ptrdiff_t rows, int columns,
                                         Answer&& answer) {
  using Matrix = Eigen::Array<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  const Eigen::Index n = film.state.size();
  const Eigen::OuterStride<> stride(rows);
  const Eigen::Map<const Matrix, 0, Eigen::OuterStride<>> from(r + film.row, n, columns, stride);
  Eigen::Map<Matrix, 0, Eigen::OuterStride<>> to(y + film.row, n, columns, stride);
  const Matrix right = from.colwise() * film.residual.template cast<Scalar>();
  Matrix found(n, columns);
  const auto size = static_cast<std::size_t>(right.size());
  answer(std::span<const Scalar>(right.data(), size), std::span<Scalar>(found.data(), size));
  to = found.colwise() / film.state.template cast<Scalar>();
}

void RotorSystem::FilmInverse::apply_columns(const double* r, double* y, std::ptrdiff_t rows, int columns) {
  for (Film& film : films_)
    in_scales(film, r, y, rows, columns, [&](std::span<const double> right, std::span<double> found) {
      if (film.inverse->exact() != nullptr) return film.inverse->apply(right, found);
      const auto n = static_cast<std::size_t>(film.state.size());
      for (std::size_t c = 0; c < static_cast<std::size_t>(columns); ++c)
        film.inverse->apply(right.subspan(c * n, n), found.subspan(c * n, n));
    });
}

void RotorSystem::FilmInverse::apply_transposed(const double* r, double* y) {
  for (Film& film : films_) {
    const Eigen::Index n = film.state.size();
    Map(film.rhs.data(), n) = ConstMap(r + film.row, n) / film.state;
    film.inverse->exact()->apply_transposed(film.rhs, {y + film.row, film.rhs.size()});
    Map(y + film.row, n) *= film.residual;
  }
}

void RotorSystem::FilmInverse::set_at(Vec x, Vec rest, std::complex<double> lambda) {
  system_.evaluate_films(x, rest, film::Need::tangents);
  for (Film& film : films_) {
    const film::StateResponse& own = look(film);
    film.inverse->exact()->set_at(own.d_states, own.d_rates, lambda);
  }
}

void RotorSystem::FilmInverse::apply_at(const std::complex<double>* r, std::complex<double>* y, std::ptrdiff_t rows,
                                        int columns) {
  using Complex = std::complex<double>;
  for (Film& film : films_)
    in_scales(film, r, y, rows, columns, [&](std::span<const Complex> right, std::span<Complex> found) {
      film.inverse->exact()->apply_at(right, found);
    });
}

}  // namespace whirl::system
