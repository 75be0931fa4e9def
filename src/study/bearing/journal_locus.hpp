#pragma once
// Where a film with states, or on a soft liner, pushes straight up: a curve, followed by its length.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "whirl/film/contract/film.hpp"

namespace whirl::study {

/// The journal at rest at (x, y) with the states s of its film: g(x, y, s) = 0 and F_x = 0, a curve in (s, x, y).
///
/// It is followed from a known point by pseudo-arclength in typical states and clearances, with steps that the bends of
/// the curve set, over folds as well. Where it ends therefore does not depend on the eccentricities that are asked for.
/// Not collective.
class JournalLocus {
public:
  struct Node {
    std::vector<double> states;
    std::array<double, 2> place{};  ///< x, y in clearances
    [[nodiscard]] double eccentricity() const;
    void members(auto& archive) { archive(states, place); }
  };
  enum class End { reached, fold, lost };
  /// `film` outlives this. At `speed` rad/s; `load` [N] is a typical force.
  JournalLocus(film::Film& film, double clearance, double speed, double load);

  /// From `start`, which lies on the curve, to the eccentricity `most`: `reached`. It ends at a `fold` if it turns back
  /// from there for good, and is `lost` where nothing of it is found beyond, or where the film carries no load
  /// downwards.
  void follow(Node start, double most);
  /// The first place on the curve with that eccentricity; nothing where it has none, or begins farther out.
  [[nodiscard]] std::optional<Node> at(double eccentricity);
  /// The farthest place.
  [[nodiscard]] const Node& farthest() const;

  std::vector<Node> nodes;    ///< in the order of the curve, with its folds
  std::vector<double> folds;  ///< eccentricities at which it turns, to 1e-9, one after another
  End end = End::reached;
  std::string why;  ///< lost: what the film said last; may be empty
  void members(auto& archive) { archive(nodes, folds, end, why); }

private:
  using Vector = Eigen::VectorXd;  // scaled states, then x, y in clearances
  struct Point {
    Vector z, tangent;
    int steps;    // of Newton's method
    double lift;  // F_y [N]
  };
  using Closing = std::function<std::pair<Vector, double>(const Vector&)>;
  [[nodiscard]] std::optional<Point> newton(Vector z, const Closing& closing);
  // The point whose share of `direction` is `length` further than that of `from`.
  [[nodiscard]] std::optional<Point> along(const Vector& from, const Vector& direction, double length);
  // The point at that eccentricity, sought from z.
  [[nodiscard]] std::optional<Point> held(Vector z, double eccentricity);
  [[nodiscard]] Eigen::SparseMatrix<double> matrix(const Vector& closing) const;
  [[nodiscard]] Vector pack(const Node& node) const;
  [[nodiscard]] Node unpack(const Vector& z) const;
  [[nodiscard]] static double rise(const Point& p);  // of the eccentricity along the tangent
  // The fold within the step from `from` to where the eccentricity moves the other way.
  [[nodiscard]] Node turn(const Point& from, double step);

  film::Film& film_;
  double clearance_, load_;
  film::JournalMotion motion_;
  std::vector<double> scale_, rows_, rest_;  // typical states and rows, times the root of their number
  film::StateResponse at_;
};

}  // namespace whirl::study
