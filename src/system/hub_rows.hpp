#pragma once
// The rows of a hub, entry by entry.

#include <memory>
#include <vector>

#include "whirl/core/petsc.hpp"

namespace whirl::system {

/// Rows that are linear in states and rates, those of one rank: A x + Omega T x + R x'. Rows and columns are numbers of
/// states over all ranks, the hub's before all others.
class HubRows {
public:
  struct Entry {
    PetscInt row, column;
    double at_rest = 0, turning = 0, rates = 0;  ///< of A, T and R
  };
  HubRows() = default;
  /// Entries of one place add up; zeros keep their places.
  explicit HubRows(std::vector<Entry> entries);
  /// f a + g b.
  [[nodiscard]] static HubRows combined(double f, const HubRows& a, double g, const HubRows& b);
  /// By rows, and by columns in each.
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  /// Puts base + change at the places of `change`; they are places of this and of `base`.
  void set(const HubRows& base, const HubRows& change);
  /// sums[row - first row of this rank] += f A x + g T x, and R xdot if `xdot` is not null. The vectors are those of a
  /// whole machine. Collective.
  void add_products(double f, double g, Vec x, Vec xdot, double* sums) const;

private:
  /// Of the columns on other ranks, what this one sees.
  struct Others {
    core::Vector values;
    core::Scatter gather;
    std::vector<PetscInt> columns;
  };
  std::vector<Entry> entries_;
  mutable std::shared_ptr<const Others> others_;  // once wanted on several ranks
};

/// Calls take(row, column, value) for the entries of this rank's rows.
template <class Take>
void for_entries(Mat m, const Take& take) {
  PetscInt begin = 0, end = 0;
  core::check(MatGetOwnershipRange(m, &begin, &end));
  for (PetscInt i = begin; i < end; ++i) {
    PetscInt n = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    core::check(MatGetRow(m, i, &n, &columns, &values));
    for (PetscInt e = 0; e < n; ++e) take(i, columns[e], values[e]);
    core::check(MatRestoreRow(m, i, &n, &columns, &values));
  }
}

}  // namespace whirl::system
