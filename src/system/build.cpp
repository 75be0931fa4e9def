#include <algorithm>

#include "blocks.hpp"
#include "change.hpp"
#include "film_part.hpp"
#include "settling.hpp"
#include "slope.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/rotor/alignment.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/system/rotor_system.hpp"

// How a train becomes matrices and films: what is made once, and what is made anew where the train changes.

namespace whirl::system {
namespace {

using core::check;

// `m` of the rotor with a diagonal of zeros for the pedestals behind it; `local` rows on this rank.
core::Matrix with_pedestals(Mat m, PetscInt local, PetscInt n_rotor) {
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(m, &begin, &end));
  std::vector<PetscInt> count(static_cast<std::size_t>(local), 1);
  for (PetscInt i = begin; i < end; ++i) {
    PetscInt k = 0;
    check(MatGetRow(m, i, &k, nullptr, nullptr));
    count[static_cast<std::size_t>(i - begin)] = k;
    check(MatRestoreRow(m, i, &k, nullptr, nullptr));
  }
  core::Matrix out = core::make_matrix(PetscObjectComm(reinterpret_cast<PetscObject>(m)), local, std::move(count));
  for (PetscInt i = begin; i < end; ++i) {
    PetscInt k = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    check(MatGetRow(m, i, &k, &columns, &values));
    check(MatSetValues(out.get(), 1, &i, k, columns, values, INSERT_VALUES));
    check(MatRestoreRow(m, i, &k, &columns, &values));
  }
  for (PetscInt i = std::max(end, n_rotor); i < begin + local; ++i)
    check(MatSetValue(out.get(), i, i, 0.0, INSERT_VALUES));
  check(MatAssemblyBegin(out.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(out.get(), MAT_FINAL_ASSEMBLY));
  return out;
}

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

void RotorSystem::build() {
  rotor_ = make_rotor(train_.rotor);
  n_rotor_ = rotor_->size();

  // Pedestals come behind the rotor's coordinates.
  n_ = n_rotor_;
  for (const Support& s : train_.supports) {
    Bearing b;
    using enum rotor::Freedom;
    for (const rotor::Freedom freedom : {x, y, slope_x, slope_y}) {
      if (rotor::is_slope(freedom) && !film::facts(s.film).tilts) break;
      const auto d = static_cast<std::size_t>(freedom);
      b.journal[d] = rotor_->coordinate(s.node, freedom);
      if (b.journal[d] < 0)
        throw core::InputError(rotor::is_slope(freedom)
                                   ? "a film tilts, but the slopes of its node are no coordinates of the rotor"
                                   : "a bearing's node is not a master node of the reduced rotor");
      b.ports.push_back({{b.journal[d], 1.0}});
      if (!s.has_pedestal || rotor::is_slope(freedom)) continue;
      b.pedestal[d] = n_++;
      b.ports.back().emplace_back(b.pedestal[d], -1.0);
    }
    bearings_.push_back(std::move(b));
  }
  axes_ = axes_of(train_);
  core::agree(comm_, [&] {
    for (std::size_t i = 0; i < bearings_.size(); ++i) {
      bearings_[i].part = std::make_unique<FilmPart>(train_.supports[i], n_own_);
      n_own_ = bearings_[i].part->end();
      ++made_.films;
    }
  });
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(rotor_->matrices().mass.get(), &begin, &end));
  const int rank = core::rank_of(comm_);
  if (first_holds_rotor()) {
    begin = rank == 0 ? 0 : n_rotor_;
    end = n_rotor_;
  }
  const int with_pedestals_on = first_holds_rotor() ? 0 : core::size_of(comm_) - 1;
  begin_ = rank > with_pedestals_on ? n_ : begin;
  end_ = rank >= with_pedestals_on ? n_ : end;
  share_out_own_states();
  make_matrices();
  load_ = load_of(*rotor_, weights_of(train_));
  unbalance_ = unbalance_of(*rotor_, train_.unbalance);

