#include "whirl/solve/newton/newton.hpp"

#include <petscsnes.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "solve/newton/settle_step.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/from_options.hpp"
#include "whirl/core/plan.hpp"
#include "whirl/core/shell.hpp"

namespace whirl::solve {

using core::check;

// All callbacks of one solve see this.
struct SolveContext {
  ExtendedProblem& problem;
  Vec row = nullptr;
  double offset = 0;
  core::Gate gate;
  ReplayLog* replay_log = nullptr;
  std::vector<double> earlier;    // norms of the residuals before those of this solve
  std::vector<double> residuals;  // of the last nonlinear solve, which writes them
  int patience = 0, small_falls = 0;
};

namespace {

void bordered_residual(SolveContext& c, Vec u, Vec r) {
  c.problem.residual(u, r);
  set_last_entry(c.problem.comm(), r, dot(c.row, u) - c.offset);
}

PetscErrorCode form_residual(SNES snes, Vec u, Vec r, void* raw) {
  auto& c = *static_cast<SolveContext*>(raw);
  const PetscErrorCode code = c.gate.run([&] { bordered_residual(c, u, r); });
  return c.gate.domain_error() ? SNESSetFunctionDomainError(snes) : code;
}

PetscErrorCode form_jacobian(SNES snes, Vec u, Mat, Mat, void* raw) {
  auto& c = *static_cast<SolveContext*>(raw);
  PetscInt iteration = 0;
  PetscCall(SNESGetIterationNumber(snes, &iteration));
  const PetscErrorCode code = c.gate.run([&] {
    // An iterate from which the solver goes on: it was found not to have arrived.
    if (c.replay_log && iteration > 0)
      c.replay_log->note([&] {
        std::vector<double> norms = c.earlier;
        const auto kept = std::min<std::ptrdiff_t>(iteration, std::ssize(c.residuals));
        norms.insert(norms.end(), c.residuals.begin(), c.residuals.begin() + kept);
        return ReplayLog::Answer{std::move(norms), {}, {ReplayLog::keep(c.replay_log, u)}};
      });
    c.problem.linearise(u, c.row);
  });
  return c.gate.domain_error() ? SNESSetJacobianDomainError(snes) : code;
}

// PETSc's own test, and the end of a search that crawls.
PetscErrorCode arrived(SNES snes, PetscInt iteration, PetscReal x_norm, PetscReal step_norm, PetscReal norm,
                       SNESConvergedReason* reason, void* raw) {
  auto& c = *static_cast<SolveContext*>(raw);
  constexpr double least_fall = 0.9;
  PetscCall(SNESConvergedDefault(snes, iteration, x_norm, step_norm, norm, reason, nullptr));
  if (*reason != SNES_CONVERGED_ITERATING || c.patience == 0) return 0;
  const bool small = iteration > 0 && static_cast<std::size_t>(iteration) <= c.residuals.size() &&
                     norm > least_fall * c.residuals[static_cast<std::size_t>(iteration) - 1];
  c.small_falls = small ? c.small_falls + 1 : 0;
  if (c.small_falls >= c.patience) *reason = SNES_DIVERGED_LINE_SEARCH;
  return 0;
}

PetscErrorCode settle_before_search(SNESLineSearch search, Vec u, Vec step, PetscBool* changed, void* raw) {
  auto& c = *static_cast<SolveContext*>(raw);
  SNES snes = nullptr;
  Vec here = nullptr;
  PetscCall(SNESLineSearchGetSNES(search, &snes));
  PetscCall(SNESGetFunction(snes, &here, nullptr, nullptr));
  return c.gate.run([&] {
    const auto residual = [&c](Vec at, Vec r) { bordered_residual(c, at, r); };
    *changed = settle_step(c.problem, residual, u, core::norm(here), step) ? PETSC_TRUE : PETSC_FALSE;
  });
}

void use_own_solve(PC pc, SolveContext& c) {
  core::set_shell(pc, c.gate, [&c](Vec rhs, Vec x) { c.problem.solve(rhs, x); });
}

// The structured solve is exact but for rounding, so one iteration is the rule; a second one shows lost digits.
// The flexible method keeps the preconditioned vectors, which saves another solve for the answer.
void configure(KSP ksp, SolveContext& c, double relative, double absolute) {
  check(KSPSetType(ksp, KSPFGMRES));
  check(KSPSetPCSide(ksp, PC_RIGHT));
  check(KSPSetTolerances(ksp, relative, absolute, PETSC_DEFAULT, 20));
  PC pc = nullptr;
  check(KSPGetPC(ksp, &pc));
  use_own_solve(pc, c);
}

// The parts of the unknowns as index sets by name, for PCFIELDSPLIT; by option each of their fields, NAME_QUANTITY.
void set_fields(PC pc, ExtendedProblem& problem, Vec like) {
  PetscInt first = 0, last = 0;
  check(VecGetOwnershipRange(like, &first, &last));
  std::vector<problem::Field> parts = problem.fields();
  if (core::plan::splits_quantities())
    for (problem::Field& f : parts) f.name += f.quantity.empty() ? "" : "_" + f.quantity;
  else
    parts = problem::parts_of(parts);
  std::vector<bool> taken(static_cast<std::size_t>(last - first), false);
  const auto add = [&](const char* name, const std::vector<PetscInt>& rows) {
    core::IndexSet set;
    check(
        ISCreateGeneral(problem.comm(), static_cast<PetscInt>(rows.size()), rows.data(), PETSC_COPY_VALUES, set.put()));
    check(PCFieldSplitSetIS(pc, name, set.get()));
  };
  std::vector<PetscInt> rows;
  for (const problem::Field& f : parts) {
    rows.clear();
    f.each([&](PetscInt i) {
      rows.push_back(first + i);
      taken[static_cast<std::size_t>(i)] = true;
    });
    add(f.name.c_str(), rows);
  }
  rows.clear();
  for (PetscInt i = first; i < last; ++i)
    if (!taken[static_cast<std::size_t>(i - first)]) rows.push_back(i);
  add("border", rows);
}

// The matrix that the preconditioner works on: if one was chosen by option, the problem's own. A problem without a
// matrix keeps its solve.
Mat preconditioned(KSP ksp, SolveContext& c, Mat shell, Vec like) {
  PC pc = nullptr;
  PetscBool own = PETSC_TRUE, split = PETSC_FALSE;
  check(KSPGetPC(ksp, &pc));
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCSHELL, &own));
  if (own) return shell;
  if (!c.problem.matrix() && c.row) c.problem.linearise(like, c.row);  // which makes it
  Mat matrix = c.problem.matrix();
  if (!matrix) {
    use_own_solve(pc, c);
    return shell;
  }
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCFIELDSPLIT, &split));
  if (split) set_fields(pc, c.problem, like);
  return matrix;
}

