#include "whirl/transient/analysis/estimators.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "transient/analysis/fourier.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"

namespace whirl::transient {
namespace {

double hann(std::size_t k, std::size_t n) {
  return (1 - std::cos(2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n))) / 2;
}

// z below which a normal variable stays with the probability (1 + p)/2: by bisection, as it is wanted once.
double normal_quantile(double probability) {
  double low = 0, high = 10;
  for (int k = 0; k < 80; ++k) {
    const double middle = (low + high) / 2;
    (std::erf(middle / std::sqrt(2.0)) < probability ? low : high) = middle;
  }
  return low;
}

}  // namespace

double equivalent_averages(int segments, int samples) {
  const auto n = static_cast<std::size_t>(samples), hop = n / 2;
  double power = 0, shared = 0;
  for (std::size_t k = 0; k < n; ++k) {
    power += hann(k, n) * hann(k, n);
    if (k + hop < n) shared += hann(k, n) * hann(k + hop, n);
  }
  const double rho = (shared / power) * (shared / power);
  return segments / (1 + 2 * (1 - 1.0 / segments) * rho);
}

SpectralMatrix spectral_matrix(const std::vector<std::vector<double>>& signals, double interval,
                               const WelchOptions& options) {
  core::require(!signals.empty() && options.segments >= 1, "spectral densities need signals and segments");
  const std::size_t length = signals.front().size(), halves = static_cast<std::size_t>(options.segments) + 1;
  const std::size_t hop = length / halves, n = 2 * hop;
  core::require(hop >= 2, "a segment needs samples");
  const auto count = static_cast<Eigen::Index>(signals.size());
  SpectralMatrix out;
  out.samples = static_cast<int>(n);
  out.segments = options.segments;
  out.resolution = 1 / (static_cast<double>(n) * interval);
  out.averages = equivalent_averages(options.segments, out.samples);
  out.lines.assign(n / 2 + 1, Eigen::MatrixXcd::Zero(count, count));
  double power = 0;
  for (std::size_t k = 0; k < n; ++k) power += hann(k, n) * hann(k, n);
  std::vector<double> means;
  for (const auto& s : signals) {
    core::require(s.size() == length, "signals have the same length");
    double sum = 0;
    for (const double v : s) sum += v;
    means.push_back(sum / static_cast<double>(length));
  }
  RealTransform transform(n);
  std::vector<std::vector<std::complex<double>>> lines(signals.size());
  for (std::size_t segment = 0; segment + 1 < halves; ++segment) {
    for (std::size_t i = 0; i < signals.size(); ++i) {
      for (std::size_t k = 0; k < n; ++k) transform.in()[k] = hann(k, n) * (signals[i][segment * hop + k] - means[i]);
      lines[i] = transform.run();
    }
    for (std::size_t k = 0; k < out.lines.size(); ++k)
      for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index j = 0; j < count; ++j)
          out.lines[k](i, j) +=
              lines[static_cast<std::size_t>(i)][k] * std::conj(lines[static_cast<std::size_t>(j)][k]);
  }
  for (std::size_t k = 0; k < out.lines.size(); ++k) {
    const bool once = k == 0 || 2 * k == n;
    out.lines[k] *= (once ? 1 : 2) * interval / (power * options.segments);
  }
  return out;
}

LineEstimate estimate(const Eigen::MatrixXcd& s, int inputs, double averages, double probability) {
  const Eigen::Index q = inputs, p = s.rows() - q;
  core::require(q >= 1 && p >= 1 && averages > inputs,
                "an estimate needs inputs, outputs and more averages than inputs");
  LineEstimate out;
  out.ordinary = Eigen::MatrixXd::Zero(p, q);
  out.multiple = Eigen::VectorXd::Zero(p);
  out.radius = Eigen::MatrixXd::Constant(p, q, std::numeric_limits<double>::infinity());
  out.h1 = Eigen::MatrixXcd::Zero(p, q);
  const Eigen::MatrixXcd ff = s.topLeftCorner(q, q), gf = s.bottomLeftCorner(p, q), gg = s.bottomRightCorner(p, p);
  for (Eigen::Index j = 0; j < q; ++j) {
    for (Eigen::Index i = 0; i < j; ++i) {
      const double both = ff(i, i).real() * ff(j, j).real();
      if (both > 0) out.input_coherence = std::max(out.input_coherence, std::norm(ff(i, j)) / both);
    }
    for (Eigen::Index i = 0; i < p; ++i) {
      const double both = gg(i, i).real() * ff(j, j).real();
      if (both > 0) out.ordinary(i, j) = std::min(1.0, std::norm(gf(i, j)) / both);
    }
  }
  using Lu = core::DenseLu<std::complex<double>>;
  const double regular = std::numeric_limits<double>::epsilon() * static_cast<double>(q);
  const Lu lu(ff);
  if (!(lu.rcond() > regular)) return out;
  const Eigen::MatrixXcd inverse = lu.inverse();
  out.h1 = gf * inverse;
  if (p == q) {
    const Lu fg(gf.adjoint());
    if (fg.rcond() > regular) out.h2 = gg * fg.inverse();
  }
  const double factor = std::pow(1 - probability, -1 / (averages - inputs)) - 1;
  for (Eigen::Index i = 0; i < p; ++i) {
    const double power = gg(i, i).real();
    if (!(power > 0)) continue;
    const double explained = (out.h1.row(i) * gf.row(i).adjoint())(0).real() / power;
    out.multiple(i) = std::clamp(explained, 0.0, 1.0);
    for (Eigen::Index j = 0; j < q; ++j)
      out.radius(i, j) = std::sqrt(factor * (1 - out.multiple(i)) * power * inverse(j, j).real());
  }
  return out;
}

Bounds coherence_bounds(double coherence, int inputs, double averages, double probability) {
  const double free = averages - inputs;
  if (coherence >= 1) return {1, 1};
  const double z = std::atanh(std::sqrt(coherence)) - inputs / (2 * free),
               half = normal_quantile(probability) / std::sqrt(2 * free);
  const auto back = [](double at) { return std::pow(std::tanh(std::max(0.0, at)), 2); };
  return {back(z - half), back(z + half)};
}

double coherence_of_chance(int inputs, double averages, double probability) {
  // 1 - the distribution at x: sum_{k < q} of (1 - x)^(n - q) x^k (n - q)_k/k!, by parts from that of one input.
  const auto beyond = [&](double x) {
    double term = 1, sum = 0;
    for (int k = 0; k < inputs; ++k) {
      sum += term;
      term *= x * (averages - inputs + k) / (k + 1);
    }
    return std::pow(1 - x, averages - inputs) * sum;
  };
  double low = 0, high = 1;
  for (int k = 0; k < 80; ++k) {
    const double middle = (low + high) / 2;
    (beyond(middle) > 1 - probability ? low : high) = middle;
  }
  return low;
}

}  // namespace whirl::transient
