#include "whirl/core/petsc.hpp"

#include <fmt/core.h>

#include "whirl/core/session.hpp"

namespace whirl::core {

void check(PetscErrorCode code) {
  if (code == 0) return;
  const char* text = nullptr;
  (void)PetscErrorMessage(code, &text, nullptr);
  std::string trace = Session::take_trace();
  throw LibraryError(code, fmt::format("PETSc error {}: {}{}{}", static_cast<int>(code), text ? text : "unknown",
                                       trace.empty() ? "" : "\n", trace));
}

Vector duplicate(Vec v) {
  Vector copy;
  check(VecDuplicate(v, copy.put()));
  return copy;
}

Vector make_vector(MPI_Comm comm, PetscInt local, PetscInt global) {
  Vector v;
  check(VecCreate(comm, v.put()));
  check(VecSetSizes(v.get(), local, global));
  check(VecSetType(v.get(), VECSTANDARD));
  check(VecSet(v.get(), 0.0));
  return v;
}

std::vector<double> gather(Vec v) {
  Scatter scatter;
  Vector whole;
  check(VecScatterCreateToAll(v, scatter.put(), whole.put()));
  check(VecScatterBegin(scatter.get(), v, whole.get(), INSERT_VALUES, SCATTER_FORWARD));
  check(VecScatterEnd(scatter.get(), v, whole.get(), INSERT_VALUES, SCATTER_FORWARD));
  const ReadArray a(whole.get());
  return {a.data(), a.data() + a.size()};
}

int rank_of(MPI_Comm comm) {
  int r = 0;
  MPI_Comm_rank(comm, &r);
  return r;
}

int size_of(MPI_Comm comm) {
  int n = 1;
  MPI_Comm_size(comm, &n);
  return n;
}

}  // namespace whirl::core
