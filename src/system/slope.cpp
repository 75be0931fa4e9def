#include "slope.hpp"

#include <algorithm>

#include "change.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"

namespace whirl::system {

RotorSystem::Slope::Slope(RotorSystem& system, const Train& minus, const Train& plus, double step)
    : system_(system), step_(step) {
  const TrainChange change = change_between(minus, plus);
  hub_ = system.hub_->rates(change, minus, plus, step);
  // Of bearings that are aligned to the shaft, the axis moves with it.
  if (change.axes) {
    const auto rate = [step](double a, double b) { return (b - a) / step; };
    const std::vector<std::array<double, 2>> below = system.axes_of(minus), above = system.axes_of(plus);
    for (std::size_t i = 0; i < minus.supports.size(); ++i) {
      const double a = minus.supports[i].elevation, b = plus.supports[i].elevation;
      if (a != b || below[i] != above[i])
        places_.push_back({i, {0, rate(a, b), rate(below[i][0], above[i][0]), rate(below[i][1], above[i][1])}});
    }
  }
  std::vector<std::unique_ptr<FilmPart>> below = system.parts_at(minus, change.films),
                                         above = system.parts_at(plus, change.films);
  for (std::size_t k = 0; k < change.films.size(); ++k)
    films_.push_back({change.films[k], std::move(below[k]), std::move(above[k])});
}

std::vector<RotorSystem::Slope::FilmRate> RotorSystem::Slope::film_rates(const FilmInputs& in) {
  std::vector<FilmRate> out(system_.bearings_.size());
  for (Film& f : films_) {
    if (!f.plus->here()) continue;
    system_.evaluate(f.bearing, *f.minus, in, film::Need::force);
    system_.evaluate(f.bearing, *f.plus, in, film::Need::force);
    const film::StateResponse &below = f.minus->response(), &above = f.plus->response();
    FilmRate& rate = out[f.bearing];
    for (std::size_t d = 0; d < rate.force.size(); ++d)
      rate.force[d] = (above.journal.force[d] - below.journal.force[d]) / step_;
    for (std::size_t k = 0; k < above.residual.size(); ++k)
      rate.residual.push_back((above.residual[k] - below.residual[k]) / step_);
  }
  return out;
}

void RotorSystem::Slope::move(const FilmInputs& in, std::vector<FilmRate>& rates) {
  for (const auto& [b, moves] : places_) {
    FilmPart& part = *system_.bearings_[b].part;
    if (!part.here()) continue;
    system_.evaluate(b, part, in, film::Need::tangents);
    const film::StateResponse& here = part.response();
    rates[b].residual.resize(here.residual.size(), 0.0);
    for (std::size_t port = 0; port < part.ports().size(); ++port) {
      for (std::size_t d = 0; d < here.journal.force.size(); ++d)
        rates[b].force[d] -= moves[port] * here.journal.d_position[d][port];
      for (std::size_t k = 0; k < here.residual.size(); ++k)
        rates[b].residual[k] -=
            moves[port] * here.inputs(static_cast<Eigen::Index>(port), static_cast<Eigen::Index>(k));
    }
  }
}

void RotorSystem::Slope::derivative(double angle, Vec x, Vec xdot, Vec f) {
  RotorSystem& s = system_;
  core::check(VecSet(f, 0.0));
  {
    const core::WriteArray fa(f);
    s.hub_->apply(hub_, s.instant(angle, x, xdot), fa.data());
  }
  if (films_.empty() && places_.empty()) return;

  const FilmInputs in = s.film_inputs(x, xdot);
  std::vector<FilmRate> rates;
  core::agree(s.comm_, [&] {
    rates = film_rates(in);
    move(in, rates);
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
