#pragma once
// Approximate inverse of the equations of a film whose states are lines in a ring.

#include <mpi.h>

#include <memory>
#include <span>
#include <vector>

#include "film/algebra/stencil.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film {

/// One V-cycle on A x = r, A a Stencil. Lines are relaxed exactly (tridiagonal, many side by side); every second line
/// is left out from level to level, down to one, so that the cost is in proportion to the states and the rate of
/// convergence depends neither on the mesh nor on the ratio of its spacings.
///
/// With C the even lines and F the odd ones, which are independent of each other, a level takes in this order
///
///     x_F = A_FF^-1 r_F,  A_c x_C = r_C - A_CF x_F,  x_F = A_FF^-1 (r_F - A_FC x_C),
///     x_C = A_CC^-1 (r_C - A_CF x_F),                x_F = A_FF^-1 (r_F - A_FC x_C)
///
/// where A_c = (I, R) A (I, P)^T has blocks that are tridiagonal along the line again: P and R are diagonal along the
/// line and equal -A_FF^-1 A_FC and -A_CF A_FF^-1 for vectors that do not change along it. It is exact, a block cyclic
/// reduction, where these hold for all vectors. On several ranks levels so small that
/// messages cost more (core::cost) are gathered to all. Source: Schaffer (1998) for semicoarsening; Ries, Trottenberg
/// and Winter (1983) for the reduction.
class RingPreconditioner final : public StateInverse {
public:
  /// `line` states in each of `lines` lines, of which this rank holds `here`. Every rank of `comm` holds two or more.
  RingPreconditioner(MPI_Comm comm, int lines, int line, Lines here);
  ~RingPreconditioner() override;

  /// Of a Stencil [rows x places] of dg/ds and one of dg/ds', of which places may be missing at the end; a second line
  /// before is lumped with the first.
  void set(const StateDerivatives& at, double alpha, double sigma) override;
  /// In single precision.
  void apply(std::span<const double> r, std::span<double> x) override;

private:
  class Level;
  std::unique_ptr<Level> top_;
  int line_;
  Lines here_;
  std::vector<float> r_, x_;  // transposed: lines run fastest
};

}  // namespace whirl::film
