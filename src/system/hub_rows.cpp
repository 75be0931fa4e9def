#include "hub_rows.hpp"

#include <algorithm>
#include <utility>

#include "whirl/core/error.hpp"

namespace whirl::system {
namespace {

using core::check;

bool before(const HubRows::Entry& a, const HubRows::Entry& b) {
  return std::pair(a.row, a.column) < std::pair(b.row, b.column);
}

void add(HubRows::Entry& to, double factor, const HubRows::Entry& e) {
  to.at_rest += factor * e.at_rest;
  to.turning += factor * e.turning;
  to.rates += factor * e.rates;
}

}  // namespace

HubRows::HubRows(std::vector<Entry> entries) : entries_(std::move(entries)) {
  std::stable_sort(entries_.begin(), entries_.end(), before);
  std::size_t kept = 0;
  for (const Entry& e : entries_)
    if (kept > 0 && !before(entries_[kept - 1], e))
      add(entries_[kept - 1], 1, e);
    else
      entries_[kept++] = e;
  entries_.resize(kept);
}

HubRows HubRows::combined(double f, const HubRows& a, double g, const HubRows& b) {
  std::vector<Entry> all;
  for (const auto& [rows, factor] : {std::pair{&a, f}, std::pair{&b, g}})
    for (const Entry& e : rows->entries_)
      all.push_back({e.row, e.column, factor * e.at_rest, factor * e.turning, factor * e.rates});
  return HubRows(std::move(all));
}

void HubRows::set(const HubRows& base, const HubRows& change) {
  for (const Entry& e : change.entries_) {
    const auto place = std::lower_bound(base.entries_.begin(), base.entries_.end(), e, before) - base.entries_.begin();
    Entry& here = entries_[static_cast<std::size_t>(place)];
    core::require(here.row == e.row && here.column == e.column, "an entry with a place");
    here = base.entries_[static_cast<std::size_t>(place)];
    add(here, 1, e);
  }
}

void HubRows::add_products(double f, double g, Vec x, Vec xdot, double* sums) const {
  PetscInt first = 0, end = 0;
  check(VecGetOwnershipRange(x, &first, &end));
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(x));
  const bool alone = core::size_of(comm) == 1;
  if (!alone && !others_) {
    Others o;
    for (const Entry& e : entries_)
      if (e.column < first || e.column >= end) o.columns.push_back(e.column);
    std::sort(o.columns.begin(), o.columns.end());
    o.columns.erase(std::unique(o.columns.begin(), o.columns.end()), o.columns.end());
    const auto count = static_cast<PetscInt>(o.columns.size());
    core::IndexSet from;
    check(ISCreateGeneral(PETSC_COMM_SELF, count, o.columns.data(), PETSC_COPY_VALUES, from.put()));
    o.values = core::make_vector(PETSC_COMM_SELF, count, PETSC_DETERMINE);
    check(VecScatterCreate(x, from.get(), o.values.get(), nullptr, o.gather.put()));
    others_ = std::make_shared<const Others>(std::move(o));
  }
  const auto add = [&](Vec v, const auto& factor) {
    if (!alone) {
      const Others& o = *others_;
      check(VecScatterBegin(o.gather.get(), v, o.values.get(), INSERT_VALUES, SCATTER_FORWARD));
      check(VecScatterEnd(o.gather.get(), v, o.values.get(), INSERT_VALUES, SCATTER_FORWARD));
    }
    const core::ReadArray own(v);
    const auto sum = [&](const auto& value) {
      for (const Entry& e : entries_) sums[e.row - first] += factor(e) * value(e.column);
    };
    if (alone) return sum([&](PetscInt c) { return own[c]; });
    const Others& o = *others_;
    const core::ReadArray others(o.values.get());
    sum([&](PetscInt c) {
      if (c >= first && c < end) return own[c - first];
      return others[static_cast<PetscInt>(std::lower_bound(o.columns.begin(), o.columns.end(), c) - o.columns.begin())];
    });
  };
  if (f != 0 || g != 0) add(x, [f, g](const Entry& e) { return f * e.at_rest + g * e.turning; });
  if (xdot) add(xdot, [](const Entry& e) { return e.rates; });
}

}  // namespace whirl::system
