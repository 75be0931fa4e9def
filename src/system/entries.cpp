// The Jacobian entry by entry: what hub and films add to it.

#include "film_part.hpp"
#include "rotor_part.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

using core::check;

const HubRows& RotorSystem::hub_rows() const {
  return lossy_ ? *lossy_ : hub_->linear();
}

template <class Entries>
void RotorSystem::list(Entries& out, bool films, double alpha, double sigma) const {
  for (const HubRows::Entry& e : hub_rows().entries())
    out.add(e.row, e.column, alpha * (e.at_rest + speed_ * e.turning) + sigma * e.rates);
  static const film::Response none;
  for (const Bearing& b : bearings_) {
    const film::Response& r = films ? b.part->journal() : none;
    const std::vector<PortEnds>& ports = b.part->ports();
    for (std::size_t d = 0; d < ports.size(); ++d)
      for (const auto& [row, to] : ports[d]) {
        if (!hub_->owns(row)) continue;
        for (std::size_t e = 0; e < ports.size(); ++e)
          for (const auto& [column, side] : ports[e]) {
            out.add(2 * row, 2 * column, -alpha * to * side * r.d_position[d][e]);
            out.add(2 * row, 2 * column + 1, -alpha * to * side * r.d_velocity[d][e]);
          }
      }
    b.part->add(out, films, alpha, sigma);
  }
}

core::Matrix RotorSystem::make_jacobian() {
  if (!pattern_) {
    problem::Entries places;
    places.begin();
    list(places, false, 0, 0);
    pattern_ = places.matrix(comm_, local_size());
  }
  core::Matrix j;
  check(MatDuplicate(pattern_.get(), MAT_DO_NOT_COPY_VALUES, j.put()));
  return j;
}

void RotorSystem::jacobian(double /*angle*/, Vec x, Vec xdot, double alpha, double sigma, Mat j) {
  prepare();
  const bool films = alpha != 0 || n_own_ > 0;
  if (films) evaluate_films(x, xdot, film::Need::tangents);
  check(MatZeroEntries(j));
  stream_.begin(j);
  list(stream_, films, alpha, sigma);
  stream_.end();
}

bool RotorSystem::entries(double /*angle*/, Vec x, Vec xdot, double alpha, double sigma, problem::Entries& out) {
  prepare();
  evaluate_films(x, xdot, film::Need::tangents);
  out.begin();
  list(out, true, alpha, sigma);
  return true;
}

}  // namespace whirl::system
