#pragma once
// Films that settle, in time: where their collocation equations hold while the rest of the cycle stays.

#include <memory>
#include <vector>

#include "solve/cycle/own_block.hpp"

namespace whirl::solve {

/// The own states s of films that are linear but for the set of their full nodes, interval by interval.
///
/// With the inputs at the points of an interval of length H and the states at its start given, g(w_j, s(c_j), s'(c_j))
/// = 0 for j = 1..m is one banded system for each film, as an OwnBlock has it. Newton's method on it takes whole steps:
/// each finds the next set of full nodes at all points. A line search would see the stiffness of the oil at every node
/// that becomes full (semi-smooth Newton: Qi and Sun 1993; whole steps on such sets: Hintermueller, Ito, Kunisch 2003).
class FilmMarch {
public:
  /// All outlive this.
  FilmMarch(const Scheme& scheme, problem::BlockStructure& structure, problem::ScaledPoint& point);
  ~FilmMarch();
  /// Moves these states at the nodes `own` [n x m] of an interval of length `length` (s) that begins at `start` [n],
  /// all scaled; returns how far they move at its end. Throws core::DomainError, core::NotConverged. Not collective.
  double interval(double length, const Eigen::VectorXd& start, double* own);

private:
  void step(double length, Eigen::Ref<Eigen::MatrixXd> nodes, double& largest);

  const Scheme& scheme_;
  problem::BlockStructure& structure_;
  problem::ScaledPoint& point_;
  std::vector<std::unique_ptr<OwnBlock>> blocks_;  // null for films that do not settle
  std::vector<problem::PointState> at_;
  std::vector<const problem::PointState*> points_;
  Eigen::MatrixXd rows_;  // [own states x m]
  Eigen::VectorXd value_, slope_, row_, film_;
  Eigen::MatrixXd force_;
};

}  // namespace whirl::solve
