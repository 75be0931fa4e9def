#include "rotor_part.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/core/error.hpp"
#include "whirl/film/contract/film.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::system {

using core::check;

namespace {

// All of `m` on the first rank.
core::Matrix on_first(Mat m) {
  MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(m));
  PetscInt n = 0;
  check(MatGetSize(m, &n, nullptr));
  core::IndexSet all;
  check(ISCreateStride(comm, core::rank_of(comm) == 0 ? n : 0, 0, 1, all.put()));
  core::Matrix out;
  check(MatCreateSubMatrix(m, all.get(), all.get(), MAT_INITIAL_MATRIX, out.put()));
  return out;
}

}  // namespace

RotorPart::RotorPart(MPI_Comm comm, const Train& train, bool on_first)
    : comm_(comm), train_(train), on_first_(on_first), rotor_(make_rotor(train.rotor)) {
  n_ = n_rotor_ = rotor_->size();
  for (const Support& s : train_.supports) {
    std::array<PetscInt, 2>& rows = pedestals_.emplace_back(std::array<PetscInt, 2>{-1, -1});
    if (!s.has_pedestal) continue;
    for (PetscInt& row : rows) row = n_++;
  }
  PetscInt begin = 0, end = 0;
  if (rotor_->states()) {
    check(MatGetOwnershipRange(rotor_->states()->rates.get(), &begin, &end));
    begin /= 2, end /= 2;
  } else {
    check(MatGetOwnershipRange(rotor_->matrices().mass.get(), &begin, &end));
  }
  const int rank = core::rank_of(comm_);
  if (on_first_) {
    begin = rank == 0 ? 0 : n_rotor_;
    end = n_rotor_;
  }
  const int with_pedestals_on = on_first_ ? 0 : core::size_of(comm_) - 1;
  begin_ = rank > with_pedestals_on ? n_ : begin;
  end_ = rank >= with_pedestals_on ? n_ : end;
  join();
  base_ = linear_ = rows_of(*rotor_);
  weights_ = load_of(*rotor_, weights_of(train_));
  update_load();
  unbalance_ = unbalance_of(*rotor_, train_.unbalance);
}

std::unique_ptr<rotor::Rotor> RotorPart::make_rotor(const rotor::Options& options) {
  ++made_;
  return std::make_unique<rotor::Rotor>(comm_, options);
}

void RotorPart::check_pattern(const rotor::Rotor& rotor) const {
  if (rotor.matrices().circulatory && !rotor_->matrices().circulatory)
    throw core::InputError("'rotor.internal_damping' varies from a positive value on, not from none");
}

void RotorPart::take(const TrainChange& change, std::unique_ptr<rotor::Rotor> rotor) {
  if (rotor)
    rotor_ = std::move(rotor);
  else if (change.damping)
    rotor_->set_stiffness_damping(train_.rotor.stiffness_damping);
  if (change.shaft || change.damping) base_ = linear_ = rows_of(*rotor_);
  if (change.shaft || change.damping || change.joints) speed_.reset();
  if (change.load) weights_ = load_of(*rotor_, weights_of(train_));
  if (change.load || change.joints) update_load();
  if (change.unbalance) unbalance_ = unbalance_of(*rotor_, train_.unbalance);
}

core::Matrix RotorPart::here(Mat of_rotor) const {
  if (on_first_) return on_first(of_rotor);
  core::check(PetscObjectReference(reinterpret_cast<PetscObject>(of_rotor)));
  return core::Matrix(of_rotor);
}

HubRows RotorPart::rows_of(const rotor::Rotor& rotor) const {
  using Entry = HubRows::Entry;
  std::vector<Entry> all;
  // Row i and column j of a matrix stand at each * i and each * j + rate among the states.
  const auto take = [&](const core::Matrix& m, double Entry::*to, PetscInt each, PetscInt rate) {
    for_entries(here(m.get()).get(), [&](PetscInt i, PetscInt j, double value) {
      all.push_back({each * i, each * j + rate});
      all.back().*to = value;
    });
  };
  if (const auto& of = rotor.states()) {
    take(of->rates, &Entry::rates, 1, 0);
    take(of->at_rest, &Entry::at_rest, 1, 0);
    take(of->turning, &Entry::turning, 1, 0);
  } else {
    const rotor::Matrices& m = rotor.matrices();
    take(m.mass, &Entry::rates, 2, 1);
    take(m.stiffness, &Entry::at_rest, 2, 0);
    take(m.damping, &Entry::at_rest, 2, 1);
    take(m.gyroscopic, &Entry::turning, 2, 1);
    if (m.circulatory) take(m.circulatory, &Entry::turning, 2, 0);
  }
  for (PetscInt i = rotor.states() ? std::max(begin_, n_rotor_) : begin_; i < end_; ++i) {
    all.push_back({2 * i + 1, 2 * i, 0, 0, 1});
    all.push_back({2 * i + 1, 2 * i + 1, -1});
  }
  // Room for joints, whose coefficients any place may have. Without a speed none leaves its table.
  const HubRows joints = joints_of(train_, std::nullopt, false);
  for (const Entry& e : joints.entries()) all.push_back({e.row, e.column});
  return HubRows(std::move(all));
}

