// Curves of cyclic folds that end where their cycles shrink to an equilibrium: at a generalised Hopf point.

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "hopf_cycles.hpp"
#include "locus_follower.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {
namespace {

constexpr double least_amplitude = 0.02;  // of a clearance: Newton's method fails not far below
constexpr double apart = 1.5;             // ratio of the amplitudes behind the extrapolation, at least
constexpr int samples = 24;

}  // namespace

// Half the change of the states within half a period, at equidistant times, scaled.
Eigen::MatrixXd LocusFollower::swing(Vec whole) const {
  const solve::Cycle cycle = cycles_->gather(problem_->branch_part(whole).get());
  Eigen::MatrixXd out(cycle.x.rows(), samples);
  for (int k = 0; k < samples; ++k) {
    const double s = 0.5 * k / samples;
    out.col(k) =
        (cycle.at(cycles_->scheme(), s) - cycle.at(cycles_->scheme(), s + 0.5)).cwiseQuotient(cycles_->state_scale()) /
        2;
  }
  return out;
}

double LocusFollower::amplitude_of(const Eigen::MatrixXd& swing) const {
  const solve::MotionSize size = motion_of_places(*system_);
  double most = 0;
  for (Eigen::Index k = 0; k < swing.cols(); ++k) most = std::max(most, size(swing.col(k)));
  return most;
}

// The square of the amplitude over that at which the curve ends, minus one: linear in the parameters near the end.
// Beyond it the same cycles come again half a period later, which counts as a negative square.
double LocusFollower::margin_of_amplitude(Vec whole) const {
  if (!cycles_ || !cycles_->options().autonomous || seed_.event != solve::Event::cyclic_fold)
    return std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd here = swing(whole);
  const double ratio = amplitude_of(here) / least_amplitude;
  const bool beyond = last_swing_.size() > 0 && (here.array() * last_swing_.array()).sum() < 0;
  return (beyond ? -1 : 1) * ratio * ratio - 1;
}

// Folds of cycles of amplitude A lie at p_0 + p_1 A^2 + p_2 A^4 near the generalised Hopf point p_0: from three points
// of the curve; two of them show how much the third one matters.
void LocusFollower::end_at_generalised_hopf(const solve::BranchEnd& end) {
  std::vector<Row> last;
  for (auto row = rows_.rbegin(); row != rows_.rend() && last.size() < 3; ++row)
    if (last.empty() || row->amplitude >= apart * last.back().amplitude) last.push_back(*row);
  const auto at_zero = [&](auto value, std::size_t count) {
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      double weight = 1;
      for (std::size_t j = 0; j < count; ++j) {
        const double a = last[i].amplitude * last[i].amplitude, b = last[j].amplitude * last[j].amplitude;
        if (j != i) weight *= b / (b - a);
      }
      sum += weight * value(last[i]);
    }
    return sum;
  };
  const auto first = [](const Row& r) { return r.first; };
  const auto second = [](const Row& r) { return r.second; };
  const std::size_t count = last.size();
  Row row = last.front();
  row.first = at_zero(first, count);
  row.second = at_zero(second, count);
  row.amplitude = 0;
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  // What the last step of the extrapolation changed, and what the location left.
  const auto error = [&](auto value, double whole) {
    return count < 2 ? unknown : std::abs(whole - at_zero(value, count - 1)) + end.bracket * second_scale_;
  };
  core::agree(context_.comm, [&] {
    second_value_ = row.second;
    system_->set_parameter(row.first);
    system_->set_train(train_at(row.first));
  });
  record_row(generalised_hopf, row, error(second, row.second) / second_scale_);
  auto& c = context_.results.summary().codimension_two.back();
  c.more["uncertainty_parameter"] = error(first, row.first) / deck::number_to_si(1, first_range_.unit);
  c.more["end_of_curve"] = 1;
}

}  // namespace whirl::study
