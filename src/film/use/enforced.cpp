#include "whirl/film/use/enforced.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

#include "film/algebra/film_matrix.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/pivoted_lu.hpp"
#include "whirl/core/shell.hpp"

namespace whirl::film {
namespace {

using Complex = std::complex<double>;
using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;
using std::numbers::pi;

constexpr int fewest_harmonics = 4, most_harmonics = 32;
constexpr double small_tail = 1e-7;
constexpr int restart = 60;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

// dg/ds + i k omega dg/ds' at rest, factorised, of k = 0, 1, ...: the same whatever the number of points.
struct Enforced::Factors {
  std::vector<core::PivotedLu<Complex>> of;
};

// The film over one period: states [state, point].
class Enforced::Period {
public:
  Period(Film& film, const JournalMotion& rest, const std::vector<double>& states, double omega, int harmonics,
         Factors& factors);
  [[nodiscard]] EnforcedForces along(std::size_t port, double amplitude, const std::array<double, 4>& at_rest);

private:
  void move(std::size_t port, double amplitude);
  void solve(EnforcedForces& out);
  // Residuals [state, point] with the answers of all points; their size in typical rows.
  double evaluate(const MatrixXd& states, std::vector<StateResponse>& answers) const;
  [[nodiscard]] MatrixXd product(const MatrixXd& x) const;
  [[nodiscard]] MatrixXd inverse_at_rest(const MatrixXd& r);
  void factor();
  [[nodiscard]] double size(const MatrixXd& x) const;

