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

long relax(Film& film, const JournalMotion& motion, std::vector<double>& states) {
  if (film.states() == 0) return 0;
  const std::vector<double> rest(states.size(), 0.0);
  Steady steady(film);
  steady.solve(motion, rest, Steady::Until::small_step, Need::force, states);
  return steady.factorisations();
}

// s = -(dg/ds + i w dg/ds')^-1 (dg/dx + i w dg/dv) x, force = (df/dx + i w df/dv) x + (df/ds + i w df/ds') s.
PortCoefficients port_coefficients(Film& film, const JournalMotion& motion, std::span<const double> states,
                                   double omega) {
  if (!(omega > 0.0)) throw core::InputError("film: the frequency of stiffness and damping must be positive");
  const std::vector<double> rest(states.size(), 0.0);
  StateResponse r;
  film.evaluate(motion, states, rest, Need::tangents, r);
  const auto ports = film.ports();
  const auto n = static_cast<Eigen::Index>(states.size()), count = static_cast<Eigen::Index>(ports.size());
  const auto columns = [&](const PortColumns& of) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, count);
    for (std::size_t j = 0; j < of.size(); ++j)
      out.col(static_cast<Eigen::Index>(j)) = Eigen::Map<const Eigen::VectorXd>(of[j].data(), n);
    return out;
  };
  // What the states do to the force, all ports at once: transfer = f_s A^-1 g_x, A and g_x at the frequency.
  Eigen::MatrixXcd of_states = Eigen::MatrixXcd::Zero(count, count);
  if (n > 0) {
    const Complex iw(0.0, omega);
    const Share& all = film.whole();
    FilmMatrix<Complex> matrix(all, all.d_states, &all.d_rates);
    Eigen::SparseLU<Eigen::SparseMatrix<Complex>> lu;
    lu.compute(matrix.filled(r.d_states, r.d_rates, 1.0, iw));
    if (lu.info() != Eigen::Success) throw core::NotConverged("the film by itself is singular");
    Eigen::MatrixXcd moved(n, count);
    moved.real() = columns(r.d_position);
    moved.imag() = omega * columns(r.d_velocity);
    const Eigen::MatrixXcd s = lu.solve(moved);
    const Eigen::MatrixXd force = columns(r.force_d_states).transpose();
    of_states.real() = force * s.real();
    of_states.imag() = force * s.imag();
    if (!r.force_d_rates.empty()) of_states += iw * (columns(r.force_d_rates).transpose().cast<Complex>() * s);
  }
  PortCoefficients out;
  out.ports = ports.size();
  for (std::size_t j = 0; j < ports.size(); ++j)
    for (std::size_t i = 0; i < ports.size(); ++i) {
      const auto of = static_cast<std::size_t>(ports[i]), to = static_cast<std::size_t>(ports[j]);
      const Complex states_do = of_states(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      out.stiffness[i][j] = states_do.real() - r.journal.d_position[of][to];
      out.damping[i][j] = states_do.imag() / omega - r.journal.d_velocity[of][to];
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
