// Curves of cyclic folds that end where their cycles shrink to an equilibrium: at a generalised Hopf point.

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/equilibrium/hopf_cycles.hpp"
#include "study/locus/amplitude_fit.hpp"
#include "study/locus/locus_follower.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {
namespace {

constexpr double least_amplitude = 0.02;  // of a clearance: Newton's method fails not far below
constexpr double small = 0.07;            // of a clearance: up to here a point says where the curve ends
constexpr std::size_t few = 5;            // points that say so, at least
constexpr int samples = 24;

}  // namespace

// Half the change of the states within half a period, at equidistant times, scaled.
Eigen::MatrixXd LocusFollower::swing(Vec whole) const {
  const solve::Cycle cycle = curve_.cycle(whole);
  Eigen::MatrixXd out(cycle.x.rows(), samples);
  for (int k = 0; k < samples; ++k) {
    const double s = 0.5 * k / samples;
    out.col(k) = (cycle.at(curve_.cycles->scheme(), s) - cycle.at(curve_.cycles->scheme(), s + 0.5))
                     .cwiseQuotient(curve_.cycles->state_scale()) /
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
  if (!curve_.autonomous() || seed_.event != solve::Event::cyclic_fold) return std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd here = swing(whole);
  const double ratio = amplitude_of(here) / least_amplitude;
  const bool beyond = last_swing_.size() > 0 && (here.array() * last_swing_.array()).sum() < 0;
  return (beyond ? -1 : 1) * ratio * ratio - 1;
}

// Cycles up to `small` clearances, or the smallest few: back from the end of the curve, and beyond its start on the
// other way, as long as they grow.
std::vector<Row> LocusFollower::smallest_cycles() const {
  std::vector<Row> back(rows_.rbegin(), rows_.rend()), out;
  back.push_back(start_);
  back.insert(back.end(), done_.begin(), done_.end());
  for (const Row& row : back) {
    if (!out.empty() && row.amplitude <= out.back().amplitude) break;
    if (row.amplitude > small && out.size() >= few) break;
    out.push_back(row);
  }
  return out;
}

// Folds of cycles of amplitude A lie at p_0 + p_1 A^2 + p_2 A^4 near the generalised Hopf point p_0. False if too few
// of them are known to say where.
bool LocusFollower::end_at_generalised_hopf() {
  const std::vector<Row> rows = smallest_cycles();
  if (rows.size() < 2) return false;
  std::vector<double> amplitudes, firsts, seconds;
  for (const Row& r : rows) {
    amplitudes.push_back(r.amplitude);
    firsts.push_back(r.first);
    seconds.push_back(r.second);
  }
  const AtZeroAmplitude first = at_zero_amplitude(amplitudes, firsts), second = at_zero_amplitude(amplitudes, seconds);
  Row row = rows.front();
  row.first = first.value;
  row.second = second.value;
  row.amplitude = 0;
  core::agree(context_.comm, [&] {
    second_value_ = row.second;
    system_->set_parameter(row.first);
    system_->set_train(train_at(row.first));
  });
  record_row(generalised_hopf, row, second.bar / second_scale_);
  auto& c = context_.results.summary().codimension_two.back();
  c.more["value_uncertainty"] = first.bar / deck::number_to_si(1, first_range_.unit);
  c.more["end_of_curve"] = 1;
  return true;
}

}  // namespace whirl::study
