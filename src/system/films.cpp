// Films of a train: who evaluates what, what they see, and what they add to residual and Jacobian.

#include <algorithm>
#include <limits>

#include "film_part.hpp"
#include "rotor_part.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

using core::check;

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

}  // namespace

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
  const double* next = inputs.data();
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    std::array<double, 4> place{}, rate{};
    const std::vector<PortEnds>& ports = bearings_[i].part->ports();
    for (std::size_t port = 0; port < ports.size(); ++port)
      for (const auto& [q, side] : ports[port]) {
        place[port] += side * *next++;
        rate[port] += side * *next++;
      }
    const film::JournalMotion seen = motion(i, {place.data(), ports.size()}, {rate.data(), ports.size()});
    for (std::size_t d = 0; d < 2; ++d) {
      out[i].position[d] = seen.position[d];
      out[i].velocity[d] = seen.velocity[d];
      out[i].tilt[d] = seen.position[2 + d];
      out[i].tilt_rate[d] = seen.velocity[2 + d];
    }
  }
  return out;
}

film::JournalMotion RotorSystem::motion(std::size_t bearing, std::span<const double> place,
                                        std::span<const double> rate) const {
  film::JournalMotion motion;
  for (std::size_t k = 0; k < place.size(); ++k) {
    motion.position[k] = place[k];
    motion.velocity[k] = rate[k];
  }
  motion.position[1] -= train_.supports[bearing].elevation;
  for (std::size_t d = 0; d < 2; ++d) motion.position[2 + d] -= axes_[bearing][d];
  motion.speed = speed_;
  return motion;
}

std::vector<JournalState> RotorSystem::journals(const double* x) const {
  std::vector<double> inputs(journal_inputs_);
  for (std::size_t k = 0; k < journal_inputs_; ++k) inputs[k] = x[wanted_[k]];
  return journals_of(inputs);
}

std::vector<PlaceState> RotorSystem::shown(const double* x) const {
  const std::vector<JournalState> all = journals(x);
  return {all.begin(), all.end()};
}

std::vector<PlaceState> RotorSystem::shown_at(Vec x) {
  const std::vector<JournalState> all = journals_of(gather_inputs(x));
  return {all.begin(), all.end()};
}

film::JournalMotion RotorSystem::motion(const JournalState& journal) const {
  film::JournalMotion motion;
  for (std::size_t d = 0; d < 2; ++d) {
    motion.position[d] = journal.position[d];
    motion.velocity[d] = journal.velocity[d];
    motion.position[2 + d] = journal.tilt[d];
    motion.velocity[2 + d] = journal.tilt_rate[d];
  }
  motion.speed = speed_;
  return motion;
}

std::vector<film::Response> RotorSystem::film_responses(const double* x, film::Need need) {
  FilmInputs in{journals(x), {}, {}};
  for (std::size_t k = journal_inputs_; k < wanted_.size(); ++k) in.own.push_back(x[wanted_[k]]);
  in.rates.resize(in.own.size());
  evaluate_films(in, need);
  return responses();
}

RotorSystem::FilmInputs RotorSystem::film_inputs(Vec x, Vec xdot) {
  const std::vector<double> inputs = gather_inputs(x);
  FilmInputs in{journals_of(inputs), {}, {}};
  if (n_own_ == 0) return in;
  const std::vector<double> rates = gather_inputs(xdot);
  const auto own = static_cast<std::ptrdiff_t>(journal_inputs_);
  in.own.assign(inputs.begin() + own, inputs.end());
  in.rates.assign(rates.begin() + own, rates.end());
  return in;
}

std::vector<film::Response> RotorSystem::responses() const {
  std::vector<film::Response> out;
  for (const Bearing& b : bearings_) out.push_back(b.part->journal());
  return out;
}

void RotorSystem::evaluate_films(Vec x, Vec xdot, film::Need need) {
  evaluate_films(film_inputs(x, xdot), need);
}

void RotorSystem::evaluate(std::size_t bearing, FilmPart& part, const FilmInputs& in, film::Need need) const {
  at_bearing(bearing, [&] { part.evaluate(motion(in.journals[bearing]), in.own, in.rates, need); });
}

void RotorSystem::evaluate_films(const FilmInputs& in, film::Need need) {
  core::agree(comm_, [&] {
    for (std::size_t i = 0; i < bearings_.size(); ++i) {
      FilmPart& part = *bearings_[i].part;
      if (!part.here()) continue;
      evaluate(i, part, in, need);
    }
  });
  if (core::size_of(comm_) > 1) sum_over_ranks();
}

namespace {

// Calls f(number) for all of a response that add up, of its first k components.
template <class F>
void each(film::Response& r, std::size_t k, F&& f) {
  for (std::size_t d = 0; d < k; ++d) {
    f(r.force[d]);
    for (std::size_t e = 0; e < k; ++e) {
      f(r.d_position[d][e]);
      f(r.d_velocity[d][e]);
    }
    f(r.d_speed[d]);
  }
}

}  // namespace

// Forces and tangents add up, be it over the parts of a film or because all ranks but one have none; of thicknesses the
// least counts.
void RotorSystem::sum_over_ranks() {
  std::vector<double> flat, thickness;
  for (Bearing& b : bearings_) {
    const bool here = b.part->here();
    film::Response own = b.part->response().journal;
    each(own, b.part->ports().size(), [&](double value) { flat.push_back(here ? value : 0.0); });
    thickness.push_back(here ? own.min_thickness : infinite);
  }
  MPI_Allreduce(MPI_IN_PLACE, flat.data(), static_cast<int>(flat.size()), MPI_DOUBLE, MPI_SUM, comm_);
  MPI_Allreduce(MPI_IN_PLACE, thickness.data(), static_cast<int>(thickness.size()), MPI_DOUBLE, MPI_MIN, comm_);
  const double* from = flat.data();
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    film::Response all;
    each(all, bearings_[i].part->ports().size(), [&](double& value) { value = *from++; });
    all.min_thickness = thickness[i];
    bearings_[i].part->take(all);
  }
}

