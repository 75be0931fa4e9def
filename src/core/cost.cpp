#include "whirl/core/cost.hpp"

namespace whirl::core::cost {

// Blocks of the Jacobian are added and scaled 25 times over.
double dense_step(std::int64_t states) {
  const auto n = static_cast<double>(states);
  return n * n * n / 3 + 25 * scattered * n * n;
}

// Entry by entry into the matrix and into the factors.
double sparse_step(std::int64_t entries) {
  return call + 190 * scattered * static_cast<double>(entries);
}

double dense_product(std::int64_t states) {
  return streamed * static_cast<double>(states * states);
}

double sparse_product(std::int64_t entries) {
  return scattered * static_cast<double>(entries) + 2000;
}

// Each state of a level takes 170 with what is done for it on all coarser levels.
double repeated_level(std::int64_t lines, std::int64_t line, int ranks) {
  return 170 * static_cast<double>(lines * line) * (1 - 1.0 / ranks);
}

double exchanged_level() {
  return 4 * message;
}

}  // namespace whirl::core::cost
