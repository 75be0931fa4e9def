// Films of a train: who evaluates what, what they see, and what they add to residual and Jacobian.

#include <algorithm>
#include <limits>

#include "film_part.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

using core::check;

void RotorSystem::scatter_inputs(Vec x) {
  check(VecScatterBegin(gather_inputs_.get(), x, inputs_.get(), INSERT_VALUES, SCATTER_FORWARD));
  check(VecScatterEnd(gather_inputs_.get(), x, inputs_.get(), INSERT_VALUES, SCATTER_FORWARD));
}

std::vector<double> RotorSystem::gather_inputs(Vec x) {
  scatter_inputs(x);
  const core::ReadArray a(inputs_.get());
  return {a.data(), a.data() + a.size()};
}

std::vector<JournalState> RotorSystem::journals_of(std::span<const double> inputs) const {
  std::vector<JournalState> out(bearings_.size());
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    for (std::size_t d = 0; d < 2; ++d) {
      const double* a = inputs.data() + 8 * i + 4 * d;
      const bool moves = bearings_[i].pedestal[d] >= 0;
      out[i].position[d] = a[0] - (moves ? a[2] : 0.0);
      out[i].velocity[d] = a[1] - (moves ? a[3] : 0.0);
    }
    out[i].position[1] -= train_.supports[i].elevation;
  }
  return out;
}

std::vector<JournalState> RotorSystem::journals(const double* x) const {
  std::vector<JournalState> out(bearings_.size());
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    for (std::size_t d = 0; d < 2; ++d) {
      const PetscInt j = bearings_[i].journal[d], p = bearings_[i].pedestal[d];
      out[i].position[d] = x[2 * j] - (p >= 0 ? x[2 * p] : 0.0);
      out[i].velocity[d] = x[2 * j + 1] - (p >= 0 ? x[2 * p + 1] : 0.0);
    }
    out[i].position[1] -= train_.supports[i].elevation;
  }
  return out;
}

film::Motion RotorSystem::motion(const JournalState& journal) const {
  film::Motion motion;
  for (std::size_t d = 0; d < 2; ++d) {
    motion.position[d] = journal.position[d];
    motion.velocity[d] = journal.velocity[d];
  }
  motion.speed = speed_;
  return motion;
}

bool RotorSystem::evaluates(std::size_t bearing) const {
  const Bearing& b = bearings_[bearing];
  if (b.part) return b.part->rows() > 0;
  return static_cast<int>(bearing) % core::size_of(comm_) == core::rank_of(comm_);
}

std::vector<film::Response> RotorSystem::film_responses(const std::vector<JournalState>& journals, film::Need need) {
  core::require(n_own_ == 0, "films with own states need the whole state");
  return films_at(journals, {}, {}, need).journal;
}

std::vector<film::Response> RotorSystem::film_responses(const double* x, film::Need need) {
  std::vector<double> own;
  for (std::size_t k = 8 * bearings_.size(); k < wanted_.size(); ++k) own.push_back(x[wanted_[k]]);
  return films_at(journals(x), own, {}, need).journal;
}

RotorSystem::Films RotorSystem::films_at(Vec x, Vec xdot, film::Need need) {
  const std::vector<double> inputs = gather_inputs(x),
                            rates = n_own_ > 0 ? gather_inputs(xdot) : std::vector<double>(inputs.size());
  const auto own = static_cast<std::ptrdiff_t>(8 * bearings_.size());
  return films_at(journals_of(inputs), {inputs.begin() + own, inputs.end()}, {rates.begin() + own, rates.end()}, need);
}

RotorSystem::Films RotorSystem::films_at(const std::vector<JournalState>& journals, std::span<const double> own,
                                         std::span<const double> rates, film::Need need) {
  Films films;
  films.journal.resize(bearings_.size());
  films.own.resize(bearings_.size());
  const std::vector<double> zero(rates.empty() ? own.size() : 0, 0.0);
  if (rates.empty()) rates = zero;
  core::agree(comm_, [&] {
    for (std::size_t i = 0; i < bearings_.size(); ++i) {
      if (!evaluates(i)) continue;
      const Bearing& b = bearings_[i];
      try {
        if (b.part) {
          b.part->evaluate(motion(journals[i]), own, rates, need, films.own[i]);
          films.journal[i] = films.own[i].journal;
        } else {
          b.film->evaluate(motion(journals[i]), need, films.journal[i]);
        }
      } catch (const core::DomainError& e) {
        throw core::DomainError("bearing " + train_.supports[i].name + ": " + e.what());
      }
    }
  });
  if (core::size_of(comm_) > 1) sum_over_ranks(films.journal);
  return films;
}

