#include <algorithm>

#include "blocks.hpp"
#include "film_part.hpp"
#include "settling.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/system/rotor_system.hpp"

// How a train becomes matrices: everything that is made once and does not change with the state.

namespace whirl::system {
namespace {

using core::check;

// `m` of the rotor with the pedestals' diagonal appended behind it; `local` rows on this rank.
core::Matrix with_pedestals(Mat m, PetscInt local, PetscInt n_rotor,
                            const std::vector<std::pair<PetscInt, double>>& diagonal) {
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
  if (end == n_rotor && local > end - begin)
    for (const auto& [row, value] : diagonal) check(MatSetValue(out.get(), row, row, value, INSERT_VALUES));
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
  rotor_ = std::make_unique<rotor::Rotor>(comm_, train_.rotor);
  const rotor::Matrices& m = rotor_->matrices();
  n_rotor_ = rotor_->size();

  // Pedestals come behind the rotor's coordinates.
  bearings_.clear();
  n_ = n_rotor_;
  for (const Support& s : train_.supports) {
    Bearing b;
    for (int d = 0; d < 2; ++d) {
      b.journal[static_cast<std::size_t>(d)] = rotor_->coordinate(s.node, d);
      if (b.journal[static_cast<std::size_t>(d)] < 0)
        throw core::InputError("a bearing's node is not a master node of the reduced rotor");
      b.ports.push_back({{b.journal[static_cast<std::size_t>(d)], 1.0}});
      if (!s.has_pedestal) continue;
      b.pedestal[static_cast<std::size_t>(d)] = n_++;
      b.ports.back().emplace_back(b.pedestal[static_cast<std::size_t>(d)], -1.0);
    }
    bearings_.push_back(std::move(b));
  }
  n_own_ = 0;
  core::agree(comm_, [&] {
    for (std::size_t i = 0; i < bearings_.size(); ++i) {
      const Support& s = train_.supports[i];
      if (film::has_states(s.film)) {
        bearings_[i].part = std::make_unique<FilmPart>(film::make_state_model(s.geometry, s.film, s.lubricant), n_own_);
        n_own_ = bearings_[i].part->end();
      } else {
        bearings_[i].film = film::make_model(s.geometry, s.film, s.lubricant);
      }
    }
  });
  PetscInt rotor_begin = 0, rotor_end = 0, rotor_here = 0;
  check(MatGetLocalSize(m.mass.get(), &rotor_here, nullptr));
  first_holds_rotor_ =
      std::any_of(bearings_.begin(), bearings_.end(), [](const Bearing& b) { return b.part != nullptr; });
  core::Matrix moved[4];
  Mat parts[] = {m.mass.get(), m.damping.get(), m.stiffness.get(), m.gyroscopic.get()};
  for (std::size_t k = 0; k < 4 && first_holds_rotor_ && core::size_of(comm_) > 1; ++k) {
    moved[k] = on_first(parts[k]);
    parts[k] = moved[k].get();
  }
  check(MatGetOwnershipRange(parts[0], &rotor_begin, &rotor_end));
  const int rank = core::rank_of(comm_), with_pedestals_on = first_holds_rotor_ ? 0 : core::size_of(comm_) - 1;
  begin_ = rank > with_pedestals_on ? n_ : rotor_begin;
  end_ = rank >= with_pedestals_on ? n_ : rotor_end;
  share_out_own_states();
  std::vector<std::pair<PetscInt, double>> pm, pc, pk, pg;
  for (std::size_t i = 0; i < bearings_.size(); ++i)
    for (std::size_t d = 0; d < 2; ++d)
      if (bearings_[i].pedestal[d] >= 0) {
        pm.emplace_back(bearings_[i].pedestal[d], train_.supports[i].mass[d]);
        pc.emplace_back(bearings_[i].pedestal[d], train_.supports[i].damping[d]);
        pk.emplace_back(bearings_[i].pedestal[d], train_.supports[i].stiffness[d]);
      }
  mass_ = with_pedestals(parts[0], end_ - begin_, n_rotor_, pm);
  damping_ = with_pedestals(parts[1], end_ - begin_, n_rotor_, pc);
  stiffness_ = with_pedestals(parts[2], end_ - begin_, n_rotor_, pk);
  gyroscopic_ = with_pedestals(parts[3], end_ - begin_, n_rotor_, pg);

  load_.assign(static_cast<std::size_t>(end_ - begin_), 0.0);
  {
    const std::vector<double> g = core::gather(m.gravity.get());
    for (PetscInt i = begin_; i < std::min(end_, n_rotor_); ++i)
      load_[static_cast<std::size_t>(i - begin_)] = train_.gravity * g[static_cast<std::size_t>(i)];
  }
  if (train_.rotor.type == rotor::Options::Type::rigid && owns(rotor_->coordinate(1, 1)))
    load_[static_cast<std::size_t>(rotor_->coordinate(1, 1) - begin_)] -= train_.rotor.load;
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    const PetscInt row = bearings_[i].pedestal[1];
    if (row >= 0 && owns(row))
      load_[static_cast<std::size_t>(row - begin_)] -= train_.gravity * train_.supports[i].mass[1];
  }