// Of the rotor alone: pedestals behind it have no loss. The other plane: +K y in rows of x, -K x in rows of y.
HubRows RotorPart::with_loss(double damping, double turning) const {
  std::vector<HubRows::Entry> all = linear_.entries();
  for_entries(here(rotor_->matrices().stiffness.get()).get(), [&](PetscInt i, PetscInt j, double k) {
    all.push_back({2 * i, 2 * j + 1, damping * k});
    all.push_back({2 * i, 2 * (j ^ 1), (i % 2 == 0 ? 1 : -1) * turning * k});
  });
  return HubRows(std::move(all));
}

RotorPart::Weights RotorPart::weights_of(const Train& train) {
  Weights w{.gravity = train.gravity,
            .gravity_x = train.gravity_x,
            .rotor_load = train.rotor.type == rotor::Options::Type::rigid ? train.rotor.load : 0.0,
            .pedestals_x = {},
            .pedestals = {},
            .loads = train.loads};
  for (const Support& s : train.supports) {
    w.pedestals_x.push_back(s.has_pedestal ? train.gravity_x * s.mass[0] : 0.0);
    w.pedestals.push_back(s.has_pedestal ? -train.gravity * s.mass[1] : 0.0);
  }
  return w;
}

std::vector<double> RotorPart::load_of(const rotor::Rotor& rotor, const Weights& weights) const {
  std::vector<double> load(static_cast<std::size_t>(rows()), 0.0);
  const auto& states = rotor.states();
  const std::vector<double> g = core::gather((states ? states->gravity : rotor.matrices().gravity).get());
  const std::vector<double> g_x =
      weights.gravity_x != 0 ? core::gather(rotor::across(rotor).get()) : std::vector<double>(g.size(), 0.0);
  const PetscInt each = states ? 1 : 2;  // rows for one entry of the weight
  for (PetscInt row = 2 * begin_; row < 2 * std::min(end_, n_rotor_); row += each) {
    const auto at = static_cast<std::size_t>(row / each);
    load[static_cast<std::size_t>(row - 2 * begin_)] = weights.gravity * g[at] + weights.gravity_x * g_x[at];
  }
  const auto push = [&](PetscInt coordinate, double force) {
    if (force != 0 && owns(coordinate)) load[static_cast<std::size_t>(2 * (coordinate - begin_))] += force;
  };
  push(rotor.coordinate(1, rotor::Freedom::y), -weights.rotor_load);
  for (std::size_t i = 0; i < pedestals_.size(); ++i) {
    push(pedestals_[i][0], weights.pedestals_x[i]);
    push(pedestals_[i][1], weights.pedestals[i]);
  }
  using enum rotor::Freedom;
  for (const StaticLoad& l : weights.loads) {
    const std::array<double, 2> moment = l.moment.value_or(std::array<double, 2>{});
    for (const auto& [freedom, force] : {std::pair{x, l.force[0]}, std::pair{y, l.force[1]},
                                         std::pair{slope_x, moment[1]}, std::pair{slope_y, -moment[0]}}) {
      if (force == 0) continue;
      const PetscInt coordinate = rotor.coordinate(l.node, freedom);
      if (coordinate < 0) throw core::InputError("a load acts on what is no coordinate of the rotor");
      push(coordinate, force);
    }
  }
  return load;
}

// U Omega^2 (cos, sin)(angle + phase) as cosine and sine parts, through T^T where the rotor is reduced.
RotorPart::Unbalances RotorPart::unbalance_of(const rotor::Rotor& rotor,
                                              const std::vector<UnbalanceMass>& masses) const {
  const auto& states = rotor.states();
  const Mat through = states ? states->forces.get() : rotor.matrices().basis.get();
  core::Vector full[2], reduced[2];
  if (through)
    check(MatCreateVecs(through, reduced[0].put(), full[0].put()));
  else
    full[0] = core::duplicate(rotor.matrices().gravity.get());
  full[1] = core::duplicate(full[0].get());
  if (through) reduced[1] = core::duplicate(reduced[0].get());
  for (const core::Vector& v : full) check(VecSet(v.get(), 0.0));
  if (core::rank_of(comm_) == 0)
    for (const UnbalanceMass& u : masses) {
      const rotor::Freedom freedom = u.couple ? rotor::Freedom::slope_x : rotor::Freedom::x;
      const PetscInt x = through ? rotor::full_coordinate(u.node, freedom) : rotor.coordinate(u.node, freedom),
                     y = x + 1;
      check(VecSetValue(full[0].get(), x, u.amount * std::cos(u.phase), ADD_VALUES));
      check(VecSetValue(full[1].get(), x, -u.amount * std::sin(u.phase), ADD_VALUES));
      check(VecSetValue(full[0].get(), y, u.amount * std::sin(u.phase), ADD_VALUES));
      check(VecSetValue(full[1].get(), y, u.amount * std::cos(u.phase), ADD_VALUES));
    }
  Unbalances out;
  std::vector<double>* parts[] = {&out.cosine, &out.sine};
  for (std::size_t k = 0; k < 2; ++k) {
    check(VecAssemblyBegin(full[k].get()));
    check(VecAssemblyEnd(full[k].get()));
    if (through) check(MatMultTranspose(through, full[k].get(), reduced[k].get()));
    const std::vector<double> values = core::gather((through ? reduced : full)[k].get());
    parts[k]->assign(static_cast<std::size_t>(2 * n_), 0.0);
    const std::size_t each = states ? 1 : 2;
    for (std::size_t i = 0; i < values.size(); ++i) (*parts[k])[each * i] = values[i];
  }
  return out;
}

