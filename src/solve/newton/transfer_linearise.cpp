// The linearisation that a transfer function is made of.

#include <algorithm>
#include <span>

#include "solve/newton/transfer_part.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/matrix_rows.hpp"

namespace whirl::solve {

using core::check;
using Eigen::Index;

namespace {

core::Matrix block(Mat a, IS rows, IS columns) {
  core::Matrix m;
  check(MatCreateSubMatrix(a, rows, columns, MAT_INITIAL_MATRIX, m.put()));
  return m;
}

core::Matrix transpose(const core::Matrix& m) {
  core::Matrix t;
  check(MatTranspose(m.get(), MAT_INITIAL_MATRIX, t.put()));
  return t;
}

}  // namespace

void TransferFunction::linearise(Vec x) {
  check(VecCopy(x, x_.get()));
  system_.scales(state_scale_.get(), row_scale_.get());
  const auto at_hub = [&](Vec v) {
    core::Vector part;
    std::vector<double> out(static_cast<std::size_t>(hub_), 0);
    const core::ReadArray a(v);
    PetscInt begin = 0;
    check(VecGetOwnershipRange(v, &begin, nullptr));
    for (std::size_t k = 0; k < out.size(); ++k)
      if (const PetscInt i = hub_numbers_[k] - begin; i >= 0 && i < a.size()) out[k] = a[i];
    MPI_Allreduce(MPI_IN_PLACE, out.data(), static_cast<int>(out.size()), MPI_DOUBLE, MPI_SUM, system_.comm());
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
  if (!eliminates_by_inverse() || !take_entries()) take_assembled();
}

void TransferFunction::assemble() const {
  if (parts_.front()->a) return;
  for (core::Matrix* j : {&jx_, &jd_}) {
    if (!*j) *j = system_.make_jacobian();
    system_.jacobian(0, x_.get(), rest_.get(), j == &jx_ ? 1 : 0, j == &jx_ ? 0 : 1, j->get());
    check(MatDiagonalScale(j->get(), row_scale_.get(), state_scale_.get()));
  }
  for (const auto& p : parts_) {
    p->a = block(jx_.get(), p->rows.get(), p->rows.get());
    p->b = block(jd_.get(), p->rows.get(), p->rows.get());
  }
}

void TransferFunction::take_assembled() {
  assemble();
  a_hub_ = core::gather_matrix(block(jx_.get(), hub_rows_.get(), hub_rows_.get()).get());
  b_hub_ = core::gather_matrix(block(jd_.get(), hub_rows_.get(), hub_rows_.get()).get());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Coupled& p = *parts_[i];
    const core::Matrix g = block(jx_.get(), p.rows.get(), hub_rows_.get());
    const core::Matrix f = transpose(block(jx_.get(), hub_rows_.get(), p.rows.get()));
    ports_[i].seen = core::used_columns(g.get());
    ports_[i].forces = core::used_columns(f.get());
    p.g0 = core::thin(g.get(), ports_[i].seen);
    p.f0 = core::thin(f.get(), ports_[i].forces);
    p.g1 = core::thin(block(jd_.get(), p.rows.get(), hub_rows_.get()).get(), ports_[i].seen);
    p.f1 = core::thin(transpose(block(jd_.get(), hub_rows_.get(), p.rows.get())).get(), ports_[i].forces);
  }
}

// Calls f(part or -1, row of the part here, number in the hub of the row or -1, of the column, entry) for entries that
// are not of a part alone: the row of the part is that of its state in G, its column in F.
struct TransferFunction::Listed {
  const TransferFunction& of;
  PetscInt begin;

