// The linearisation that a resolvent at complex frequencies is made of.

#include <algorithm>
#include <span>

#include "solve/newton/frequency_hub.hpp"
#include "solve/newton/frequency_inverse.hpp"
#include "solve/newton/frequency_part.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/matrix_rows.hpp"
#include "whirl/core/plan.hpp"

namespace whirl::solve {

using core::check;
using Eigen::Index;

// Where the entries of the list belong.
struct FrequencyResolvent::Places {
  struct Hub {
    std::size_t entry, row, column;
    Index value;  // among those of a and b
  };
  // Of G_i: row of the part here, one of its ports. Of F_i: column of the part here, one of its forces.
  struct Port {
    std::size_t entry, part;
    bool force;
    Index state, port;
    std::size_t hub;
  };
  std::vector<Hub> hub;
  std::vector<Port> ports;
  bool own = false;  // those of A_i are known too
};

FrequencyResolvent::FrequencyResolvent(problem::System& system)
    : system_(system), hub_(std::make_unique<FrequencyHub>()) {
  rest_ = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  for (core::Vector* v : {&x_, &state_scale_, &row_scale_}) *v = core::duplicate(rest_.get());
  check(VecGetOwnershipRange(rest_.get(), &begin_, nullptr));
  std::vector<bool> taken(static_cast<std::size_t>(system.local_size()), false);
  const std::vector<problem::Field> fields = problem::parts_of(system.fields());
  PetscInt largest = 0;
  for (std::size_t f = 1; f < fields.size(); ++f) {
    auto part = std::make_unique<Coupled>();
    part->first = fields[f].begin;
    part->count = fields[f].end - fields[f].begin;
    std::fill(taken.begin() + fields[f].begin, taken.begin() + fields[f].end, true);
    PetscInt sizes[] = {part->count, part->count}, most = 0;
    MPI_Allreduce(&sizes[0], &most, 1, MPIU_INT, MPI_MAX, comm());
    MPI_Exscan(&sizes[0], &part->offset, 1, MPIU_INT, MPI_SUM, comm());
    MPI_Allreduce(&sizes[1], &part->states, 1, MPIU_INT, MPI_SUM, comm());
    part->alone = most == part->states;
    largest = std::max(largest, part->states);
    parts_.push_back(std::move(part));
    ports_.push_back({fields[f].name, {}, {}});
  }
  core::IndexSet rows, all;
  for (std::size_t i = 0; i < taken.size(); ++i)
    if (!taken[i]) hub_numbers_.push_back(begin_ + static_cast<PetscInt>(i));
  check(ISCreateGeneral(comm(), static_cast<PetscInt>(hub_numbers_.size()), hub_numbers_.data(), PETSC_COPY_VALUES,
                        rows.put()));
  check(ISAllGather(rows.get(), all.put()));
  PetscInt size = 0;
  const PetscInt* numbers = nullptr;
  check(ISGetSize(all.get(), &size));
  check(ISGetIndices(all.get(), &numbers));
  hub_numbers_.assign(numbers, numbers + size);
  check(ISRestoreIndices(all.get(), &numbers));
  auto inverse = parts_.empty() ? nullptr : system.make_part_inverse();
  if (inverse && inverse->exact() != nullptr)
    inverse_ = std::move(inverse);
  else if (inverse && largest > core::plan::kept_states())
    iterated_ = std::make_unique<FrequencyInverse>(system, std::move(inverse));
}

FrequencyResolvent::~FrequencyResolvent() = default;

void FrequencyResolvent::linearise(Vec x) {
  check(VecCopy(x, x_.get()));
  system_.scales(state_scale_.get(), row_scale_.get());
  const auto at_hub = [&](Vec v) {
    std::vector<double> out(hub_numbers_.size(), 0);
    const core::ReadArray a(v);
    for (std::size_t k = 0; k < out.size(); ++k)
      if (const PetscInt i = hub_numbers_[k] - begin_; i >= 0 && i < a.size()) out[k] = a[i];
    MPI_Allreduce(MPI_IN_PLACE, out.data(), static_cast<int>(out.size()), MPI_DOUBLE, MPI_SUM, comm());
    return out;
  };
  hub_scale_ = at_hub(state_scale_.get());
  hub_row_scale_ = at_hub(row_scale_.get());
  check(VecReciprocal(row_scale_.get()));
  for (const auto& p : parts_) {
    p->a.reset();
    p->b.reset();
    p->x.resize(0, 0);
    p->dx.resize(0, 0);
  }
  take_entries(!eliminates_by_inverse());
  std::vector<bool> in_parts(hub_numbers_.size(), false);
  for (const Ports& p : ports_)
    for (const PetscInt row : p.forces) in_parts[static_cast<std::size_t>(row)] = true;
  hub_->linearise(in_parts);
}

void FrequencyResolvent::take_entries(bool factors) {
  own_taken_ = factors;
  const core::ReadArray states(state_scale_.get()), rows(row_scale_.get());
  std::vector<double> hub_rows;
  for (const double scale : hub_row_scale_) hub_rows.push_back(1 / scale);
  for (const bool rates : {false, true}) {
    list(rates);
    if (!places_ || (factors && !places_->own)) sort_places(factors);
    const std::span<const double> values = entries_.values();
    FrequencyHub::Sparse& hub = rates ? hub_->b : hub_->a;
    std::fill_n(hub.valuePtr(), hub.nonZeros(), 0.0);
    for (const Places::Hub& e : places_->hub)
      hub.valuePtr()[e.value] += values[e.entry] * hub_scale_[e.column] * hub_rows[e.row];
    if (core::size_of(comm()) > 1)
      MPI_Allreduce(MPI_IN_PLACE, hub.valuePtr(), static_cast<int>(hub.nonZeros()), MPI_DOUBLE, MPI_SUM, comm());
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      Coupled& p = *parts_[i];
      (rates ? p.g1 : p.g0).setZero(p.count, static_cast<Index>(ports_[i].seen.size()));
      (rates ? p.f1 : p.f0).setZero(p.count, static_cast<Index>(ports_[i].forces.size()));
      std::vector<double>& own = rates ? p.rates : p.at_rest;
      own.resize(factors ? p.entries.size() : 0);
      for (std::size_t k = 0; k < own.size(); ++k)
        own[k] = values[p.entries[k]] * rows[p.first + p.places[k].row - p.offset];
    }
    for (const Places::Port& e : places_->ports) {
      Coupled& p = *parts_[e.part];
      const PetscInt i = p.first + static_cast<PetscInt>(e.state);
      if (e.force)
        (rates ? p.f1 : p.f0)(e.state, e.port) += values[e.entry] * states[i] * hub_rows[e.hub];
      else
        (rates ? p.g1 : p.g0)(e.state, e.port) += values[e.entry] * rows[i] * hub_scale_[e.hub];
    }
  }
}

