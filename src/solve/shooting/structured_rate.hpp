#pragma once
// The rates dz/dt of a system that tells its structure, and their derivatives by the places of its films.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "whirl/problem/scaled_point.hpp"
#include "whirl/problem/system.hpp"

namespace whirl::solve {

/// A = d(dz/dt)/dz at one point, in the places that StructuredRate knows.
using RateMatrix = Eigen::VectorXd;

/// One film: where its arrays stand in a RateMatrix.
struct RateFilm {
  problem::OwnStates at;
  std::vector<Eigen::Index> shifts;   ///< column - row of each diagonal, the shorter way around
  std::vector<Eigen::Index> entries;  ///< of dg/ds: where each belongs, counted from `diagonals`
  Eigen::Index forces = 0, inputs = 0, diagonals = 0, seen = 0;  ///< seen: one for each input that the film sees
  Eigen::Index reach = 0;                                        ///< the largest shift
  Eigen::Index stride = 0;                                       ///< of arrays: count, filled up with zeros
};

/// dz/dt of F(angle, z, dz/dt) = 0 with z = (x, s) in scaled states, for a system on one rank whose dF/d(dx/dt) depends
/// on nothing but the parameter: L1 beside one entry in each row of a film's own states. With these
///
///     d(dz/dt)/dz = [ K     Q P ]     K [n x n], Q = L1^-1 B [n x r], P = df/ds [r x k],
///                   [ E C   D   ]     E = -R^-1 dg/dw [k x w], D = -R^-1 dg/ds: one array per distance of neighbours,
///                                     film by film, counted around the ring of its states
///
/// No sparse matrix is assembled, and a product costs one pass over these arrays. Nothing here communicates.
class StructuredRate {
public:
  /// Null if the system tells no structure of this kind, or if it has many coordinates beside its films' states.
  static std::unique_ptr<StructuredRate> make(problem::System& system);

  [[nodiscard]] Eigen::Index size() const { return point_.size(); }
  /// To be called after each change of the system's parameter.
  void refresh();
  /// dz/dt [n + k] at (angle, z) until the next call, and its derivatives by z and (per SI unit) by the parameter.
  /// Throws core::DomainError.
  const Eigen::VectorXd& evaluate(double angle, const Eigen::Ref<const Eigen::VectorXd>& z, RateMatrix& a,
                                  Eigen::VectorXd& d_parameter);
  /// y = A v [n + k] of an A at the parameter of the last refresh().
  void times(const RateMatrix& a, const double* v, double* y) const;
  [[nodiscard]] Eigen::Index coordinates() const { return n_; }
  [[nodiscard]] const std::vector<RateFilm>& films() const { return films_; }
  /// Q [n x r] and C [w x n], scaled.
  [[nodiscard]] const Eigen::MatrixXd& lead() const { return lead_; }
  [[nodiscard]] const Eigen::MatrixXd& inputs() const { return point_.blocks().c; }
  /// True if films have neighbours so few that implicit stages are solved in bands.
  [[nodiscard]] bool narrow() const;

private:
  explicit StructuredRate(problem::System& system);
  bool find_places();
  void follow_rates();

  problem::ScaledPoint point_;
  const std::vector<problem::OwnStates>& own_;
  Eigen::Index n_;  // coordinates, without own states
  std::vector<RateFilm> films_;
  Eigen::Index values_ = 0, reach_ = 0;
  Eigen::MatrixXd mass_, lead_, linear_;  // L1^-1, Q and -L1^-1 L0
  problem::PointState at_;
  Eigen::VectorXd z_, rate_, f_;
  Eigen::VectorXd inverse_;       // -1/R in scaled states per SI of the residual [k]
  Eigen::MatrixXd inputs_;        // df/dw C
  std::vector<double> rates_;     // R of all films at the last point
  std::vector<double> factors_;   // of all entries of dg/ds: -1/R in scaled states
  mutable Eigen::VectorXd ring_;  // states of a film with their neighbours around the ring
};

}  // namespace whirl::solve
