#include "whirl/system/rotor_system.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "blocks.hpp"
#include "film_part.hpp"
#include "settling.hpp"
#include "slope.hpp"
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

// Where the option ends at p, the difference is one-sided.
const RotorSystem::Slope& RotorSystem::slope() {
  if (slope_) return *slope_;
  const double p = varying_.value, step = 1e-5 * varying_.magnitude;
  const auto beside = [&](double there) -> std::pair<double, Train> {
    try {
      return {there, varying_.train(there)};
    } catch (const core::DomainError&) {
      return {p, train_};
    }
  };
  const auto [below, minus] = beside(p - step);
  const auto [above, plus] = beside(p + step);
  core::require(above > below, "an option may vary on one side of its value");
  slope_ = std::make_unique<Slope>(*this, minus, plus, above - below);
  return *slope_;
}

void RotorSystem::set_parameter(double p) {
  if (p == parameter()) return;
  if (!varying_.train) {
    if (!(p > 0)) throw core::DomainError("the speed is not positive");
    speed_ = p;
    return;
  }
  set_train(varying_.train(p));  // both may refuse the value, and then nothing has changed
  varying_.value = p;
}

// The centre of unbalance moves along (cos, sin)(angle): its acceleration has a part towards the axis and one along the
// turn.
std::array<double, 2> RotorSystem::unbalance_factors(double angle) const {
  if (!forcing_) return {};
  const double c = std::cos(angle), s = std::sin(angle), inward = speed_ * speed_;
  return {inward * c + acceleration_ * s, inward * s - acceleration_ * c};
}

core::Vector RotorSystem::products(const Matrices& m, Vec x, Vec xdot) const {
  // q, v and their rates as vectors of coordinates.
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
  check(MatMult(m.stiffness.get(), q.get(), sum.get()));
  check(MatMultAdd(m.damping.get(), v.get(), sum.get(), sum.get()));
  check(MatMultAdd(m.mass.get(), a.get(), sum.get(), sum.get()));
  check(MatMult(m.gyroscopic.get(), v.get(), a.get()));
  check(VecAXPY(sum.get(), speed_, a.get()));
  return sum;
}

void RotorSystem::subtract(const std::vector<std::array<double, 4>>& forces, double* rows) const {
  for (std::size_t b = 0; b < bearings_.size(); ++b)
    for (std::size_t port = 0; port < bearings_[b].ports.size(); ++port)
      for (const auto& [q, side] : bearings_[b].ports[port])
        if (owns(q)) rows[2 * (q - begin_)] -= side * forces[b][port];
}

void RotorSystem::residual(double angle, Vec x, Vec xdot, Vec f) {
  const Films films = films_at(x, xdot, film::Need::force);
  const core::Vector sum = products(matrices_, x, xdot);
  const core::ReadArray xa(x), da(xdot), sa(sum.get());
  const core::WriteArray fa(f);
  const auto [c, s] = unbalance_factors(angle);
  for (PetscInt i = 0; i < sa.size(); ++i) {
    const auto g = static_cast<std::size_t>(begin_ + i);
    fa[2 * i + 1] = da[2 * i] - xa[2 * i + 1];
    fa[2 * i] = sa[i] - load_[static_cast<std::size_t>(i)] - c * unbalance_.cosine[g] - s * unbalance_.sine[g];
  }
  std::vector<std::array<double, 4>> forces;
  for (const film::Response& r : films.journal) forces.push_back(r.force);
  subtract(forces, fa.data());
  for (std::size_t b = 0; b < bearings_.size(); ++b)
    std::copy(films.own[b].residual.begin(), films.own[b].residual.end(), fa.data() + bearings_[b].part->row());
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
  if (varying_.train) return slope().derivative(angle, x, xdot, f);
  const Films films = films_at(x, xdot, film::Need::tangents);
  core::Vector v = core::make_vector(comm_, end_ - begin_, n_), sum = core::duplicate(v.get());
  {
    const core::ReadArray xa(x);
    const core::WriteArray va(v.get());
    for (PetscInt i = 0; i < va.size(); ++i) va[i] = xa[2 * i + 1];
  }
  check(MatMult(matrices_.gyroscopic.get(), v.get(), sum.get()));
  const core::ReadArray sa(sum.get());
  const core::WriteArray fa(f);
  const double force = forcing_ ? 2 * speed_ : 0.0, c = force * std::cos(angle), s = force * std::sin(angle);
  for (PetscInt i = 0; i < sa.size(); ++i) {
    const auto g = static_cast<std::size_t>(begin_ + i);
    fa[2 * i + 1] = 0;
    fa[2 * i] = sa[i] - c * unbalance_.cosine[g] - s * unbalance_.sine[g];
  }
  std::vector<std::array<double, 4>> forces;
  for (const film::Response& r : films.journal) forces.push_back(r.d_speed);
  subtract(forces, fa.data());
  for (std::size_t b = 0; b < bearings_.size(); ++b)
    std::copy(films.own[b].d_speed.begin(), films.own[b].d_speed.end(), fa.data() + bearings_[b].part->row());
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
  const core::WriteArray s(state_scale), r(residual_scale);
  for (PetscInt i = 0; i < end_ - begin_; ++i) {
    const PetscInt g = begin_ + i;
    double length = clearance, load = force;
    if (g < n_rotor_) {
      const std::optional<rotor::Freedom> freedom = rotor_->freedom(g);
      if (!freedom) {  // mass-normalised modes
        length = clearance * std::sqrt(mass);
        load = force / std::sqrt(mass);
      } else if (rotor::is_slope(*freedom)) {
        load = force * 0.1;  // clearance per metre, moments on a lever of 0.1 m
      }
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
    for (problem::Field& f : bearings_[i].part->fields(train_.supports[i].name)) out.push_back(std::move(f));
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
  std::vector<double> out;
  const std::vector<JournalState> at = journals(x);
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    const FilmPart& part = *bearings_[i].part;
    out.push_back(part.film().least_thickness(motion(at[i]), part.of(x, n_)));
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
    out.resize(static_cast<std::size_t>(rotor::freedoms_per_node * rotor_->n_nodes()),
               0.0);  // a rigid rotor does not tilt
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
