#include <algorithm>
#include <cmath>

#include "film_part.hpp"
#include "settling.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/system/rotor_system.hpp"

// Films that find their state by whole steps of Newton's method while the machine stays where it is.

namespace whirl::system {

using core::check;

bool RotorSystem::settles() const {
  return std::any_of(bearings_.begin(), bearings_.end(), [](const Bearing& b) { return b.part->settles(); });
}

RotorSystem::Settling& RotorSystem::settling() {
  if (settling_) return *settling_;
  (void)film_comms();
  settling_ = std::make_unique<Settling>();
  settling_->comms = film_comms_;
  settling_->rest = core::make_vector(comm_, local_size(), PETSC_DETERMINE);
  for (const std::size_t b :
       FilmComms::in_order(*film_comms_, bearings_, [](const FilmPart& part) { return part.settles(); })) {
    const FilmPart& part = *bearings_[b].part;
    auto inverse = part.film().inverse(film_comms_->of(b), part.share());
    core::require(inverse && inverse->exact() != nullptr, "films that settle by their own exact inverses");
    settling_->films.push_back({b, std::move(inverse), std::vector<double>(static_cast<std::size_t>(part.rows()))});
  }
  return *settling_;
}

// All films at once, each until its own step is small: as film::relax does with one film on one rank.
void RotorSystem::settle(Vec x, bool still) {
  constexpr int most_steps = 60;
  constexpr double enough = 1e-10;  // of the typical state
  Settling& s = settling();
  std::vector<char> found;
  for (const Bearing& b : bearings_) found.push_back(!b.part->settles());
  for (int k = 0; k < most_steps; ++k) {
    FilmInputs in = film_inputs(x, s.rest.get());
    for (JournalState& j : in.journals)
      if (still) j.velocity = j.tilt_rate = {};
    core::agree(comm_, [&] {
      for (const Settling::Film& f : s.films)
        if (!found[f.bearing]) evaluate(f.bearing, *bearings_[f.bearing].part, in, film::Need::tangents);
    });
    std::vector<double> moved(bearings_.size(), 0.0);
    for (Settling::Film& film : s.films) {
      if (found[film.bearing]) continue;
      const FilmPart& part = *bearings_[film.bearing].part;
      const film::StateResponse& own = part.response();
      film.inverse->set({own.d_states, own.d_rates}, 1, 0);
      film.inverse->apply(own.residual, film.step);
      for (const problem::Field& f : part.fields({}))
        f.each([&](PetscInt j) {
          moved[film.bearing] += std::pow(film.step[static_cast<std::size_t>(j - part.row())] / f.scale, 2);
        });
    }
    MPI_Allreduce(MPI_IN_PLACE, moved.data(), static_cast<int>(moved.size()), MPI_DOUBLE, MPI_SUM, comm_);
    if (!std::all_of(moved.begin(), moved.end(), [](double d) { return std::isfinite(d); }))
      core::agree(comm_, [] { throw core::NotConverged("a film by itself is singular"); });
    {
      const core::WriteArray xa(x);
      for (const Settling::Film& film : s.films)
        for (std::size_t j = 0; !found[film.bearing] && j < film.step.size(); ++j)
          xa[bearings_[film.bearing].part->row() + static_cast<PetscInt>(j)] -= film.step[j];
    }
    for (std::size_t i = 0; i < bearings_.size(); ++i) {
      if (found[i]) continue;
      found[i] = std::sqrt(moved[i]) <= enough * std::sqrt(static_cast<double>(bearings_[i].part->count()));
    }
    if (std::find(found.begin(), found.end(), 0) == found.end()) return;
  }
  core::agree(comm_, [] { throw core::NotConverged("the films by themselves did not settle"); });
}

}  // namespace whirl::system
