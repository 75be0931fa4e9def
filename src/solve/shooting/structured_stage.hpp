#pragma once
// Implicit stages of systems that tell their structure.

#include <Eigen/Core>
#include <vector>

#include "solve/shooting/structured_rate.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/core/pivoted_band.hpp"

namespace whirl::solve {

/// (I - own A)^-1 of a RateMatrix A, own = H a(j,j) > 0. The states of a film but its last `reach` are a band,
///
///     [ B   U ] [ s ]     B: films, one band each;  X: coordinates and the last states of the films
///     [ W   V ] [ X ]     U, W: their inputs and forces, and the ends of their rings
///
/// and X follows from V - W B^-1 U. The cost is in proportion to the number of states.
class StructuredStage {
public:
  void factorise(const StructuredRate& rate, const RateMatrix& a, double own);
  /// In place.
  void solve(double* r) const;

private:
  struct Part {
    core::PivotedBand band;
    Eigen::MatrixXd response;  // B^-1 U: of the seen inputs, then of the last states [interior x ...]
    Eigen::MatrixXd forces;    // own P^T [interior x forces]
    Eigen::MatrixXd ends;      // own D^T of the last states' rows [interior x reach]
    Eigen::MatrixXd inputs;    // C of the seen inputs [seen x n]
  };
  const StructuredRate* rate_ = nullptr;
  std::vector<Part> parts_;
  core::DenseLu<double> border_;
  mutable Eigen::VectorXd x_;
};

}  // namespace whirl::solve
