#include "whirl/solve/cycle/cycle_quantity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace whirl::solve {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::VectorXd;

double height(const Vector2d& p, const Vector2d& direction) {
  return direction.isZero() ? p.norm() : direction.dot(p);
}

// The polynomial of one interval.
struct Piece {
  const Scheme& scheme;
  Eigen::Matrix2Xd nodes;  // [2 x (m + 1)]
  Vector2d direction;

  [[nodiscard]] Vector2d place(double t) const { return nodes * lagrange(scheme, t); }
  [[nodiscard]] double value(double t) const { return height(place(t), direction); }
  // For |p| the slope of |p|^2/2: it has the same sign.
  [[nodiscard]] double slope(double t) const {
    const Vector2d rate = nodes * lagrange_slope(scheme, t);
    return (direction.isZero() ? place(t) : direction).dot(rate);
  }
  // Where the slope falls through zero between a and b; b if it does not.
  [[nodiscard]] double top(double a, double b) const {
    if (!(slope(a) > 0 && slope(b) < 0)) return b;
    for (int k = 0; k < 60; ++k) {
      const double middle = (a + b) / 2;
      (slope(middle) > 0 ? a : b) = middle;
    }
    return (a + b) / 2;
  }
};

Index column_of(const Cycle& path, Index m, Index interval, Index node) {
  return interval == 0 && node == 0 ? path.x.cols() - 1 : interval * m + node - 1;
}

Piece piece_of(const Scheme& scheme, const Cycle& path, Index interval, const Vector2d& direction) {
  Piece piece{scheme, Eigen::Matrix2Xd(2, scheme.degree + 1), direction};
  for (Index l = 0; l <= scheme.degree; ++l)
    piece.nodes.col(l) = path.x.col(column_of(path, scheme.degree, interval, l));
  return piece;
}

}  // namespace

CyclePeak peak_of(const Scheme& scheme, const Cycle& path, const Vector2d& direction) {
  const int parts = 4 * scheme.degree;
  CyclePeak best;
  Index where = -1;
  double at = 0;
  for (Index i = 0; i < path.intervals(); ++i) {
    const Piece piece = piece_of(scheme, path, i, direction);
    for (int k = 0; k < parts; ++k) {
      const double t = piece.top(1.0 * k / parts, 1.0 * (k + 1) / parts), value = piece.value(t);
      if (where >= 0 && !(value > best.value)) continue;
      best.value = value;
      where = i;
      at = t;
    }
  }
  const auto begin = static_cast<std::size_t>(where);
  best.time = path.mesh[begin] + at * (path.mesh[begin + 1] - path.mesh[begin]);
  const Vector2d along =
      direction.isZero() ? piece_of(scheme, path, where, direction).place(at).normalized() : direction;
  const VectorXd weights = lagrange(scheme, at);
  best.by_nodes = Eigen::Matrix2Xd::Zero(2, path.x.cols());
  for (Index l = 0; l <= scheme.degree; ++l)
    best.by_nodes.col(column_of(path, scheme.degree, where, l)) += weights(l) * along;
  return best;
}

bool another_peak(const Scheme& scheme, const Cycle& path, const Vector2d& direction, const CyclePeak& peak,
                  double before, double depth) {
  constexpr int looks = 64;
  const double way = std::remainder(peak.time - before, 1.0);
  double valley = peak.value, least = peak.value;
  for (int k = 0; k <= looks; ++k) {
    const double s = before + way * k / looks;
    const double value = height(path.at(scheme, s - std::floor(s)), direction);
    if (k == 0) least = std::min(value, peak.value);
    valley = std::min(valley, value);
  }
  return least - valley > depth;
}

CycleQuantity::Value CycleQuantity::of(const Scheme& scheme, const Cycle& path, double speed) const {
  if (kind == Kind::period) return {path.period, 1, {}};
  if (kind == Kind::whirl_ratio) {
    const double ratio = 2 * std::numbers::pi / (path.period * speed);
    return {ratio, -ratio / path.period, {}};
  }
  Value out{0, 0, Eigen::Matrix2Xd::Zero(2, path.x.cols())};
  for (const Vector2d& d : directions) {
    const CyclePeak peak = peak_of(scheme, path, d);
    out.value += factor * peak.value;
    out.by_nodes += factor * peak.by_nodes;
  }
  return out;
}

}  // namespace whirl::solve