// Forces and tangents add up, be it over the parts of a film or because all ranks but one have none; of thicknesses the
// least counts.
void RotorSystem::sum_over_ranks(std::vector<film::Response>& films) const {
  constexpr std::size_t width = 2 + 4 + 4 + 2;
  std::vector<double> flat(width * films.size(), 0.0), thickness(films.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < films.size(); ++i) {
    if (!evaluates(i)) continue;
    double* f = flat.data() + width * i;
    for (std::size_t d = 0; d < 2; ++d) {
      f[d] = films[i].force[d];
      for (std::size_t e = 0; e < 2; ++e) {
        f[2 + 2 * d + e] = films[i].d_position[d][e];
        f[6 + 2 * d + e] = films[i].d_velocity[d][e];
      }
      f[10 + d] = films[i].d_speed[d];
    }
    thickness[i] = films[i].min_thickness;
  }
  MPI_Allreduce(MPI_IN_PLACE, flat.data(), static_cast<int>(flat.size()), MPI_DOUBLE, MPI_SUM, comm_);
  MPI_Allreduce(MPI_IN_PLACE, thickness.data(), static_cast<int>(thickness.size()), MPI_DOUBLE, MPI_MIN, comm_);
  for (std::size_t i = 0; i < films.size(); ++i) {
    const double* f = flat.data() + width * i;
    for (std::size_t d = 0; d < 2; ++d) {
      films[i].force[d] = f[d];
      for (std::size_t e = 0; e < 2; ++e) {
        films[i].d_position[d][e] = f[2 + 2 * d + e];
        films[i].d_velocity[d][e] = f[6 + 2 * d + e];
      }
      films[i].d_speed[d] = f[10 + d];
    }
    films[i].min_thickness = thickness[i];
  }
}

void RotorSystem::add_films(Mat j, const Films* films, double alpha, double sigma) const {
  static const film::Response none;
  film_entries_.begin(j);
  for (std::size_t b = 0; b < bearings_.size(); ++b) {
    const film::Response& r = films ? films->journal[b] : none;
    const std::vector<PortEnds>& ports = bearings_[b].ports;
    for (std::size_t d = 0; d < ports.size(); ++d)
      for (const auto& [row, to] : ports[d]) {
        if (!owns(row)) continue;
        for (std::size_t e = 0; e < ports.size(); ++e)
          for (const auto& [column, side] : ports[e]) {
            film_entries_.add(2 * row, 2 * column, -alpha * to * side * r.d_position[d][e]);
            film_entries_.add(2 * row, 2 * column + 1, -alpha * to * side * r.d_velocity[d][e]);
          }
      }
    if (const FilmPart* part = bearings_[b].part.get(); part && part->rows() > 0)
      part->add(film_entries_, films ? &films->own[b] : nullptr, n_, ports, alpha, sigma);
  }
  film_entries_.end();
}

bool RotorSystem::constant_rates() const {
  return std::all_of(bearings_.begin(), bearings_.end(),
                     [](const Bearing& b) { return !b.part || b.part->film().constant_rates(); });
}

film::Summary RotorSystem::film_summary(int b, const double* x) {
  const auto i = static_cast<std::size_t>(b);
  const Bearing& bearing = bearings_[i];
  const film::Motion at = motion(journals(x)[i]);
  return bearing.part ? bearing.part->film().summary(at, bearing.part->of(x, n_)) : bearing.film->summary(at);
}

std::vector<film::Field> RotorSystem::film_fields(int b, const double* x) {
  const auto i = static_cast<std::size_t>(b);
  const Bearing& bearing = bearings_[i];
  const film::Motion at = motion(journals(x)[i]);
  return bearing.part ? bearing.part->film().fields(at, bearing.part->of(x, n_)) : bearing.film->fields(at);
}

// Every rank relaxes the whole of a film that it holds a share of: a sparse LU of the film per Newton step, on each of
// its ranks at the same time.
void RotorSystem::relax_films(Vec x) {
  const std::vector<JournalState> journals = journals_of(gather_inputs(x));
  core::agree(comm_, [&] {
    const core::WriteArray xa(x);
    for (std::size_t i = 0; i < bearings_.size(); ++i) {
      const FilmPart* part = bearings_[i].part.get();
      if (!part || part->rows() == 0) continue;
      film::Motion at = motion(journals[i]);
      at.velocity = {};
      std::vector<double> states(part->film().states());
      part->film().unloaded(at, states);
      film::relax(part->film(), at, states);
      std::copy_n(states.begin() + part->share().begin, part->rows(), xa.data() + part->row());
    }
  });
}

std::vector<double> RotorSystem::resampled(const Plant& of, const double* x) const {
  const auto& other = dynamic_cast<const RotorSystem&>(of);
  core::require(other.n_ == n_, "systems that differ in more than film meshes");
  std::vector<double> out(x, x + 2 * n_);
  out.resize(static_cast<std::size_t>(size()));
  const std::vector<JournalState> at = journals(x);
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    const FilmPart *to = bearings_[i].part.get(), *from = other.bearings_[i].part.get();
    if (to)
      to->film().resample(motion(at[i]), from->film(), from->of(x, n_),
                          {out.data() + 2 * n_ + to->first(), to->film().states()});
  }
  return out;
}

}  // namespace whirl::system