  Film& film_;
  JournalMotion rest_;
  VectorXd states_, scale_, row_scale_;
  double omega_;
  int harmonics_;
  Index points_, n_;
  MatrixXd rates_;                      // s' = s rates_
  Eigen::MatrixXcd to_points_;          // [harmonic, point]
  std::vector<JournalMotion> motions_;  // at the points
  MatrixXd now_;
  std::vector<StateResponse> here_;
  Factors& factors_;
};

Enforced::Period::Period(Film& film, const JournalMotion& rest, const std::vector<double>& states, double omega,
                         int harmonics, Factors& factors)
    : film_(film),
      rest_(rest),
      states_(Eigen::Map<const VectorXd>(states.data(), static_cast<Index>(states.size()))),
      scale_(states_.size()),
      row_scale_(states_.size()),
      omega_(omega),
      harmonics_(harmonics),
      points_(2 * harmonics + 1),
      n_(states_.size()),
      rates_(points_, points_),
      to_points_(harmonics + 1, points_),
      here_(at(points_)),
      factors_(factors) {
  for (const StateField& f : film.state_fields())
    f.each([&](int k) {
      scale_(k) = f.scale;
      row_scale_(k) = f.row_scale();
    });
  const double turn = 2 * pi / static_cast<double>(points_);
  for (Index j = 0; j < points_; ++j) {
    for (Index k = 0; k < points_; ++k)
      rates_(j, k) =
          j == k ? 0.0 : ((k - j) % 2 == 0 ? 1 : -1) * omega / (2 * std::sin(0.5 * turn * static_cast<double>(k - j)));
    for (Index k = 0; k <= harmonics; ++k) to_points_(k, j) = std::polar(1.0, turn * static_cast<double>(j * k));
  }
}

void Enforced::Period::move(std::size_t port, double amplitude) {
  const auto w = static_cast<std::size_t>(film_.ports()[port]);
  motions_.assign(at(points_), rest_);
  for (Index k = 0; k < points_; ++k) {
    const double phase = 2 * pi * static_cast<double>(k) / static_cast<double>(points_);
    motions_[at(k)].position[w] += amplitude * std::sin(phase);
    motions_[at(k)].velocity[w] += amplitude * omega_ * std::cos(phase);
  }
}

double Enforced::Period::size(const MatrixXd& x) const {
  return (scale_.cwiseInverse().asDiagonal() * x).norm() / std::sqrt(static_cast<double>(std::max<Index>(x.size(), 1)));
}

double Enforced::Period::evaluate(const MatrixXd& states, std::vector<StateResponse>& answers) const {
  const MatrixXd rates = states * rates_;
  double sum = 0;
  for (Index k = 0; k < points_; ++k) {
    StateResponse& r = answers[at(k)];
    film_.evaluate(motions_[at(k)], std::span(states.col(k).data(), at(n_)), std::span(rates.col(k).data(), at(n_)),
                   Need::tangents, r);
    sum += Eigen::Map<const VectorXd>(r.residual.data(), n_).cwiseQuotient(row_scale_).squaredNorm();
  }
  return std::sqrt(sum);
}

// dg/ds x + dg/ds' x' at all points.
MatrixXd Enforced::Period::product(const MatrixXd& x) const {
  const MatrixXd rates = x * rates_;
  const Share& whole = film_.whole();
  MatrixXd out = MatrixXd::Zero(n_, points_);
  for (Index k = 0; k < points_; ++k) {
    const StateResponse& r = here_[at(k)];
    for_entries(whole, whole.d_states, r.d_states, [&](int i, int j, double v) { out(i, k) += v * x(j, k); });
    for_entries(whole, whole.d_rates, r.d_rates, [&](int i, int j, double v) { out(i, k) += v * rates(j, k); });
  }
  return out;
}

void Enforced::Period::factor() {
  auto& lu = factors_.of;
  if (lu.size() > static_cast<std::size_t>(harmonics_)) return;
  StateResponse r;
  const std::vector<double> still(at(n_), 0.0);
  film_.evaluate(rest_, std::span(states_.data(), at(n_)), still, Need::tangents, r);
  const Share& whole = film_.whole();
  FilmMatrix<Complex> matrix(whole, whole.d_states, &whole.d_rates);
  for (int k = static_cast<int>(lu.size()); k <= harmonics_; ++k) {
    core::PivotedLu<Complex> next(matrix.filled(r.d_states, r.d_rates, 1.0, Complex(0.0, k * omega_)));
    if (!next.regular()) throw core::NotConverged("the film by itself is singular");
    lu.push_back(std::move(next));
  }
}

MatrixXd Enforced::Period::inverse_at_rest(const MatrixXd& r) {
  const Eigen::MatrixXcd in = r.cast<Complex>() * to_points_.adjoint() / static_cast<double>(points_);
  Eigen::MatrixXcd out(n_, harmonics_ + 1);
  for (int k = 0; k <= harmonics_; ++k) {
    const Eigen::VectorXcd b = in.col(k);
    out.col(k) = (k == 0 ? 1.0 : 2.0) * factors_.of[static_cast<std::size_t>(k)].solve(b);
  }
  return (out * to_points_).real();
}

void Enforced::Period::solve(EnforcedForces& out) {
  constexpr int most_steps = 30;
  constexpr double enough = 1e-9, rounding = 1e-5, shortest = 1e-3;
  now_ = states_.replicate(1, points_);
  double left = evaluate(now_, here_);
  if (n_ == 0) return;
  factor();
  core::Gate gate{PETSC_COMM_SELF};
  const auto total = static_cast<PetscInt>(now_.size());
  const auto in = [&](Vec v, const auto& use) {
    const core::ReadArray a(v);
    use(Eigen::Map<const MatrixXd>(a.data(), n_, points_));
  };
  const auto into = [&](const MatrixXd& from, Vec v) {
    core::WriteArray a(v);
    Eigen::Map<MatrixXd>(a.data(), n_, points_) = from;
  };
  const core::Matrix matrix = core::make_shell(PETSC_COMM_SELF, total, gate, [&](Vec x, Vec y) {
    in(x, [&](const auto& m) { into(row_scale_.cwiseInverse().asDiagonal() * product(m), y); });
  });
  const core::LinearSolver krylov = core::make_krylov(
      matrix.get(), gate, {.prefix = "enforced_", .tolerance = 1e-6, .most = 300, .restart = restart},
      [&](Vec x, Vec y) { in(x, [&](const auto& m) { into(inverse_at_rest(row_scale_.asDiagonal() * m), y); }); });
  const core::Vector b = core::make_vector(PETSC_COMM_SELF, total, total), x = core::duplicate(b.get());
  double before = std::numeric_limits<double>::infinity();
  std::vector<StateResponse> there(at(points_));
  for (int step = 0; step < most_steps; ++step) {
    MatrixXd rows(n_, points_);
    for (Index k = 0; k < points_; ++k)
      rows.col(k) = Eigen::Map<const VectorXd>(here_[at(k)].residual.data(), n_).cwiseQuotient(row_scale_);
    into(rows, b.get());
    gate.rethrow(KSPSolve(krylov.get(), b.get(), x.get()));
    if (core::reason_of(krylov.get()) < 0)
      throw core::NotConverged("the film of a moving journal: GMRES did not converge");
    PetscInt count = 0;
    core::check(KSPGetIterationNumber(krylov.get(), &count));
    out.krylov += static_cast<int>(count);
    ++out.newton;
    MatrixXd change;
    in(x.get(), [&](const auto& m) { change = m; });
    const double moves = size(change), whole = size(now_ - change - states_.replicate(1, points_));
    const bool last = moves <= enough * whole || (moves <= rounding * whole && moves > 0.3 * before);
    for (double part = 1;; part /= 2) {
      if (part < shortest) throw core::NotConverged("the film of a moving journal does not repeat itself");
      const MatrixXd next = now_ - part * change;
      try {
        const double then = evaluate(next, there);
        if (last || then < (1 - 1e-4 * part) * left) {
          left = then;
          now_ = next;
          std::swap(here_, there);
          break;
        }
        if (moves <= rounding * whole) return;  // rounding is all that is left
      } catch (const core::DomainError&) {
      }
    }
    if (last) return;
    before = moves;
  }
  throw core::NotConverged("the film of a moving journal does not repeat itself");
}

EnforcedForces Enforced::Period::along(std::size_t port, double amplitude, const std::array<double, 4>& at_rest) {
  EnforcedForces out;
  out.points = static_cast<int>(points_);
  move(port, amplitude);
  solve(out);
  const auto ports = film_.ports();
  const bool slopes = ports[port] >= Port::tilt_x;
  double all = 0, explained = 0, highest = 0;
  for (std::size_t i = 0; i < ports.size(); ++i) {
    const auto w = static_cast<std::size_t>(ports[i]);
    VectorXd force(points_);
    for (Index k = 0; k < points_; ++k) force(k) = here_[at(k)].journal.force[w];
    const Eigen::VectorXcd f = to_points_.conjugate() * force.cast<Complex>() / static_cast<double>(points_);
    // The regressors are orthogonal: F = F_0 + 2 Re f_1 cos - 2 Im f_1 sin.
    out.mean[i] = f(0).real() - at_rest[w];
    out.stiffness[i] = 2 * f(1).imag() / amplitude;
    out.damping[i] = -2 * f(1).real() / (amplitude * omega_);
    if ((ports[i] >= Port::tilt_x) != slopes) continue;
    all += (force.array() - f(0).real()).matrix().squaredNorm() / static_cast<double>(points_);
    explained += 2 * std::norm(f(1));
    highest = std::max({highest, std::abs(f(harmonics_)), std::abs(f(harmonics_ - 1))});
  }
  if (!(explained > 0)) return out;
  out.distortion = std::sqrt(std::max(0.0, all - explained) / all);
  out.tail = highest / std::sqrt(0.5 * explained);
  return out;
}

Enforced::Enforced(Film& film, const JournalMotion& rest, std::vector<double> states, double omega)
    : film_(film), rest_(rest), states_(std::move(states)), omega_(omega), factors_(std::make_unique<Factors>()) {
  if (!(omega > 0)) throw core::InputError("film: the frequency of stiffness and damping must be positive");
  StateResponse r;
  const std::vector<double> still(states_.size(), 0.0);
  film_.evaluate(rest_, states_, still, Need::force, r);
  force_ = r.journal.force;
}

Enforced::~Enforced() = default;

EnforcedForces Enforced::along(std::size_t port, double amplitude) {
  if (!(amplitude > 0)) throw core::InputError("film: the amplitude of a journal's motion must be positive");
  for (int harmonics = fewest_harmonics;; harmonics *= 2) {
    Period period(film_, rest_, states_, omega_, harmonics, *factors_);
    EnforcedForces out = period.along(port, amplitude, force_);
    if (out.tail <= small_tail || harmonics >= most_harmonics) return out;
  }
}

// Of each state: factors of about 6 log2(n) entries, at each point two evaluations with 25 numbers each, and what GMRES
// keeps between restarts.
double Enforced::memory(double states) {
  constexpr double factors = most_harmonics + 1, points = 2 * most_harmonics + 1, entry = 20;
  const double of_factors = factors * 6 * std::log2(std::max(states, 2.0)) * entry;
  return states * (of_factors + points * sizeof(double) * (2 * 25 + restart));
}

}  // namespace whirl::film
