#pragma once
// Modes of a machine whose films are linearised: of its whole shaft, and of reduced ones beside them.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <complex>

#include "whirl/system/rotor_system.hpp"

namespace whirl::study {

/// The lowest modes of a machine with its whole shaft, on one rank, films without states of their own: with
/// A x + L1 dx/dt = 0 and the energy norm |x|^2 = v^H M v + q^H K q, K the symmetric part of the stiffness.
class WholeModes {
public:
  /// The `count` modes of lowest frequency at the equilibrium x. Throws core::NotConverged, also where the machine's
  /// stiffness is not positive definite.
  WholeModes(system::RotorSystem& system, Vec x, int count);

  /// Frequencies [rad/s], ascending.
  [[nodiscard]] const Eigen::VectorXd& frequencies() const { return frequencies_; }
  /// Derivatives of the forces of the films in the motions of their journals.
  [[nodiscard]] const Eigen::MatrixXd& films() const { return films_; }

  struct Errors {
    Eigen::VectorXd frequency;  ///< |Im s/Im s_whole - 1|
    Eigen::VectorXd vector;     ///< distance of the vectors of length one, in the energy norm, over their best phase
    Eigen::MatrixXcd r;         ///< R = I - W^T L1 V* (2.70): V* of length one and W^T L1 V = I with V of length one
  };
  /// Of a reduced machine in the same films, its modes by ascending frequency. Throws core::NotConverged.
  [[nodiscard]] Errors errors(system::RotorSystem& reduced) const;

private:
  [[nodiscard]] std::complex<double> energy(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) const;

  Eigen::MatrixXd films_;
  Eigen::SparseMatrix<double> rates_, energy_;
  Eigen::VectorXd frequencies_;
  Eigen::MatrixXcd right_, left_;  // columns
};

/// Displacement of a place over time, a row of x and a row of y.
using Orbit = Eigen::Matrix<double, 2, Eigen::Dynamic>;

/// Motion of a shaft node (1-based) from the state of rest under the unbalance that sets in at angle zero, at `count`
/// times 0, step, 2 step ... [s], relative to where it rests; A x + L1 dx/dt = Re(f exp(i Omega t)) with the films as
/// `films` says. Exact in time: the forced motion and free ones in all modes of the machine, which must be
/// diagonalisable, as it is on springs. Throws core::NotConverged. Dense, of the size of the machine.
[[nodiscard]] Orbit orbit_from_rest(system::RotorSystem& system, const Eigen::MatrixXd& films, int node, double step,
                                    Eigen::Index count);

/// States of the whole machine [rows] that those of a reduced one are; of a machine with its whole shaft its own.
[[nodiscard]] Eigen::MatrixXd whole_states(const system::RotorSystem& reduced);

}  // namespace whirl::study
