#include "whirl/core/from_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <petscts.h>
#include <slepceps.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "whirl/core/error.hpp"

namespace whirl::core {
namespace {

constexpr double rounding = 1e-14;

struct Tolerance {
  const char* option;
  double own, now;
  bool relative;
};

template <class Solver>
std::string prefix_of(Solver solver) {
  const char* prefix = nullptr;
  check(PetscObjectGetOptionsPrefix(reinterpret_cast<PetscObject>(solver), &prefix));
  return prefix ? prefix : "";
}

[[noreturn]] void refuse(const std::string& text) {
  InputError wrong(text);
  wrong.mark_agreed();
  throw wrong;
}

// `own` was stored, and comes back the same unless an option has set it.
void check_tolerances(const std::string& prefix, std::initializer_list<Tolerance> all) {
  for (const Tolerance& t : all) {
    const double most = t.relative ? std::max(t.own, rounding) : t.own;
    if (!(t.now <= most))
      refuse(
          fmt::format("PETSc option -{}{} {:.3g}: results would be less accurate than their error bars say; give at "
                      "most {:.3g}, or leave the option out",
                      prefix, t.option, t.now, most));
  }
}

void refuse_given(const std::string& prefix, std::initializer_list<const char*> options) {
  for (const char* option : options) {
    PetscBool given = PETSC_FALSE;
    check(PetscOptionsHasName(nullptr, prefix.c_str(), (std::string("-") + option).c_str(), &given));
    if (given)
      refuse(
          fmt::format("PETSc option -{}{}: it replaces the test of convergence that error bars stand on; leave it out",
                      prefix, option));
  }
}

struct NonlinearTolerances {
  explicit NonlinearTolerances(SNES solver) { check(SNESGetTolerances(solver, &atol, &rtol, &stol, nullptr, nullptr)); }
  double atol = 0, rtol = 0, stol = 0;
};

void check_nonlinear(SNES solver, const NonlinearTolerances& own) {
  const NonlinearTolerances now(solver);
  const std::string prefix = prefix_of(solver);
  check_tolerances(prefix, {{"snes_atol", own.atol, now.atol, false},
                            {"snes_rtol", own.rtol, now.rtol, true},
                            {"snes_stol", own.stol, now.stol, true}});
  refuse_given(prefix, {"snes_convergence_test"});
}

}  // namespace

void set_from_options(SNES solver, std::initializer_list<const char*> types) {
  // The option is read before PETSc makes a solver of that type.
  const std::string prefix = prefix_of(solver);
  char type[64] = "";
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsGetString(nullptr, prefix.c_str(), "-snes_type", type, sizeof type, &given));
  if (given && std::none_of(types.begin(), types.end(), [&](const char* one) { return std::string_view(type) == one; }))
    refuse(fmt::format("PETSc option -{}snes_type {}: this solver can be {}", prefix, type, fmt::join(types, ", ")));
  const NonlinearTolerances own(solver);
  check(SNESSetFromOptions(solver));
  check_nonlinear(solver, own);
}

void set_from_options(EPS solver) {
  double own = 0, now = 0;
  check(EPSGetTolerances(solver, &own, nullptr));
  check(EPSSetFromOptions(solver));
  check(EPSGetTolerances(solver, &now, nullptr));
  const std::string prefix = prefix_of(solver);
  if (now != own) check_tolerances(prefix, {{"eps_tol", own, now, true}});
  refuse_given(prefix, {"eps_conv_abs", "eps_conv_rel", "eps_conv_norm", "eps_conv_user"});
}

void set_from_options(TS solver) {
  SNES stages = nullptr;
  check(TSGetSNES(solver, &stages));
  const NonlinearTolerances own_stages(stages);
  double atol = 0, rtol = 0, now_atol = 0, now_rtol = 0;
  check(TSGetTolerances(solver, &atol, nullptr, &rtol, nullptr));
  check(TSSetFromOptions(solver));
  check(TSGetTolerances(solver, &now_atol, nullptr, &now_rtol, nullptr));
  const std::string prefix = prefix_of(solver);
  check_tolerances(prefix, {{"ts_atol", atol, now_atol, false}, {"ts_rtol", rtol, now_rtol, true}});
  check_nonlinear(stages, own_stages);
}

void set_from_options(KSP solver) {
  double rtol = 0, atol = 0, now_rtol = 0, now_atol = 0;
  check(KSPGetTolerances(solver, &rtol, &atol, nullptr, nullptr));
  check(KSPSetFromOptions(solver));
  check(KSPGetTolerances(solver, &now_rtol, &now_atol, nullptr, nullptr));
  const std::string prefix = prefix_of(solver);
  check_tolerances(prefix, {{"ksp_rtol", rtol, now_rtol, true}, {"ksp_atol", atol, now_atol, false}});
}

}  // namespace whirl::core
