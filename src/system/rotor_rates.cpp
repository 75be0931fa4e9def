// How the rows of rotor and pedestals change with a parameter other than the speed.

#include "rotor_part.hpp"
#include "whirl/core/error.hpp"

namespace whirl::system {

using core::check;

namespace {

// Unbalance masses whose cosine and sine parts are the rates of those of `minus` and `plus`.
std::vector<UnbalanceMass> rate_of(const std::vector<UnbalanceMass>& minus, const std::vector<UnbalanceMass>& plus,
                                   double step) {
  core::require(minus.size() == plus.size(), "unbalances in the same planes");
  std::vector<UnbalanceMass> out;
  for (std::size_t k = 0; k < minus.size(); ++k) {
    const UnbalanceMass &a = minus[k], &b = plus[k];
    core::require(a.node == b.node && a.phase == b.phase && a.couple == b.couple, "unbalances in the same planes");
    out.push_back({a.node, (b.amount - a.amount) / step, a.phase, a.couple});
  }
  return out;
}

std::vector<StaticLoad> rate_of(const std::vector<StaticLoad>& minus, const std::vector<StaticLoad>& plus,
                                double step) {
  core::require(minus.size() == plus.size(), "loads on the same nodes");
  std::vector<StaticLoad> out = plus;
  for (std::size_t k = 0; k < out.size(); ++k) {
    core::require(minus[k].node == plus[k].node && minus[k].moment.has_value() == plus[k].moment.has_value(),
                  "loads on the same nodes");
    for (std::size_t d = 0; d < 2; ++d) {
      out[k].force[d] = (plus[k].force[d] - minus[k].force[d]) / step;
      if (out[k].moment) (*out[k].moment)[d] = ((*plus[k].moment)[d] - (*minus[k].moment)[d]) / step;
    }
  }
  return out;
}

}  // namespace

RotorPart::Rates RotorPart::rates(const TrainChange& change, const Train& minus, const Train& plus, double step) {
  Rates out;
  const auto rate = [step](double a, double b) { return (b - a) / step; };
  const auto rates_of = [&](const std::vector<double>& a, std::vector<double> b) {
    for (std::size_t i = 0; i < a.size(); ++i) b[i] = rate(a[i], b[i]);
    return b;
  };
  if (change.shaft) {
    const auto below = make_rotor(minus.rotor), above = make_rotor(plus.rotor);
    check_pattern(*above);
    out.rows = HubRows::combined(1 / step, rows_of(*above), -1 / step, rows_of(*below));
    const Unbalances a = unbalance_of(*below, minus.unbalance), b = unbalance_of(*above, plus.unbalance);
    out.unbalance = {rates_of(a.cosine, b.cosine), rates_of(a.sine, b.sine)};
    out.load = rates_of(load_of(*below, weights_of(minus)), load_of(*above, weights_of(plus)));
  } else {
    if (change.load) {
      const Weights a = weights_of(minus), b = weights_of(plus);
      out.load = load_of(*rotor_, {rate(a.gravity, b.gravity), rate(a.gravity_x, b.gravity_x),
                                   rate(a.rotor_load, b.rotor_load), rates_of(a.pedestals_x, b.pedestals_x),
                                   rates_of(a.pedestals, b.pedestals), rate_of(a.loads, b.loads, step)});
    }
    if (change.unbalance) out.unbalance = unbalance_of(*rotor_, rate_of(minus.unbalance, plus.unbalance, step));
    // C = value K
    if (change.damping) {
      const double by = rate(minus.rotor.stiffness_damping, plus.rotor.stiffness_damping);
      std::vector<HubRows::Entry> all;
      for_entries(here(rotor_->matrices().stiffness.get()).get(), [&](PetscInt i, PetscInt j, double k) {
        all.push_back({2 * i, 2 * j + 1, by * k});
      });
      out.rows = HubRows(std::move(all));
    }
  }
  if (change.joints) {
    core::require(speed_.has_value(), "joints at the speed");
    const HubRows joints =
        HubRows::combined(1 / step, joints_of(plus, *speed_, false), -1 / step, joints_of(minus, *speed_, false));
    out.rows = HubRows::combined(1, out.rows.value_or(HubRows()), 1, joints);
  }
  // What elements lack away from their place of rest.
  if (!rest_.empty()) {
    out.load.resize(static_cast<std::size_t>(rows()), 0.0);
    add_rest(train_, rest_rate_, false, 1, out.load);
    if (change.joints) {
      add_rest(plus, rest_, false, 1 / step, out.load);
      add_rest(minus, rest_, false, -1 / step, out.load);
    }
  }
  return out;
}

void RotorPart::apply(const Rates& rates, const Instant& at, double* f) const {
  const auto [c, s] = unbalance_factors(at);
  for (PetscInt i = 0; i < rows(); ++i) {
    const auto at_row = static_cast<std::size_t>(i), all = static_cast<std::size_t>(2 * begin_ + i);
    f[i] = rates.load.empty() ? 0.0 : -rates.load[at_row];
    if (rates.unbalance) f[i] -= c * rates.unbalance->cosine[all] + s * rates.unbalance->sine[all];
  }
  if (rates.rows) rates.rows->add_products(1, at.speed, at.x, at.xdot, f);
}

}  // namespace whirl::system
