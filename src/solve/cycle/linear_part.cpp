#include "solve/cycle/linear_part.hpp"

// With V = value(:, 1..m) and D = slope(:, 1..m)/H, the row alpha x_a' + beta x_b = y_i holds at the m points:
//
//     alpha D X_a + beta V X_b = Y_i    =>    X_a = D^-1 (Y_i - beta V X_b)/alpha
//
// If x_a' occurs in no other row, then X_a enters the other rows (index k: kept) through L0 only, as V x L0_ka, and
//
//     [ V x L0_kk + D x L1_kk - (V D^-1 V) x (L0_ka beta/alpha) ] X_k = Y_k - (V D^-1 x L0_ka/alpha) Y_i
//
// D^-1 integrates over the interval, so that the elimination multiplies by H times a frequency: it is stable.
// The transposed equations W0^T x = y eliminate the same rows: with U = D^-T Y_a/alpha,
//
//     [ ... ]^T X_k = Y_k - beta V^T U  (at b),    X_i = U - (V D^-1 x L0_ka/alpha)^T X_k

namespace whirl::solve {
namespace {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// (a x I) z, with z as a matrix of m neighbouring columns (the points) per right-hand side.
MatrixXd along(const MatrixXd& a, const MatrixXd& z) {
  const Index m = a.rows();
  MatrixXd out = MatrixXd::Zero(z.rows(), z.cols());
  for (Index first = 0; first < z.cols(); first += m)
    for (Index j = 0; j < m; ++j)
      for (Index l = 0; l < m; ++l)
        if (a(j, l) != 0) out.col(first + j) += a(j, l) * z.col(first + l);
  return out;
}

}  // namespace

LinearPart::LinearPart(const Scheme& sc, double len, problem::DenseBlocks blocks)
    : ThinPart(sc, len, std::move(blocks)) {
  take_pairs();
  factorise();
  const Index m = scheme.degree;
  free.resize(m * n, n);
  y = MatrixXd::Zero(m * n, m * r);
  for (Index j = 0; j < m; ++j) {
    free.middleRows(j * n, n) = -scheme.value(j, 0) * l0 - (scheme.slope(j, 0) / length) * l1;
    y.block(j * n, j * r, n, r) = b;
  }
  solve(free);
  solve(y);
  vy = inputs(y);
  inputs_free = inputs(free);
  for (Index j = 0; j < m; ++j) inputs_free.middleRows(j * w, w) += scheme.value(j, 0) * c;
}

void LinearPart::take_pairs() {
  const auto pairs = static_cast<Index>(kinematic.size());
  std::vector<bool> row_taken(static_cast<std::size_t>(n), false), state_taken = row_taken;
  alpha_.resize(pairs);
  beta_.resize(pairs);
  for (Index e = 0; e < pairs; ++e) {
    const auto& [row, state, rate] = kinematic[static_cast<std::size_t>(e)];
    rate_row_.push_back(row);
    rate_state_.push_back(state);
    alpha_(e) = l1(row, state);
    beta_(e) = l0(row, rate);
    row_taken[static_cast<std::size_t>(row)] = state_taken[static_cast<std::size_t>(state)] = true;
  }
  std::vector<Index> place(static_cast<std::size_t>(n), 0);
  for (Index k = 0; k < n; ++k) {
    if (!row_taken[static_cast<std::size_t>(k)]) row_.push_back(k);
    if (state_taken[static_cast<std::size_t>(k)]) continue;
    place[static_cast<std::size_t>(k)] = static_cast<Index>(state_.size());
    state_.push_back(k);
  }
  for (const problem::KinematicRow& k : kinematic) rate_of_.push_back(place[static_cast<std::size_t>(k.rate)]);
}

void LinearPart::factorise() {
  const Index m = scheme.degree, kept = n - eliminated();
  const MatrixXd slope = scheme.slope.rightCols(m) / length;
  value_ = scheme.value.rightCols(m);
  integral_ = core::DenseLu<double>(slope).inverse();
  value_integral_ = value_ * integral_;
  const MatrixXd twice = value_integral_ * value_;
  coupling_ = l0(row_, rate_state_) * alpha_.inverse().matrix().asDiagonal();
  const MatrixXd l0_kept = l0(row_, state_), l1_kept = l1(row_, state_);
  MatrixXd through = MatrixXd::Zero(kept, kept);
  for (Index e = 0; e < eliminated(); ++e)
    through.col(rate_of_[static_cast<std::size_t>(e)]) += beta_(e) * coupling_.col(e);
  MatrixXd a(m * kept, m * kept);
  for (Index j = 0; j < m; ++j)
    for (Index l = 0; l < m; ++l)
      a.block(j * kept, l * kept, kept, kept) = value_(j, l) * l0_kept + slope(j, l) * l1_kept - twice(j, l) * through;
  lu_.compute(a);
}

void LinearPart::solve(MatrixXd& x) const {
  const Index m = scheme.degree, kept = n - eliminated();
  Map<MatrixXd> points(x.data(), n, m * x.cols());
  const MatrixXd y_i = points(rate_row_, Eigen::all);
  MatrixXd x_k = points(row_, Eigen::all);
  x_k.noalias() -= coupling_ * along(value_integral_, y_i);
  Map<MatrixXd> v(x_k.data(), m * kept, x.cols());
  v = lu_.solve(v);
  const MatrixXd x_b = along(value_, x_k(rate_of_, Eigen::all));
  points(state_, Eigen::all) = x_k;
  points(rate_state_, Eigen::all) =
      along(integral_, alpha_.inverse().matrix().asDiagonal() * (y_i - beta_.matrix().asDiagonal() * x_b));
}

void LinearPart::solve_transposed(MatrixXd& x) const {
  const Index m = scheme.degree, kept = n - eliminated();
  Map<MatrixXd> points(x.data(), n, m * x.cols());
  MatrixXd u = along(integral_.transpose(), alpha_.inverse().matrix().asDiagonal() * points(rate_state_, Eigen::all));
  MatrixXd x_k = points(state_, Eigen::all);
  const MatrixXd vu = beta_.matrix().asDiagonal() * along(value_.transpose(), u);
  for (Index e = 0; e < eliminated(); ++e) x_k.row(rate_of_[static_cast<std::size_t>(e)]) -= vu.row(e);
  Map<MatrixXd> v(x_k.data(), m * kept, x.cols());
  v = lu_.solve_transposed(v);
  u -= along(value_integral_.transpose(), coupling_.transpose() * x_k);
  points(row_, Eigen::all) = x_k;
  points(rate_row_, Eigen::all) = u;
}

void SparsePart::prepare() const {
  if (y.size() > 0) return;
  modes_ = interval_modes(scheme, length);
  pencil_.compute(l1, l0, kinematic, modes_.lambda);
  y = MatrixXd::Zero(scheme.degree * n, scheme.degree * r);
  for (Index j = 0; j < scheme.degree; ++j) y.block(j * n, j * r, n, r) = MatrixXd(b);
  solve(y);
  vy = inputs(y);
}

void SparsePart::apply(MatrixXd& x, const MatrixXd& into, const MatrixXd& out, bool adjoint) const {
  const Index m = scheme.degree, lanes = modes_.lanes, columns = x.cols(), count = lanes * columns;
  MatrixXd all(2 * count, n);
  for (Index q = 0; q < columns; ++q) {
    const MatrixXd hat = into.transpose() * x.col(q).reshaped(n, m).transpose();
    all.middleRows(q * lanes, lanes) = hat.topRows(lanes);
    all.middleRows(count + q * lanes, lanes) = hat.bottomRows(lanes);
  }
  adjoint ? pencil_.solve_adjoint(all, columns) : pencil_.solve(all, columns);
  for (Index q = 0; q < columns; ++q)
    x.col(q).reshaped(n, m) = (out.leftCols(lanes) * all.middleRows(q * lanes, lanes) +
                               out.rightCols(lanes) * all.middleRows(count + q * lanes, lanes))
                                  .transpose();
}

}  // namespace whirl::solve
