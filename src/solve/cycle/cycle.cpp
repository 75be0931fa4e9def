#include "whirl/solve/cycle/cycle.hpp"

#include <algorithm>
#include <cmath>

namespace whirl::solve {
namespace {

using Eigen::Index;

Index interval_of(const std::vector<double>& mesh, double s) {
  const auto it = std::upper_bound(mesh.begin() + 1, mesh.end() - 1, s);
  return static_cast<Index>(it - mesh.begin()) - 1;
}

double length(const std::vector<double>& mesh, Index i) {
  return mesh[static_cast<std::size_t>(i) + 1] - mesh[static_cast<std::size_t>(i)];
}

// m-th derivative of the interval's polynomial: m! times the leading divided difference.
Eigen::VectorXd top_derivative(const Scheme& scheme, const Cycle& cycle, Index i) {
  const Index m = scheme.degree, last = cycle.intervals() * m - 1;
  const double h = length(cycle.mesh, i);
  Eigen::VectorXd d = Eigen::VectorXd::Zero(cycle.x.rows());
  double factorial = 1;
  for (Index l = 0; l <= m; ++l) {
    double w = 1;
    for (Index k = 0; k <= m; ++k)
      if (k != l) w /= scheme.node(l) - scheme.node(k);
    const Index column = l == 0 ? (i == 0 ? last : i * m - 1) : i * m + l - 1;
    d += w * cycle.x.col(column);
    if (l > 0) factorial *= static_cast<double>(l);
  }
  return d * factorial / std::pow(h, static_cast<double>(m));
}

}  // namespace

Eigen::VectorXd Cycle::at(const Scheme& scheme, double s) const {
  const Index m = scheme.degree, i = interval_of(mesh, s);
  const double t = (s - mesh[static_cast<std::size_t>(i)]) / length(mesh, i);
  const Eigen::VectorXd w = lagrange(scheme, t);
  Eigen::VectorXd value = w(0) * x.col(i == 0 ? x.cols() - 1 : i * m - 1);
  for (Index l = 1; l <= m; ++l) value += w(l) * x.col(i * m + l - 1);
  return value;
}

Cycle Cycle::on(const Scheme& scheme, const std::vector<double>& new_mesh) const {
  if (new_mesh == mesh) return *this;
  Cycle out{new_mesh, {}, period, parameter};
  const Index m = scheme.degree, count = out.intervals();
  out.x.resize(x.rows(), count * m);
  for (Index i = 0; i < count; ++i)
    for (Index l = 1; l <= m; ++l)
      out.x.col(i * m + l - 1) =
          at(scheme, new_mesh[static_cast<std::size_t>(i)] + scheme.node(l) * length(new_mesh, i));
  return out;
}

std::vector<double> uniform_mesh(int intervals) {
  std::vector<double> mesh(static_cast<std::size_t>(intervals) + 1);
  for (int i = 0; i <= intervals; ++i) mesh[static_cast<std::size_t>(i)] = static_cast<double>(i) / intervals;
  return mesh;
}

std::vector<double> refined(const std::vector<double>& mesh, int parts) {
  std::vector<double> out{mesh.front()};
  for (std::size_t i = 0; i + 1 < mesh.size(); ++i)
    for (int k = 1; k <= parts; ++k)
      out.push_back(k == parts ? mesh[i + 1] : mesh[i] + (mesh[i + 1] - mesh[i]) * k / parts);
  return out;
}

std::vector<double> doubled(const std::vector<double>& mesh) {
  return refined(mesh, 2);
}

const Scheme& quintic() {
  static const Scheme scheme = make_scheme(5, Points::gauss);
  return scheme;
}

Cycle through(const Cycle& points) {
  const Scheme& scheme = quintic();
  const Index m = scheme.degree, count = points.intervals(), used = std::min<Index>(6, count);
  // Point k stands at s_(k+1) of its lap.
  const auto time = [&](Index k) {
    const Index lap = k >= 0 ? k / count : -((count - 1 - k) / count), own = k - lap * count;
    return static_cast<double>(lap) + points.mesh[static_cast<std::size_t>(own) + 1];
  };
  Cycle out{points.mesh, Eigen::MatrixXd(points.x.rows(), count * m), points.period, points.parameter};
  for (Index i = 0; i < count; ++i) {
    const double begin = points.mesh[static_cast<std::size_t>(i)], h = length(points.mesh, i);
    const Index first = i - used / 2;
    for (Index l = 1; l < m; ++l) {
      const double s = begin + h * scheme.node(l);
      Eigen::VectorXd value = Eigen::VectorXd::Zero(points.x.rows());
      for (Index a = first; a < first + used; ++a) {
        double weight = 1;
        for (Index b = first; b < first + used; ++b)
          if (b != a) weight *= (s - time(b)) / (time(a) - time(b));
        value += weight * points.x.col((a % count + count) % count);
      }
      out.x.col(i * m + l - 1) = value;
    }
    out.x.col(i * m + m - 1) = points.x.col(i);
  }
  return out;
}

std::vector<double> interval_errors(const Scheme& scheme, const Cycle& cycle, const Eigen::VectorXd& scale,
                                    MPI_Comm comm) {
  const Index n = cycle.intervals(), m = scheme.degree;
  std::vector<Eigen::VectorXd> top(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i)
    top[static_cast<std::size_t>(i)] = top_derivative(scheme, cycle, i).cwiseQuotient(scale);
  const Eigen::VectorXd centre = cycle.x.rowwise().mean();
  // Of this rank's rows: jumps of the top derivative from the interval before, and the deviation. Some may have none.
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(n + 1);
  for (Index i = 0; i < n && scale.size() > 0; ++i)
    largest(i) =
        (top[static_cast<std::size_t>(i)] - top[static_cast<std::size_t>((i + n - 1) % n)]).cwiseAbs().maxCoeff();
  if (scale.size() > 0)
    largest(n) = (cycle.x.colwise() - centre).cwiseQuotient(scale.replicate(1, cycle.x.cols())).cwiseAbs().maxCoeff();
  MPI_Allreduce(MPI_IN_PLACE, largest.data(), static_cast<int>(n + 1), MPI_DOUBLE, MPI_MAX, comm);
  const double size = largest(n);
  double error_constant = 1;  // of the interpolation at the nodes, with equal spacing as a bound
  for (Index k = 1; k <= m + 1; ++k) error_constant /= 2.0 * static_cast<double>(k);
  std::vector<double> error(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) {
    const Index left = (i + n - 1) % n, right = (i + 1) % n;
    const double h = length(cycle.mesh, i);
    const auto jump = [&](Index a, Index b) {
      return largest(b) / ((length(cycle.mesh, a) + length(cycle.mesh, b)) / 2);
    };
    const double derivative = std::max(jump(left, i), jump(i, right));
    error[static_cast<std::size_t>(i)] =
        error_constant * derivative * std::pow(h, static_cast<double>(m) + 1) / std::max(size, 1e-6);
  }
  return error;
}

std::vector<double> adapted_mesh(const Scheme& scheme, const Cycle& cycle, const Eigen::VectorXd& scale,
                                 double tolerance, int base, int max_intervals, MPI_Comm comm) {
  const std::vector<double> error = interval_errors(scheme, cycle, scale, comm);
  const double unit = 1.0 / base, ratio = std::pow(2.0, scheme.degree + 1);
  // The level of an interval: how many times 1/base was halved (negative: doubled).
  struct Piece {
    double begin;
    int level;
    double error;
  };
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < error.size(); ++i) {
    const double h = cycle.mesh[i + 1] - cycle.mesh[i];
    const int level = static_cast<int>(std::lround(std::log2(unit / h)));
    int splits = 0;
    for (double e = error[i]; e > tolerance && splits < 3; e /= ratio) ++splits;
    for (int k = 0; k < (1 << splits); ++k)
      pieces.push_back({cycle.mesh[i] + h * k / (1 << splits), level + splits, error[i] / std::pow(ratio, splits)});
  }
  // Merge neighbours that together make one dyadic interval; never coarser than 1/base.
  std::vector<Piece> merged;
  for (const Piece& p : pieces) {
    merged.push_back(p);
    while (merged.size() >= 2) {
      const Piece &a = merged[merged.size() - 2], &b = merged.back();
      const double h = unit / std::pow(2.0, b.level);
      const bool pair = a.level == b.level && b.level > 0 && std::lround(a.begin / h) % 2 == 0 &&
                        std::lround(b.begin / h) == std::lround(a.begin / h) + 1;
      if (!pair || std::max(a.error, b.error) * ratio > tolerance / 2) break;
      const Piece joined{a.begin, a.level - 1, std::max(a.error, b.error) * ratio};
      merged.pop_back();
      merged.back() = joined;
    }
  }
  if (static_cast<int>(merged.size()) > max_intervals && base <= max_intervals)
    return adapted_mesh(scheme, cycle, scale, 2 * tolerance, base, max_intervals, comm);
  std::vector<double> mesh;
  for (const Piece& p : merged) {
    const double h = unit / std::pow(2.0, p.level);
    mesh.push_back(static_cast<double>(std::lround(p.begin / h)) * h);
  }
  mesh.push_back(1);
  return mesh;
}

}  // namespace whirl::solve
