#include "whirl/core/session.hpp"

#include <fmt/core.h>
#include <petscsys.h>
#include <slepcsys.h>

#include <algorithm>
#include <array>
#include <csignal>

#include "whirl/core/petsc.hpp"

namespace whirl::core {
namespace {

// PETSc's error handler is a C hook of the whole process, so its text has to live in one place of the process.
std::string& trace() {
  static std::string text;
  return text;
}

PetscErrorCode keep_text(MPI_Comm, int line, const char* function, const char* file, PetscErrorCode code,
                         PetscErrorType type, const char* message, void*) {
  if (type == PETSC_ERROR_INITIAL) trace().clear();
  if (trace().size() < 2000)
    trace() += fmt::format("  {} ({}:{}){}{}\n", function, file, line, message && *message ? ": " : "",
                           message ? message : "");
  return code;
}

// Those of the command line, which PETSc keeps for the process, too.
std::vector<std::string>& given_options() {
  static std::vector<std::string> names;
  return names;
}

// Options for the end of a process, which PETSc asks for when it is there.
constexpr std::array at_end = {"-log_", "-malloc_", "-memory_", "-objects_", "-options_"};

}  // namespace

Session::Session(int argc, char** argv, const std::vector<std::string>& petsc_options) {
  int one = argc > 0 ? 1 : 0;
  check(SlepcInitialize(&one, &argv, nullptr, nullptr));
  given_options() = petsc_options;
  for (std::size_t i = 0; i < petsc_options.size(); ++i) {
    const bool has_value =
        i + 1 < petsc_options.size() && (petsc_options[i + 1].empty() || petsc_options[i + 1][0] != '-');
    check(PetscOptionsSetValue(nullptr, petsc_options[i].c_str(), has_value ? petsc_options[i + 1].c_str() : nullptr));
    if (has_value) ++i;
  }
  check(PetscPushErrorHandler(keep_text, nullptr));
  // A reader who has seen enough (`whirl describe | head`) is no error to report.
  (void)std::signal(SIGPIPE, SIG_DFL);
}

Session::~Session() {
  (void)PetscPopErrorHandler();
  (void)SlepcFinalize();
}

std::vector<std::string> Session::unused_options() {
  PetscInt n = 0;
  char **names = nullptr, **values = nullptr;
  check(PetscOptionsLeftGet(nullptr, &n, &names, &values));
  std::vector<std::string> unused;
  for (PetscInt i = 0; i < n; ++i) {
    std::string name = fmt::format("-{}", names[i]);
    // Not what other sources set, nor what PETSc asks for only as it ends.
    const auto is = [&](const std::string& option) { return option == name; };
    const auto late = [&](const char* start) { return name.starts_with(start); };
    const auto& given = given_options();
    if (std::any_of(given.begin(), given.end(), is) && std::none_of(at_end.begin(), at_end.end(), late))
      unused.push_back(std::move(name));
  }
  check(PetscOptionsLeftRestore(nullptr, &n, &names, &values));
  return unused;
}

std::string Session::take_trace() {
  return std::exchange(trace(), std::string());
}

}  // namespace whirl::core
