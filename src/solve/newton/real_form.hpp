#pragma once
// Complex matrices as real ones of twice the size, real and imaginary parts interleaved.

#include <complex>
#include <vector>

#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::solve {

/// A row of a complex matrix, which becomes two rows of a real one.
class RealRow {
public:
  void add(PetscInt column, std::complex<double> z) {
    for (PetscInt part = 0; part < 2; ++part) to_.push_back(2 * column + part);
    upper_.insert(upper_.end(), {z.real(), -z.imag()});
    lower_.insert(lower_.end(), {z.imag(), z.real()});
  }
  /// Sets the entries added since the last call.
  void put(Mat m, PetscInt row) {
    for (PetscInt part = 0; part < 2; ++part) {
      const PetscInt r = 2 * row + part;
      core::check(MatSetValues(m, 1, &r, static_cast<PetscInt>(to_.size()), to_.data(),
                               (part == 0 ? upper_ : lower_).data(), INSERT_VALUES));
    }
    to_.clear();
    upper_.clear();
    lower_.clear();
  }

private:
  std::vector<PetscInt> to_;
  std::vector<PetscScalar> upper_, lower_;
};

/// Room for a + lambda b in real form, which have one pattern, and for `beside` more complex columns in every row and
/// `below` more full rows on this rank, of which there are `width` complex columns in all.
[[nodiscard]] inline core::Matrix make_real_form(Mat a, PetscInt beside = 0, PetscInt below = 0, PetscInt width = 0) {
  PetscInt begin = 0, end = 0;
  core::check(MatGetOwnershipRange(a, &begin, &end));
  const PetscInt rows = 2 * (end - begin + below);
  std::vector<PetscInt> count(static_cast<std::size_t>(rows), 2 * width);
  for (PetscInt i = begin; i < end; ++i) {
    PetscInt k = 0;
    core::check(MatGetRow(a, i, &k, nullptr, nullptr));
    for (PetscInt part = 0; part < 2; ++part)
      count[static_cast<std::size_t>(2 * (i - begin) + part)] = 2 * (k + beside);
    core::check(MatRestoreRow(a, i, &k, nullptr, nullptr));
  }
  return core::make_matrix(PetscObjectComm(reinterpret_cast<PetscObject>(a)), rows, std::move(count));
}

/// Puts this rank's rows of a + lambda b; `more(i, row)` may add entries to complex row i (global). Not assembled.
template <class F>
void put_pencil(Mat a, Mat b, std::complex<double> lambda, Mat real, F&& more) {
  PetscInt begin = 0, end = 0;
  core::check(MatGetOwnershipRange(a, &begin, &end));
  RealRow row;
  for (PetscInt i = begin; i < end; ++i) {
    // Both have the same pattern, so that their rows run in step.
    PetscInt k = 0, kb = 0;
    const PetscInt *columns = nullptr, *columns_b = nullptr;
    const PetscScalar *x = nullptr, *d = nullptr;
    core::check(MatGetRow(a, i, &k, &columns, &x));
    core::check(MatGetRow(b, i, &kb, &columns_b, &d));
    core::require(k == kb, "dF/dx and dF/d(dx/dt) have one pattern");
    for (PetscInt e = 0; e < k; ++e) row.add(columns[e], x[e] + lambda * d[e]);
    core::check(MatRestoreRow(a, i, &k, &columns, &x));
    core::check(MatRestoreRow(b, i, &kb, &columns_b, &d));
    more(i, row);
    row.put(real, i);
  }
}

}  // namespace whirl::solve
