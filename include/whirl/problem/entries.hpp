#pragma once
// A linearisation entry by entry.

#include <span>
#include <vector>

#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::problem {

/// Entries of a matrix in an order that is the same in every pass, rows and columns numbered as states. Those of one
/// place add up. Where parts are spread over ranks, each rank adds the entries in its rows, and those that rows of the
/// hub have in columns of its parts, wherever the row stands: so nothing that is as long as a part travels.
class Entries {
public:
  struct Place {
    PetscInt row, column;
  };
  /// A pass begins; the first one takes the places.
  void begin() {
    placed_ = placed_ || !values_.empty();
    values_.clear();
  }
  void add(PetscInt row, PetscInt column, double value) {
    values_.push_back(value);
    if (!placed_) places_.push_back({row, column});
  }
  [[nodiscard]] std::span<const Place> places() const { return places_; }
  /// Of a pass that has ended; core::Bug if it listed more or less than the first one.
  [[nodiscard]] std::span<const double> values() const {
    core::require(values_.size() == places_.size(), "entries are listed in the same order in every pass");
    return values_;
  }

  /// A matrix of zeros with these places, `local` rows and columns here; it may be filled by MatSetValuesCOO().
  /// Collective.
  [[nodiscard]] core::Matrix matrix(MPI_Comm comm, PetscInt local) const;

private:
  bool placed_ = false;
  std::vector<Place> places_;
  std::vector<double> values_;
};

}  // namespace whirl::problem