  // U Omega^2 (cos, sin)(angle + phase) as cosine and sine parts, through T^T where the rotor is reduced.
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
    for (const UnbalanceMass& u : train_.unbalance) {
      const PetscInt x = reduced ? 4 * (u.node - 1) : rotor_->coordinate(u.node, 0), y = x + 1;
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
  unbalance_c_ = core::gather(c.get());
  unbalance_s_ = core::gather(s.get());
  unbalance_c_.resize(static_cast<std::size_t>(n_), 0.0);
  unbalance_s_.resize(static_cast<std::size_t>(n_), 0.0);

  // Which entries of the state the films see: journal and pedestal positions and velocities, and own states.
  wanted_.clear();
  for (const Bearing& b : bearings_)
    for (std::size_t d = 0; d < 2; ++d)
      for (const PetscInt q : {b.journal[d], b.pedestal[d]})
        for (PetscInt rate = 0; rate < 2; ++rate) wanted_.push_back(2 * std::max<PetscInt>(q, 0) + rate);
  for (const Bearing& b : bearings_)
    for (std::size_t k = 0; b.part && k < b.part->share().seen.size(); ++k)
      wanted_.push_back(2 * n_ + b.part->first() + b.part->share().seen[k]);
  core::Vector state = core::make_vector(comm_, local_size(), PETSC_DETERMINE);
  core::IndexSet from;
  check(ISCreateGeneral(PETSC_COMM_SELF, static_cast<PetscInt>(wanted_.size()), wanted_.data(), PETSC_COPY_VALUES,
                        from.put()));
  inputs_ = core::make_vector(PETSC_COMM_SELF, static_cast<PetscInt>(wanted_.size()), PETSC_DETERMINE);
  check(VecScatterCreate(state.get(), from.get(), inputs_.get(), nullptr, gather_inputs_.put()));
  if (blocks_) blocks_->rebuild();
  neighbours_ = {};
  settling_.reset();
  j_at_rest_.reset();
  film_entries_ = {};
}

// Own states stand behind all pairs, film by film, in near equal shares of all.
void RotorSystem::share_out_own_states() {
  const int rank = core::rank_of(comm_), size = core::size_of(comm_);
  const auto cut = [&](int r) -> PetscInt {
    const PetscInt wanted = n_own_ * r / size;
    for (const Bearing& b : bearings_)
      if (b.part && wanted < b.part->end())
        return b.part->first() + b.part->film().cut(static_cast<int>(wanted - b.part->first()));
    return n_own_;
  };
  const PetscInt begin = cut(rank), end = cut(rank + 1);
  own_here_ = end - begin;
  std::size_t gathered = 0;
  for (const Bearing& b : bearings_) {
    if (!b.part) continue;
    b.part->hold(begin, end, 2 * (end_ - begin_), gathered);
    gathered += b.part->share().seen.size();
  }
}

// The parts of the Jacobian that are constant between builds, all in the pattern of make_jacobian(): so a Jacobian is a
// sum of arrays plus the few entries of the films.
void RotorSystem::make_constant_parts() {
  const PetscInt rows = end_ - begin_, local_rows = local_size();
  std::vector<PetscInt> count(static_cast<std::size_t>(std::max<PetscInt>(local_rows, 1)), 2);
  std::vector<PetscInt> coupled(static_cast<std::size_t>(n_), 0);  // own states that act on a coordinate
  for (const Bearing& b : bearings_) {
    if (!b.part) continue;
    for (const PortEnds& port : b.ports)
      for (const auto& [q, side] : port) coupled[static_cast<std::size_t>(q)] += b.part->count();
    b.part->count_entries(b.ports, count);
  }
  for (PetscInt& c : count) c = std::min(c, size());
  for (PetscInt i = 0; i < rows; ++i) {
    PetscInt k = 0, total = coupled[static_cast<std::size_t>(begin_ + i)];
    for (Mat m : {mass_.get(), damping_.get(), stiffness_.get(), gyroscopic_.get()}) {
      check(MatGetRow(m, begin_ + i, &k, nullptr, nullptr));
      total += 2 * k;
      check(MatRestoreRow(m, begin_ + i, &k, nullptr, nullptr));
    }
    count[static_cast<std::size_t>(2 * i)] = std::min(total + 8, size());
  }
  std::vector<PetscInt> columns_to;
  std::vector<PetscScalar> scaled;
  // Every part sets every entry, if need be to zero.
  const auto make = [&](double at_rest, double gyroscopic, double rates) {
    core::Matrix j = core::make_matrix(comm_, local_rows, count);
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
        check(MatSetValues(j.get(), 1, &row, k, columns_to.data(), scaled.data(), ADD_VALUES));
        check(MatRestoreRow(m, i, &k, &columns, &values));
      }
    };
    add(stiffness_.get(), 0, at_rest);
    add(damping_.get(), 1, at_rest);
    add(gyroscopic_.get(), 1, gyroscopic);
    add(mass_.get(), 1, rates);
    for (PetscInt i = begin_; i < end_; ++i) {
      check(MatSetValue(j.get(), 2 * i + 1, 2 * i, rates, ADD_VALUES));
      check(MatSetValue(j.get(), 2 * i + 1, 2 * i + 1, -at_rest, ADD_VALUES));
    }
    add_films(j.get(), nullptr, 0, 0);
    check(MatAssemblyBegin(j.get(), MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(j.get(), MAT_FINAL_ASSEMBLY));
    return j;
  };
  j_at_rest_ = make(1, 0, 0);
  j_gyroscopic_ = make(0, 1, 0);
  j_rates_ = make(0, 0, 1);
}

core::Matrix RotorSystem::make_jacobian() {
  if (!j_at_rest_) make_constant_parts();
  core::Matrix j;
  check(MatDuplicate(j_at_rest_.get(), MAT_DO_NOT_COPY_VALUES, j.put()));
  return j;
}

}  // namespace whirl::system
