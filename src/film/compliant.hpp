#pragma once
// What all compliant films share: scales, differences, and the integral of the positive pressure around the
// bearing.

#include <array>
#include <vector>

#include "whirl/film/state_model.hpp"

namespace whirl::film {

/// Scales of a compliant film with thickness h and eccentricity e in clearances and P = p (c/R)^2/(6 mu) in 1/s. A
/// linear liner gives P = u/b with its deflection u = h - 1 + e_x cos + e_y sin.
struct CompliantScales {
  CompliantScales(const Geometry& geometry, const Options& options, const Lubricant& lubricant);
  double pressure;  // Pa s, p/P = 6 mu (R/c)^2
  double force;     // N s, force over int P (cos, sin) d theta of the mean pressure along z: 3 mu L D (R/c)^2
  double liner;     // s, b
};

/// Throws core::InputError unless bore, lubricant and liner make a compliant film.
void check_compliant(const Geometry& geometry, const Options& options, const Lubricant& lubricant);

/// Weights of the nodes k - 2 ... k + 1 around the bearing. `third_order` is the difference of third order that is
/// biased against the flow (kappa = 1/3), exact for cubics; the speed must not be negative for both upwind kinds.
struct Neighbours {
  explicit Neighbours(Options::Differences which);
  std::array<double, 4> slope{};  // of dh/dtheta at k, over the step
  std::array<double, 4> face{};   // of h midway between k - 1 and k
  int reach = 1;                  // lines before k that enter the slope
};

/// The rates s' at which g(motion, s, s') = 0, which is linear in them.
[[nodiscard]] std::vector<double> settled_rates(StateModel& film, const Motion& motion, std::span<const double> states);

/// -int max(P, 0) (cos, sin) d theta over the cells between nodes k = 0 .. n - 1 at 90 deg + k 2 pi/n, by its weights:
/// exact for a P that is linear between the nodes, or Simpson's rule over nodal values.
class RingQuadrature {
public:
  RingQuadrature(int n, Options::Quadrature rule);

  [[nodiscard]] int nodes() const { return n_; }
  [[nodiscard]] double step() const { return step_; }
  [[nodiscard]] double angle(int k) const;
  [[nodiscard]] double cosine(int k) const { return cos_[index(k)]; }
  [[nodiscard]] double sine(int k) const { return sin_[index(k)]; }

  /// Integral over cell k, from node k to k + 1, is `left` a + `right` b (x and y), if P is a and b at its ends. The
  /// weights are its derivatives.
  struct Weights {
    std::array<double, 2> left{}, right{};
  };
  [[nodiscard]] Weights weights(int k, double a, double b) const {
    if (a <= 0.0 && b <= 0.0) return {};
    if (simpson_ || (a >= 0.0 && b >= 0.0)) {
      Weights w = full_[index(k)];
      if (a <= 0.0 && simpson_) w.left = {};
      if (b <= 0.0 && simpson_) w.right = {};
      return w;
    }
    return part(k, a, b);
  }

private:
  [[nodiscard]] std::size_t index(int k) const { return static_cast<std::size_t>((k % n_ + n_) % n_); }
  [[nodiscard]] Weights part(int k, double a, double b) const;
  int n_;
  bool simpson_;
  double step_;
  std::vector<double> cos_, sin_;
  std::vector<Weights> full_;  // of a cell without negative pressure
};

}  // namespace whirl::film
