#include "slope.hpp"

#include <algorithm>

#include "change.hpp"
#include "whirl/core/agree.hpp"
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
    core::require(a.node == b.node && a.phase == b.phase, "unbalances in the same planes");
    out.push_back({a.node, (b.amount - a.amount) / step, a.phase});
  }
  return out;
}

}  // namespace

RotorSystem::Slope::Slope(RotorSystem& system, const Train& minus, const Train& plus, double step)
    : system_(system), step_(step) {
  const Change change = change_between(minus, plus);
  const auto rate = [step](double a, double b) { return (b - a) / step; };
  if (change.shaft) {
    const auto below = system.make_rotor(minus.rotor), above = system.make_rotor(plus.rotor);
    take_matrices(*below, *above);
    const Unbalances a = system.unbalance_of(*below, minus.unbalance), b = system.unbalance_of(*above, plus.unbalance);
    unbalance_.emplace();
    for (std::size_t i = 0; i < a.cosine.size(); ++i) {
      unbalance_->cosine.push_back(rate(a.cosine[i], b.cosine[i]));
      unbalance_->sine.push_back(rate(a.sine[i], b.sine[i]));
    }
    load_ = system.load_of(*above, weights_of(plus));
    const std::vector<double> load = system.load_of(*below, weights_of(minus));
    for (std::size_t i = 0; i < load.size(); ++i) load_[i] = rate(load[i], load_[i]);
  } else {
    if (change.load) {
      Weights weights = weights_of(plus);
      const Weights below = weights_of(minus);
      weights.gravity = rate(below.gravity, weights.gravity);
      weights.rotor_load = rate(below.rotor_load, weights.rotor_load);
      for (std::size_t i = 0; i < weights.pedestals.size(); ++i)
        weights.pedestals[i] = rate(below.pedestals[i], weights.pedestals[i]);
      load_ = system.load_of(*system.rotor_, weights);
    }
    if (change.unbalance)
      unbalance_ = system.unbalance_of(*system.rotor_, rate_of(minus.unbalance, plus.unbalance, step));
    // C = value K
    if (change.damping) {
      matrices_ = system.matrices_of(*system.rotor_);
      check(MatCopy(matrices_->stiffness.get(), matrices_->damping.get(), SAME_NONZERO_PATTERN));
      check(MatScale(matrices_->damping.get(), rate(minus.rotor.stiffness_damping, plus.rotor.stiffness_damping)));
      for (const core::Matrix* m : {&matrices_->mass, &matrices_->gyroscopic, &matrices_->stiffness})
        check(MatZeroEntries(m->get()));
    }
  }
  // Of bearings that are aligned to the shaft, the axis moves with it.
  std::vector<std::array<double, 2>> below_axes, above_axes;
  if (change.axes) {
    below_axes = system.axes_of(minus);
    above_axes = system.axes_of(plus);
  }
  for (std::size_t i = 0; i < minus.supports.size(); ++i) {
    const Support &a = minus.supports[i], &b = plus.supports[i];
    if (change.axes && (a.elevation != b.elevation || below_axes[i] != above_axes[i]))
      places_.push_back({i,
                         {0, rate(a.elevation, b.elevation), rate(below_axes[i][0], above_axes[i][0]),
                          rate(below_axes[i][1], above_axes[i][1])}});
    for (std::size_t d = 0; change.pedestals && d < 2; ++d)
      if (const PetscInt row = system.bearings_[i].pedestal[d]; row >= 0 && system.owns(row))
        pedestals_.push_back(
            {row, rate(a.mass[d], b.mass[d]), rate(a.damping[d], b.damping[d]), rate(a.stiffness[d], b.stiffness[d])});
  }
  std::vector<FilmPart> below = system.parts_at(minus, change.films), above = system.parts_at(plus, change.films);
  for (std::size_t k = 0; k < change.films.size(); ++k)
    films_.push_back({change.films[k], std::move(below[k]), std::move(above[k])});
}

