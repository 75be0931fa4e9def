#include "whirl/system/rotor_system.hpp"

#include <algorithm>
#include <cmath>

#include "blocks.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::system {

using core::check;

RotorSystem::RotorSystem(MPI_Comm comm, Train train, double speed)
    : comm_(comm), train_(std::move(train)), speed_(speed) {
  build();
}

RotorSystem::RotorSystem(MPI_Comm comm, Varying varying, double speed)
    : comm_(comm), train_(varying.train(varying.value)), varying_(std::move(varying)), speed_(speed) {
  build();
}

RotorSystem::~RotorSystem() = default;

void RotorSystem::set_train(Train train) {
  train_ = std::move(train);
  build();
}

// Everything that depends on the option is rebuilt on both sides of the parameter, once for all points at one value;
// meshes and masters stay.
RotorSystem::Neighbours& RotorSystem::neighbours() {
  if (!neighbours_.plus) {
    neighbours_.step = 1e-5 * varying_.magnitude;
    const auto at = [&](double p) { return std::make_unique<RotorSystem>(comm_, varying_.train(p), speed_); };
    neighbours_.minus = at(varying_.value - neighbours_.step);
    neighbours_.plus = at(varying_.value + neighbours_.step);
  }
  for (RotorSystem* side : {neighbours_.minus.get(), neighbours_.plus.get()}) side->set_forcing(forcing_);
  return neighbours_;
}

void RotorSystem::set_parameter(double p) {
  if (p == parameter()) return;
  if (!varying_.train) {
    if (!(p > 0)) throw core::DomainError("the speed is not positive");
    speed_ = p;
    return;
  }
  Train train = varying_.train(p);  // may refuse the value, and then nothing has changed
  varying_.value = p;
  set_train(std::move(train));
}

std::vector<JournalState> RotorSystem::journals_of(Vec x) {
  check(VecScatterBegin(gather_inputs_.get(), x, inputs_.get(), INSERT_VALUES, SCATTER_FORWARD));
  check(VecScatterEnd(gather_inputs_.get(), x, inputs_.get(), INSERT_VALUES, SCATTER_FORWARD));
  const core::ReadArray a(inputs_.get());
  std::vector<JournalState> out(bearings_.size());
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    for (std::size_t d = 0; d < 2; ++d) {
      const auto k = static_cast<PetscInt>(8 * i + 4 * d);
      const bool moves = bearings_[i].pedestal[d] >= 0;
      out[i].position[d] = a[k] - (moves ? a[k + 2] : 0.0);
      out[i].velocity[d] = a[k + 1] - (moves ? a[k + 3] : 0.0);
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

int RotorSystem::evaluator(std::size_t bearing) const {
  const int size = core::size_of(comm_);
  return bearings_[bearing].states ? size - 1 : static_cast<int>(bearing) % size;
}

std::vector<film::Response> RotorSystem::film_responses(const std::vector<JournalState>& journals, film::Need need) {
  core::require(n_own_ == 0, "films with own states need the whole state");
  return films_at(journals, nullptr, nullptr, need).journal;
}

std::vector<film::Response> RotorSystem::film_responses(const double* x, film::Need need) {
  return films_at(journals(x), x + 2 * n_, nullptr, need).journal;
}

RotorSystem::Films RotorSystem::films_at(Vec x, Vec xdot, film::Need need) {
  const std::vector<JournalState> journals = journals_of(x);
  const core::ReadArray xa(x), da(xdot);
  const PetscInt own = 2 * (end_ - begin_);
  return films_at(journals, xa.data() + own, da.data() + own, need);
}

RotorSystem::Films RotorSystem::films_at(const std::vector<JournalState>& journals, const double* own,
                                         const double* rates, film::Need need) {
  const int rank = core::rank_of(comm_), size = core::size_of(comm_);
  Films films;
  std::vector<film::Response>& out = films.journal;
  out.resize(bearings_.size());
  films.own.resize(bearings_.size());
  core::agree(comm_, [&] {
    for (std::size_t i = 0; i < bearings_.size(); ++i) {
      if (evaluator(i) != rank) continue;
      const Bearing& b = bearings_[i];
      try {
        if (b.states) {
          const auto n = static_cast<std::size_t>(b.count);
          const std::vector<double> zero(rates ? 0 : n, 0.0);
          b.states->evaluate(motion(journals[i]), {own + b.first, n}, rates ? std::span(rates + b.first, n) : zero,
                             need, films.own[i]);
          out[i] = films.own[i].journal;
        } else {
          b.film->evaluate(motion(journals[i]), need, out[i]);
        }
      } catch (const core::DomainError& e) {
        throw core::DomainError("bearing " + train_.supports[i].name + ": " + e.what());
      }
    }
  });
  if (size == 1) return films;
  constexpr std::size_t width = 2 + 4 + 4 + 2 + 1;
  std::vector<double> flat(width * out.size(), 0.0);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (evaluator(i) != rank) continue;
    double* f = flat.data() + width * i;
    for (std::size_t d = 0; d < 2; ++d) {
      f[d] = out[i].force[d];
      for (std::size_t e = 0; e < 2; ++e) {
        f[2 + 2 * d + e] = out[i].d_position[d][e];
        f[6 + 2 * d + e] = out[i].d_velocity[d][e];
      }
      f[10 + d] = out[i].d_speed[d];
    }
    f[12] = out[i].min_thickness;
  }
  MPI_Allreduce(MPI_IN_PLACE, flat.data(), static_cast<int>(flat.size()), MPI_DOUBLE, MPI_SUM, comm_);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double* f = flat.data() + width * i;
    for (std::size_t d = 0; d < 2; ++d) {
      out[i].force[d] = f[d];
      for (std::size_t e = 0; e < 2; ++e) {
        out[i].d_position[d][e] = f[2 + 2 * d + e];
        out[i].d_velocity[d][e] = f[6 + 2 * d + e];
      }
      out[i].d_speed[d] = f[10 + d];
    }
    out[i].min_thickness = f[12];
  }
  return films;
}

