#include <algorithm>
#include <numeric>

#include "whirl/core/matrix_rows.hpp"
#include "whirl/problem/system.hpp"

namespace whirl::problem {

std::vector<Field> parts_of(const std::vector<Field>& fields) {
  std::vector<Field> parts;
  for (const Field& f : fields) {
    if (parts.empty() || parts.back().part != f.part) {
      parts.push_back(f);
      parts.back().end = f.last();
      parts.back().stride = 0;
      parts.back().repeats = 1;
    } else {
      const Field& p = parts.back();
      parts.back() = {
          .name = f.name, .begin = std::min(p.begin, f.begin), .end = std::max(p.end, f.last()), .part = f.part};
    }
  }
  return parts;
}

std::vector<PetscInt> hub_numbers(const System& system) {
  const PetscInt local = system.local_size();
  PetscInt begin = 0;
  MPI_Exscan(&local, &begin, 1, MPIU_INT, MPI_SUM, system.comm());
  if (core::rank_of(system.comm()) == 0) begin = 0;
  const std::vector<Field> parts = parts_of(system.fields());
  std::vector<bool> taken(static_cast<std::size_t>(local), false);
  for (std::size_t p = 1; p < parts.size(); ++p)
    std::fill(taken.begin() + parts[p].begin, taken.begin() + parts[p].end, true);
  std::vector<PetscInt> here;
  for (std::size_t i = 0; i < taken.size(); ++i)
    if (!taken[i]) here.push_back(begin + static_cast<PetscInt>(i));
  const int count = static_cast<int>(here.size());
  std::vector<int> counts(static_cast<std::size_t>(core::size_of(system.comm()))), begins = counts;
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, system.comm());
  std::exclusive_scan(counts.begin(), counts.end(), begins.begin(), 0);
  std::vector<PetscInt> out(static_cast<std::size_t>(begins.back() + counts.back()));
  MPI_Allgatherv(here.data(), count, MPIU_INT, out.data(), counts.data(), begins.data(), MPIU_INT, system.comm());
  return out;
}

void list_entries(System& system, const Point& at, double alpha, double sigma, core::Matrix& jacobian, Entries& out) {
  if (system.entries(at.angle, at.x, at.xdot, alpha, sigma, out)) return;
  if (!jacobian) jacobian = system.make_jacobian();
  system.jacobian(at.angle, at.x, at.xdot, alpha, sigma, jacobian.get());
  out.begin();
  const PetscInt first = core::first_row(jacobian.get());
  core::for_rows(jacobian.get(), [&](PetscInt i, const PetscInt* columns, const PetscScalar* values, PetscInt count) {
    for (PetscInt k = 0; k < count; ++k) out.add(first + i, columns[k], values[k]);
  });
}

}  // namespace whirl::problem