  template <class F>
  void operator()(F&& f) const {
    const std::span<const problem::Entries::Place> places = of.entries_.places();
    const std::vector<PetscInt>& hub = of.hub_numbers_;
    const auto in_hub = [&](PetscInt k) -> Index {
      if (k < hub.front() || k > hub.back()) return -1;
      const auto at = std::lower_bound(hub.begin(), hub.end(), k);
      return *at == k ? at - hub.begin() : -1;
    };
    std::size_t part = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
      const Index row = in_hub(places[k].row), column = in_hub(places[k].column);
      if (row < 0 && column < 0) continue;
      if (row >= 0 && column >= 0) {
        f(part, Index{-1}, row, column, k);
        continue;
      }
      const PetscInt state = (row < 0 ? places[k].row : places[k].column) - begin;
      const auto holds = [&](std::size_t p) {
        return state >= of.parts_[p]->first && state < of.parts_[p]->first + of.parts_[p]->count;
      };
      if (!holds(part)) {
        part = 0;
        while (part < of.parts_.size() && !holds(part)) ++part;
        core::require(part < of.parts_.size(), "entries in rows and columns of parts on this rank");
      }
      f(part, Index{state - of.parts_[part]->first}, row, column, k);
    }
  }
};

bool TransferFunction::take_entries() {
  if (!system_.entries(0, x_.get(), rest_.get(), 1, 0, entries_)) return false;
  PetscInt begin = 0;
  check(VecGetOwnershipRange(rest_.get(), &begin, nullptr));
  const Listed listed{*this, begin};
  const auto hub = static_cast<std::size_t>(hub_);
  std::vector<unsigned char> used(2 * hub * parts_.size(), 0);
  listed([&](std::size_t part, Index at, Index row, Index column, std::size_t) {
    if (at < 0) return;
    used[(2 * part + (row < 0 ? 0 : 1)) * hub + static_cast<std::size_t>(row < 0 ? column : row)] = 1;
  });
  MPI_Allreduce(MPI_IN_PLACE, used.data(), static_cast<int>(used.size()), MPI_UNSIGNED_CHAR, MPI_MAX, comm());
  std::vector<Index> place(used.size(), -1);  // among the ports of its part
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (k % hub == 0) (k / hub % 2 == 0 ? ports_[k / hub / 2].seen : ports_[k / hub / 2].forces).clear();
    if (!used[k]) continue;
    std::vector<PetscInt>& to = k / hub % 2 == 0 ? ports_[k / hub / 2].seen : ports_[k / hub / 2].forces;
    place[k] = static_cast<Index>(to.size());
    to.push_back(static_cast<PetscInt>(k % hub));
  }
  const core::ReadArray states(state_scale_.get()), rows(row_scale_.get());
  for (const bool rates : {false, true}) {
    if (rates) (void)system_.entries(0, x_.get(), rest_.get(), 0, 1, entries_);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      Coupled& p = *parts_[i];
      (rates ? p.g1 : p.g0).setZero(p.count, static_cast<Index>(ports_[i].seen.size()));
      (rates ? p.f1 : p.f0).setZero(p.count, static_cast<Index>(ports_[i].forces.size()));
    }
    std::vector<double> mine;
    const std::span<const double> values = entries_.values();
    listed([&](std::size_t part, Index at, Index row, Index column, std::size_t k) {
      const auto r = static_cast<std::size_t>(row), c = static_cast<std::size_t>(column);
      if (at < 0) {
        mine.insert(mine.end(), {static_cast<double>(row), static_cast<double>(column),
                                 values[k] * hub_scale_[c] / hub_row_scale_[r]});
        return;
      }
      Coupled& p = *parts_[part];
      const auto i = p.first + static_cast<PetscInt>(at);
      if (row < 0)
        (rates ? p.g1 : p.g0)(at, place[2 * part * hub + c]) += values[k] * rows[i] * hub_scale_[c];
      else
        (rates ? p.f1 : p.f0)(at, place[(2 * part + 1) * hub + r]) += values[k] * states[i] / hub_row_scale_[r];
    });
    (rates ? b_hub_ : a_hub_) = core::gather_entries(comm(), hub_, mine);
  }
  return true;
}

}  // namespace whirl::solve