void RotorSystem::Slope::take_matrices(const rotor::Rotor& minus, const rotor::Rotor& plus) {
  matrices_ = system_.matrices_of(plus);
  const Matrices below = system_.matrices_of(minus);
  for (const auto& [m, less] :
       {std::pair{&matrices_->mass, &below.mass}, std::pair{&matrices_->damping, &below.damping},
        std::pair{&matrices_->gyroscopic, &below.gyroscopic}, std::pair{&matrices_->stiffness, &below.stiffness}}) {
    check(MatAXPY(m->get(), -1, less->get(), DIFFERENT_NONZERO_PATTERN));
    check(MatScale(m->get(), 1 / step_));
  }
}

template <class Evaluate>
std::vector<RotorSystem::Slope::FilmRate> RotorSystem::Slope::film_rates(const Evaluate& evaluate) const {
  std::vector<FilmRate> out(system_.bearings_.size());
  film::StateResponse below, above;
  for (const Film& f : films_) {
    if (!f.plus.here()) continue;
    evaluate(f.bearing, f.minus, below);
    evaluate(f.bearing, f.plus, above);
    FilmRate& rate = out[f.bearing];
    for (std::size_t d = 0; d < rate.force.size(); ++d)
      rate.force[d] = (above.journal.force[d] - below.journal.force[d]) / step_;
    for (std::size_t k = 0; k < above.residual.size(); ++k)
      rate.residual.push_back((above.residual[k] - below.residual[k]) / step_);
  }
  return out;
}

double RotorSystem::Slope::force_on(PetscInt i, const std::array<double, 2>& factors) const {
  const auto here = static_cast<std::size_t>(i), all = static_cast<std::size_t>(system_.begin_ + i);
  double force = load_.empty() ? 0 : load_[here];
  if (unbalance_) force += factors[0] * unbalance_->cosine[all] + factors[1] * unbalance_->sine[all];
  return force;
}

void RotorSystem::Slope::derivative(double angle, Vec x, Vec xdot, Vec f) const {
  RotorSystem& s = system_;
  check(VecSet(f, 0.0));
  const std::array<double, 2> factors = s.unbalance_factors(angle);
  {
    const core::Vector sum = matrices_ ? s.products(*matrices_, x, xdot) : core::Vector();
    const core::ReadArray xa(x), da(xdot);
    const core::WriteArray fa(f);
    for (PetscInt i = 0; i < s.end_ - s.begin_; ++i) fa[2 * i] = -force_on(i, factors);
    for (const Pedestal& p : pedestals_) {
      const PetscInt i = 2 * (p.row - s.begin_);
      fa[i] += p.mass * da[i + 1] + p.damping * xa[i + 1] + p.stiffness * xa[i];
    }
    if (sum) {
      const core::ReadArray sa(sum.get());
      for (PetscInt i = 0; i < sa.size(); ++i) fa[2 * i] += sa[i];
    }
  }
  if (films_.empty() && places_.empty()) return;

  const FilmInputs in = s.film_inputs(x, xdot);
  std::vector<FilmRate> rates;
  core::agree(s.comm_, [&] {
    rates = film_rates([&](std::size_t b, const FilmPart& part, film::StateResponse& r) {
      s.evaluate(b, part, in, film::Need::force, r);
    });
    film::StateResponse here;
    for (const auto& [b, moves] : places_) {
      const FilmPart& part = *s.bearings_[b].part;
      if (!part.here()) continue;
      s.evaluate(b, part, in, film::Need::tangents, here);
      rates[b].residual.resize(here.residual.size(), 0.0);
      for (std::size_t port = 0; port < s.bearings_[b].ports.size(); ++port) {
        for (std::size_t d = 0; d < here.journal.force.size(); ++d)
          rates[b].force[d] -= moves[port] * here.journal.d_position[d][port];
        for (std::size_t k = 0; k < here.residual.size(); ++k)
          rates[b].residual[k] -= moves[port] * here.d_position[port][k];
      }
    }
  });
  std::vector<std::array<double, 4>> forces;
  for (const FilmRate& r : rates) forces.push_back(r.force);
  MPI_Allreduce(MPI_IN_PLACE, forces.data(), static_cast<int>(4 * forces.size()), MPI_DOUBLE, MPI_SUM, s.comm_);
  const core::WriteArray fa(f);
  s.subtract(forces, fa.data());
  for (std::size_t b = 0; b < rates.size(); ++b)
    std::copy(rates[b].residual.begin(), rates[b].residual.end(), fa.data() + s.bearings_[b].part->row());
}

}  // namespace whirl::system
