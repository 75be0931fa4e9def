#pragma once
// What the parts of a system offer to solve their own linearised equations with.

#include <petscvec.h>

#include <complex>
#include <cstddef>

#include "whirl/core/error.hpp"

namespace whirl::problem {

/// Inverses of the own equations A_pp of all parts, A = alpha dF/dx + sigma dF/d(dx/dt) in the scales of
/// System::scales(): exact, or approximate and good to precondition only. They outlast a change of the parameter and
/// end with the system. All members but exact() are collective on System::comm().
class PartInverse {
public:
  PartInverse() = default;
  PartInverse(const PartInverse&) = delete;
  PartInverse& operator=(const PartInverse&) = delete;
  virtual ~PartInverse() = default;

  /// Takes the derivatives at (angle, x, xdot). Throws core::DomainError on all ranks outside the validity of a film.
  virtual void set(double angle, Vec x, Vec xdot, double alpha, double sigma) = 0;
  /// Whether apply() is A_pp^-1 to rounding, and has a transpose. The same on all ranks.
  [[nodiscard]] virtual bool exact() const { return false; }
  /// y = A_pp^-1 r: this rank's rows of all parts, one after the other in the order of System::fields(). Not finite if
  /// A_pp is singular.
  virtual void apply(const double* r, double* y) = 0;
  /// The same of r and y [rows x columns], `rows` being this rank's rows of all parts.
  virtual void apply_columns(const double* r, double* y, std::ptrdiff_t rows, int columns) {
    for (int c = 0; c < columns; ++c) apply(r + c * rows, y + c * rows);
  }
  /// y = A_pp^-T r of exact ones; core::Bug of others.
  virtual void apply_transposed(const double* /*r*/, double* /*y*/) {
    core::require(false, "inverses of parts that are exact");
  }
  /// The same of exact ones at rest and a complex frequency, A = dF/dx + lambda dF/d(dx/dt). Throws as set().
  virtual void set_at(Vec /*x*/, Vec /*rest*/, std::complex<double> /*lambda*/) {
    core::require(false, "inverses of parts that are exact");
  }
  /// y = A_pp^-1 r at the lambda of set_at(): r and y [rows x columns], rows as of apply_columns().
  virtual void apply_at(const std::complex<double>* /*r*/, std::complex<double>* /*y*/, std::ptrdiff_t /*rows*/,
                        int /*columns*/) {
    core::require(false, "inverses of parts that are exact");
  }
};

}  // namespace whirl::problem