void RotorSystem::residual(double angle, Vec x, Vec xdot, Vec f) {
  const Films all = films_at(x, xdot, film::Need::force);
  const std::vector<film::Response>& films = all.journal;
  // q, v and their rates as vectors of coordinates, for the matrix products.
  core::Vector q = core::make_vector(comm_, end_ - begin_, n_), v = core::duplicate(q.get()),
               a = core::duplicate(q.get()), sum = core::duplicate(q.get());
  {
    const core::ReadArray xa(x), da(xdot);
    const core::WriteArray qa(q.get()), va(v.get()), aa(a.get());
    for (PetscInt i = 0; i < qa.size(); ++i) {
      qa[i] = xa[2 * i];
      va[i] = xa[2 * i + 1];
      aa[i] = da[2 * i + 1];
    }
  }
  check(MatMult(stiffness_.get(), q.get(), sum.get()));
  check(MatMultAdd(damping_.get(), v.get(), sum.get(), sum.get()));
  check(MatMultAdd(mass_.get(), a.get(), sum.get(), sum.get()));
  check(MatMult(gyroscopic_.get(), v.get(), a.get()));
  check(VecAXPY(sum.get(), speed_, a.get()));
  const core::ReadArray xa(x), da(xdot), sa(sum.get());
  const core::WriteArray fa(f);
  const double force = forcing_ ? speed_ * speed_ : 0.0, c = force * std::cos(angle), s = force * std::sin(angle);
  for (PetscInt i = 0; i < sa.size(); ++i) {
    const auto g = static_cast<std::size_t>(begin_ + i);
    fa[2 * i + 1] = da[2 * i] - xa[2 * i + 1];
    fa[2 * i] = sa[i] - load_[static_cast<std::size_t>(i)] - c * unbalance_c_[g] - s * unbalance_s_[g];
  }
  for (std::size_t b = 0; b < bearings_.size(); ++b)
    for (std::size_t d = 0; d < 2; ++d) {
      const PetscInt j = bearings_[b].journal[d], p = bearings_[b].pedestal[d];
      if (owns(j)) fa[2 * (j - begin_)] -= films[b].force[d];
      if (p >= 0 && owns(p)) fa[2 * (p - begin_)] += films[b].force[d];
    }
  for (std::size_t b = 0; b < bearings_.size() && on_last_; ++b)
    for (PetscInt k = 0; k < bearings_[b].count; ++k)
      fa[2 * (end_ - begin_) + bearings_[b].first + k] = all.own[b].residual[static_cast<std::size_t>(k)];
}

