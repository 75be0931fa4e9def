#pragma once
// A linearisation entry by entry.

#include <petscsystypes.h>

#include <span>
#include <vector>

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
  [[nodiscard]] std::span<const double> values() const { return values_; }

private:
  bool placed_ = false;
  std::vector<Place> places_;
  std::vector<double> values_;
};

}  // namespace whirl::problem
