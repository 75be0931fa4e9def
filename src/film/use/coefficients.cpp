#include "whirl/film/use/coefficients.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "film/algebra/film_matrix.hpp"
#include "film/use/lent_lu.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/pivoted_lu.hpp"

namespace whirl::film {
namespace {

using Complex = std::complex<double>;
using Eigen::Index, Eigen::MatrixXcd, Eigen::MatrixXd;

}  // namespace

// V of block Arnoldi [states x ports of each step] on dg/ds^-T dg/ds'^T, and what that does to it.
struct FrequencyCoefficients::Space {
  explicit Space(Film& film) : lu(film) {}

  LentLu lu;
  Eigen::SparseMatrix<double> rates;  // dg/ds'
  MatrixXd basis;                     // [states x k] in its first columns, with room for more
  Index held = 0;                     // k of them
  MatrixXd hessenberg;                // [k + ports x k]
  MatrixXd start;                     // dg/ds^-T df/ds = V_1 start
  MatrixXd by_position, by_velocity;  // V^T dg/dw, V^T dg/dw' [k x ports]
  MatrixXd d_position, d_velocity;
  bool ended = false;
  bool known = false;  // dg/ds is regular
};

FrequencyCoefficients::FrequencyCoefficients(Film& film, const JournalMotion& motion, std::span<const double> states)
    : film_(film) {
  const std::vector<double> rest(states.size(), 0.0);
  film.evaluate(motion, states, rest, Need::tangents, at_);
}

FrequencyCoefficients::~FrequencyCoefficients() = default;

// A film whose dg/ds is singular has coefficients at frequencies all the same, but no such space.
void FrequencyCoefficients::begin() {
  const auto n = static_cast<Index>(at_.residual.size()), p = static_cast<Index>(film_.ports().size());
  const Share& whole = film_.whole();
  space_ = std::make_unique<Space>(film_);
  Space& s = *space_;
  FilmMatrix<double> a(whole, whole.d_states);
  if (!s.lu->compute(a.filled(at_.d_states))) return;
  s.known = true;
  FilmMatrix<double> e(whole, whole.d_rates);
  s.rates = e.filled(at_.d_rates);
  s.d_position = at_.inputs.topRows(p).transpose();
  s.d_velocity = at_.inputs.bottomRows(p).transpose();
  s.basis.resize(n, 0);
  s.hessenberg.resize(0, 0);
  s.by_position.resize(0, p);
  s.by_velocity.resize(0, p);
  const MatrixXd force = at_.forces.transpose();
  s.start = append(s.lu->solve_transposed(force));
}

// Orthonormalises w against the basis and itself, and appends it; what it was in them [all columns x those of w].
Eigen::MatrixXd FrequencyCoefficients::append(Eigen::MatrixXd w) {
  Space& s = *space_;
  const Index k = s.held, p = w.cols();
  MatrixXd in = MatrixXd::Zero(k + p, p);
  const double size = w.norm();
  for (int twice = 0; twice < 2; ++twice) {
    const MatrixXd more = s.basis.leftCols(k).transpose() * w;
    w.noalias() -= s.basis.leftCols(k) * more;
    in.topRows(k) += more;
  }
  s.ended = !(w.norm() > 1e-14 * size);
  // Columns among themselves; one that depends on the others becomes zero.
  for (Index j = 0; j < p; ++j) {
    const double before = w.col(j).norm();
    for (int twice = 0; twice < 2; ++twice)
      for (Index i = 0; i < j; ++i) {
        const double more = w.col(i).dot(w.col(j));
        w.col(j) -= more * w.col(i);
        in(k + i, j) += more;
      }
    const double norm = w.col(j).norm();
    in(k + j, j) = norm > 1e-14 * before ? norm : 0.0;
    if (in(k + j, j) > 0)
      w.col(j) /= norm;
    else
      w.col(j).setZero();
  }
  if (s.basis.cols() < k + p) s.basis.conservativeResize(Eigen::NoChange, std::max(8 * p, 2 * k));
  s.basis.middleCols(k, p) = w;
  s.held = k + p;
  s.by_position.conservativeResize(k + p, Eigen::NoChange);
  s.by_position.bottomRows(p) = w.transpose() * s.d_position;
  s.by_velocity.conservativeResize(k + p, Eigen::NoChange);
  s.by_velocity.bottomRows(p) = w.transpose() * s.d_velocity;
  return in;
}

// One more block: (dg/ds)^-T (dg/ds')^T of the last one.
void FrequencyCoefficients::grow() {
  Space& s = *space_;
  const Index k = s.held, p = s.start.cols();
  const MatrixXd last = s.rates.transpose() * s.basis.middleCols(k - p, p);
  const MatrixXd in = append(s.lu->solve_transposed(last));
  s.hessenberg.conservativeResize(k + p, k);
  s.hessenberg.bottomRows(p).setZero();
  s.hessenberg.rightCols(p) = in;
}

// df/ds (dg/ds + i w dg/ds')^-1 (dg/dx + i w dg/dv) by a basis of `blocks` blocks, each port's force: y^T (dg/dx + i w
// dg/dv) with (I + i w M^T) y = (dg/ds)^-T df/ds in the basis by Galerkin's condition.
Eigen::MatrixXcd FrequencyCoefficients::by_basis(Index blocks, double omega) const {
  const Space& s = *space_;
  const Index p = s.start.cols(), k = blocks * p;
  const Complex iw(0.0, omega);
  MatrixXcd a = MatrixXcd::Identity(k, k) + iw * s.hessenberg.topLeftCorner(k, k).cast<Complex>();
  MatrixXcd b = MatrixXcd::Zero(k, p);
  b.topRows(p) = s.start.cast<Complex>();
  const MatrixXcd y = core::DenseLu<Complex>(a).solve(b);
  return y.transpose() * (s.by_position.topRows(k).cast<Complex>() + iw * s.by_velocity.topRows(k).cast<Complex>());
}

bool FrequencyCoefficients::by_krylov(double omega, Eigen::MatrixXcd& out) {
  constexpr Index most = 16;
  constexpr double enough = 1e-10, rounding = 1e-11, falls = 0.2;
  if (at_.force_rates.rows() > 0) return false;
  if (!space_) begin();
  Space& s = *space_;
  if (!s.known) return false;
  const Index p = s.start.cols();
  const auto ready = [&](Index blocks) {
    while (s.hessenberg.cols() < blocks * p && !s.ended) grow();
    return s.hessenberg.cols() >= blocks * p;
  };
  MatrixXcd before;
  double close = 0, ratio_before = 1;
  for (Index blocks = 1; blocks <= most; ++blocks) {
    if (!ready(blocks)) break;
    MatrixXcd now = by_basis(blocks, omega);
    if (!now.allFinite()) return false;
    if (before.size() > 0) {
      // Of what the entry could be, by those of its row's and its column's kind.
      Eigen::VectorXd size(p);
      for (Index i = 0; i < p; ++i) size(i) = now.block(i - i % 2, i - i % 2, 2, 2).cwiseAbs().maxCoeff();
      double moved = 0;
      for (Index i = 0; i < p; ++i)
        for (Index j = 0; j < p; ++j) {
          const double d = std::abs(now(i, j) - before(i, j));
          if (d > 0) moved = std::max(moved, d / std::sqrt(size(i) * size(j)));
        }
      // The third change of a falling sequence: what is left is less than it, by the larger ratio of two.
      const double ratio = close > 0 ? moved / close : 1;
      const double worst = std::max(ratio, ratio_before);
      if (moved <= rounding || (worst < falls && worst / (1 - worst) * moved <= enough)) {
        out = now;
        return true;
      }
      close = moved;
      ratio_before = ratio;
    }
    before = std::move(now);
  }
  return false;
}

// s = -(dg/ds + i w dg/ds')^-1 (dg/dx + i w dg/dv) x, force = (df/dx + i w df/dv) x + (df/ds + i w df/ds') s.
Eigen::MatrixXcd FrequencyCoefficients::by_factors(double omega) const {
  const auto n = static_cast<Index>(at_.residual.size()), p = static_cast<Index>(film_.ports().size());
  const Complex iw(0.0, omega);
  const Share& all = film_.whole();
  FilmMatrix<Complex> matrix(all, all.d_states, &all.d_rates);
  const core::PivotedLu<Complex> lu(matrix.filled(at_.d_states, at_.d_rates, 1.0, iw));
  if (!lu.regular()) throw core::NotConverged("the film by itself is singular");
  MatrixXcd moved(n, p);
  moved.real() = at_.inputs.topRows(p).transpose();
  moved.imag() = omega * at_.inputs.bottomRows(p).transpose();
  const MatrixXcd s = lu.solve(moved);
  MatrixXcd out = at_.forces.cast<Complex>() * s;
  if (at_.force_rates.rows() > 0) out += iw * (at_.force_rates.cast<Complex>() * s);
  return out;
}

PortCoefficients FrequencyCoefficients::at(double omega) {
  if (!(omega > 0.0)) throw core::InputError("film: the frequency of stiffness and damping must be positive");
  const auto ports = film_.ports();
  const auto p = static_cast<Index>(ports.size());
  MatrixXcd of_states = MatrixXcd::Zero(p, p);
  if (!at_.residual.empty() && !by_krylov(omega, of_states)) of_states = by_factors(omega);
  PortCoefficients out;
  out.ports = ports.size();
  for (std::size_t j = 0; j < ports.size(); ++j)
    for (std::size_t i = 0; i < ports.size(); ++i) {
      const auto of = static_cast<std::size_t>(ports[i]), to = static_cast<std::size_t>(ports[j]);
      const Complex states_do = of_states(static_cast<Index>(i), static_cast<Index>(j));
      out.stiffness[i][j] = states_do.real() - at_.journal.d_position[of][to];
      out.damping[i][j] = states_do.imag() / omega - at_.journal.d_velocity[of][to];
    }
  return out;
}

PortCoefficients port_coefficients(Film& film, const JournalMotion& motion, std::span<const double> states,
                                   double omega) {
  return FrequencyCoefficients(film, motion, states).at(omega);
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