void RotorSystem::jacobian(double /*angle*/, Vec x, Vec xdot, double alpha, double sigma, Mat j) {
  if (!j_at_rest_) make_constant_parts();
  check(MatCopy(j_at_rest_.get(), j, SAME_NONZERO_PATTERN));
  if (alpha != 1) check(MatScale(j, alpha));
  if (alpha != 0) check(MatAXPY(j, alpha * speed_, j_gyroscopic_.get(), SAME_NONZERO_PATTERN));
  if (alpha != 0 || n_own_ > 0) add_films(j, films_at(x, xdot, film::Need::tangents), alpha, sigma);
  if (sigma != 0) check(MatAXPY(j, sigma, j_rates_.get(), SAME_NONZERO_PATTERN));
}

void RotorSystem::add_films(Mat j, const Films& all, double alpha, double sigma) const {
  const std::vector<film::Response>& films = all.journal;
  for (std::size_t b = 0; b < bearings_.size(); ++b)
    for (std::size_t d = 0; d < 2; ++d)
      for (const auto& [row, sign] :
           {std::pair{bearings_[b].journal[d], -1.0}, std::pair{bearings_[b].pedestal[d], 1.0}}) {
        if (row < 0 || !owns(row)) continue;
        for (std::size_t e = 0; e < 2; ++e)
          for (const auto& [column, side] :
               {std::pair{bearings_[b].journal[e], 1.0}, std::pair{bearings_[b].pedestal[e], -1.0}}) {
            if (column < 0) continue;
            check(MatSetValue(j, 2 * row, 2 * column, alpha * sign * side * films[b].d_position[d][e], ADD_VALUES));
            check(MatSetValue(j, 2 * row, 2 * column + 1, alpha * sign * side * films[b].d_velocity[d][e], ADD_VALUES));
          }
      }
  for (std::size_t b = 0; b < bearings_.size() && on_last_; ++b) {
    const Bearing& bearing = bearings_[b];
    const film::StateResponse& own = all.own[b];
    const PetscInt first = 2 * n_ + bearing.first;
    for (const film::Entry& e : own.d_states)
      check(MatSetValue(j, first + e.row, first + e.column, alpha * e.value, ADD_VALUES));
    for (const film::Entry& e : own.d_rates)
      check(MatSetValue(j, first + e.row, first + e.column, sigma * e.value, ADD_VALUES));
    for (std::size_t d = 0; d < 2; ++d)
      for (const auto& [q, side] : {std::pair{bearing.journal[d], 1.0}, std::pair{bearing.pedestal[d], -1.0}})
        for (PetscInt k = 0; k < bearing.count && q >= 0; ++k) {
          const auto state = static_cast<std::size_t>(k);
          const PetscInt row = first + k;
          check(MatSetValue(j, row, 2 * q, alpha * side * own.d_position[state][d], ADD_VALUES));
          check(MatSetValue(j, row, 2 * q + 1, alpha * side * own.d_velocity[state][d], ADD_VALUES));
          check(MatSetValue(j, 2 * q, row, -alpha * side * own.force_d_states[state][d], ADD_VALUES));
        }
  }
  check(MatAssemblyBegin(j, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(j, MAT_FINAL_ASSEMBLY));
}

void RotorSystem::parameter_derivative(double angle, Vec x, Vec xdot, Vec f) {
  if (varying_.train) {
    const Neighbours& at = neighbours();
    core::Vector minus = core::duplicate(f);
    at.plus->residual(angle, x, xdot, f);
    at.minus->residual(angle, x, xdot, minus.get());
    check(VecAXPBY(f, -1 / (2 * at.step), 1 / (2 * at.step), minus.get()));
    return;
  }
  const Films all = films_at(x, xdot, film::Need::tangents);
  const std::vector<film::Response>& films = all.journal;
  core::Vector v = core::make_vector(comm_, end_ - begin_, n_), sum = core::duplicate(v.get());
  {
    const core::ReadArray xa(x);
    const core::WriteArray va(v.get());
    for (PetscInt i = 0; i < va.size(); ++i) va[i] = xa[2 * i + 1];
  }
  check(MatMult(gyroscopic_.get(), v.get(), sum.get()));
  const core::ReadArray sa(sum.get());
  const core::WriteArray fa(f);
  const double force = forcing_ ? 2 * speed_ : 0.0, c = force * std::cos(angle), s = force * std::sin(angle);
  for (PetscInt i = 0; i < sa.size(); ++i) {
    const auto g = static_cast<std::size_t>(begin_ + i);
    fa[2 * i + 1] = 0;
    fa[2 * i] = sa[i] - c * unbalance_c_[g] - s * unbalance_s_[g];
  }
  for (std::size_t b = 0; b < bearings_.size(); ++b)
    for (std::size_t d = 0; d < 2; ++d) {
      const PetscInt j = bearings_[b].journal[d], p = bearings_[b].pedestal[d];
      if (owns(j)) fa[2 * (j - begin_)] -= films[b].d_speed[d];
      if (p >= 0 && owns(p)) fa[2 * (p - begin_)] += films[b].d_speed[d];
    }
  for (std::size_t b = 0; b < bearings_.size() && on_last_; ++b)
    for (PetscInt k = 0; k < bearings_[b].count; ++k)
      fa[2 * (end_ - begin_) + bearings_[b].first + k] = all.own[b].d_speed[static_cast<std::size_t>(k)];
}

// Displacements are measured in clearances, rates in clearances times a typical whirl frequency, forces in parts of the
// weight.
void RotorSystem::scales(Vec state_scale, Vec residual_scale) {
  double clearance = 0;
  int films = 0;
  for (const Support& s : train_.supports)
    if (s.geometry.clearance > 0) {
      clearance += s.geometry.clearance;
      ++films;
    }
  clearance = films > 0 ? clearance / films : 1e-4;
  constexpr double frequency = 300;  // rad/s
  const double mass = rotor::total_mass(train_.rotor),
               force = std::max(mass * std::abs(train_.gravity) + std::abs(train_.rotor.load),
                                mass * clearance * frequency * frequency) /
                       std::max<double>(1.0, static_cast<double>(bearings_.size()));
  const bool reduced = static_cast<bool>(rotor_->matrices().basis);
  const auto masters = static_cast<PetscInt>(2 * train_.rotor.reduction.masters.size());
  const core::WriteArray s(state_scale), r(residual_scale);
  for (PetscInt i = 0; i < end_ - begin_; ++i) {
    const PetscInt g = begin_ + i;
    double length = clearance, load = force;
    if (g < n_rotor_ && !reduced && g % 4 > 1)
      load = force * 0.1;                           // slopes: clearance per metre, moments on a lever of 0.1 m
    if (g < n_rotor_ && reduced && g >= masters) {  // mass-normalised modes
      length = clearance * std::sqrt(mass);
      load = force / std::sqrt(mass);
    }
    s[2 * i] = length;
    s[2 * i + 1] = length * frequency;
    r[2 * i + 1] = length * frequency;
    r[2 * i] = load;
  }
  for (const Bearing& b : bearings_)
    for (PetscInt k = 0; k < b.count && on_last_; ++k) {
      const PetscInt i = 2 * (end_ - begin_) + b.first + k;
      s[i] = b.states->state_scale();
      r[i] = s[i] * frequency;
    }
}

film::Summary RotorSystem::film_summary(int b, const double* x) {
  const auto i = static_cast<std::size_t>(b);
  const Bearing& bearing = bearings_[i];
  const film::Motion at = motion(journals(x)[i]);
  if (!bearing.states) return bearing.film->summary(at);
  return bearing.states->summary(at, {x + 2 * n_ + bearing.first, bearing.states->states()});
}

std::vector<film::Field> RotorSystem::film_fields(int b, const double* x) {
  const auto i = static_cast<std::size_t>(b);
  const Bearing& bearing = bearings_[i];
  const film::Motion at = motion(journals(x)[i]);
  if (!bearing.states) return bearing.film->fields(at);
  return bearing.states->fields(at, {x + 2 * n_ + bearing.first, bearing.states->states()});
}

film::Coefficients RotorSystem::film_coefficients(int b, const double* x, double omega) {
  const auto i = static_cast<std::size_t>(b);
  const Bearing& bearing = bearings_[i];
  const film::Motion at = motion(journals(x)[i]);
  if (bearing.states)
    return film::coefficients(*bearing.states, at, {x + 2 * n_ + bearing.first, bearing.states->states()}, omega);
  film::Response response;
  bearing.film->evaluate(at, film::Need::tangents, response);
  film::Coefficients out;
  for (std::size_t d = 0; d < 2; ++d)
    for (std::size_t e = 0; e < 2; ++e) {
      out.stiffness[2 * d + e] = -response.d_position[d][e];
      out.damping[2 * d + e] = -response.d_velocity[d][e];
    }
  return out;
}

void RotorSystem::relax_films(Vec x) {
  const std::vector<JournalState> journals = journals_of(x);
  core::agree(comm_, [&] {
    const core::WriteArray xa(x);
    for (std::size_t i = 0; i < bearings_.size() && on_last_; ++i) {
      const Bearing& b = bearings_[i];
      if (!b.states) continue;
      film::Motion still = motion(journals[i]);
      still.velocity = {};
      std::vector<double> states(b.states->states());
      b.states->unloaded(still, states);
      film::relax(*b.states, still, states);
      for (PetscInt k = 0; k < b.count; ++k)
        xa[2 * (end_ - begin_) + b.first + k] = states[static_cast<std::size_t>(k)];
    }
  });
}

std::vector<double> RotorSystem::resampled(const RotorSystem& other, const double* x) const {
  core::require(other.n_ == n_, "systems that differ in more than film meshes");
  std::vector<double> out(x, x + 2 * n_);
  out.resize(static_cast<std::size_t>(size()));
  const std::vector<JournalState> at = journals(x);
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    const Bearing &to = bearings_[i], &from = other.bearings_[i];
    if (to.states)
      to.states->resample(motion(at[i]), {x + 2 * n_ + from.first, static_cast<std::size_t>(from.count)},
                          {out.data() + 2 * n_ + to.first, static_cast<std::size_t>(to.count)});
  }
  return out;
}