const char* text_of(SNESConvergedReason reason) {
  switch (reason) {
    case SNES_CONVERGED_FNORM_ABS:
    case SNES_CONVERGED_FNORM_RELATIVE:
      return "residual below tolerance";
    case SNES_CONVERGED_SNORM_RELATIVE:
      return "step below tolerance";
    case SNES_DIVERGED_FUNCTION_DOMAIN:
    case SNES_DIVERGED_JACOBIAN_DOMAIN:
      return "a film left its validity";
    case SNES_DIVERGED_LINEAR_SOLVE:
      return "the linear solve did not converge";
    case SNES_DIVERGED_FNORM_NAN:
      return "the residual is not a number";
    case SNES_DIVERGED_MAX_IT:
      return "too many Newton iterations";
    case SNES_DIVERGED_LINE_SEARCH:
      return "the line search found no better point";
    default:
      return SNESConvergedReasons[reason];
  }
}

// How many iterations residuals r_0, r_1, ... took. Near the wall large forces cancel, and their rounding stays above
// the tolerance: whether the last iteration is made is then chance. There r_{j+1} = (r_j / r_{j-1}^2) r_j^2 goes on
// from the last two residuals that are far above rounding.
int effort_of(std::span<const double> residuals, double tolerance, bool below_tolerance) {
  constexpr double far_above_rounding = 1e4;
  const int taken = static_cast<int>(residuals.size()) - 1;
  if (taken < 1 || (below_tolerance && residuals.back() <= 0.01 * tolerance)) return taken;
  int last = taken;
  while (last > 0 && !(residuals[static_cast<std::size_t>(last)] > far_above_rounding * tolerance)) --last;
  if (last == 0) return std::min(taken, 2);
  const auto j = static_cast<std::size_t>(last);
  double r = residuals[j];
  const double c = r / (residuals[j - 1] * residuals[j - 1]);
  int n = last;
  // One that falls more slowly than that says nothing of what is to come.
  for (; r > tolerance && n < taken + 1; ++n) r = std::min(c * r * r, r);
  return n;
}

}  // namespace

struct Newton::Objects {
  Objects(ExtendedProblem& problem, Vec like)
      : context{problem, nullptr, 0, core::Gate(problem.comm()), nullptr, {}, {}} {
    check(VecGetLocalSize(like, &local));
    check(VecGetSize(like, &global));
    shell = core::make_shell(problem.comm(), local, context.gate, [&problem](Vec v, Vec y) { problem.multiply(v, y); });
  }
  void make_nonlinear(const NewtonOptions& options, Vec like);
  void make_linear(const std::string& prefix, Vec like);

  SolveContext context;
  PetscInt local = 0, global = 0;
  core::Matrix shell;
  core::Vector residual;
  core::NonlinearSolver snes;
  core::LinearSolver ksp;
};

