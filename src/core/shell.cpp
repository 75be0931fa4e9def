#include "whirl/core/shell.hpp"

#include <memory>
#include <utility>

namespace whirl::core {
namespace {

struct Functions {
  Functions(Gate& g, Action p, Action t) : gate(g), plain(std::move(p)), transposed(std::move(t)) {}
  Gate& gate;
  Action plain, transposed;
};

PetscErrorCode context_of(Mat m, void** raw) {
  return MatShellGetContext(m, raw);
}
PetscErrorCode context_of(PC pc, void** raw) {
  return PCShellGetContext(pc, raw);
}

template <class Object, Action Functions::*which>
PetscErrorCode act(Object object, Vec x, Vec y) {
  void* raw = nullptr;
  PetscCall(context_of(object, &raw));
  auto& f = *static_cast<Functions*>(raw);
  return f.gate.run([&] { (f.*which)(x, y); });
}

PetscErrorCode forget(void* raw) {
  const std::unique_ptr<Functions> last(static_cast<Functions*>(raw));
  return 0;
}

PetscErrorCode forget(PC pc) {
  void* raw = nullptr;
  PetscCall(context_of(pc, &raw));
  return forget(raw);
}

}  // namespace

Matrix make_shell(MPI_Comm comm, PetscInt local, Gate& gate, Action multiply, Action transposed) {
  const auto set = [](Mat m, MatOperation operation, PetscErrorCode (*f)(Mat, Vec, Vec)) {
    check(MatShellSetOperation(m, operation, reinterpret_cast<void (*)()>(f)));
  };
  Matrix m;
  const bool both = static_cast<bool>(transposed);
  auto functions = std::make_unique<Functions>(gate, std::move(multiply), std::move(transposed));
  check(MatCreateShell(comm, local, local, PETSC_DETERMINE, PETSC_DETERMINE, functions.get(), m.put()));
  check(MatShellSetContextDestroy(m.get(), forget));
  (void)functions.release();
  set(m.get(), MATOP_MULT, act<Mat, &Functions::plain>);
  if (both) set(m.get(), MATOP_MULT_TRANSPOSE, act<Mat, &Functions::transposed>);
  return m;
}

void set_shell(PC pc, Gate& gate, Action apply, Action transposed) {
  check(PCSetType(pc, PCSHELL));
  const bool both = static_cast<bool>(transposed);
  auto functions = std::make_unique<Functions>(gate, std::move(apply), std::move(transposed));
  check(PCShellSetContext(pc, functions.get()));
  check(PCShellSetDestroy(pc, forget));
  (void)functions.release();
  check(PCShellSetApply(pc, act<PC, &Functions::plain>));
  if (both) check(PCShellSetApplyTranspose(pc, act<PC, &Functions::transposed>));
}

LinearSolver make_krylov(Mat matrix, Gate& gate, const KrylovOptions& options, Action apply, Action transposed) {
  LinearSolver solver;
  check(KSPCreate(PetscObjectComm(reinterpret_cast<PetscObject>(matrix)), solver.put()));
  KSP ksp = solver.get();
  check(KSPSetOptionsPrefix(ksp, options.prefix));
  check(KSPSetOperators(ksp, matrix, matrix));
  check(KSPSetType(ksp, options.type));
  check(KSPSetPCSide(ksp, PC_RIGHT));
  check(KSPGMRESSetRestart(ksp, options.restart));
  check(KSPSetTolerances(ksp, options.tolerance, 1e-300, PETSC_DEFAULT, options.most));
  PC pc = nullptr;
  check(KSPGetPC(ksp, &pc));
  if (apply)
    set_shell(pc, gate, std::move(apply), std::move(transposed));
  else
    check(PCSetType(pc, PCNONE));
  check(KSPSetFromOptions(ksp));
  return solver;
}

KSPConvergedReason reason_of(KSP ksp) {
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(ksp, &reason));
  return reason;
}

}  // namespace whirl::core
