#pragma once
// What the parts of a system offer to solve their own linearised equations with.

#include <petscvec.h>

#include <complex>
#include <cstddef>

namespace whirl::problem {

class ExactPartInverse;

/// Inverses of the own equations A_pp of all parts, A = alpha dF/dx + sigma dF/d(dx/dt) in the scales of
/// System::scales(), good to precondition with. They outlast a change of the parameter and end with the system. All
/// members but exact() are collective on System::comm().
class PartInverse {
public:
  PartInverse() = default;
  PartInverse(const PartInverse&) = delete;
  PartInverse& operator=(const PartInverse&) = delete;
  virtual ~PartInverse() = default;

  /// Takes the derivatives at (angle, x, xdot). Throws core::DomainError on all ranks outside the validity of a film.
  virtual void set(double angle, Vec x, Vec xdot, double alpha, double sigma) = 0;
  /// This, if apply() is A_pp^-1 to rounding; else null. The same on all ranks.
  [[nodiscard]] virtual ExactPartInverse* exact() { return nullptr; }
  /// y = A_pp^-1 r: this rank's rows of all parts, one after the other in the order of System::fields(). Not finite if
  /// A_pp is singular.
  virtual void apply(const double* r, double* y) = 0;
  /// The same of r and y [rows x columns], `rows` being this rank's rows of all parts.
  virtual void apply_columns(const double* r, double* y, std::ptrdiff_t rows, int columns) {
    for (int c = 0; c < columns; ++c) apply(r + c * rows, y + c * rows);
  }
};

/// Exact ones: they have a transpose, and stand at complex frequencies too.
class ExactPartInverse : public PartInverse {
public:
  [[nodiscard]] ExactPartInverse* exact() override { return this; }
  /// y = A_pp^-T r.
  virtual void apply_transposed(const double* r, double* y) = 0;
  /// At rest and a complex frequency, A = dF/dx + lambda dF/d(dx/dt). Throws as set().
  virtual void set_at(Vec x, Vec rest, std::complex<double> lambda) = 0;
  /// y = A_pp^-1 r at the lambda of set_at(): r and y [rows x columns], rows as of apply_columns().
  virtual void apply_at(const std::complex<double>* r, std::complex<double>* y, std::ptrdiff_t rows, int columns) = 0;
};

}  // namespace whirl::problem