  // Which entries of the state the films see: journal and pedestal positions and velocities, and own states.
  for (const Bearing& b : bearings_)
    for (std::size_t d = 0; d < 2; ++d)
      for (const PetscInt q : {b.journal[d], b.pedestal[d]})
        for (PetscInt rate = 0; rate < 2; ++rate) wanted_.push_back(2 * std::max<PetscInt>(q, 0) + rate);
  for (const Bearing& b : bearings_)
    for (std::size_t d = 2; d < b.ports.size(); ++d)
      for (PetscInt rate = 0; rate < 2; ++rate) wanted_.push_back(2 * b.journal[d] + rate);
  journal_inputs_ = wanted_.size();
  for (const Bearing& b : bearings_)
    for (const int k : b.part->share().seen) wanted_.push_back(2 * n_ + b.part->first() + k);
  core::Vector state = core::make_vector(comm_, local_size(), PETSC_DETERMINE);
  core::IndexSet from;
  check(ISCreateGeneral(PETSC_COMM_SELF, static_cast<PetscInt>(wanted_.size()), wanted_.data(), PETSC_COPY_VALUES,
                        from.put()));
  inputs_ = core::make_vector(PETSC_COMM_SELF, static_cast<PetscInt>(wanted_.size()), PETSC_DETERMINE);
  check(VecScatterCreate(state.get(), from.get(), inputs_.get(), nullptr, gather_inputs_.put()));
}

// What may refuse its values comes before anything changes.
void RotorSystem::set_train(Train train) {
  const Change change = change_between(train_, train);
  std::unique_ptr<rotor::Rotor> rotor = change.shaft ? make_rotor(train.rotor) : nullptr;
  std::vector<FilmPart> films = parts_at(train, change.films);
  if (change.axes) axes_ = axes_of(train);
  train_ = std::move(train);
  for (std::size_t k = 0; k < films.size(); ++k) *bearings_[change.films[k]].part = std::move(films[k]);
  if (rotor)
    rotor_ = std::move(rotor);
  else if (change.damping)
    rotor_->set_stiffness_damping(train_.rotor.stiffness_damping);
  const bool matrices = change.shaft || change.damping;
  if (matrices) {
    make_matrices();
    if (j_at_rest_) fill_constant_parts();
  } else if (change.pedestals) {
    set_pedestals();
  }
  if (blocks_ && (matrices || change.pedestals)) blocks_->rebuild();
  if (change.load) load_ = load_of(*rotor_, weights_of(train_));
  if (change.unbalance) unbalance_ = unbalance_of(*rotor_, train_.unbalance);
  slope_.reset();
}

std::unique_ptr<rotor::Rotor> RotorSystem::make_rotor(const rotor::Options& options) {
  ++made_.rotors;
  return std::make_unique<rotor::Rotor>(comm_, options);
}

std::vector<FilmPart> RotorSystem::parts_at(const Train& train, const std::vector<std::size_t>& bearings) {
  std::vector<FilmPart> out;
  core::agree(comm_, [&] {
    for (const std::size_t b : bearings) {
      out.push_back(bearings_[b].part->with(train.supports[b]));
      ++made_.films;
    }
  });
  return out;
}

RotorSystem::Matrices RotorSystem::matrices_of(const rotor::Rotor& rotor) const {
  const rotor::Matrices& m = rotor.matrices();
  const auto made = [&](Mat from) {
    const core::Matrix moved = first_holds_rotor() ? on_first(from) : core::Matrix();
    return with_pedestals(moved ? moved.get() : from, end_ - begin_, n_rotor_);
  };
  return {made(m.mass.get()), made(m.damping.get()), made(m.gyroscopic.get()), made(m.stiffness.get())};
}

void RotorSystem::make_matrices() {
  matrices_ = matrices_of(*rotor_);
  set_pedestals();
}

// They stand on diagonals, in the matrices and in the parts of the Jacobian made of these.
void RotorSystem::set_pedestals() {
  for (std::size_t i = 0; i < bearings_.size(); ++i)
    for (std::size_t d = 0; d < 2; ++d) {
      const PetscInt row = bearings_[i].pedestal[d];
      if (row < 0 || !owns(row)) continue;
      const Support& s = train_.supports[i];
      check(MatSetValue(matrices_.mass.get(), row, row, s.mass[d], INSERT_VALUES));
      check(MatSetValue(matrices_.damping.get(), row, row, s.damping[d], INSERT_VALUES));
      check(MatSetValue(matrices_.stiffness.get(), row, row, s.stiffness[d], INSERT_VALUES));
      if (!j_at_rest_) continue;
      check(MatSetValue(j_at_rest_.get(), 2 * row, 2 * row, s.stiffness[d], INSERT_VALUES));
      check(MatSetValue(j_at_rest_.get(), 2 * row, 2 * row + 1, s.damping[d], INSERT_VALUES));
      check(MatSetValue(j_rates_.get(), 2 * row, 2 * row + 1, s.mass[d], INSERT_VALUES));
    }
  for (const core::Matrix* m : {&matrices_.mass, &matrices_.damping, &matrices_.stiffness, &j_at_rest_, &j_rates_})
    if (*m) {
      check(MatAssemblyBegin(m->get(), MAT_FINAL_ASSEMBLY));
      check(MatAssemblyEnd(m->get(), MAT_FINAL_ASSEMBLY));
    }
}

RotorSystem::Weights RotorSystem::weights_of(const Train& train) {
  Weights w{train.gravity, train.rotor.type == rotor::Options::Type::rigid ? train.rotor.load : 0.0, {}};
  for (const Support& s : train.supports) w.pedestals.push_back(s.has_pedestal ? train.gravity * s.mass[1] : 0.0);
  return w;
}

std::vector<double> RotorSystem::load_of(const rotor::Rotor& rotor, const Weights& weights) const {
  std::vector<double> load(static_cast<std::size_t>(end_ - begin_), 0.0);
  const std::vector<double> g = core::gather(rotor.matrices().gravity.get());
  for (PetscInt i = begin_; i < std::min(end_, n_rotor_); ++i)
    load[static_cast<std::size_t>(i - begin_)] = weights.gravity * g[static_cast<std::size_t>(i)];
  const auto take = [&](PetscInt row, double weight) {
    if (weight != 0 && owns(row)) load[static_cast<std::size_t>(row - begin_)] -= weight;
  };
  take(rotor.coordinate(1, rotor::Freedom::y), weights.rotor_load);
  for (std::size_t i = 0; i < bearings_.size(); ++i) take(bearings_[i].pedestal[1], weights.pedestals[i]);
  return load;
}

// U Omega^2 (cos, sin)(angle + phase) as cosine and sine parts, through T^T where the rotor is reduced.
RotorSystem::Unbalances RotorSystem::unbalance_of(const rotor::Rotor& rotor,
                                                  const std::vector<UnbalanceMass>& masses) const {
  const rotor::Matrices& m = rotor.matrices();
  PetscInt rotor_here = 0;
  check(MatGetLocalSize(m.mass.get(), &rotor_here, nullptr));
  core::Vector full_c, full_s, c = core::make_vector(comm_, rotor_here, PETSC_DETERMINE), s = core::duplicate(c.get());
  const bool reduced = static_cast<bool>(m.basis);
  if (reduced) {
    check(MatCreateVecs(m.basis.get(), nullptr, full_c.put()));
    full_s = core::duplicate(full_c.get());
  }
  Vec tc = reduced ? full_c.get() : c.get(), ts = reduced ? full_s.get() : s.get();
  check(VecSet(tc, 0.0));
  check(VecSet(ts, 0.0));
  if (core::rank_of(comm_) == 0)
    for (const UnbalanceMass& u : masses) {
      const PetscInt x = reduced ? rotor::full_coordinate(u.node, rotor::Freedom::x)
                                 : rotor.coordinate(u.node, rotor::Freedom::x),
                     y = x + 1;
      check(VecSetValue(tc, x, u.amount * std::cos(u.phase), ADD_VALUES));
      check(VecSetValue(ts, x, -u.amount * std::sin(u.phase), ADD_VALUES));
      check(VecSetValue(tc, y, u.amount * std::sin(u.phase), ADD_VALUES));
      check(VecSetValue(ts, y, u.amount * std::cos(u.phase), ADD_VALUES));
    }
  for (Vec v : {tc, ts}) {
    check(VecAssemblyBegin(v));
    check(VecAssemblyEnd(v));
  }
  if (reduced) {
    check(MatMultTranspose(m.basis.get(), tc, c.get()));
    check(MatMultTranspose(m.basis.get(), ts, s.get()));
  }
  Unbalances out{core::gather(c.get()), core::gather(s.get())};
  out.cosine.resize(static_cast<std::size_t>(n_), 0.0);
  out.sine.resize(static_cast<std::size_t>(n_), 0.0);
  return out;
}

// Bearings are bored in line with the shaft as it lies on them at rest, unless the deck says how they stand.
std::vector<std::array<double, 2>> RotorSystem::axes_of(const Train& train) const {
  std::vector<std::array<double, 2>> out(bearings_.size());
  std::vector<double> line;
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    if (!bearings_[i].tilts()) continue;
    const Support& support = train.supports[i];
    if (support.slope) {
      out[i] = *support.slope;
      continue;
    }
    if (line.empty()) {
      std::vector<rotor::Support> supports;
      for (const Support& s : train.supports) supports.push_back({s.node, s.elevation});
      line = rotor::rigid_static(comm_, train.rotor, supports, train.gravity).slope;
    }
    out[i] = {0.0, line[static_cast<std::size_t>(support.node - 1)]};
  }
  return out;
}

