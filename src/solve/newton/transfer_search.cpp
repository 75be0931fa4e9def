#include "solve/newton/transfer_search.hpp"

#include <limits>

#include "whirl/core/pivoted_lu.hpp"
#include "whirl/spectral/dense.hpp"

namespace whirl::solve {

using Complex = std::complex<double>;
using Sparse = FrequencyResolvent::Sparse;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using std::numbers::pi;

namespace {

using Factors = core::PivotedLu<Complex>;

double wrapped(double angle) {
  return std::remainder(angle, 2 * pi);
}

}  // namespace

VectorXcd TransferSearch::joined(const Transfers& h) const {
  Index size = 0, at = 0;
  for (const auto& b : h) size += b.value.size();
  VectorXcd out(size);
  for (const auto& b : h) {
    out.segment(at, b.value.size()) = b.value.reshaped();
    at += b.value.size();
  }
  return out;
}

FrequencyResolvent::Transfers TransferSearch::split(const VectorXcd& values, bool slope) const {
  Transfers out;
  Index at = 0;
  for (const auto& p : machine_.ports()) {
    const auto rows = static_cast<Index>(p.forces.size()), columns = static_cast<Index>(p.seen.size());
    MatrixXcd h = values.segment(at, rows * columns).reshaped(rows, columns);
    at += rows * columns;
    out.push_back(slope ? FrequencyResolvent::Block{{}, std::move(h)} : FrequencyResolvent::Block{std::move(h), {}});
  }
  return out;
}

double TransferSearch::sample() {
  std::vector<double> angles;
  std::vector<VectorXcd> samples;
  const auto add = [&](double angle) {
    const auto place = std::lower_bound(angles.begin(), angles.end(), angle) - angles.begin();
    VectorXcd h = joined(solve_(ellipse_.at(angle), false));
    angles.insert(angles.begin() + place, angle);
    samples.insert(samples.begin() + place, std::move(h));
    return place;
  };
  const auto fit = [&](auto&& takes) {
    std::vector<Complex> points;
    MatrixXcd values(samples.front().size(), 0);
    for (std::size_t k = 0; k < angles.size(); ++k) {
      if (!takes(k)) continue;
      points.push_back(ellipse_.at(angles[k]));
      values.conservativeResize(Eigen::NoChange, values.cols() + 1);
      values.col(values.cols() - 1) = samples[k];
    }
    return RationalFit(std::move(points), std::move(values), 0.1 * options_.fit);
  };
  constexpr int first = 10;
  for (int k = 0; k <= first; ++k) add(pi * k / first);
  RationalFit before = fit([](std::size_t k) { return k % 2 == 0; });
  fit_.emplace(fit([](std::size_t) { return true; }));
  double error = 1;
  for (int good = 0; good < 2 && static_cast<int>(angles.size()) < options_.most_samples;) {
    // Where the last two fits differ most, between the samples.
    double worst = 0, angle = pi / 3;
    for (std::size_t k = 1; k < angles.size(); ++k)
      for (const double share : {0.25, 0.5, 0.75}) {
        const double here = angles[k - 1] + share * (angles[k] - angles[k - 1]);
        const Complex z = ellipse_.at(here);
        // The density of samples breaks ties between fits that agree to rounding.
        const double differs =
            (fit_->value(z) - before.value(z)).norm() / fit_->magnitude() + 1e-13 * (angles[k] - angles[k - 1]);
        if (differs > worst) worst = differs, angle = here;
      }
    const VectorXcd foretold = fit_->value(ellipse_.at(angle));
    const auto place = static_cast<std::size_t>(add(angle));
    error = (foretold - samples[place]).norm() / fit_->magnitude();
    good = error <= options_.fit ? good + 1 : 0;
    before = std::move(*fit_);
    fit_.emplace(fit([](std::size_t) { return true; }));
  }
  return error;
}

std::optional<double> TransferSearch::turn(double from, double angle_from, double to, double angle_to,
                                           int depth) const {
  const double all = wrapped(angle_to - angle_from), middle = 0.5 * (from + to);
  const Complex place = ellipse_.at(middle);
  const double length = std::abs(ellipse_.at(to) - ellipse_.at(from));
  const auto clear = [&](Complex mark) { return length <= std::abs(mark - place); };
  if (std::abs(all) < pi / 3 && std::all_of(marks_.begin(), marks_.end(), clear)) return all;
  if (depth == 0) return std::nullopt;
  const Factors t(fitted(place, false));
  if (!t.regular()) return std::nullopt;
  const double angle = t.angle();
  const auto left = turn(from, angle_from, middle, angle, depth - 1);
  const auto right = left ? turn(middle, angle, to, angle_to, depth - 1) : std::nullopt;
  return right ? std::optional(*left + *right) : std::nullopt;
}

// det T is real on the real axis and conjugate below it.
std::optional<int> TransferSearch::winding(int points, std::vector<Complex> marks) {
  marks_ = std::move(marks);
  double sum = 0, last = 0;
  for (int k = 0; k <= points; ++k) {
    const double angle = pi * k / points;
    const Factors t(fitted(ellipse_.at(angle), false));
    if (!t.regular()) return std::nullopt;
    const double now = t.angle();
    if (k > 0) {
      const auto part = turn(pi * (k - 1) / points, last, angle, now, 24);
      if (!part) return std::nullopt;
      sum += *part;
    }
    last = now;
  }
  return static_cast<int>(std::lround(sum / pi));
}

// Beyn's method: with mu = (lambda - centre)/size and the moments A_k = 1/(2 pi i) int mu^k T^-1 V dlambda, the block
// Hankel matrices B0 = [A_(i+j)] = U S W^* and B1 = [A_(i+j+1)] give the eigenvalues mu of U^* B1 W S^-1 and, in the
// first rows of U, their motions.
std::vector<Root> TransferSearch::candidates(const Contour& contour, int points, int wanted) const {
  const Index n = machine_.hub();
  const Index lanes = std::min<Index>(n, wanted + 4), blocks = (wanted + 4 + lanes - 1) / lanes;
  MatrixXd v(n, lanes);
  for (Index i = 0; i < v.size(); ++i) v.data()[i] = std::sin(1.0 + 0.9 * static_cast<double>(i * (i % 7 + 1)));
  std::vector<MatrixXcd> moments(static_cast<std::size_t>(2 * blocks), MatrixXcd::Zero(n, lanes));
  for (int k = 0; k < points; ++k) {
    const double angle = (contour.half ? pi : 2 * pi) * (k + 0.5) / points;
    const Complex mu = Complex(contour.along * std::cos(angle), contour.across * std::sin(angle)) / contour.size();
    const Complex slope(-contour.along * std::sin(angle), contour.across * std::cos(angle));
    const Factors t(fitted(contour.centre + contour.size() * mu, false));
    if (!t.regular()) continue;
    MatrixXcd y = t.solve(MatrixXcd(v.cast<Complex>())) * (slope / static_cast<double>(points));
    for (MatrixXcd& a : moments) {
      // The other half gives the conjugate.
      if (contour.half)
        a += y.imag().cast<Complex>();
      else
        a += y;
      y *= mu;
    }
  }
  const auto hankel = [&](Index shift) {
    MatrixXcd b(n * blocks, lanes * blocks);
    for (Index i = 0; i < blocks; ++i)
      for (Index j = 0; j < blocks; ++j)
        b.block(i * n, j * lanes, n, lanes) = moments[static_cast<std::size_t>(i + j + shift)];
    return b;
  };
  const spectral::Svd svd = spectral::svd(hankel(0));
  const Eigen::VectorXd& s = svd.sizes;
  Index rank = 0;
  while (rank < s.size() && s(rank) > 1e-12 * s(0)) ++rank;
  std::vector<Root> out;
  if (rank == 0) return out;
  const MatrixXcd u = svd.u.leftCols(rank);
  const MatrixXcd reduced =
      u.adjoint() * hankel(1) * svd.v.leftCols(rank) * s.head(rank).cwiseInverse().cast<Complex>().asDiagonal();
  const spectral::Eigenpairs pairs = spectral::complex_eigenpairs(reduced);
  if (!pairs.values.allFinite()) return out;
  for (Index k = 0; k < rank; ++k) {
    const Complex mu = pairs.values(k);
    Root r{contour.centre + contour.size() * mu, u.topRows(n) * pairs.vectors.col(k)};
    if (r.lambda.imag() < -1e-9 * ellipse_.size() || ellipse_.level(r.lambda) > 1.3 || r.motion.norm() == 0) continue;
    if (std::hypot(mu.real() * contour.size() / contour.along, mu.imag() * contour.size() / contour.across) > 1.5)
      continue;
    r.motion.normalize();
    out.push_back(std::move(r));
  }
  return out;
}

// T + T' d = 0 on the new z = -d T^-1 T' z, with its part along the old z unchanged.
std::optional<Complex> TransferSearch::step(const Sparse& t, const Sparse& slope, VectorXcd& z) {
  const Factors factors(t);
  if (!factors.regular()) return Complex(0);  // an eigenvalue to the last digit
  const VectorXcd next = factors.solve(VectorXcd(slope * z));
  const Complex along = z.dot(next);
  if (along == 0.0 || !next.allFinite()) return std::nullopt;
  const Complex d = -z.squaredNorm() / along;
  z = next.normalized();
  return d;
}

double TransferSearch::rounding(const Sparse& t, const Sparse& slope, const VectorXcd& z, double magnitude) {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  // One solve with a nearly singular matrix turns anything into its left null vector.
  const Factors factors(Sparse(t.adjoint()));
  if (!factors.regular()) return eps * magnitude;
  VectorXcd y(z.size());
  for (Index i = 0; i < y.size(); ++i) y(i) = std::polar(1.0, 1.7 * static_cast<double>(i * (i % 5 + 1)));
  y = factors.solve(y);
  return eps * magnitude * y.norm() * z.norm() / std::abs(y.dot(slope * z));
}

bool TransferSearch::refine_on_fit(Root& root) const {
  for (int k = 0; k < 30; ++k) {
    const auto d = step(fitted(root.lambda, false), fitted(root.lambda, true), root.motion);
    if (!d) return false;
    root.lambda += *d;
    if (ellipse_.level(root.lambda) > 2) return false;
    if (std::abs(*d) <= 1e-10 * ellipse_.size()) return true;
  }
  return false;
}

std::optional<Complex> TransferSearch::refine(Root& root) {
  for (int k = 0; k < 8; ++k) {
    const Transfers h = solve_(root.lambda, true);
    const Sparse t = machine_.matrix(root.lambda, h, false), slope = machine_.matrix(root.lambda, h, true);
    const double magnitude = machine_.magnitude(root.lambda, h);
    const auto d = step(t, slope, root.motion);
    if (!d || std::abs(*d) > 0.1 * ellipse_.size()) return std::nullopt;
    root.lambda += *d;
    // The next step would be the square of this one.
    if (std::abs(*d) > 1e-8 * std::max(std::abs(root.lambda), 1e-3 * ellipse_.size())) continue;
    root.rounding = rounding(t, slope, root.motion, magnitude);
    return d;
  }
  return std::nullopt;
}

}  // namespace whirl::solve
