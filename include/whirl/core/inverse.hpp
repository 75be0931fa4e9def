#pragma once
// The inverses that a film or a machine offers of its own equations.

#include <complex>
#include <cstddef>
#include <span>

namespace whirl::core {

/// All entries of a matrix or a vector.
template <class Matrix>
[[nodiscard]] auto span_of(Matrix& m) {
  return std::span(m.data(), static_cast<std::size_t>(m.size()));
}

template <class Derivatives>
class ExactInverse;

/// An inverse of A = alpha dF/ds + sigma dF/d(ds/dt), good to precondition with. The states s and the rows of F stand
/// on the ranks of one communicator. `Derivatives` is what an inverse takes dF/ds and dF/d(ds/dt) from. Several columns
/// [this rank's rows x columns] are given one behind the other. All members but exact() are collective.
template <class Derivatives>
class Inverse {
public:
  Inverse() = default;
  Inverse(const Inverse&) = delete;
  Inverse& operator=(const Inverse&) = delete;
  virtual ~Inverse() = default;

  /// Takes the derivatives. Throws as their evaluation does, if that is part of it.
  virtual void set(const Derivatives& at, double alpha, double sigma) = 0;
  /// This, if apply() is A^-1 to rounding; else null. The same on all ranks.
  [[nodiscard]] virtual ExactInverse<Derivatives>* exact() { return nullptr; }
  /// y = A^-1 r. Does not throw: the ranks that hold nothing would wait for the others. Not finite if A is singular.
  virtual void apply(std::span<const double> r, std::span<double> y) = 0;
};

/// A^-1 to rounding. Only such an inverse has a transpose, and stands at complex frequencies too.
template <class Derivatives>
class ExactInverse : public Inverse<Derivatives> {
public:
  [[nodiscard]] ExactInverse* exact() final { return this; }
  /// y = A^-T r.
  virtual void apply_transposed(std::span<const double> r, std::span<double> y) = 0;
  /// At a complex frequency, A = dF/ds + lambda dF/d(ds/dt). Throws as set().
  virtual void set_at(const Derivatives& at, std::complex<double> lambda) = 0;
  /// As apply(), at the lambda of set_at().
  virtual void apply_at(std::span<const std::complex<double>> r, std::span<std::complex<double>> y) = 0;
};

}  // namespace whirl::core
