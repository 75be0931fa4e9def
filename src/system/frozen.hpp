#pragma once
// Linearised equations of a machine whose films with own states bring their preconditioners: sparse films with thin
// borders.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "film_part.hpp"
#include "whirl/core/gate.hpp"
#include "whirl/problem/frozen.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

/// What all frozen equations of one system share: the Krylov method (FGMRES, prefix "stage_"), the sparse constant
/// blocks of rotor and pedestals on the first rank, and the films, each with a communicator of the ranks that hold it.
///
/// With r the rotor's states on the first rank and s the films', u = C r the journals' positions and velocities in
/// their bearings [4 a film] and f = F s the films' forces [2 a film],
///
///     A = [ A_rr     -alpha B F ]        preconditioned by elimination of s with the films' own
///         [ G C       D         ]        preconditioners in place of D^-1
class RotorSystem::FilmSolver {
public:
  ~FilmSolver();
  /// Empty if there is no film with states or one of them has no preconditioner. Collective.
  [[nodiscard]] static std::unique_ptr<FilmSolver> make(RotorSystem& system);

  class Equations;
  [[nodiscard]] std::unique_ptr<problem::Frozen> freeze(Vec x, Vec xdot, double alpha, double sigma,
                                                        const problem::Frozen* similar);

private:
  using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  struct Film {
    std::size_t bearing = 0;
    const FilmPart* part = nullptr;
    MPI_Comm comm = MPI_COMM_NULL;  // of the ranks that hold it; null elsewhere. Owned
    // Scales of the states it sees, and of its states and rows here; the places of D, and where dg/ds' adds to them.
    Eigen::VectorXd seen, state, residual;
    film::Places places;
    std::vector<std::size_t> rates_at;
    std::array<double, 8> journal_scale{};  // of the entries of journal and pedestal among the films' inputs
  };
  explicit FilmSolver(RotorSystem& system);
  void make_rotor();
  void make_films();
  void make_krylov();
  [[nodiscard]] Sparse rotor_block(double alpha, double sigma) const;
  /// What film k sees of the scaled inputs of all films.
  [[nodiscard]] std::array<double, 4> motion_of(std::size_t k, const double* inputs) const;
  static PetscErrorCode shell_multiply(Mat m, Vec v, Vec y);
  static PetscErrorCode shell_precondition(PC pc, Vec r, Vec y);

  RotorSystem& system_;
  std::vector<Film> films_;
  Sparse rates_, at_rest_, gyroscopic_;  // of the rotor's rows, scaled
  Sparse inputs_, outputs_;              // C [4 films x 2 n], B [2 n x 2 films], from scaled states and to scaled rows
  Eigen::VectorXd state_, residual_;     // scales of the rotor's states and rows, on the first rank
  core::Matrix shell_;
  core::LinearSolver krylov_;
  core::Gate gate_;
  const Equations* current_ = nullptr;
};

}  // namespace whirl::system
