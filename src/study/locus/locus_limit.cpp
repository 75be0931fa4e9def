// Curves of cycles that keep a quantity instead of a bifurcation.

#include <fmt/core.h>

#include "study/locus/locus_follower.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/brief.hpp"

namespace whirl::study {

std::unique_ptr<solve::Condition> LocusFollower::condition_of(solve::CycleProblem& cycles, system::RotorSystem& system,
                                                              std::complex<double> critical, const FilmFactor& film) {
  if (!options_.limit) return cycles.condition(seed_.event, critical);
  const LimitOptions& limit = *options_.limit;
  // Where a place is depends on the speed in no way, and on other parameters only where more than its travel counts.
  const bool moves = has_place(limit) && (limit.node || limit.quantity == LimitOptions::Quantity::eccentricity);
  const auto place = [this, &limit, &system, film, moves](double change) {
    if (change != 0 && moves && first_.path != "speed")
      return place_of(limit, *make_system(system.parameter() + change, film));
    solve::LinearPlace here = place_of(limit, system);
    if (first_.path == "speed") here.speed += change;
    return here;
  };
  return solve::make_limit(cycles, quantity_of(limit), limit.value.value, place);
}

double LocusFollower::slope_of_limit(Vec whole) {
  const core::Vector u = curve_.problem->branch_part(whole), along = solve::any_tangent(*curve_.cycles, u.get());
  Eigen::MatrixXd none;
  std::vector<core::Vector> gradients;
  curve_.condition->derivatives(u.get(), {}, none, gradients);
  double slope = 0;
  core::check(VecDot(gradients.front().get(), along.get(), &slope));
  return slope / solve::last_entry(curve_.cycles->comm(), along.get());
}

void LocusFollower::watch_peaks(Vec whole, const Row& before) {
  const solve::CycleQuantity quantity = quantity_of(*options_.limit);
  const double depth = 1e-3 * options_.limit->value.value;
  const solve::Cycle path = place_of(*options_.limit, *system_).path(curve_.cycle(whole));
  std::vector<double> times;
  bool jumped = false;
  for (std::size_t k = 0; k < quantity.directions.size(); ++k) {
    const auto peak = solve::peak_of(curve_.cycles->scheme(), path, quantity.directions[k]);
    jumped = jumped ||
             (k < peak_times_.size() &&
              solve::another_peak(curve_.cycles->scheme(), path, quantity.directions[k], peak, peak_times_[k], depth));
    times.push_back(peak.time);
  }
  peak_times_ = std::move(times);
  const std::string& unit = options_.second.range.unit;
  if (jumped)
    context_.results.summary().warnings.push_back(fmt::format(
        "between {} {} and {} {} of {} another peak of the motion becomes the largest: the curve has a kink there",
        io::reading(deck::from_si(before.second, unit)), unit, io::reading(deck::from_si(last_.second, unit)), unit,
        options_.second.path));
}

}  // namespace whirl::study
