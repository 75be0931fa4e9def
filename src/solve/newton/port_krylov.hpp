#pragma once
// A Krylov method for matrices in blocks, preconditioned by elimination of their parts.

#include <optional>
#include <string>

#include "solve/newton/port_elimination.hpp"
#include "whirl/core/gate.hpp"

namespace whirl::solve {

/// FGMRES for many matrices of one layout, each preconditioned by the elimination of a similar one. Collective.
class PortKrylov {
public:
  /// Reads PETSc options with `prefix`.
  PortKrylov(const PortLayout& layout, const char* prefix);
  PortKrylov(const PortKrylov&) = delete;
  PortKrylov& operator=(const PortKrylov&) = delete;
  ~PortKrylov() = default;
  /// a x = rhs to the relative residual `tolerance`, or to that of the option -ksp_rtol if it is given; returns the
  /// iterations that it took. Throws core::DomainError, on all ranks, if it does not come that far or `similar` is
  /// singular.
  int solve(const PortMatrix& a, PortElimination& similar, Vec rhs, Vec x, double tolerance);
  /// y = a x.
  static void multiply(const PortMatrix& a, Vec x, Vec y);

private:
  void fail(const std::string& why) const;
  MPI_Comm comm_;
  std::optional<double> asked_;  // tolerance that an option asks for
  core::Gate gate_;
  core::Matrix shell_;
  core::LinearSolver ksp_;
  const PortMatrix* matrix_ = nullptr;  // of the present solve
  PortElimination* similar_ = nullptr;
};

}  // namespace whirl::solve