void Newton::Objects::make_nonlinear(const NewtonOptions& options, Vec like) {
  residual = core::duplicate(like);
  check(SNESCreate(context.problem.comm(), snes.put()));
  check(SNESSetOptionsPrefix(snes.get(), options.prefix.c_str()));
  check(SNESSetFunction(snes.get(), residual.get(), form_residual, &context));
  check(SNESSetJacobian(snes.get(), shell.get(), shell.get(), form_jacobian, &context));
  const double root_n = std::sqrt(static_cast<double>(global));
  check(SNESSetTolerances(snes.get(), options.tolerance * root_n, 1e-30, options.step_tolerance, options.max_iterations,
                          1000));
  check(SNESSetMaxLinearSolveFailures(snes.get(), 1));
  check(SNESSetCheckJacobianDomainError(snes.get(), PETSC_TRUE));  // PETSc looks in debug builds only
  auto& norms = context.residuals;
  context.patience = options.patience;
  check(SNESSetConvergenceTest(snes.get(), arrived, &context, nullptr));
  SNESLineSearch search = nullptr;
  check(SNESGetLineSearch(snes.get(), &search));
  check(SNESLineSearchSetType(search, options.searches ? SNESLINESEARCHBT : SNESLINESEARCHBASIC));
  // Residuals that may rise before they fall rise the more the finer the mesh.
  if (!options.searches) check(SNESSetDivergenceTolerance(snes.get(), -1));
  if (context.problem.settles()) {
    check(SNESLineSearchSetPreCheck(search, settle_before_search, &context));
    // It has asked for a fall of the residual already. The slope along a step that settles is none of a smooth
    // function. A search of another type has no such number: PETSc would write it into memory that is not there.
    constexpr double any_fall = 1e-12;
    if (options.searches) check(SNESLineSearchBTSetAlpha(search, any_fall));
  }
  KSP inner = nullptr;
  check(SNESGetKSP(snes.get(), &inner));
  // Digits below Newton's own tolerance are of no use.
  configure(inner, context, context.problem.linear_tolerance(), 0.1 * options.tolerance * root_n);
  core::set_from_options(snes.get(), core::newton_types);
  // An option may allow more iterations; beyond some the history is not kept.
  constexpr PetscInt most_kept = 10000;
  PetscInt most = 0;
  check(SNESGetTolerances(snes.get(), nullptr, nullptr, nullptr, &most, nullptr));
  norms.resize(static_cast<std::size_t>(std::clamp<PetscInt>(most, 0, most_kept)) + 2);
  check(SNESSetConvergenceHistory(snes.get(), norms.data(), nullptr, static_cast<PetscInt>(norms.size()), PETSC_TRUE));
  Mat matrix = preconditioned(inner, context, shell.get(), like);
  if (matrix != shell.get()) check(SNESSetJacobian(snes.get(), shell.get(), matrix, form_jacobian, &context));
}

void Newton::Objects::make_linear(const std::string& prefix, Vec like) {
  check(KSPCreate(context.problem.comm(), ksp.put()));
  check(KSPSetOptionsPrefix(ksp.get(), prefix.c_str()));
  configure(ksp.get(), context, 1e-9, 1e-300);
  core::set_from_options(ksp.get());
  check(KSPSetOperators(ksp.get(), shell.get(), preconditioned(ksp.get(), context, shell.get(), like)));
}

Newton::Newton(ExtendedProblem& problem, NewtonOptions options) : problem_(problem), options_(std::move(options)) {}
Newton::~Newton() = default;

Newton::Objects& Newton::objects(Vec like) {
  if (objects_) {
    // Every rank looks at the same two numbers: the last one's unknowns change with any other layout.
    PetscInt local = 0, global = 0;
    check(VecGetLocalSize(like, &local));
    check(VecGetSize(like, &global));
    int same = local == objects_->local && global == objects_->global;
    MPI_Allreduce(MPI_IN_PLACE, &same, 1, MPI_INT, MPI_LAND, problem_.comm());
    if (!same) objects_.reset();
  }
  if (!objects_) objects_ = std::make_unique<Objects>(problem_, like);
  return *objects_;
}

NewtonResult Newton::solve(Vec u, Vec row, double offset) {
  if (!options_.replay_log) return solve_from(u, row, offset, {});
  const ReplayLog::Answer found =
      options_.replay_log->ask("newton", {core::norm(u), offset}, [&](const ReplayLog::Answer& so_far) {
        for (const ReplayLog::Rows& iterate : so_far.vectors) ReplayLog::give(iterate, u);
        const NewtonResult r = solve_from(u, row, offset, so_far.numbers);
        std::vector<double> facts{r.converged ? 1.0 : 0.0, static_cast<double>(r.iterations),
                                  static_cast<double>(r.effort), static_cast<double>(r.linear_iterations), r.residual};
        return ReplayLog::Answer{std::move(facts), r.reason, {ReplayLog::keep(options_.replay_log, u)}};
      });
  ReplayLog::give(found.vectors.at(0), u);
  const std::vector<double>& facts = found.numbers;
  return {facts[0] != 0, static_cast<int>(facts[1]), static_cast<int>(facts[2]), static_cast<int>(facts[3]), facts[4],
          found.text};
}