// Own states stand behind all pairs, film by film, in near equal shares of all.
void RotorSystem::share_out_own_states() {
  const int rank = core::rank_of(comm_), size = core::size_of(comm_);
  const auto cut = [&](int r) -> PetscInt {
    const PetscInt wanted = n_own_ * r / size;
    for (const Bearing& b : bearings_)
      if (wanted < b.part->end()) return b.part->cut(wanted);
    return n_own_;
  };
  const PetscInt begin = cut(rank), end = cut(rank + 1);
  own_here_ = end - begin;
  std::size_t gathered = 0;
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    FilmPart& part = *bearings_[i].part;
    part.hold(begin, end, 2 * (end_ - begin_), gathered, static_cast<int>(i) % size == rank);
    gathered += part.share().seen.size();
  }
}

// The parts of the Jacobian that do not change with the state, all in the pattern of make_jacobian(): so a Jacobian is
// a sum of arrays plus the few entries of the films.
void RotorSystem::make_constant_parts() {
  const PetscInt rows = end_ - begin_, local_rows = local_size();
  std::vector<PetscInt> count(static_cast<std::size_t>(std::max<PetscInt>(local_rows, 1)), 2);
  std::vector<PetscInt> coupled(static_cast<std::size_t>(n_), 0);  // own states that act on a coordinate
  for (const Bearing& b : bearings_) {
    for (const PortEnds& port : b.ports)
      for (const auto& [q, side] : port) coupled[static_cast<std::size_t>(q)] += b.part->count();
    b.part->count_entries(b.ports, count);
  }
  for (PetscInt& c : count) c = std::min(c, size());
  for (PetscInt i = 0; i < rows; ++i) {
    PetscInt k = 0, total = coupled[static_cast<std::size_t>(begin_ + i)];
    for (Mat m :
         {matrices_.mass.get(), matrices_.damping.get(), matrices_.stiffness.get(), matrices_.gyroscopic.get()}) {
      check(MatGetRow(m, begin_ + i, &k, nullptr, nullptr));
      total += 2 * k;
      check(MatRestoreRow(m, begin_ + i, &k, nullptr, nullptr));
    }
    count[static_cast<std::size_t>(2 * i)] = std::min(total + 12, size());
  }
  for (core::Matrix* j : {&j_at_rest_, &j_gyroscopic_, &j_rates_}) *j = core::make_matrix(comm_, local_rows, count);
  fill_constant_parts();
}

