#include "whirl/system/rotor_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "blocks.hpp"
#include "film_part.hpp"
#include "settling.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/system/start.hpp"

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

// The centre of unbalance moves along (cos, sin)(angle): its acceleration has a part towards the axis and one along the
// turn.
std::array<double, 2> RotorSystem::unbalance_factors(double angle) const {
  if (!forcing_) return {};
  const double c = std::cos(angle), s = std::sin(angle), inward = speed_ * speed_;
  return {inward * c + acceleration_ * s, inward * s - acceleration_ * c};
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
  const auto [c, s] = unbalance_factors(angle);
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
  for (std::size_t b = 0; b < bearings_.size(); ++b)
    if (const FilmPart* part = bearings_[b].part.get())
      std::copy_n(all.own[b].residual.begin(), part->rows(), fa.data() + part->row());
}

void RotorSystem::jacobian(double /*angle*/, Vec x, Vec xdot, double alpha, double sigma, Mat j) {
  if (!j_at_rest_) make_constant_parts();
  check(MatCopy(j_at_rest_.get(), j, SAME_NONZERO_PATTERN));
  if (alpha != 1) check(MatScale(j, alpha));
  if (alpha != 0) check(MatAXPY(j, alpha * speed_, j_gyroscopic_.get(), SAME_NONZERO_PATTERN));
  if (alpha != 0 || n_own_ > 0) {
    const Films films = films_at(x, xdot, film::Need::tangents);
    add_films(j, &films, alpha, sigma);
  }
  if (sigma != 0) check(MatAXPY(j, sigma, j_rates_.get(), SAME_NONZERO_PATTERN));
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
  for (std::size_t b = 0; b < bearings_.size(); ++b)
    if (const FilmPart* part = bearings_[b].part.get())
      std::copy_n(all.own[b].d_speed.begin(), part->rows(), fa.data() + part->row());
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
  for (const problem::Field& f : fields())
    for (PetscInt i = f.begin; f.scale > 0 && i < f.end; ++i) {
      s[i] = f.scale;
      r[i] = s[i] * frequency;
    }
}

std::vector<problem::Field> RotorSystem::fields() const {
  std::vector<problem::Field> out{{"machine", 0, 2 * (end_ - begin_)}};
  for (std::size_t i = 0; i < bearings_.size(); ++i)
    if (const FilmPart* part = bearings_[i].part.get())
      for (problem::Field& f : part->fields(train_.supports[i].name)) out.push_back(std::move(f));
  return out;
}

problem::Structure* RotorSystem::structure() {
  if (core::size_of(comm_) != 1) return nullptr;
  if (!blocks_) blocks_ = std::make_unique<Blocks>(*this);
  return blocks_.get();
}

Places RotorSystem::places() const {
  Places p{{}, {}, "m", "m/s", "journal relative to the bearing centre"};
  for (const Support& s : train_.supports) {
    p.names.push_back(s.name);
    p.clearances.push_back(s.geometry.clearance);
    p.least_films.push_back(s.minimum_film);
  }
  return p;
}

std::vector<double> RotorSystem::film_thickness(const double* x) const {
  std::vector<double> out(bearings_.size(), std::numeric_limits<double>::infinity());
  const std::vector<JournalState> at = journals(x);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Bearing& b = bearings_[i];
    if (b.part)
      out[i] = b.part->film().least_thickness(motion(at[i]), b.part->of(x, n_));
    else if (!b.film->linear())
      out[i] = film::minimum_thickness(train_.supports[i].geometry, {at[i].position[0], at[i].position[1], 0, 0});
  }
  return out;
}

core::Vector RotorSystem::guess() {
  return static_guess(*this);
}

// Journals of one node share their coordinates.
void RotorSystem::displace(Vec x, const std::array<double, 2>& offset) {
  std::set<PetscInt> moved;
  for (std::size_t b = 0; b < bearings_.size(); ++b)
    for (std::size_t d = 0; d < 2; ++d) {
      const PetscInt q = bearings_[b].journal[d];
      const double by = offset[d] * train_.supports[b].geometry.clearance;
      if (by != 0 && moved.insert(q).second && owns(q)) check(VecSetValue(x, 2 * q, by, ADD_VALUES));
    }
  check(VecAssemblyBegin(x));
  check(VecAssemblyEnd(x));
  if (own_states() > 0 && !moved.empty()) relax_films(x);
}

bool RotorSystem::has_film_mesh() const {
  return std::any_of(train_.supports.begin(), train_.supports.end(),
                     [](const Support& s) { return film::facts(s.film).cells[0] > 0; });
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
