#pragma once
// Thin owners of PETSc objects: move-only, with the raw handle exposed. Nothing here imitates PETSc's own interface.

#include <petscksp.h>
#include <petscsf.h>
#include <petscsnes.h>

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "whirl/core/error.hpp"

namespace whirl::core {

/// A PETSc, SLEPc or MPI call failed; the text is PETSc's own with its traceback's first lines. Exit code 70.
class LibraryError : public Error {
public:
  LibraryError(PetscErrorCode code, const std::string& what) : Error(what, Exit::bug), code_(code) {}
  [[nodiscard]] PetscErrorCode code() const noexcept { return code_; }

private:
  PetscErrorCode code_;
};

/// Throws LibraryError unless `code` is zero.
void check(PetscErrorCode code);

/// Owner of a PETSc-like object `T` (a pointer) that is destroyed with `Destroy`.
template <class T, PetscErrorCode (*Destroy)(T*)>
class Handle {
public:
  Handle() = default;
  explicit Handle(T raw) noexcept : raw_(raw) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle(Handle&& other) noexcept : raw_(std::exchange(other.raw_, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      raw_ = std::exchange(other.raw_, nullptr);
    }
    return *this;
  }
  ~Handle() { reset(); }

  [[nodiscard]] T get() const noexcept { return raw_; }
  /// Destroys what it owns and returns the address for a PETSc `XxxCreate(..., &handle)` call.
  [[nodiscard]] T* put() noexcept {
    reset();
    return &raw_;
  }
  void reset() noexcept {
    if (raw_) (void)Destroy(&raw_);
    raw_ = nullptr;
  }
  explicit operator bool() const noexcept { return raw_ != nullptr; }

private:
  T raw_ = nullptr;
};

using Vector = Handle<Vec, VecDestroy>;
using Matrix = Handle<Mat, MatDestroy>;
using LinearSolver = Handle<KSP, KSPDestroy>;
using NonlinearSolver = Handle<SNES, SNESDestroy>;
using Scatter = Handle<VecScatter, VecScatterDestroy>;
using IndexSet = Handle<IS, ISDestroy>;
using StarForest = Handle<PetscSF, PetscSFDestroy>;

/// Read access to the local part of a vector for the life of the guard.
class ReadArray {
public:
  explicit ReadArray(Vec v) : v_(v) {
    check(VecGetArrayRead(v, &data_));
    check(VecGetLocalSize(v, &size_));
  }
  ReadArray(const ReadArray&) = delete;
  ReadArray& operator=(const ReadArray&) = delete;
  ~ReadArray() { (void)VecRestoreArrayRead(v_, &data_); }
  [[nodiscard]] const double* data() const noexcept { return data_; }
  [[nodiscard]] PetscInt size() const noexcept { return size_; }
  [[nodiscard]] std::span<const double> span() const noexcept { return {data_, static_cast<std::size_t>(size_)}; }
  double operator[](PetscInt i) const noexcept { return data_[i]; }

private:
  Vec v_;
  const PetscScalar* data_ = nullptr;
  PetscInt size_ = 0;
};

/// Write access to the local part of a vector for the life of the guard.
class WriteArray {
public:
  explicit WriteArray(Vec v) : v_(v) {
    check(VecGetArray(v, &data_));
    check(VecGetLocalSize(v, &size_));
  }
  WriteArray(const WriteArray&) = delete;
  WriteArray& operator=(const WriteArray&) = delete;
  ~WriteArray() { (void)VecRestoreArray(v_, &data_); }
  [[nodiscard]] double* data() const noexcept { return data_; }
  [[nodiscard]] PetscInt size() const noexcept { return size_; }
  [[nodiscard]] std::span<double> span() const noexcept { return {data_, static_cast<std::size_t>(size_)}; }
  double& operator[](PetscInt i) const noexcept { return data_[i]; }

private:
  Vec v_;
  PetscScalar* data_ = nullptr;
  PetscInt size_ = 0;
};

/// A new vector of the same layout as `v`; entries are not set.
[[nodiscard]] Vector duplicate(Vec v);
/// A vector of `local` entries on this rank (PETSC_DECIDE to let PETSc split `global`), all zero. Collective on `comm`.
[[nodiscard]] Vector make_vector(MPI_Comm comm, PetscInt local, PetscInt global);

/// Euclidean norm. Collective.
[[nodiscard]] double norm(Vec v);
/// A square AIJ matrix with `local` rows and columns on this rank and room for row_entries[i] in row i [local or more].
/// Collective on `comm`.
[[nodiscard]] Matrix make_matrix(MPI_Comm comm, PetscInt local, std::vector<PetscInt> row_entries);

/// All entries of a distributed vector on every rank, in natural order. Collective.
[[nodiscard]] std::vector<double> gather(Vec v);
/// The other way: this rank's part of `all` into v. Throws core::Error if v is of another size.
void fill(Vec v, const std::vector<double>& all);
/// The same where each rank of v has other ones of all entries, those from `begin` on, in whatever way they are shared
/// out. Throws core::Error, agreed, if they are not as many as v has. Collective.
void fill(Vec v, std::size_t begin, const std::vector<double>& rows);

/// Rank of this process in `comm` / number of processes of `comm`.
[[nodiscard]] int rank_of(MPI_Comm comm);
[[nodiscard]] int size_of(MPI_Comm comm);

}  // namespace whirl::core
