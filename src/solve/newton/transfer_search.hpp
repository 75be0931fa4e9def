#pragma once
// The search for eigenvalues of T(lambda), by one rank.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "solve/newton/rational_fit.hpp"
#include "solve/newton/transfer_modes.hpp"
#include "whirl/solve/newton/frequency_resolvent.hpp"

namespace whirl::solve {

/// The upper half of an ellipse about the real axis, angle 0 to pi: the region of the options.
struct Ellipse {
  double centre, along, across;
  explicit Ellipse(const TransferOptions& o)
      : centre((o.frequency - o.decay) / 2), along((o.frequency + o.decay) / 2), across(o.frequency) {}
  [[nodiscard]] std::complex<double> at(double angle) const {
    return {centre + along * std::cos(angle), angle == std::numbers::pi ? 0 : across * std::sin(angle)};
  }
  /// Below one inside.
  [[nodiscard]] double level(std::complex<double> z) const {
    return std::hypot((z.real() - centre) / along, z.imag() / across);
  }
  [[nodiscard]] double size() const { return std::max(along, across); }
  /// A circle about a real place that holds the ellipse. The farther to the right, the fewer of the many strongly
  /// damped eigenvalues of a film lie in it, and the less they differ in their distance.
  [[nodiscard]] double target() const { return centre + std::max(0.0, across - along); }
  [[nodiscard]] double radius() const {
    double out = 0;
    for (int k = 0; k <= 64; ++k) out = std::max(out, std::abs(at(std::numbers::pi * k / 64) - target()));
    return out * 1.01;
  }
};

/// A closed curve for moments: an ellipse with conjugate values on its other half, or a whole circle.
struct Contour {
  std::complex<double> centre;
  double along, across;
  bool half;
  [[nodiscard]] double size() const { return std::max(along, across); }
};

/// An eigenvalue [1/s], the motion of the hub, scaled, and what rounding may have done to the eigenvalue [1/s].
struct Root {
  std::complex<double> lambda;
  Eigen::VectorXcd motion;
  double rounding = 0;
};

/// What one rank decides; `solve` asks all ranks for H, and its slope if it is wanted. Both references have to live on.
class TransferSearch {
public:
  using Complex = std::complex<double>;
  using Transfers = FrequencyResolvent::Transfers;
  using Solve = std::function<Transfers(Complex, bool slopes)>;
  TransferSearch(const FrequencyResolvent& machine, const TransferOptions& options, Solve solve)
      : machine_(machine), options_(options), ellipse_(options), solve_(std::move(solve)) {}

  /// Samples H until the fit foretells it; returns how well it did.
  double sample();
  /// Winding number of det T about the region, or nothing if an eigenvalue lies on its edge. Poles and zeros come in
  /// pairs, past which det T turns a whole time and seems not to turn at all: no step along the edge is longer than the
  /// distance to those known (`marks`, Im >= 0).
  [[nodiscard]] std::optional<int> winding(int points, std::vector<Complex> marks);
  /// Candidates with Im >= 0 for about `wanted` eigenvalues within a curve.
  [[nodiscard]] std::vector<Root> candidates(const Contour& contour, int points, int wanted) const;
  /// Newton's method with the fit, and with the machine.
  [[nodiscard]] bool refine_on_fit(Root& root) const;
  /// The last step is added to `root` and returned: the solve was made where it began. Rounding is eps (|A| + |lambda
  /// B|
  /// + |H|) |y| |z|/|y* T' z| with the left vector y, Frobenius norms (Stewart and Sun 1990, sec. VI.2, of T).
  [[nodiscard]] std::optional<Complex> refine(Root& root);

private:
  [[nodiscard]] FrequencyResolvent::Sparse fitted(Complex lambda, bool slope) const {
    return machine_.matrix(lambda, split(slope ? fit_->slope(lambda) : fit_->value(lambda), slope), slope);
  }
  [[nodiscard]] Eigen::VectorXcd joined(const Transfers& h) const;
  [[nodiscard]] Transfers split(const Eigen::VectorXcd& values, bool slope) const;
  /// One step of Newton's method for (lambda, z) with z scaled by its own direction.
  [[nodiscard]] static std::optional<Complex> step(const FrequencyResolvent::Sparse& t,
                                                   const FrequencyResolvent::Sparse& slope, Eigen::VectorXcd& z);
  [[nodiscard]] static double rounding(const FrequencyResolvent::Sparse& t, const FrequencyResolvent::Sparse& slope,
                                       const Eigen::VectorXcd& z, double magnitude);
  [[nodiscard]] std::optional<double> turn(double from, double angle_from, double to, double angle_to, int depth) const;

  const FrequencyResolvent& machine_;
  const TransferOptions& options_;
  Ellipse ellipse_;
  Solve solve_;
  std::optional<RationalFit> fit_;
  std::vector<Complex> marks_;
};

}  // namespace whirl::solve