problem::Structure* RotorSystem::structure() {
  if (core::size_of(comm_) != 1) return nullptr;
  if (!blocks_) blocks_ = std::make_unique<Blocks>(*this);
  return blocks_.get();
}

std::vector<double> RotorSystem::gather(Vec x) const {
  return core::gather(x);
}

std::vector<double> RotorSystem::shaft(const double* x, int component, bool with_gravity) const {
  const rotor::Matrices& m = rotor_->matrices();
  if (!m.basis) {
    std::vector<double> out(static_cast<std::size_t>(n_rotor_));
    for (PetscInt i = 0; i < n_rotor_; ++i) out[static_cast<std::size_t>(i)] = x[2 * i + component];
    out.resize(static_cast<std::size_t>(4 * rotor_->n_nodes()), 0.0);  // a rigid rotor does not tilt
    return out;
  }
  core::Vector q, full;
  check(MatCreateVecs(m.basis.get(), q.put(), full.put()));
  {
    PetscInt begin = 0;
    check(VecGetOwnershipRange(q.get(), &begin, nullptr));
    const core::WriteArray qa(q.get());
    for (PetscInt i = 0; i < qa.size(); ++i) qa[i] = x[2 * (begin + i) + component];
  }
  check(MatMult(m.basis.get(), q.get(), full.get()));
  if (with_gravity && m.offset) check(VecAXPY(full.get(), train_.gravity, m.offset.get()));
  return core::gather(full.get());
}

}  // namespace whirl::system
