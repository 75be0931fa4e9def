#include "whirl/system/rotor_system.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "blocks.hpp"
#include "film_part.hpp"
#include "rest.hpp"
#include "rotor_part.hpp"
#include "settling.hpp"
#include "slope.hpp"
#include "system/start.hpp"
#include "whirl/core/error.hpp"

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

// Where the option ends at p, the difference is one-sided. A search may be far outside the range of the option.
RotorSystem::Slope& RotorSystem::slope() {
  if (slope_) return *slope_;
  const double p = varying_.value, step = 1e-5 * std::max(varying_.magnitude, std::abs(p));
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

Instant RotorSystem::instant(double angle, Vec x, Vec xdot) const {
  return {angle, speed_, acceleration_, forcing_, x, xdot};
}

std::vector<const Part*> RotorSystem::parts() const {
  std::vector<const Part*> out{hub_.get()};
  for (const Bearing& b : bearings_) out.push_back(b.part.get());
  return out;
}

void RotorSystem::subtract(const std::vector<std::array<double, 4>>& forces, double* rows) const {
  for (std::size_t b = 0; b < bearings_.size(); ++b) {
    const std::vector<PortEnds>& ports = bearings_[b].part->ports();
    for (std::size_t port = 0; port < ports.size(); ++port)
      for (const auto& [q, side] : ports[port])
        if (hub_->owns(q)) rows[2 * (q - hub_->begin())] -= side * forces[b][port];
  }
}

void RotorSystem::subtract(std::array<double, 4> film::Response::*of, double* rows) const {
  std::vector<std::array<double, 4>> forces;
  for (const Bearing& b : bearings_) forces.push_back(b.part->journal().*of);
  subtract(forces, rows);
}

void RotorSystem::residual(double angle, Vec x, Vec xdot, Vec f) {
  prepare_loads(false);
  evaluate_films(x, xdot, film::Need::force);
  const core::WriteArray fa(f);
  for (const Part* part : parts()) part->residual(instant(angle, x, xdot), fa.data() + part->row());
  subtract(&film::Response::force, fa.data());
}

void RotorSystem::parameter_derivative(double angle, Vec x, Vec xdot, Vec f) {
  prepare_loads(true);
  if (varying_.train) return slope().derivative(angle, x, xdot, f);
  evaluate_films(x, xdot, film::Need::tangents);
  const core::WriteArray fa(f);
  for (const Part* part : parts()) part->speed_derivative(instant(angle, x, xdot), fa.data() + part->row());
  subtract(&film::Response::d_speed, fa.data());
}

void RotorSystem::scales(Vec state_scale, Vec residual_scale) {
  const core::WriteArray s(state_scale), r(residual_scale);
  for (const Part* part : parts()) part->scales(s.data() + part->row(), r.data() + part->row());
}

// Of coordinates of second order: a reduction in state space has none but for the pedestals.
std::vector<problem::KinematicRow> RotorSystem::kinematic() const {
  std::vector<problem::KinematicRow> out;
  for (PetscInt q = hub_->rotor().states() ? hub_->rotor_coordinates() : 0; q < hub_->coordinates(); ++q)
    out.push_back({2 * q + 1, 2 * q, 2 * q + 1});
  return out;
}

std::vector<problem::Field> RotorSystem::fields() const {
  std::vector<problem::Field> out = hub_->fields("machine");
  for (std::size_t i = 0; i < bearings_.size(); ++i)
    for (problem::Field& f : bearings_[i].part->fields(train_.supports[i].name)) {
      f.part = static_cast<int>(i) + 1;
      out.push_back(std::move(f));
    }
  return out;
}

problem::BlockStructure* RotorSystem::structure() {
  if (core::size_of(comm_) != 1) return nullptr;
  if (blocks_) return blocks_.get();
  prepare();
  blocks_ = std::make_unique<MachineBlocks>(*this);
  return blocks_.get();
}

ShownPlaces RotorSystem::places() const {
  ShownPlaces p{{}, {}, "m", "m/s", "journal relative to the bearing centre"};
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
    out.push_back(part.film().least_thickness(motion(at[i]), part.of(x)));
  }
  return out;
}

core::Vector RotorSystem::guess() {
  if (!rest_) return static_guess(*this);
  prepare_loads(false);
  core::Vector x = core::duplicate(rest_->state());
  check(VecCopy(rest_->state(), x.get()));
  return x;
}

std::vector<RotorSystem::ElementState> RotorSystem::elements(const double* x) {
  prepare_loads(false);
  const RotorPart::Motions motions = hub_->motions(x);
  std::vector<ElementState> out;
  for (std::size_t e = 0; e < motions.size(); ++e)
    out.push_back({motions[e], hub_->force(e, motions[e], {}), sees_slopes(train_.elements[e]) ? 4 : 2});
  return out;
}

