#include "whirl/film/film.hpp"

#include <Eigen/SparseLU>
#include <cmath>
#include <complex>

#include "film/steady.hpp"
#include "whirl/core/error.hpp"
#include "whirl/film/film_matrix.hpp"

namespace whirl::film {
using Complex = std::complex<double>;

void StatePreconditioner::apply_transposed(std::span<const double> /*r*/, std::span<double> /*x*/) {
  core::require(false, "a preconditioner that is exact");
}

void StatePreconditioner::set_at(std::span<const double> /*d_states*/, std::span<const double> /*d_rates*/,
                                 Complex /*lambda*/) {
  core::require(false, "a preconditioner that is exact");
}

void StatePreconditioner::apply_at(std::span<const Complex> /*r*/, std::span<Complex> /*x*/) {
  core::require(false, "a preconditioner that is exact");
}

std::span<const Port> Film::ports() const {
  return std::span(all_ports).first(2);
}

const Share& Film::whole() const {
  if (!whole_) whole_ = std::make_unique<const Share>(share(0, static_cast<int>(states())));
  return *whole_;
}

void Film::evaluate(const JournalMotion& motion, std::span<const double> states, std::span<const double> rates,
                    Need need, StateResponse& response) {
  core::require(states.size() == this->states() && rates.size() == states.size(), "states of a film");
  const Share& all = whole();
  if (all.seen.size() == states.size()) return evaluate(motion, all, states, rates, need, response);
  evaluate(motion, all, seen_of(all, states), seen_of(all, rates), need, response);
}

void Film::evaluate(const JournalMotion& motion, Need need, Response& response) {
  core::require(states() == 0, "a film without states");
  StateResponse all;
  evaluate(motion, whole(), {}, {}, need, all);
  response = all.journal;
}

void relax(Film& film, const JournalMotion& motion, std::vector<double>& states) {
  if (film.states() == 0) return;
  const std::vector<double> rest(states.size(), 0.0);
  Steady(film).solve(motion, rest, Steady::Until::small_step, Need::force, states);
}

// s = -(dg/ds + i w dg/ds')^-1 (dg/dx + i w dg/dv) x, force = (df/dx + i w df/dv) x + (df/ds + i w df/ds') s.
Coefficients coefficients(Film& film, const JournalMotion& motion, std::span<const double> states, double omega) {
  if (!(omega > 0.0)) throw core::InputError("film: the frequency of stiffness and damping must be positive");
  const std::vector<double> rest(states.size(), 0.0);
  StateResponse r;
  film.evaluate(motion, states, rest, Need::tangents, r);
  const Complex iw(0.0, omega);
  Coefficients out;
  if (states.empty()) {
    for (std::size_t i = 0; i < 4; ++i) {
      out.stiffness[i] = -r.journal.d_position[i / 2][i % 2];
      out.damping[i] = -r.journal.d_velocity[i / 2][i % 2];
    }
    return out;
  }
  const Share& all = film.whole();
  FilmMatrix<Complex> matrix(all, all.d_states, &all.d_rates);
  const Eigen::SparseLU<Eigen::SparseMatrix<Complex>> lu(matrix.filled(r.d_states, r.d_rates, 1.0, iw));
  if (lu.info() != Eigen::Success) throw core::NotConverged("the film by itself is singular");
  const auto n = static_cast<Eigen::Index>(states.size());
  const auto thin = [n](const std::vector<double>& v) { return Eigen::Map<const Eigen::VectorXd>(v.data(), n); };
  for (std::size_t j = 0; j < 2; ++j) {  // ports x and y
    const Eigen::VectorXcd rhs = thin(r.d_position[j]).cast<Complex>() + iw * thin(r.d_velocity[j]);
    const Eigen::VectorXcd s = lu.solve(rhs);
    for (std::size_t i = 0; i < 2; ++i) {
      Complex transfer = r.journal.d_position[i][j] + iw * r.journal.d_velocity[i][j];
      transfer -= thin(r.force_d_states[i]).cast<Complex>().dot(s);
      if (!r.force_d_rates.empty()) transfer -= iw * thin(r.force_d_rates[i]).cast<Complex>().dot(s);
      out.stiffness[2 * i + j] = -transfer.real();
      out.damping[2 * i + j] = -transfer.imag() / omega;
    }
  }
  return out;
}

}  // namespace whirl::film
