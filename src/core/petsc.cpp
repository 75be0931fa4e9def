#include "whirl/core/petsc.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/session.hpp"

namespace whirl::core {

void check(PetscErrorCode code) {
  if (code == 0) return;
  const char* text = nullptr;
  (void)PetscErrorMessage(code, &text, nullptr);
  std::string trace = Session::take_trace();
  if (code == PETSC_ERR_MEM) throw Error(out_of_memory);
  if (const std::string wish = Session::impossible_option(code, trace); !wish.empty()) {
    InputError wrong(wish);
    wrong.mark_agreed();  // all ranks have the same options
    throw wrong;
  }
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

double norm(Vec v) {
  double value = 0;
  check(VecNorm(v, NORM_2, &value));
  return value;
}

Matrix make_matrix(MPI_Comm comm, PetscInt local, std::vector<PetscInt> row_entries) {
  row_entries.resize(std::max<std::size_t>(row_entries.size(), 1));  // PETSc wants an address
  std::vector<PetscInt> here = row_entries;
  for (PetscInt& k : here) k = std::min(k, local);
  Matrix m;
  check(MatCreate(comm, m.put()));
  check(MatSetSizes(m.get(), local, local, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetType(m.get(), MATAIJ));
  check(MatSeqAIJSetPreallocation(m.get(), 0, row_entries.data()));
  check(MatMPIAIJSetPreallocation(m.get(), 0, here.data(), 0, row_entries.data()));
  return m;
}

std::vector<double> gather(Vec v) {
  MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(v));
  const int size = size_of(comm);
  const PetscInt* ranges = nullptr;
  check(VecGetOwnershipRanges(v, &ranges));
  std::vector<int> counts, offsets(ranges, ranges + size);
  for (int r = 0; r < size; ++r) counts.push_back(static_cast<int>(ranges[r + 1] - ranges[r]));
  std::vector<double> all(static_cast<std::size_t>(ranges[size]));
  const ReadArray a(v);
  MPI_Allgatherv(a.data(), static_cast<int>(a.size()), MPI_DOUBLE, all.data(), counts.data(), offsets.data(),
                 MPI_DOUBLE, comm);
  return all;
}

namespace {

constexpr const char* other_size = "numbers kept of a problem of another size: compute the study again";

}  // namespace

void fill(Vec v, const std::vector<double>& all) {
  PetscInt begin = 0, size = 0;
  check(VecGetOwnershipRange(v, &begin, nullptr));
  check(VecGetSize(v, &size));
  if (static_cast<std::size_t>(size) != all.size()) throw Error(other_size);
  const WriteArray a(v);
  std::copy_n(all.begin() + begin, a.size(), a.data());
}

void fill(Vec v, std::size_t begin, const std::vector<double>& rows) {
  PetscInt size = 0;
  check(VecGetSize(v, &size));
  std::uint64_t end = begin + rows.size(), facts[] = {rows.size(), 0};
  MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(v));
  MPI_Allreduce(MPI_IN_PLACE, &facts[0], 1, MPI_UINT64_T, MPI_SUM, comm);
  MPI_Allreduce(&end, &facts[1], 1, MPI_UINT64_T, MPI_MAX, comm);
  if (facts[0] != static_cast<std::uint64_t>(size) || facts[1] != facts[0]) {
    Error other(other_size);
    other.mark_agreed();
    throw other;
  }
  std::vector<PetscInt> places(rows.size());
  std::iota(places.begin(), places.end(), static_cast<PetscInt>(begin));
  check(VecSetValues(v, static_cast<PetscInt>(rows.size()), places.data(), rows.data(), INSERT_VALUES));
  check(VecAssemblyBegin(v));
  check(VecAssemblyEnd(v));
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