// Journals of one node share their coordinates.
void RotorSystem::displace(Vec x, const std::array<double, 2>& offset) {
  std::set<PetscInt> moved;
  for (std::size_t b = 0; b < bearings_.size(); ++b)
    for (std::size_t d = 0; d < 2; ++d) {
      const PetscInt q = bearings_[b].journal[d];
      const double by = offset[d] * train_.supports[b].geometry.clearance;
      if (by != 0 && moved.insert(q).second && hub_->owns(q)) check(VecSetValue(x, 2 * q, by, ADD_VALUES));
    }
  check(VecAssemblyBegin(x));
  check(VecAssemblyEnd(x));
  if (own_states() > 0 && !moved.empty()) relax_films(x);
}

bool RotorSystem::has_film_mesh() const {
  return std::any_of(train_.supports.begin(), train_.supports.end(),
                     [](const Support& s) { return film::facts(s.film).cells[0] > 0; });
}

const rotor::Rotor& RotorSystem::rotor() const {
  return hub_->rotor();
}

const std::vector<double>& RotorSystem::forcing_cosine() const {
  return hub_->unbalance().cosine;
}

const std::vector<double>& RotorSystem::forcing_sine() const {
  return hub_->unbalance().sine;
}

RotorSystem::Made RotorSystem::made() const {
  return {hub_->made(), films_made_};
}

int RotorSystem::loss_sense(double frequency) const {
  if (train_.rotor.loss_frame == rotor::LossFrame::stationary) return 1;
  const double difference = frequency - speed_;
  return std::abs(difference) <= 1e-12 * speed_ ? 0 : difference > 0 ? 1 : -1;
}

// i eta K (P_backward + s P_forward) = i eta (1 + s)/2 K + eta (1 - s)/2 K x [[0, 1], [-1, 0]], and i frequency q = v.
RotorSystem::Loss RotorSystem::loss_at(double frequency) const {
  core::require(frequency > 0, "vibration at a frequency");
  const double eta = train_.rotor.loss_factor, s = loss_sense(frequency);
  return {eta * (1 + s) / (2 * frequency), eta * (1 - s) / 2};
}

void RotorSystem::set_loss(const Loss& loss) {
  prepare();
  loss_ = loss;
  lossy_ = std::make_unique<const HubRows>(hub_->with_loss(loss.damping, loss.turning));
}

void RotorSystem::drop_loss() noexcept {
  lossy_.reset();
}

PetscInt RotorSystem::local_size() const {
  return hub_->rows() + own_here_;
}

int RotorSystem::ports(int b) const {
  return static_cast<int>(bearings_[static_cast<std::size_t>(b)].part->ports().size());
}

// They stand at the beginning of a whole state, and of each rank's rows.
std::vector<double> RotorSystem::shaft(Vec x, int component, bool with_gravity) const {
  return shaft(hub_states(x).data(), component, with_gravity);
}

std::vector<double> RotorSystem::hub_states(Vec x) const {
  const int here = static_cast<int>(hub_->rows()), size = core::size_of(comm_);
  std::vector<int> counts(static_cast<std::size_t>(size)), places(counts.size(), 0);
  MPI_Allgather(&here, 1, MPI_INT, counts.data(), 1, MPI_INT, comm_);
  std::partial_sum(counts.begin(), counts.end() - 1, places.begin() + 1);
  std::vector<double> hub(static_cast<std::size_t>(2 * n_));
  const core::ReadArray xa(x);
  MPI_Allgatherv(xa.data(), here, MPI_DOUBLE, hub.data(), counts.data(), places.data(), MPI_DOUBLE, comm_);
  return hub;
}

std::vector<double> RotorSystem::shaft(const double* x, int component, bool with_gravity) const {
  const rotor::Matrices& m = rotor().matrices();
  const auto& states = rotor().states();
  if (!states && !m.basis) {
    const PetscInt n = hub_->rotor_coordinates();
    std::vector<double> out(static_cast<std::size_t>(n));
    for (PetscInt i = 0; i < n; ++i) out[static_cast<std::size_t>(i)] = x[2 * i + component];
    out.resize(static_cast<std::size_t>(rotor::freedoms_per_node * rotor().n_nodes()),
               0.0);  // a rigid rotor does not tilt
    return out;
  }
  const Mat basis = !states ? m.basis.get() : component == 0 ? states->displacement.get() : states->velocity.get();
  const Vec offset = states ? states->offset.get() : m.offset.get();
  core::Vector q, full;
  check(MatCreateVecs(basis, q.put(), full.put()));
  {
    PetscInt begin = 0;
    check(VecGetOwnershipRange(q.get(), &begin, nullptr));
    const core::WriteArray qa(q.get());
    for (PetscInt i = 0; i < qa.size(); ++i) qa[i] = states ? x[begin + i] : x[2 * (begin + i) + component];
  }
  check(MatMult(basis, q.get(), full.get()));
  if (with_gravity) check(VecAXPY(full.get(), train_.gravity, offset));
  if (with_gravity && train_.gravity_x != 0) check(VecAXPY(full.get(), train_.gravity_x, rotor::turned(offset).get()));
  std::vector<double> out = core::gather(full.get());
  out.resize(static_cast<std::size_t>(rotor::freedoms_per_node * rotor().n_nodes()));  // without inner freedoms
  return out;
}

}  // namespace whirl::system
