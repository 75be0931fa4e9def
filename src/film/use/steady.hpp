#pragma once
// The steady equations of a film with states by Newton's method: g(motion, s, s') = 0 in s at given rates s'.
//
// Factors are kept from step to step, and from motion to motion, as long as steps with them are expected to cost less
// than new ones: derivatives and a factorisation cost several residuals. Kept factors change the way to the solution,
// not what is left at its end.

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "film/algebra/film_matrix.hpp"
#include "film/use/lent_lu.hpp"
#include "whirl/core/band_lu.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film {

class Steady {
public:
  static constexpr double unknown = std::numeric_limits<double>::infinity();
  explicit Steady(Film& film);
  Steady(const Steady&) = delete;
  Steady& operator=(const Steady&) = delete;
  /// How small the last step must be: 1e-10 of the typical state, or so small too that it does not show in the force.
  enum class Until { small_step, same_force };
  /// Finds the states from those given, which it leaves as they were if it throws core::NotConverged or
  /// core::DomainError. Where tangents are needed too, those are of the states before the last step, which is then too
  /// small to show in them. `error` is what the states given may lack, in typical states, as far as that is known.
  void solve(const JournalMotion& motion, std::span<const double> rates, Until until, Need need,
             std::vector<double>& states, double error = unknown);
  /// What the film answers at the states found, without tangents.
  [[nodiscard]] const StateResponse& here() const { return *at_; }
  /// The same with tangents.
  [[nodiscard]] const StateResponse& tangents();
  /// x = (dg/ds)^-T b [states x any] at the states found, after tangents().
  [[nodiscard]] Eigen::MatrixXd solve_transposed(const Eigen::MatrixXd& b);
  /// ds/dw [states x (2 ports + 1)] by positions and velocities of the ports and by the speed, after tangents().
  [[nodiscard]] Eigen::MatrixXd slopes();
  /// How much of a typical state each state is, as the root of a mean square.
  [[nodiscard]] double size(const Eigen::VectorXd& step) const;
  /// How much derivatives change, relatively, where the states change by `size`, and what a prediction by them lacks.
  /// At least by 1 over a typical state: what kept factors have shown may be that of one direction.
  [[nodiscard]] double bends(double size) const { return size == 0.0 ? 0.0 : std::max(1.0, bend_) * size; }
  [[nodiscard]] double lacks(double size) const { return bends(size) * size; }
  /// Adds to `states`, those of a motion that was solved, what the derivatives last taken say that a change of the
  /// motion does to them; not if that is more than half a typical state, where derivatives say little.
  void follow(const JournalMotion& from, const JournalMotion& to, std::vector<double>& states);
  /// Factorisations so far.
  [[nodiscard]] long factorisations() const { return factorisations_; }

private:
  void linearise(std::span<const double> states);
  void factor();
  [[nodiscard]] Eigen::VectorXd step(const std::vector<double>& residual);
  [[nodiscard]] Eigen::MatrixXd refined(const Eigen::MatrixXd& b, bool transposed);
  [[nodiscard]] double distance(const StateResponse& at) const;
  [[nodiscard]] std::array<double, 4> effect(const Eigen::VectorXd& step) const;
  [[nodiscard]] std::pair<std::array<double, 4>, std::array<double, 4>> effect_by_steps(
      const std::array<double, 4>& force_before) const;
  [[nodiscard]] bool pays(double contraction, double size) const;
  void take_last(const Eigen::VectorXd& step, std::vector<double>& states);

  Film& film_;
  Eigen::VectorXd scale_, row_weight_;
  // What is being solved, and where it stands.
  JournalMotion motion_;
  std::vector<double> rates_, now_, trial_;
  StateResponse linear_, here_, there_;  // `linear_` with derivatives, of which the factors are or were
  const StateResponse* at_ = &here_;     // of both, that of now_
  FilmMatrix<double> matrix_;
  // One of both.
  std::optional<core::BandLu> band_;
  LentLu lu_;
  std::vector<double> factored_;  // dg/ds that the factors belong to; empty: there are none
  Eigen::VectorXd factored_at_;   // states that they are of
  double price_;                  // of derivatives and factors, in steps with kept ones
  double contraction_ = unknown;  // of the last step with kept factors
  double bend_ = unknown;         // contraction over how far the states are from where the factors are of
  long factorisations_ = 0;
};

}  // namespace whirl::film
