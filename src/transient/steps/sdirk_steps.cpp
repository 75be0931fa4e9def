#include "transient/steps/sdirk_steps.hpp"

#include <algorithm>
#include <cmath>

#include "transient/steps/stages.hpp"
#include "whirl/core/local_part.hpp"

namespace whirl::transient {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double rounding_part = 1e-13;  // of the states' scale: no change is smaller
constexpr int most_changes = 10;
constexpr double slow_ratio = 0.3;  // convergence that pays for new tangents
// Of one stage. Where a film's equations have a kink, as that of an orifice between sonic and still gas has, factors
// from one side of it may not serve on the other.
constexpr int most_renewals = 4;
constexpr std::size_t most_nodes = 5;

}  // namespace

SdirkSteps::SdirkSteps(Equations& equations, const solve::Tableau& tableau, double tolerance, double newton)
    : equations_(equations),
      tableau_(tableau),
      tolerance_(tolerance),
      newton_(newton),
      estimate_(tableau.b - embedded_weights(tableau)),
      continuous_(continuous_weights(tableau)),
      stage_(equations.make_stage()) {
  const auto n = static_cast<Index>(equations.system().local_size());
  for (VectorXd* v : {&start_, &weights_, &known_, &value_, &slope_, &f_, &change_, &end_}) v->resize(n);
  slopes_.resize(n, tableau.stages());
  before_.resize(n, tableau.stages());
}

void SdirkSteps::forget() {
  length_ = length_before_ = 0;
  has_tangents_ = careful_ = false;
  rate_ = 1;
  stage_ = equations_.make_stage();
}

// By the polynomial through the slopes that lie nearest in time, of this step and of the last one.
void SdirkSteps::predict(Index i, double length) {
  nodes_.clear();
  const double wanted = tableau_.c(i);
  const auto add = [&](double at, const double* slope) {
    const auto farther = [&](double d, const Node& n) { return d < std::abs(n.at - wanted); };
    nodes_.insert(std::upper_bound(nodes_.begin(), nodes_.end(), std::abs(at - wanted), farther), {at, slope});
  };
  for (Index j = 0; j < i; ++j) add(tableau_.c(j), slopes_.col(j).data());
  for (Index j = 0; length_before_ > 0 && j < tableau_.stages(); ++j)
    add((tableau_.c(j) - 1) * length_before_ / length, before_.col(j).data());
  if (nodes_.size() > most_nodes) nodes_.erase(nodes_.begin() + most_nodes, nodes_.end());
  slope_.setZero();
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    double weight = 1;
    for (std::size_t l = 0; l < nodes_.size(); ++l)
      if (l != k) weight *= (wanted - nodes_[l].at) / (nodes_[k].at - nodes_[l].at);
    slope_ += weight * Eigen::Map<const VectorXd>(nodes_[k].slope, slope_.size());
  }
}

bool SdirkSteps::solve_stage(Index i, double time, double length) {
  const double own = length * tableau_.a(i, i), at = time + length * tableau_.c(i);
  const bool cheap = equations_.stages().derivative_is_free();
  const double tolerance = equations_.thin() ? 1 : equations_.tolerance();
  known_ = start_;
  if (i > 0) known_.noalias() += length * (slopes_.leftCols(i) * tableau_.a.row(i).head(i).transpose());
  predict(i, length);
  value_ = known_ + own * slope_;
  equations_.turn(at);
  // After a failure by Newton's method itself, with a matrix of its own for each change.
  const bool careful = careful_ && !cheap;
  // Of the same step in time and speed as the matrix, or nearly so.
  const solve::StepOf here{own, equations_.system().parameter()};
  bool renew = cheap || careful || !has_tangents_ || !stage_->factors(made_).is_near(here);
  int renewals = 0;
  double last = 0, rate = std::pow(std::max(rate_, 1e-4), 0.8);
  for (int k = 0; k < most_changes; ++k) {
    equations_.residual(*stage_, at, value_, slope_, f_, renew);
    if (renew) {
      equations_.factorise(*stage_, own, value_, slope_);
      made_ = here;
      has_tangents_ = true;
      ++renewals;
      renew = false;
      last = 0;
    }
    stage_->solve(f_, tolerance);  // now the change of the slope
    slope_ -= f_;
    value_.noalias() -= own * f_;
    const double moved = own * norm(f_);
    if (!std::isfinite(moved)) return false;
    const bool rounding = moved * tolerance_ < rounding_part;
    if (last > 0 && !rounding) {
      const double ratio = moved / last;
      if (ratio >= 1) {
        if (renewals > (cheap ? 0 : most_renewals - 1)) return false;
        renew = true;
        if (renewals > 0) continue;
        predict(i, length);
        value_ = known_ + own * slope_;
        continue;
      }
      rate = ratio / (1 - ratio);
      renew = !cheap && ratio > slow_ratio && renewals < most_renewals;
    }
    last = moved;
    renew = renew || careful;
    // With a contraction q per iteration what is left after a change is q + q^2 + ... = q/(1 - q) of it. The ratio of
    // two changes tells the q of what they consist of, and that of an earlier stage, with other factors, nothing of
    // this one: where the factors are not of this tau and speed, an error along stiff directions shrinks by no more
    // than their mismatch, however small it is among the first changes.
    const double q = stage_->factors(made_).mismatch(here);
    // Careful, the change itself is small enough.
    if (rounding || (careful ? 1 : std::max(rate, q / (1 - q))) * moved <= newton_) {
      rate_ = rate;
      slopes_.col(i) = slope_;
      return true;
    }
  }
  return false;
}

std::optional<double> SdirkSteps::attempt(double time, double length) {
  weights_ = (tolerance_ * (1 + start_.array().abs())).inverse();
  for (Index i = 0; i < tableau_.stages(); ++i) {
    if (!solve_stage(i, time, length)) {
      careful_ = true;
      rate_ = 1;
      has_tangents_ = false;
      return std::nullopt;
    }
  }
  end_ = value_;
  weights_ = (tolerance_ * (1 + start_.array().abs().max(end_.array().abs()))).inverse();
  change_.noalias() = length * (slopes_ * estimate_);
  return norm(change_);
}

Taken SdirkSteps::step(double time, double wanted, Vec u) {
  core::get(u, start_);
  const Taken taken = take_step(wanted, tableau_.order, [&](double h) { return attempt(time, h); });
  careful_ = false;
  time_ = time;
  length_ = length_before_ = taken.length;
  before_ = slopes_;
  core::put(end_, u);
  return taken;
}

void SdirkSteps::interpolate(double time, Vec u) {
  const double part = (time - time_) / length_;
  VectorXd weights = VectorXd::Zero(tableau_.stages());
  for (Index p = continuous_.cols() - 1; p >= 0; --p) weights = part * (weights + continuous_.col(p));
  core::put(start_ + length_ * (before_ * weights), u);
}

}  // namespace whirl::transient
