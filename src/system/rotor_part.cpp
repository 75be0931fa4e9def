#include "rotor_part.hpp"

#include <algorithm>
#include <cmath>

#include "states.hpp"
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
  make_matrices();
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
  if (change.shaft || change.damping)
    make_matrices();
  else if (change.joints)
    speed_.reset();
  if (change.load) weights_ = load_of(*rotor_, weights_of(train_));
  if (change.load || change.joints) update_load();
  if (change.unbalance) unbalance_ = unbalance_of(*rotor_, train_.unbalance);
}

core::Matrix RotorPart::here(Mat of_rotor) const {
  if (on_first_) return on_first(of_rotor);
  core::check(PetscObjectReference(reinterpret_cast<PetscObject>(of_rotor)));
  return core::Matrix(of_rotor);
}

RotorPart::Matrices RotorPart::matrices_of(const rotor::Rotor& rotor) const {
  StateEntries rates, at_rest, turning;
  if (const auto& of = rotor.states()) {
    rates.add(here(of->rates.get()).get());
    at_rest.add(here(of->at_rest.get()).get());
    turning.add(here(of->turning.get()).get());
  } else {
    const rotor::Matrices& m = rotor.matrices();
    rates.add(here(m.mass.get()).get(), 1);
    at_rest.add(here(m.stiffness.get()).get(), 0);
    at_rest.add(here(m.damping.get()).get(), 1);
    turning.add(here(m.gyroscopic.get()).get(), 1);
    if (m.circulatory) turning.add(here(m.circulatory.get()).get(), 0);
  }
  for (PetscInt i = rotor.states() ? std::max(begin_, n_rotor_) : begin_; i < end_; ++i) {
    rates.add(2 * i + 1, 2 * i, 1);
    at_rest.add(2 * i + 1, 2 * i + 1, -1);
  }
  // Room for joints, whose coefficients any place may have.
  for (const auto& [place, none] : places()) {
    const auto [i, j] = place;
    rates.add(2 * i, 2 * j + 1, 0);
    for (const PetscInt rate : {0, 1}) at_rest.add(2 * i, 2 * j + rate, 0);
  }
  const PetscInt rows = end_ - begin_;
  return {rates.matrix(comm_, rows), at_rest.matrix(comm_, rows), turning.matrix(comm_, rows)};
}

void RotorPart::make_matrices() {
  matrices_ = matrices_of(*rotor_);
  find_base();
  speed_.reset();
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

core::Vector RotorPart::own(Vec x) const {
  core::Vector out = core::make_vector(comm_, rows(), PETSC_DETERMINE);
  const core::ReadArray from(x);
  const core::WriteArray to(out.get());
  std::copy_n(from.data(), to.size(), to.data());
  return out;
}

core::Vector RotorPart::products(const Matrices& m, const Instant& at) const {
  const core::Vector x = own(at.x);
  core::Vector sum = core::duplicate(x.get());
  check(VecSet(sum.get(), 0.0));
  if (m.turning) {
    check(MatMult(m.turning.get(), x.get(), sum.get()));
    check(VecScale(sum.get(), at.speed));
  }
  if (m.at_rest) check(MatMultAdd(m.at_rest.get(), x.get(), sum.get(), sum.get()));
  if (m.rates) check(MatMultAdd(m.rates.get(), own(at.xdot).get(), sum.get(), sum.get()));
  return sum;
}

void RotorPart::residual(const Instant& at, double* f) const {
  const core::Vector sum = products(matrices_, at);
  const core::ReadArray sa(sum.get());
  const auto [c, s] = unbalance_factors(at);
  for (PetscInt i = 0; i < sa.size(); ++i) {
    const auto row = static_cast<std::size_t>(2 * begin_ + i);
    f[i] = sa[i] - load_[static_cast<std::size_t>(i)] - c * unbalance_.cosine[row] - s * unbalance_.sine[row];
  }
}

void RotorPart::speed_derivative(const Instant& at, double* f) const {
  const core::Vector x = own(at.x), sum = core::duplicate(x.get());
  check(MatMult(matrices_.turning.get(), x.get(), sum.get()));
  if (by_speed_.at_rest) {
    check(MatMultAdd(by_speed_.at_rest.get(), x.get(), sum.get(), sum.get()));
    check(MatMultAdd(by_speed_.rates.get(), own(at.xdot).get(), sum.get(), sum.get()));
  }
  const std::vector<double> lacking = load_by_speed();
  const core::ReadArray sa(sum.get());
  const double force = at.forcing ? 2 * at.speed : 0.0, c = force * std::cos(at.angle), s = force * std::sin(at.angle);
  for (PetscInt i = 0; i < sa.size(); ++i) {
    const auto row = static_cast<std::size_t>(2 * begin_ + i);
    f[i] = sa[i] - c * unbalance_.cosine[row] - s * unbalance_.sine[row];
    if (!lacking.empty()) f[i] -= lacking[static_cast<std::size_t>(i)];
  }
}

void RotorPart::count_entries(std::span<PetscInt> count) const {
  // A journal and its slopes, displacements and velocities, and the pedestals of all bearings at one node.
  PetscInt pedestals = 1;
  for (const Support& s : train_.supports)
    pedestals = std::max<PetscInt>(
        pedestals, std::count_if(train_.supports.begin(), train_.supports.end(),
                                 [&s](const Support& t) { return t.has_pedestal && t.node == s.node; }));
  const PetscInt of_films = 8 + 4 * pedestals;
  for (PetscInt i = 0; i < rows(); ++i) {
    PetscInt total = i % 2 == 0 ? of_films : 0;
    for (const core::Matrix* m : {&matrices_.rates, &matrices_.at_rest, &matrices_.turning}) {
      PetscInt k = 0;
      check(MatGetRow(m->get(), 2 * begin_ + i, &k, nullptr, nullptr));
      total += k;
      check(MatRestoreRow(m->get(), 2 * begin_ + i, &k, nullptr, nullptr));
    }
    count[static_cast<std::size_t>(i)] += total;
  }
}

void RotorPart::add(Mat j, double at_rest, double gyroscopic, double rates) const {
  for (const auto& [m, factor] :
       {std::pair{matrices_.at_rest.get(), at_rest}, std::pair{matrices_.turning.get(), gyroscopic},
        std::pair{matrices_.rates.get(), rates}})
    for_entries(m, [j, by = factor](PetscInt row, PetscInt column, double value) {
      check(MatSetValue(j, row, column, by * value, ADD_VALUES));
    });
  if (loss_ != std::array<double, 2>{}) add_loss(j, at_rest);
}

// Of the rotor alone: pedestals behind it have no loss.
void RotorPart::add_loss(Mat j, double at_rest) const {
  for_entries(here(rotor_->matrices().stiffness.get()).get(), [&](PetscInt i, PetscInt column, double value) {
    const double k = at_rest * value;
    check(MatSetValue(j, 2 * i, 2 * column + 1, loss_[0] * k, ADD_VALUES));
    // The other plane: +K y in rows of x, -K x in rows of y.
    check(MatSetValue(j, 2 * i, 2 * (column ^ 1), (i % 2 == 0 ? 1 : -1) * loss_[1] * k, ADD_VALUES));
  });
}

}  // namespace whirl::system
