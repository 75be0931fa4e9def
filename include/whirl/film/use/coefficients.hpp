#pragma once
// Stiffness and damping of a film about rest at any number of frequencies from one factorisation.

#include <Eigen/Core>
#include <memory>
#include <span>

#include "whirl/film/contract/film.hpp"

namespace whirl::film {

/// K + i omega C = -(df/dw + i omega df/dw') + df/ds (A + i omega E)^-1 (dg/dw + i omega dg/dw') of all ports, A =
/// dg/ds and E = dg/ds', as port_coefficients().
///
/// The adjoint y = (A + i omega E)^-T df/ds is found in the block Krylov space of A^-T E^T from A^-T df/ds, which is
/// real and the same at all frequencies: a real LU of A, four solves for each block more, and few blocks where the
/// film's own decay is faster than omega. The basis grows until the coefficients stand still to 1e-9 and less. Where
/// they do not, A is singular, or the force depends on rates of states, a complex LU of A + i omega E. Not thread-safe.
/// Source: moments of transfer functions by Krylov spaces, Antoulas (2005) ch. 11.
class FrequencyCoefficients {
public:
  /// About a journal at rest and a film that has come to rest with it. Throws as Film::evaluate().
  FrequencyCoefficients(Film& film, const JournalMotion& motion, std::span<const double> states);
  ~FrequencyCoefficients();
  /// @param omega frequency [rad/s], positive. Throws core::NotConverged where A + i omega E is singular.
  [[nodiscard]] PortCoefficients at(double omega);
  /// Always by a complex LU, to compare with. Entry [i][j] of what the states do to force i by motion j.
  [[nodiscard]] Eigen::MatrixXcd by_factors(double omega) const;

private:
  struct Space;
  void begin();
  void grow();
  [[nodiscard]] Eigen::MatrixXd append(Eigen::MatrixXd w);
  [[nodiscard]] Eigen::MatrixXcd by_basis(Eigen::Index blocks, double omega) const;
  [[nodiscard]] bool by_krylov(double omega, Eigen::MatrixXcd& out);

  Film& film_;
  StateResponse at_;
  std::unique_ptr<Space> space_;
};

}  // namespace whirl::film
