#pragma once
// Linearised equations of a rigid rotor with one film in lines: a sparse film with a thin border.

#include <Eigen/LU>
#include <memory>

#include "whirl/core/gate.hpp"
#include "whirl/film/ring_preconditioner.hpp"
#include "whirl/problem/frozen.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

/// What all frozen equations of one system share: the Krylov method (GMRES, prefix "stage_"), the constant dense blocks
/// of rotor and pedestals on the first rank, and work space.
///
/// With r the rotor's states on the first rank and s the film's, u = C r the journal's position and velocity in its
/// bearing [4] and f the film's force [2],
///
///     A = [ A_rr     -alpha B F ]        preconditioned by        [ 1        0 ] [ S  -alpha B F ]
///         [ G C       D         ]                                 [ . G C S^-1  1 ] ...
///
/// that is by elimination of s with one cycle of film::RingPreconditioner in place of D^-1.
class RotorSystem::FilmSolver {
public:
  explicit FilmSolver(RotorSystem& system);
  /// Empty if the machine is not of that kind.
  [[nodiscard]] static std::unique_ptr<FilmSolver> make(RotorSystem& system);

  class Equations;
  [[nodiscard]] std::unique_ptr<problem::Frozen> freeze(Vec x, Vec xdot, double alpha, double sigma,
                                                        const problem::Frozen* similar);

private:
  friend class Equations;
  [[nodiscard]] Eigen::MatrixXd rotor_block(double alpha, double sigma) const;
  static PetscErrorCode shell_multiply(Mat m, Vec v, Vec y);
  static PetscErrorCode shell_precondition(PC pc, Vec r, Vec y);

  RotorSystem& system_;
  std::size_t film_ = 0;  // the bearing whose film has states
  Eigen::MatrixXd mass_, damping_, gyroscopic_, stiffness_;
  Eigen::MatrixXd inputs_, outputs_;  // C [4 x 2 n], B [2 n x 2], from scaled states and to scaled rows
  Eigen::VectorXd state_, residual_;  // scales of the rotor's states and rows, on the first rank
  double film_state_ = 1, film_residual_ = 1;
  std::array<double, 8> journal_scale_{};  // of the journal's and the pedestal's entries among the films' inputs
  core::Matrix shell_;
  core::LinearSolver krylov_;
  core::Gate gate_;
  const Equations* current_ = nullptr;
};

}  // namespace whirl::system
