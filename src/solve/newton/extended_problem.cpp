#include "whirl/solve/newton/extended_problem.hpp"

namespace whirl::solve {

using core::check;

core::Vector copy(Vec v) {
  core::Vector out = core::duplicate(v);
  check(VecCopy(v, out.get()));
  return out;
}

double dot(Vec a, Vec b) {
  double value = 0;
  check(VecDot(a, b, &value));
  return value;
}

double last_entry(MPI_Comm comm, Vec u) {
  double value = 0;
  const int last = core::size_of(comm) - 1;
  if (core::rank_of(comm) == last) {
    core::ReadArray a(u);
    value = a[a.size() - 1];
  }
  MPI_Bcast(&value, 1, MPI_DOUBLE, last, comm);
  return value;
}

void set_last_entry(MPI_Comm comm, Vec u, double value) {
  core::WriteArray a(u);  // on every rank: array access bumps the object state, which PETSc wants equal on all
  if (core::rank_of(comm) == core::size_of(comm) - 1) a[a.size() - 1] = value;
}

double inner(const ExtendedProblem& problem, Vec a, Vec b) {
  core::Vector work = core::duplicate(a);
  check(VecPointwiseMult(work.get(), problem.weights(), a));
  return dot(work.get(), b);
}

void weighted_row(const ExtendedProblem& problem, Vec direction, Vec row) {
  check(VecPointwiseMult(row, problem.weights(), direction));
}

void parameter_row(const ExtendedProblem& problem, Vec row) {
  check(VecSet(row, 0.0));
  set_last_entry(problem.comm(), row, 1.0);
}

}  // namespace whirl::solve
