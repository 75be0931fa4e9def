#pragma once
// Searches for eigenvalues of pencils by SLEPc, dense and by iteration.

#include <slepceps.h>

#include <vector>

#include "whirl/core/gate.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::spectral {

using EigenSolver = core::Handle<EPS, EPSDestroy>;

/// Residual over eigenvalue at which search_near() ends.
inline constexpr double search_tolerance = 1e-10;

/// dF/dx u = lambda (-dF/d(dx/dt)) u at an equilibrium, rows and columns in the scales of the system.
struct ScaledPencil {
  core::Matrix a, b;
  std::vector<double> states, rows;  ///< the scales, whole on every rank
};
/// Collective.
[[nodiscard]] ScaledPencil scaled_pencil(problem::System& system, Vec x);

/// The whole of a small distributed matrix, dense on this rank. Collective on its communicator.
[[nodiscard]] core::Matrix redundant_dense(Mat m);

/// Real SLEPc keeps a complex pair as two entries and its vector as real and imaginary part: hidden here once.
struct Pair {
  Complex value;
  std::vector<double> real, imaginary;  ///< whole on every rank
};

/// Number i of what was found; without `vectors` re and im may be null.
[[nodiscard]] Pair pair_of(EPS eps, PetscInt i, Vec re, Vec im, bool vectors);

/// Rank 0's list for all ranks.
void share(MPI_Comm comm, std::vector<Complex>& values);

/// All eigenvalues of a u = lambda b u on this rank, in no order. `eps`, which holds the pencil, may be made anew.
void solve_dense(EigenSolver& eps, Mat a, Mat b);

/// A ShiftInverse as the preconditioner of a KSP.
struct InverseShell {
  ShiftInverse& inverse;
  core::Gate gate;

  static PetscErrorCode set_up(PC pc) {
    void* raw = nullptr;
    Mat a = nullptr;
    PetscCall(PCShellGetContext(pc, &raw));
    PetscCall(PCGetOperators(pc, &a, nullptr));
    auto& self = *static_cast<InverseShell*>(raw);
    return self.gate.run([&] { self.inverse.factorise(a); });
  }
  static PetscErrorCode apply(PC pc, Vec rhs, Vec x) {
    void* raw = nullptr;
    PetscCall(PCShellGetContext(pc, &raw));
    auto& self = *static_cast<InverseShell*>(raw);
    return self.gate.run([&] { self.inverse.solve(rhs, x); });
  }
  void serve(KSP ksp) {
    PC pc = nullptr;
    core::check(KSPSetType(ksp, KSPPREONLY));
    core::check(KSPGetPC(ksp, &pc));
    core::check(PCSetType(pc, PCSHELL));
    core::check(PCShellSetContext(pc, this));
    core::check(PCShellSetSetUp(pc, set_up));
    core::check(PCShellSetApply(pc, apply));
  }
};

/// Makes `eps` look for the `wanted` eigenvalues nearest to a real target, by Krylov-Schur with shift and invert, from
/// the same start on any number of ranks; by LU without a `shell`.
void search_near(EPS eps, Mat a, double target, PetscInt wanted, InverseShell* shell);

}  // namespace whirl::spectral
