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
PortCoefficients port_coefficients(Film& film, const JournalMotion& motion, std::span<const double> states,
                                   double omega) {
  if (!(omega > 0.0)) throw core::InputError("film: the frequency of stiffness and damping must be positive");
  const std::vector<double> rest(states.size(), 0.0);
  StateResponse r;
  film.evaluate(motion, states, rest, Need::tangents, r);
  const Complex iw(0.0, omega);
  const auto ports = film.ports();
  const auto n = static_cast<Eigen::Index>(states.size());
  const auto thin = [n](const std::vector<double>& v) { return Eigen::Map<const Eigen::VectorXd>(v.data(), n); };
  Eigen::SparseLU<Eigen::SparseMatrix<Complex>> lu;
  if (n > 0) {
    const Share& all = film.whole();
    FilmMatrix<Complex> matrix(all, all.d_states, &all.d_rates);
    lu.compute(matrix.filled(r.d_states, r.d_rates, 1.0, iw));
    if (lu.info() != Eigen::Success) throw core::NotConverged("the film by itself is singular");
  }
  PortCoefficients out;
  out.ports = ports.size();
  for (std::size_t j = 0; j < ports.size(); ++j) {
    Eigen::VectorXcd s;
    if (n > 0) s = lu.solve(thin(r.d_position[j]).cast<Complex>() + iw * thin(r.d_velocity[j]));
    const auto to = static_cast<std::size_t>(ports[j]);
    for (std::size_t i = 0; i < ports.size(); ++i) {
      const auto of = static_cast<std::size_t>(ports[i]);
      Complex transfer = r.journal.d_position[of][to] + iw * r.journal.d_velocity[of][to];
      if (n > 0) transfer -= thin(r.force_d_states[i]).cast<Complex>().dot(s);
      if (n > 0 && !r.force_d_rates.empty()) transfer -= iw * thin(r.force_d_rates[i]).cast<Complex>().dot(s);
      out.stiffness[i][j] = -transfer.real();
      out.damping[i][j] = -transfer.imag() / omega;
    }
  }
  return out;
}

Coefficients coefficients(Film& film, const JournalMotion& motion, std::span<const double> states, double omega) {
  const PortCoefficients all = port_coefficients(film, motion, states, omega);
  Coefficients out;
  for (std::size_t i = 0; i < 4; ++i) {
    out.stiffness[i] = all.stiffness[i / 2][i % 2];
    out.damping[i] = all.damping[i / 2][i % 2];
  }
  return out;
}

}  // namespace whirl::film