Observed RotorSystem::observe(Vec x) {
  const std::vector<JournalState> journals = journals_of(gather_inputs(x));
  Observed out{{journals.begin(), journals.end()}, std::vector<double>(bearings_.size(), infinite)};
  core::agree(comm_, [&] {
    const core::ReadArray xa(x);
    for (std::size_t i = 0; i < bearings_.size(); ++i) {
      const FilmPart& part = *bearings_[i].part;
      if (part.here())
        out.film_thickness[i] = part.film().least_thickness(
            motion(journals[i]), {xa.data() + part.row(), static_cast<std::size_t>(part.rows())});
    }
  });
  MPI_Allreduce(MPI_IN_PLACE, out.film_thickness.data(), static_cast<int>(bearings_.size()), MPI_DOUBLE, MPI_MIN,
                comm_);
  return out;
}

PetscInt RotorSystem::own_states(int b) const {
  return bearings_[static_cast<std::size_t>(b)].part->count();
}

bool RotorSystem::constant_rates() const {
  return std::all_of(bearings_.begin(), bearings_.end(), [](const Bearing& b) { return b.part->constant_rates(); });
}

std::vector<film::FilmReport> RotorSystem::film_summaries(const double* x) {
  const auto rank = static_cast<std::size_t>(core::rank_of(comm_)),
             size = static_cast<std::size_t>(core::size_of(comm_));
  const std::vector<JournalState> at = journals(x);
  std::vector<film::FilmReport> out(bearings_.size());
  core::agree(comm_, [&] {
    for (std::size_t i = rank; i < out.size(); i += size)
      out[i] = bearings_[i].part->film().summary(motion(at[i]), bearings_[i].part->of(x));
  });
  for (std::size_t i = 0; i < out.size() && size > 1; ++i) {
    film::FilmReport& s = out[i];
    const int from = static_cast<int>(i % size);
    int holes = static_cast<int>(s.hole_flows.size());
    MPI_Bcast(&holes, 1, MPI_INT, from, comm_);
    s.hole_flows.resize(static_cast<std::size_t>(holes));
    for (double* value : {&s.min_thickness, &s.max_pressure, &s.max_temperature, &s.mean_temperature, &s.side_flow,
                          &s.power_loss, &s.inlet_flow, &s.outlet_flow, &s.imbalance, &s.mass_flow, &s.drag_torque})
      MPI_Bcast(value, 1, MPI_DOUBLE, from, comm_);
    MPI_Bcast(s.hole_flows.data(), holes, MPI_DOUBLE, from, comm_);
  }
  return out;
}

std::vector<film::NodalField> RotorSystem::film_fields(int b, const double* x) {
  const auto i = static_cast<std::size_t>(b);
  return bearings_[i].part->film().fields(motion(journals(x)[i]), bearings_[i].part->of(x));
}

// Films that settle do so together, each on its ranks. Of another one every rank relaxes the whole that it holds a
// share of: a sparse LU of the film per Newton step, on each of its ranks at the same time.
void RotorSystem::relax_films(Vec x) {
  const std::vector<JournalState> journals = journals_of(gather_inputs(x));
  core::agree(comm_, [&] {
    const core::WriteArray xa(x);
    for (std::size_t i = 0; i < bearings_.size(); ++i) {
      const FilmPart& part = *bearings_[i].part;
      if (part.rows() == 0) continue;
      film::JournalMotion at = motion(journals[i]);
      at.velocity = {};
      at_bearing(i, [&] {
        const std::vector<double> states = part.settles() ? part.unloaded(at) : part.relaxed(at);
        std::copy_n(states.begin() + part.share().begin, part.rows(), xa.data() + part.row());
      });
    }
  });
  if (settles()) settle(x, true);
}

template <class Wanted>
void RotorSystem::resample_films(const RotorSystem& other, const double* x, double* to, Wanted&& wanted) const {
  core::require(other.n_ == n_, "systems that differ in more than film meshes");
  const std::vector<JournalState> at = journals(x);
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    const FilmPart &here = *bearings_[i].part, &from = *other.bearings_[i].part;
    if (wanted(here))
      here.film().resample(motion(at[i]), from.film(), from.of(x),
                           {to + 2 * n_ + here.first(), static_cast<std::size_t>(here.count())});
  }
}

void RotorSystem::resample(const Plant& of, const double* x, Vec to) const {
  const auto& other = dynamic_cast<const RotorSystem&>(of);
  std::vector<double> all(x, x + 2 * n_);
  all.resize(static_cast<std::size_t>(size()));
  core::agree(comm_, [&] { resample_films(other, x, all.data(), [](const FilmPart& p) { return p.rows() > 0; }); });
  PetscInt begin = 0;
  check(VecGetOwnershipRange(to, &begin, nullptr));
  const core::WriteArray a(to);
  std::copy_n(all.begin() + begin, a.size(), a.data());
}

std::vector<double> RotorSystem::resampled(const Plant& of, const double* x) const {
  std::vector<double> out(x, x + 2 * n_);
  out.resize(static_cast<std::size_t>(size()));
  resample_films(dynamic_cast<const RotorSystem&>(of), x, out.data(), [](const FilmPart&) { return true; });
  return out;
}

}  // namespace whirl::system
