#pragma once
// What two ways to the same answer cost, counted from sizes, so that the cheaper one can be taken: the same on every
// machine and in every run.

#include <cstdint>

namespace whirl::core::cost {

// The unit is a multiply-add in a product of dense matrices, 0.03 ns on the machine of docs/speed.md, which measures
// what others take (bench_cost).

/// Of a dense matrix that is read once for one vector.
inline constexpr double streamed = 3.3;
/// In sparse matrices, bands and small blocks.
inline constexpr double scattered = 6;
/// Before a sparse or iterative solver has done anything: objects, analysis, 0.13 ms.
inline constexpr double call = 4.5e6;
/// An exchange with a neighbour, 5 us.
inline constexpr double message = 1.65e5;

/// Whether a dense matrix of so many states costs less than a sparse one of PETSc with so many entries. A step in time
/// takes factors (MUMPS's where the matrix is sparse), a product takes the matrix alone.
enum class Work { step, product };
[[nodiscard]] bool dense_is_cheaper(Work work, std::int64_t states, std::int64_t entries);

/// All lines of a level of a multigrid cycle on every rank instead of a share on each: what that adds in arithmetic,
/// and what the level's four exchanges cost.
[[nodiscard]] double repeated_level(std::int64_t lines, std::int64_t line, int ranks);
[[nodiscard]] double exchanged_level();

}  // namespace whirl::core::cost