void RotorSystem::fill_constant_parts() {
  std::vector<PetscInt> columns_to;
  std::vector<PetscScalar> scaled;
  // Every part sets every entry, if need be to zero.
  const auto fill = [&](Mat j, double at_rest, double gyroscopic, double rates) {
    const auto add = [&](Mat m, PetscInt rate, double factor) {
      for (PetscInt i = begin_; i < end_; ++i) {
        PetscInt k = 0;
        const PetscInt* columns = nullptr;
        const PetscScalar* values = nullptr;
        check(MatGetRow(m, i, &k, &columns, &values));
        columns_to.assign(columns, columns + k);
        scaled.assign(values, values + k);
        for (PetscInt e = 0; e < k; ++e) {
          columns_to[static_cast<std::size_t>(e)] = 2 * columns_to[static_cast<std::size_t>(e)] + rate;
          scaled[static_cast<std::size_t>(e)] *= factor;
        }
        const PetscInt row = 2 * i;
        check(MatSetValues(j, 1, &row, k, columns_to.data(), scaled.data(), ADD_VALUES));
        check(MatRestoreRow(m, i, &k, &columns, &values));
      }
    };
    PetscBool filled = PETSC_FALSE;
    check(MatAssembled(j, &filled));
    if (filled) check(MatZeroEntries(j));
    add(matrices_.stiffness.get(), 0, at_rest);
    add(matrices_.damping.get(), 1, at_rest);
    add(matrices_.gyroscopic.get(), 1, gyroscopic);
    add(matrices_.mass.get(), 1, rates);
    for (PetscInt i = begin_; i < end_; ++i) {
      check(MatSetValue(j, 2 * i + 1, 2 * i, rates, ADD_VALUES));
      check(MatSetValue(j, 2 * i + 1, 2 * i + 1, -at_rest, ADD_VALUES));
    }
    if (!filled) return add_films(j, nullptr, 0, 0);
    check(MatAssemblyBegin(j, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(j, MAT_FINAL_ASSEMBLY));
  };
  fill(j_at_rest_.get(), 1, 0, 0);
  fill(j_gyroscopic_.get(), 0, 1, 0);
  fill(j_rates_.get(), 0, 0, 1);
}

core::Matrix RotorSystem::make_jacobian() {
  if (!j_at_rest_) make_constant_parts();
  core::Matrix j;
  check(MatDuplicate(j_at_rest_.get(), MAT_DO_NOT_COPY_VALUES, j.put()));
  return j;
}

}  // namespace whirl::system
