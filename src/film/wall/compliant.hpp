#pragma once
// What all compliant films share: scales, differences, liner, and the integral of the positive pressure around the
// bearing.

#include <array>
#include <vector>

#include "film/wall/liner.hpp"
#include "whirl/core/error.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film {

/// Scales of a compliant film with thickness h and eccentricity e in clearances and P = p (c/R)^2/(6 mu) in 1/s. A
/// linear liner gives P = u/b with its deflection u = h - 1 + e_x cos + e_y sin.
struct CompliantScales {
  CompliantScales(const Geometry& geometry, const Compliant& options, const Lubricant& lubricant);
  double pressure;  // Pa s, p/P = 6 mu (R/c)^2
  double force;     // N s, force over int P (cos, sin) d theta of the mean pressure along z: 3 mu L D (R/c)^2
  double liner;     // s, b
};

/// Weights of the nodes k - 2 ... k + 1 around the bearing. `third_order` is the difference of third order that is
/// biased against the flow (kappa = 1/3), exact for cubics; the speed must not be negative for both upwind kinds.
struct Neighbours {
  explicit Neighbours(Compliant::Differences which);
  std::array<double, 4> slope{};  // of dh/dtheta at k, over the step
  std::array<double, 4> face{};   // of h midway between k - 1 and k
  int reach = 1;                  // lines before k that enter the slope
};

/// -int max(P, 0) (cos, sin) d theta over the cells between nodes k = 0 .. n - 1 at 90 deg + k 2 pi/n, by its weights:
/// exact for a P that is linear between the nodes, or Simpson's rule over nodal values. Nodes and cells may be counted
/// on by one turn on either side, -n <= k < 2 n.
class RingQuadrature {
public:
  RingQuadrature(int n, Compliant::Quadrature rule);

  [[nodiscard]] int nodes() const { return n_; }
  [[nodiscard]] double step() const { return step_; }
  [[nodiscard]] double angle(int k) const;
  /// Of the node within the first turn.
  [[nodiscard]] std::size_t index(int k) const {
    return static_cast<std::size_t>(k < 0 ? k + n_ : k < n_ ? k : k - n_);
  }
  [[nodiscard]] double cosine(int k) const { return cos_[index(k)]; }
  [[nodiscard]] double sine(int k) const { return sin_[index(k)]; }
  /// True if every node counts by itself, with its own weight where its P is positive.
  [[nodiscard]] bool nodal() const { return simpson_; }

  /// Integral over cell k, from node k to k + 1, is `left` a + `right` b (x and y), if P is a and b at its ends. The
  /// weights are its derivatives.
  struct Weights {
    std::array<double, 2> left{}, right{};
  };
  /// Of a cell without negative pressure.
  [[nodiscard]] const Weights& full(int k) const { return full_[index(k)]; }
  /// Of a cell with P < 0 at one end and P > 0 at the other; not for a nodal rule.
  [[nodiscard]] Weights part(int k, double a, double b) const;
  /// Of node k between two cells without negative pressure.
  [[nodiscard]] std::array<double, 2> node(int k) const {
    const Weights &before = full(k - 1), &after = full(k);
    return {before.right[0] + after.left[0], before.right[1] + after.left[1]};
  }

private:
  int n_;
  bool simpson_;
  double step_;
  std::vector<double> cos_, sin_;
  std::vector<Weights> full_;
};

/// The film as its option `states` says.
[[nodiscard]] inline std::unique_ptr<Film> used(const Compliant& options, std::unique_ptr<Film> film) {
  if (options.states == States::condensed) {
    if (options.liner_damping > 0)
      throw core::InputError("a liner that gives way at once (states: condensed) has no damping");
    return condense(std::move(film));
  }
  return film;
}

/// What all compliant films are made of.
class CompliantModel : public Film {
public:
  /// Throws core::InputError unless bore, lubricant and liner make a compliant film.
  /// Its mesh has `options.cells[0]` cells around the bearing and `along` along it, 0 for none.
  CompliantModel(const Geometry& geometry, const Compliant& options, int along, const Lubricant& lubricant);
  [[nodiscard]] bool constant_rates() const final { return !liner_.damped(); }
  [[nodiscard]] std::vector<StateField> state_fields() const final {
    return {{"thickness", "m", g_.clearance, 0, static_cast<int>(states())}};
  }
  /// The thickness over a liner whose deflection stays.
  [[nodiscard]] PortColumns carried_rates() const final;
  [[nodiscard]] double least_thickness(const JournalMotion& /*motion*/, std::span<const double> states) final {
    return *std::min_element(states.begin(), states.end());
  }

protected:
  /// Thickness over an undeflected liner at node k around the bearing, in clearances.
  [[nodiscard]] double rigid(const JournalMotion& m, int k) const {
    return 1.0 - (m.position[0] * ring_.cosine(k) + m.position[1] * ring_.sine(k)) / g_.clearance;
  }
  /// For reports, which know no rates: those at which g(motion, s, s') = 0, which is linear in them, if the force
  /// depends on them.
  [[nodiscard]] std::vector<double> balanced_rates(const JournalMotion& motion, std::span<const double> states);
  /// Sizes for the rows of a share; derivatives only if they are wanted.
  void resize(const Share& share, Need need, StateResponse& response) const;
  /// Of an empty film on a mesh of `along` nodes along it: theta, z, pressure and thickness.
  [[nodiscard]] std::array<NodalField, 4> empty_fields(std::size_t along) const;

  Geometry g_;
  double viscosity_;
  CompliantScales scales_;
  LinerLaw liner_;
  Neighbours neighbours_;
  RingQuadrature ring_;
};

}  // namespace whirl::film
