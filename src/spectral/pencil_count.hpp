#pragma once
// How many eigenvalues a large sparse pencil has near zero, beside those that a search has found.

#include <petscmat.h>

#include <complex>
#include <vector>

namespace whirl::spectral {

/// A count of the eigenvalues of a u = lambda b u in the circle |lambda| < radius.
struct PencilCount {
  double radius = 0;  ///< zero: nothing was counted
  int counted = 0;    ///< both of each pair
  int missed = 0;     ///< of these not among the known ones
  bool real = false;  ///< an odd number of real eigenvalues above `radius` is not among the known ones
  bool sure = true;   ///< false: the phase could not be followed, or fewer were counted than are known
  int factorisations = 0;
};

/// By the winding number of det(a - lambda b) over the product of (lambda - lambda_k) of the known eigenvalues along
/// the circle. Known eigenvalues cancel, so the phase turns only where one is missing and a few dozen factorisations
/// follow it. The radius lies in the widest gap among the moduli of the farther half of the known ones, which are the
/// nearest to zero that a search has found, both of each pair. The sign of the determinant on the positive real axis
/// beyond tells of real eigenvalues there.
///
/// Nothing is counted where factors have more than 2,000,000 entries, or with fewer than four known eigenvalues.
/// One rank works, all get the result. Collective.
[[nodiscard]] PencilCount count_near_zero(Mat a, Mat b, const std::vector<std::complex<double>>& known);

}  // namespace whirl::spectral
