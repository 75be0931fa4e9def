#pragma once
// A matrix between states that stand in lines which form a ring: its entries by diagonals.

#include <span>

namespace whirl::film {

/// Lines [begin, end) of a ring: a line is a run of consecutive states.
struct Lines {
  int begin = 0, end = 1;
  [[nodiscard]] int count() const { return end - begin; }
};

/// The rows of some lines, one array [rows] per place of the neighbour, one behind the other: `before` and `after` are
/// the lines on either side, `below` and `above` the neighbours within the line, where zero at its ends.
struct Stencil {
  enum Place { centre, before, after, below, above, second_before };
  /// Places of a film that looks `reach` lines back.
  static int places(int reach) { return reach == 2 ? 6 : 5; }
  /// Where a place begins among the values of n rows.
  static double* at(Place place, std::size_t n, double* values) { return values + static_cast<std::size_t>(place) * n; }
  static const double* at(Place place, std::size_t n, const double* values) {
    return values + static_cast<std::size_t>(place) * n;
  }
};

}  // namespace whirl::film
