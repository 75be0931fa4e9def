#include "whirl/film/state_model.hpp"

#include <Eigen/SparseLU>
#include <cmath>
#include <complex>

#include "whirl/core/error.hpp"

namespace whirl::film {
namespace {

using Complex = std::complex<double>;

template <class Scalar>
using Sparse = Eigen::SparseMatrix<Scalar>;

// dg/ds + sigma dg/ds'.
template <class Scalar>
Sparse<Scalar> matrix(const StateResponse& r, Scalar sigma) {
  const auto n = static_cast<Eigen::Index>(r.residual.size());
  std::vector<Eigen::Triplet<Scalar>> entries;
  for (const Entry& e : r.d_states) entries.emplace_back(e.row, e.column, Scalar(e.value));
  for (const Entry& e : r.d_rates) entries.emplace_back(e.row, e.column, sigma * e.value);
  Sparse<Scalar> m(n, n);
  m.setFromTriplets(entries.begin(), entries.end());
  return m;
}

double norm(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size())).norm();
}

}  // namespace

std::vector<double> with_neighbours(const StateModel& film, Lines part, std::span<const double> states) {
  const Ring ring = film.ring();
  const std::size_t line = film.line();
  std::vector<double> out;
  out.reserve(static_cast<std::size_t>(part.count() + 2 * ring.reach) * line);
  for (int i = part.begin - ring.reach; i < part.end + ring.reach; ++i) {
    const auto from = static_cast<std::size_t>((i % ring.lines + ring.lines) % ring.lines) * line;
    out.insert(out.end(), states.begin() + static_cast<std::ptrdiff_t>(from),
               states.begin() + static_cast<std::ptrdiff_t>(from + line));
  }
  return out;
}

void add_entries(const StateModel& film, Lines part, const Stencil& stencil, std::vector<Entry>& entries) {
  const int line = static_cast<int>(film.line()), lines = film.ring().lines;
  constexpr std::array<std::array<int, 2>, Stencil::n_places> offset = {
      {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-2, 0}}};
  for (std::size_t place = 0; place < Stencil::n_places; ++place) {
    if (stencil.at[place].empty()) continue;
    const double* value = stencil.at[place].data();
    for (int i = part.begin; i < part.end; ++i)
      for (int j = 0; j < line; ++j, ++value) {
        const int other = j + offset[place][1];
        if (other < 0 || other >= line) continue;
        entries.push_back({i * line + j, (i + offset[place][0] + lines) % lines * line + other, *value});
      }
  }
}

void StateModel::evaluate(const Motion& motion, std::span<const double> states, std::span<const double> rates,
                          Need need, StateResponse& response) {
  core::require(states.size() == this->states() && rates.size() == states.size(), "states of a film");
  const Lines all{0, ring().lines};
  if (all.end == 1) return evaluate_lines(motion, all, states, rates, need, response);
  evaluate_lines(motion, all, with_neighbours(*this, all, states), with_neighbours(*this, all, rates), need, response);
  response.d_states.clear();
  response.d_rates.clear();
  if (need == Need::force) return;
  add_entries(*this, all, response.by_states, response.d_states);
  add_entries(*this, all, response.by_rates, response.d_rates);
}

// Converged by the step and not by the residual, whose rounding error grows with the square of the mesh.
void relax(StateModel& film, const Motion& motion, std::vector<double>& states) {
  const std::vector<double> rest(states.size(), 0.0);
  StateResponse here, there;
  film.evaluate(motion, states, rest, Need::tangents, here);
  const auto n = static_cast<Eigen::Index>(states.size());
  const double enough = 1e-10 * film.state_scale() * std::sqrt(static_cast<double>(n));
  for (int iteration = 0; iteration < 60; ++iteration) {
    Eigen::SparseLU<Sparse<double>> lu(matrix(here, 0.0));
    if (lu.info() != Eigen::Success) throw core::NotConverged("the film by itself is singular");
    const Eigen::VectorXd step = lu.solve(Eigen::Map<const Eigen::VectorXd>(here.residual.data(), n));
    const bool last = step.norm() <= enough;
    for (double damping = 1.0;; damping *= 0.5) {
      if (damping < 1e-6) throw core::NotConverged("the film by itself did not relax");
      std::vector<double> trial = states;
      for (std::size_t k = 0; k < trial.size(); ++k) trial[k] -= damping * step[static_cast<Eigen::Index>(k)];
      try {
        film.evaluate(motion, trial, rest, Need::tangents, there);
      } catch (const core::DomainError&) {
        continue;
      }
      if (!last && !film.whole_steps() && norm(there.residual) > (1.0 - 1e-4 * damping) * norm(here.residual)) continue;
      states = std::move(trial);
      std::swap(here, there);
      break;
    }
    if (last) return;
  }
  throw core::NotConverged("the film by itself did not relax");
}

// s = -(dg/ds + i w dg/ds')^-1 (dg/dx + i w dg/dv) x, force = (df/dx + i w df/dv) x + (df/ds + i w df/ds') s.
Coefficients coefficients(StateModel& film, const Motion& motion, std::span<const double> states, double omega) {
  if (!(omega > 0.0)) throw core::InputError("film: the frequency of stiffness and damping must be positive");
  const std::vector<double> rest(states.size(), 0.0);
  StateResponse r;
  film.evaluate(motion, states, rest, Need::tangents, r);
  const Complex iw(0.0, omega);
  Sparse<Complex> m = matrix(r, iw);
  Eigen::SparseLU<Sparse<Complex>> lu(m);
  if (lu.info() != Eigen::Success) throw core::NotConverged("the film by itself is singular");
  Coefficients out;
  const auto n = static_cast<Eigen::Index>(states.size());
  for (std::size_t j = 0; j < 2; ++j) {
    Eigen::VectorXcd rhs(n);
    for (Eigen::Index k = 0; k < n; ++k)
      rhs(k) = r.d_position[static_cast<std::size_t>(k)][j] + iw * r.d_velocity[static_cast<std::size_t>(k)][j];
    const Eigen::VectorXcd s = lu.solve(rhs);
    for (std::size_t i = 0; i < 2; ++i) {
      Complex transfer = r.journal.d_position[i][j] + iw * r.journal.d_velocity[i][j];
      for (Eigen::Index k = 0; k < n; ++k) {
        const auto state = static_cast<std::size_t>(k);
        transfer -= r.force_d_states[state][i] * s(k);
        if (!r.force_d_rates.empty()) transfer -= iw * r.force_d_rates[state][i] * s(k);
      }
      out.stiffness[2 * i + j] = -transfer.real();
      out.damping[2 * i + j] = -transfer.imag() / omega;
    }
  }
  return out;
}

}  // namespace whirl::film