// Entries of an assembled matrix: those that rows of the hub have in columns of a part go to the rank that holds it.
void FrequencyResolvent::list(bool rates) {
  const double alpha = rates ? 0 : 1, sigma = rates ? 1 : 0;
  if (system_.entries(0, x_.get(), rest_.get(), alpha, sigma, entries_)) return;
  core::Matrix& j = rates ? jd_ : jx_;
  if (!j) j = system_.make_jacobian();
  system_.jacobian(0, x_.get(), rest_.get(), alpha, sigma, j.get());
  const bool spread = core::size_of(comm()) > 1 && !parts_.empty();
  const auto in_hub = [this](PetscInt k) { return std::ranges::binary_search(hub_numbers_, k); };
  std::vector<double> away;
  entries_.begin();
  core::for_rows(j.get(), [&](PetscInt i, const PetscInt* columns, const PetscScalar* values, PetscInt count) {
    const bool hub = spread && in_hub(begin_ + i);
    for (PetscInt k = 0; k < count; ++k)
      if (hub && !in_hub(columns[k]))
        away.insert(away.end(), {static_cast<double>(begin_ + i), static_cast<double>(columns[k]), values[k]});
      else
        entries_.add(begin_ + i, columns[k], values[k]);
  });
  if (!spread) return;
  const Eigen::SparseMatrix<double> all = core::gather_entries(comm(), size(), away);
  for (PetscInt c = begin_; c < begin_ + system_.local_size(); ++c)
    for (Eigen::SparseMatrix<double>::InnerIterator e(all, c); e; ++e)
      entries_.add(static_cast<PetscInt>(e.row()), c, e.value());
}

