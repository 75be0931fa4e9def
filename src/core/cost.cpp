#include "whirl/core/cost.hpp"

namespace whirl::core::cost {

// In a step the blocks of a dense Jacobian are added and scaled 25 times over; a sparse one goes entry by entry into
// the matrix and into the factors. The call of a sparse product takes 2000.
bool dense_is_cheaper(Work work, std::int64_t states, std::int64_t entries) {
  const auto n = static_cast<double>(states), sparse = scattered * static_cast<double>(entries);
  if (work == Work::product) return streamed * n * n <= sparse + 2000;
  return n * n * n / 3 + 25 * scattered * n * n < call + 190 * sparse;
}

// Each state of a level takes 170 with what is done for it on all coarser levels.
double repeated_level(std::int64_t lines, std::int64_t line, int ranks) {
  return 170 * static_cast<double>(lines * line) * (1 - 1.0 / ranks);
}

double exchanged_level() {
  return 4 * message;
}

}  // namespace whirl::core::cost
