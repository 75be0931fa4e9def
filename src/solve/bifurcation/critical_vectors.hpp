#pragma once
// Null vectors of the linearised machine at a Hopf point.

#include "whirl/solve/newton/frequency_resolvent.hpp"

namespace whirl::solve {

/// Right and left null vectors of A = dF/dx + i omega dF/d(dx/dt) where it is singular, A q = 0 and p^* A = 0, each of
/// root mean square one.
struct CriticalVectors {
  ComplexVector q, p;
};
/// Generic vectors [n] that serve as borders c and b where the null vectors q and p are not known, of length one.
[[nodiscard]] CriticalVectors generic_vectors(Eigen::Index n);
/// With c = q and b = p of `borders`: v and w of [A b; c^* 0] (v, g) = (0, 1) and of its conjugate transpose, (w, g').
/// Returns g, which is zero where A is singular. Collective.
std::complex<double> null_vectors(FrequencyResolvent& shifted, double omega, const CriticalVectors& borders,
                                  CriticalVectors& out);
/// Leaves `shifted` factorised anew. Collective.
[[nodiscard]] CriticalVectors critical_vectors(FrequencyResolvent& shifted, double omega);

}  // namespace whirl::solve
