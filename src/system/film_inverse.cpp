// The inverses of a machine's films, in the scales of its states and rows.

#include <Eigen/Core>
#include <complex>
#include <span>

#include "film_comms.hpp"
#include "whirl/film/algebra/direct_inverse.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

using core::check;
using Map = Eigen::Map<Eigen::ArrayXd>;
using ConstMap = Eigen::Map<const Eigen::ArrayXd>;

class RotorSystem::FilmInverses {
public:
  explicit FilmInverses(RotorSystem& system);
  /// Whether a film offers one, else there are none; whether all are exact. The same on all ranks.
  [[nodiscard]] bool offered() const { return offered_; }
  [[nodiscard]] bool exact() const { return exact_; }
  void set(const problem::Point& at, double alpha, double sigma);
  void apply(std::span<const double> r, std::span<double> y);
  void apply_transposed(std::span<const double> r, std::span<double> y);
  void set_at(const problem::Point& at, std::complex<double> lambda);
  void apply_at(std::span<const std::complex<double>> r, std::span<std::complex<double>> y);

private:
  struct Film {
    std::size_t bearing = 0;
    Eigen::Index row = 0;  // among those of all films here
    std::unique_ptr<film::StateInverse> inverse;
    Eigen::ArrayXd state, residual;  // scales of its states and rows here, which a parameter may change
  };
  /// Calls answer(film, right, found) for the columns of each film. `right` is r times the scales of the film's rows,
  /// and y is `found` divided by the scales of its states. Transposed, the two scales change places.
  template <class Scalar, class Answer>
  void in_scales(std::span<const Scalar> r, std::span<Scalar> y, bool transposed, Answer&& answer);
  /// Its derivatives at the state that was evaluated last.
  [[nodiscard]] film::StateDerivatives look(Film& film) const;

  RotorSystem& system_;
  std::shared_ptr<const FilmComms> comms_;  // outlives the inverses
  std::vector<Film> films_;                 // with rows on this rank
  bool offered_ = false, exact_ = true;
};

template <class Interface>
class RotorSystem::OfFilms : public Interface {
public:
  explicit OfFilms(FilmInverses films) : films_(std::move(films)) {}
  void set(const problem::Point& at, double alpha, double sigma) override { films_.set(at, alpha, sigma); }
  void apply(std::span<const double> r, std::span<double> y) override { films_.apply(r, y); }

protected:
  FilmInverses films_;
};

class RotorSystem::OfExactFilms final : public OfFilms<problem::ExactPartInverse> {
public:
  using OfFilms::OfFilms;
  void apply_transposed(std::span<const double> r, std::span<double> y) override { films_.apply_transposed(r, y); }
  void set_at(const problem::Point& at, std::complex<double> lambda) override { films_.set_at(at, lambda); }
  void apply_at(std::span<const std::complex<double>> r, std::span<std::complex<double>> y) override {
    films_.apply_at(r, y);
  }
};

const RotorSystem::FilmComms& RotorSystem::film_comms() {
  if (!film_comms_) film_comms_ = std::make_shared<const FilmComms>(comm_, bearings_);
  return *film_comms_;
}

std::unique_ptr<problem::PartInverse> RotorSystem::make_part_inverse() {
  if (n_own_ == 0) return nullptr;
  (void)film_comms();
  FilmInverses films(*this);
  if (!films.offered()) return nullptr;
  if (films.exact()) return std::make_unique<OfExactFilms>(std::move(films));
  return std::make_unique<OfFilms<problem::PartInverse>>(std::move(films));
}

RotorSystem::FilmInverses::FilmInverses(RotorSystem& s) : system_(s), comms_(s.film_comms_) {
  const PetscInt machine = s.local_size() - s.own_here_;
  for (const std::size_t b : FilmComms::in_order(*comms_, s.bearings_, [](const FilmPart&) { return true; })) {
    const FilmPart* part = s.bearings_[b].part.get();
    Film& film = films_.emplace_back();
    film.bearing = b;
    film.row = part->row() - machine;
    film.inverse = part->film().inverse(comms_->of(b), part->share());
    offered_ = offered_ || film.inverse;
    film.state.resize(part->rows());
    film.residual.resize(part->rows());
  }
  MPI_Allreduce(MPI_IN_PLACE, &offered_, 1, MPI_CXX_BOOL, MPI_LOR, s.comm_);
  if (!offered_) return;
  for (Film& film : films_) {
    if (!film.inverse)
      film.inverse = film::make_direct_inverse(comms_->of(film.bearing), s.bearings_[film.bearing].part->share());
    exact_ = exact_ && film.inverse->exact() != nullptr;
  }
  MPI_Allreduce(MPI_IN_PLACE, &exact_, 1, MPI_CXX_BOOL, MPI_LAND, s.comm_);
}

film::StateDerivatives RotorSystem::FilmInverses::look(Film& film) const {
  const FilmPart& part = *system_.bearings_[film.bearing].part;
  part.scales(film.state.data(), film.residual.data());
  return {part.response().d_states, part.response().d_rates};
}

void RotorSystem::FilmInverses::set(const problem::Point& at, double alpha, double sigma) {
  system_.evaluate_films(at.x, at.xdot, film::Need::tangents);
  for (Film& film : films_) film.inverse->set(look(film), alpha, sigma);
}

void RotorSystem::FilmInverses::set_at(const problem::Point& at, std::complex<double> lambda) {
  system_.evaluate_films(at.x, at.xdot, film::Need::tangents);
  for (Film& film : films_) film.inverse->exact()->set_at(look(film), lambda);
}

// A film's own inverse knows no scales.
template <class Scalar, class Answer>
void RotorSystem::FilmInverses::in_scales(std::span<const Scalar> r, std::span<Scalar> y, bool transposed,
                                          Answer&& answer) {
  using Matrix = Eigen::Array<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  const Eigen::Index rows = system_.own_here_, columns = rows > 0 ? static_cast<Eigen::Index>(r.size()) / rows : 0;
  for (Film& film : films_) {
    const Eigen::Index n = film.state.size();
    const Eigen::OuterStride<> stride(rows);
    const Eigen::Map<const Matrix, 0, Eigen::OuterStride<>> from(r.data() + film.row, n, columns, stride);
    Eigen::Map<Matrix, 0, Eigen::OuterStride<>> to(y.data() + film.row, n, columns, stride);
    Matrix right = from, found(n, columns);
    if (transposed)
      right.colwise() /= film.state.template cast<Scalar>();
    else
      right.colwise() *= film.residual.template cast<Scalar>();
    answer(*film.inverse, std::span<const Scalar>(core::span_of(right)), core::span_of(found));
    if (transposed)
      to = found.colwise() * film.residual.template cast<Scalar>();
    else
      to = found.colwise() / film.state.template cast<Scalar>();
  }
}

void RotorSystem::FilmInverses::apply(std::span<const double> r, std::span<double> y) {
  in_scales(r, y, false, [](film::StateInverse& film, auto right, auto found) { film.apply(right, found); });
}

void RotorSystem::FilmInverses::apply_transposed(std::span<const double> r, std::span<double> y) {
  in_scales(r, y, true,
            [](film::StateInverse& film, auto right, auto found) { film.exact()->apply_transposed(right, found); });
}

void RotorSystem::FilmInverses::apply_at(std::span<const std::complex<double>> r, std::span<std::complex<double>> y) {
  in_scales(r, y, false,
            [](film::StateInverse& film, auto right, auto found) { film.exact()->apply_at(right, found); });
}

}  // namespace whirl::system