NewtonResult Newton::solve_from(Vec u, Vec row, double offset, std::vector<double> earlier) {
  Objects& o = objects(u);
  o.context.row = row;
  try {
    if (!o.snes) o.make_nonlinear(options_, u);
  } catch (const core::DomainError& error) {  // in the linearisation for a preconditioner that was asked for
    objects_.reset();
    NewtonResult outside;
    outside.reason = std::string(text_of(SNES_DIVERGED_FUNCTION_DOMAIN)) + ": " + error.what();
    return outside;
  }
  o.context.offset = offset;
  o.context.gate = core::Gate(problem_.comm());
  o.context.replay_log = options_.replay_log;
  o.context.earlier = std::move(earlier);
  SNES snes = o.snes.get();
  const auto before = static_cast<PetscInt>(o.context.earlier.size());
  PetscInt most = 0;
  check(SNESGetTolerances(snes, nullptr, nullptr, nullptr, &most, nullptr));
  const auto allow = [&](PetscInt n) {
    if (before > 0) check(SNESSetTolerances(snes, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, n, PETSC_DEFAULT));
  };
  allow(most - before);
  if (before == 0) (void)problem_.settle(u);
  const PetscErrorCode code = SNESSolve(snes, nullptr, u);
  allow(most);
  o.context.row = nullptr;
  o.context.gate.rethrow(code);

  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt iterations = 0, linear = 0;
  double norm = 0;
  check(SNESGetConvergedReason(snes, &reason));
  check(SNESGetIterationNumber(snes, &iterations));
  check(SNESGetLinearSolveIterations(snes, &linear));
  check(SNESGetFunctionNorm(snes, &norm));
  PetscInt known = 0;
  check(SNESGetConvergenceHistory(snes, nullptr, nullptr, &known));
  const double root_n = std::sqrt(static_cast<double>(o.global));
  std::vector<double> norms = std::move(o.context.earlier);
  norms.insert(norms.end(), o.context.residuals.begin(), o.context.residuals.begin() + known);
  const int effort = effort_of(norms, options_.tolerance * root_n, reason == SNES_CONVERGED_FNORM_ABS);
  NewtonResult result{reason > 0,    static_cast<int>(before + iterations),
                      effort,        static_cast<int>(linear),
                      norm / root_n, text_of(reason)};
  // The last digits of a residual of large cancelling terms can stay above the tolerance: a line search that stalls
  // there has arrived.
  if (!result.converged && reason == SNES_DIVERGED_LINE_SEARCH && result.residual < 100 * options_.tolerance)
    result.converged = true;
  // Steps that the line search has cut to nothing are no convergence either.
  if (reason == SNES_CONVERGED_SNORM_RELATIVE && !(result.residual < 1e4 * options_.tolerance)) {
    result.converged = false;
    result.reason = "the steps became too small";
  }
  if (!result.converged && !o.context.gate.domain_text().empty()) result.reason += ": " + o.context.gate.domain_text();
  // A solver that has failed keeps flags of the failure.
  if (reason <= 0) objects_.reset();
  return result;
}

int Newton::solve_linear(Vec rhs, Vec x) {
  Objects& o = objects(x);
  if (!o.ksp) o.make_linear(options_.linear_prefix, x);
  o.context.gate = core::Gate(problem_.comm());
  o.context.gate.rethrow(KSPSolve(o.ksp.get(), rhs, x));
  const KSPConvergedReason reason = core::reason_of(o.ksp.get());
  if (reason == KSP_DIVERGED_NANORINF || reason == KSP_DIVERGED_PC_FAILED)
    throw core::NotConverged(o.context.gate.domain_text().empty()
                                 ? "the linearised equations are singular"
                                 : "the linearised equations were not solved: " + o.context.gate.domain_text());
  PetscInt iterations = 0;
  check(KSPGetIterationNumber(o.ksp.get(), &iterations));
  return static_cast<int>(iterations);
}

NewtonResult newton(ExtendedProblem& problem, Vec u, Vec row, double offset, const NewtonOptions& options) {
  return Newton(problem, options).solve(u, row, offset);
}

int solve_linear(ExtendedProblem& problem, Vec rhs, Vec x, const std::string& prefix) {
  NewtonOptions options;
  options.linear_prefix = prefix;
  return Newton(problem, options).solve_linear(rhs, x);
}

}  // namespace whirl::solve
