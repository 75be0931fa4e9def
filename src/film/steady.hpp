#pragma once
// The steady equations of a film with states by Newton's method: g(motion, s, s') = 0 in s at given rates s'.

#include <Eigen/SparseLU>
#include <array>
#include <optional>
#include <vector>

#include "film/band_lu.hpp"
#include "whirl/film/film.hpp"
#include "whirl/film/film_matrix.hpp"

namespace whirl::film {

class Steady {
public:
  explicit Steady(Film& film);
  /// How small the last step must be: 1e-10 of the typical state, or so small too that it does not show in the force.
  enum class Until { small_step, same_force };
  /// Finds the states from those given, which it leaves as they were if it throws core::NotConverged or
  /// core::DomainError.
  void solve(const JournalMotion& motion, std::span<const double> rates, Until until, std::vector<double>& states);
  /// What the film answered at the states found, with tangents; may be taken from.
  [[nodiscard]] StateResponse& here() { return here_; }
  /// x = (dg/ds)^-T b at the states found.
  [[nodiscard]] Eigen::VectorXd solve_transposed(const std::vector<double>& b);
  /// Factorisations so far.
  [[nodiscard]] long factorisations() const { return factorisations_; }

private:
  void factor();
  [[nodiscard]] double distance(const StateResponse& at) const;
  [[nodiscard]] std::array<double, 4> effect(const Eigen::VectorXd& step) const;

  Film& film_;
  Eigen::VectorXd scale_, row_weight_;
  StateResponse here_, there_;
  std::vector<double> trial_;
  FilmMatrix<double> matrix_;
  // One of both.
  std::optional<BandLu> band_;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> lu_;
  std::vector<double> factored_;  // dg/ds that the factors belong to
  long factorisations_ = 0;
};

}  // namespace whirl::film