std::vector<problem::Field> RotorPart::fields(const std::string& name) const {
  return {{name, 0, rows()}};
}

// Displacements are measured in clearances, rates in clearances times a typical whirl frequency, forces in parts of the
// weight.
void RotorPart::scales(double* s, double* r) const {
  double clearance = 0;
  int films = 0;
  for (const Support& support : train_.supports)
    if (support.geometry.clearance > 0) {
      clearance += support.geometry.clearance;
      ++films;
    }
  clearance = films > 0 ? clearance / films : 1e-4;
  const double mass = rotor::total_mass(train_.rotor),
               force = std::max(mass * std::hypot(train_.gravity, train_.gravity_x) + std::abs(train_.rotor.load),
                                mass * clearance * film::typical_frequency * film::typical_frequency) /
                       std::max<double>(1.0, static_cast<double>(train_.supports.size()));
  for (PetscInt i = 0; i < end_ - begin_; ++i) {
    const PetscInt g = begin_ + i;
    double length = clearance, load = force;
    if (g < n_rotor_) {
      const std::optional<rotor::Freedom> freedom = rotor_->freedom(g);
      if (!freedom && rotor_->reduced()) {  // mass-normalised modes
        length = clearance * std::sqrt(mass);
        load = force / std::sqrt(mass);
      } else if (!freedom || rotor::is_slope(*freedom)) {  // inner freedoms of elements are angles or curvatures
        load = force * 0.1;                                // clearance per metre, moments on a lever of 0.1 m
      }
    }
    s[2 * i] = length;
    s[2 * i + 1] = length * film::typical_frequency;
    r[2 * i + 1] = length * film::typical_frequency;
    r[2 * i] = load;
    // Both entries of a mode in state space are displacements, and both of its rows their rates.
    if (g < n_rotor_ && rotor_->states() && !rotor_->freedom(g)) {
      s[2 * i + 1] = length;
      r[2 * i] = length * film::typical_frequency;
    }
  }
}

// The centre of unbalance moves along (cos, sin)(angle): its acceleration has a part towards the axis and one along the
// turn.
std::array<double, 2> RotorPart::unbalance_factors(const Instant& at) {
  if (!at.forcing) return {};
  const double c = std::cos(at.angle), s = std::sin(at.angle), inward = at.speed * at.speed;
  return {inward * c + at.acceleration * s, inward * s - at.acceleration * c};
}

void RotorPart::residual(const Instant& at, double* f) const {
  std::fill_n(f, rows(), 0.0);
  linear_.add_products(1, at.speed, at.x, at.xdot, f);
  const auto [c, s] = unbalance_factors(at);
  for (PetscInt i = 0; i < rows(); ++i) {
    const auto row = static_cast<std::size_t>(2 * begin_ + i);
    f[i] -= load_[static_cast<std::size_t>(i)] + c * unbalance_.cosine[row] + s * unbalance_.sine[row];
  }
}

void RotorPart::speed_derivative(const Instant& at, double* f) const {
  std::fill_n(f, rows(), 0.0);
  linear_.add_products(0, 1, at.x, nullptr, f);
  if (varies_) by_speed_.add_products(1, 0, at.x, at.xdot, f);
  const std::vector<double> lacking = load_by_speed();
  const double force = at.forcing ? 2 * at.speed : 0.0, c = force * std::cos(at.angle), s = force * std::sin(at.angle);
  for (PetscInt i = 0; i < rows(); ++i) {
    const auto row = static_cast<std::size_t>(2 * begin_ + i);
    f[i] -= c * unbalance_.cosine[row] + s * unbalance_.sine[row];
    if (!lacking.empty()) f[i] -= lacking[static_cast<std::size_t>(i)];
  }
}

}  // namespace whirl::system