void FrequencyResolvent::sort_places(bool own) {
  places_ = std::make_unique<Places>();
  places_->own = own;
  const std::size_t hub = hub_numbers_.size();
  const auto in_hub = [&](PetscInt k) {
    const auto at = std::ranges::lower_bound(hub_numbers_, k);
    return at != hub_numbers_.end() && *at == k ? at - hub_numbers_.begin() : -1;
  };
  // Of every part on every rank: its first state, and how many of its states stand on lower ranks.
  const auto ranks = static_cast<std::size_t>(core::size_of(comm()));
  std::vector<std::vector<PetscInt>> firsts(parts_.size()), offsets(parts_.size());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Coupled& p = *parts_[i];
    p.places.clear();
    p.entries.clear();
    const PetscInt first = begin_ + p.first;
    firsts[i].resize(ranks);
    offsets[i].resize(ranks);
    MPI_Allgather(&first, 1, MPIU_INT, firsts[i].data(), 1, MPIU_INT, comm());
    MPI_Allgather(&p.offset, 1, MPIU_INT, offsets[i].data(), 1, MPIU_INT, comm());
  }
  // A matrix without gaps has places of one part in columns of another too: -1.
  const auto number = [&](std::size_t part, PetscInt state) -> PetscInt {
    const auto next = static_cast<std::size_t>(std::ranges::upper_bound(firsts[part], state) - firsts[part].begin());
    if (next == 0) return -1;
    const PetscInt at = offsets[part][next - 1] + state - firsts[part][next - 1];
    return at < (next < ranks ? offsets[part][next] : parts_[part]->states) ? at : -1;
  };
  std::vector<double> mine;
  std::vector<unsigned char> used(2 * hub * parts_.size(), 0);
  std::size_t part = 0;
  const std::span<const problem::Entries::Place> places = entries_.places();
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Index row = in_hub(places[k].row), column = in_hub(places[k].column);
    if (row >= 0 && column >= 0) {
      places_->hub.push_back({k, static_cast<std::size_t>(row), static_cast<std::size_t>(column), 0});
      mine.insert(mine.end(), {static_cast<double>(row), static_cast<double>(column), 0.0});
      continue;
    }
    const PetscInt state = (row < 0 ? places[k].row : places[k].column) - begin_;
    const auto holds = [&](std::size_t p) {
      return state >= parts_[p]->first && state < parts_[p]->first + parts_[p]->count;
    };
    if (!holds(part)) {
      part = 0;
      while (part < parts_.size() && !holds(part)) ++part;
      core::require(part < parts_.size(), "entries in rows and columns of parts on this rank");
    }
    Coupled& p = *parts_[part];
    if (row >= 0 || column >= 0) {
      const auto at = static_cast<std::size_t>(row < 0 ? column : row);
      used[(2 * part + (row < 0 ? 0 : 1)) * hub + at] = 1;
      places_->ports.push_back({k, part, row >= 0, state - p.first, 0, at});
    } else if (const PetscInt to = own ? number(part, places[k].column) : -1; to >= 0) {
      p.places.push_back({number(part, places[k].row), to});
      p.entries.push_back(k);
    }
  }
  hub_->a = hub_->b = core::gather_entries(comm(), static_cast<Index>(hub), mine);
  for (Places::Hub& e : places_->hub) {
    const auto* first = hub_->a.innerIndexPtr();
    const auto* const column = hub_->a.outerIndexPtr() + e.column;
    e.value = std::lower_bound(first + column[0], first + column[1], static_cast<int>(e.row)) - first;
  }
  MPI_Allreduce(MPI_IN_PLACE, used.data(), static_cast<int>(used.size()), MPI_UNSIGNED_CHAR, MPI_MAX, comm());
  std::vector<Index> port(used.size(), -1);  // among the ports of its part
  for (std::size_t k = 0; k < used.size(); ++k) {
    Ports& of = ports_[k / hub / 2];
    std::vector<PetscInt>& to = k / hub % 2 == 0 ? of.seen : of.forces;
    if (k % hub == 0) to.clear();
    if (!used[k]) continue;
    port[k] = static_cast<Index>(to.size());
    to.push_back(static_cast<PetscInt>(k % hub));
  }
  for (Places::Port& e : places_->ports) e.port = port[(2 * e.part + (e.force ? 1 : 0)) * hub + e.hub];
}

void FrequencyResolvent::assemble() const {
  if (parts_.empty() || parts_.front()->a) return;
  for (core::Matrix* j : {&jx_, &jd_}) {
    if (!*j) *j = system_.make_jacobian();
    system_.jacobian(0, x_.get(), rest_.get(), j == &jx_ ? 1 : 0, j == &jx_ ? 0 : 1, j->get());
    check(MatDiagonalScale(j->get(), row_scale_.get(), state_scale_.get()));
  }
  for (const auto& p : parts_) {
    core::IndexSet rows;
    check(ISCreateStride(comm(), p->count, begin_ + p->first, 1, rows.put()));
    for (const bool rates : {false, true})
      check(MatCreateSubMatrix((rates ? jd_ : jx_).get(), rows.get(), rows.get(), MAT_INITIAL_MATRIX,
                               (rates ? p->b : p->a).put()));
  }
}

}  // namespace whirl::solve
