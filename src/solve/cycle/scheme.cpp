#include "whirl/solve/cycle/scheme.hpp"

#include <fmt/core.h>

#include <cmath>

#include "whirl/core/error.hpp"
#include "whirl/core/symmetric.hpp"

namespace whirl::solve {
namespace {

// Nodes and weights on [0, 1] from the Legendre three-term recurrence (Golub and Welsch 1969); for Radau the last
// diagonal entry is moved so that 1 becomes a node (Golub 1973).
void quadrature(int m, Points points, Eigen::VectorXd& c, Eigen::VectorXd& weight) {
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(m, m);
  for (int k = 1; k < m; ++k) jacobi(k, k - 1) = jacobi(k - 1, k) = k / std::sqrt(4.0 * k * k - 1);
  if (points == Points::radau) jacobi(m - 1, m - 1) = m / (2.0 * m - 1);
  const core::SymmetricPairs pairs = core::symmetric_pairs(std::move(jacobi), "the recurrence of Legendre polynomials");
  c = (pairs.values.array() + 1) / 2;
  weight = pairs.vectors.row(0).array().square().matrix().transpose();
  if (points == Points::radau) c(m - 1) = 1;
}

}  // namespace

Eigen::VectorXd lagrange(const Scheme& scheme, double t) {
  const Eigen::Index n = scheme.node.size();
  Eigen::VectorXd w = Eigen::VectorXd::Ones(n);
  for (Eigen::Index l = 0; l < n; ++l)
    for (Eigen::Index k = 0; k < n; ++k)
      if (k != l) w(l) *= (t - scheme.node(k)) / (scheme.node(l) - scheme.node(k));
  return w;
}

Eigen::VectorXd lagrange_slope(const Scheme& scheme, double t) {
  const Eigen::Index n = scheme.node.size();
  Eigen::VectorXd w = Eigen::VectorXd::Zero(n);
  for (Eigen::Index l = 0; l < n; ++l)
    for (Eigen::Index q = 0; q < n; ++q) {
      if (q == l) continue;
      double term = 1 / (scheme.node(l) - scheme.node(q));
      for (Eigen::Index k = 0; k < n; ++k)
        if (k != l && k != q) term *= (t - scheme.node(k)) / (scheme.node(l) - scheme.node(k));
      w(l) += term;
    }
  return w;
}

Eigen::MatrixXd lower_factor(const Eigen::MatrixXd& a) {
  const Eigen::Index m = a.rows();
  Eigen::MatrixXd l = Eigen::MatrixXd::Zero(m, m), u = Eigen::MatrixXd::Identity(m, m);
  for (Eigen::Index k = 0; k < m; ++k) {
    for (Eigen::Index i = k; i < m; ++i) l(i, k) = a(i, k) - l.row(i).head(k).dot(u.col(k).head(k));
    for (Eigen::Index j = k + 1; j < m; ++j) u(k, j) = (a(k, j) - l.row(k).head(k).dot(u.col(j).head(k))) / l(k, k);
  }
  return l;
}

Scheme make_scheme(int degree, Points points) {
  if (degree < 1 || degree > 10) throw core::InputError(fmt::format("collocation degree {} is outside 1..10", degree));
  Scheme s;
  s.degree = degree;
  s.points = points;
  quadrature(degree, points, s.c, s.weight);
  s.node.resize(degree + 1);
  s.node(0) = 0;
  for (int l = 1; l <= degree; ++l) s.node(l) = points == Points::radau ? s.c(l - 1) : static_cast<double>(l) / degree;
  s.node_weight = points == Points::radau ? s.weight : Eigen::VectorXd::Constant(degree, 1.0 / degree);
  s.value.resize(degree, degree + 1);
  s.slope.resize(degree, degree + 1);
  for (int j = 0; j < degree; ++j) {
    s.value.row(j) = lagrange(s, s.c(j)).transpose();
    s.slope.row(j) = lagrange_slope(s, s.c(j)).transpose();
  }
  return s;
}

}  // namespace whirl::solve
