#include "whirl/core/session.hpp"

#include <dlfcn.h>
#include <fmt/core.h>
#include <petscsys.h>
#include <slepcsys.h>
#include <sys/mman.h>

#include <petscblaslapack.h>  // after petscsys.h

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <sstream>

#include "whirl/core/error.hpp"
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

// Whether PETSc takes a word for the name of an option; negative numbers are values.
bool names_option(const std::string& word) {
  PetscBool valid = PETSC_FALSE;
  check(PetscOptionsValidKey(word.c_str(), &valid));
  return valid == PETSC_TRUE;
}

// PETSc takes --NAME for -NAME.
std::string plain_option(const std::string& name) {
  return name.starts_with("--") ? name.substr(1) : name;
}

// The options of a database that `fill` fills, or of the process (nothing to fill).
std::vector<OptionInForce> options_of(const std::function<void(PetscOptions)>& fill) {
  PetscOptions own = nullptr;
  if (fill) {
    check(PetscOptionsCreate(&own));
    fill(own);
  }
  char* text = nullptr;
  check(PetscOptionsGetAll(own, &text));
  std::istringstream words(text);
  check(PetscFree(text));
  if (own) check(PetscOptionsDestroy(&own));
  std::vector<OptionInForce> all;
  for (std::string word; words >> word;)
    if (names_option(word))
      all.push_back({plain_option(word), "", ""});
    else if (!all.empty())
      all.back().value += (all.back().value.empty() ? "" : " ") + word;
  return all;
}

constexpr const char* no_files = "-skip_petscrc";

// ~/.petscrc, empty if there is none. A pipe of that name would be waited for.
std::string own_file() {
  const char* home = std::getenv("HOME");
  if (!home) return {};
  std::string path = std::string(home) + "/.petscrc";
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored) ? path : std::string();
}

// Options for the end of a process, which PETSc asks for when it is there.
constexpr std::array at_end = {"-log_", "-malloc_", "-memory_", "-objects_", "-options_"};

}  // namespace

// The ranks are our parallelism. More BLAS threads than one have nothing to do in our small products and spin while
// they wait. The library has read its environment before main, so it is told; what the user set there stays.
void Session::one_blas_thread() {
  for (const char* name : {"OPENBLAS_NUM_THREADS", "GOTO_NUM_THREADS", "OMP_NUM_THREADS", "BLIS_NUM_THREADS"})
    if (std::getenv(name)) return;
  for (const char* name : {"openblas_set_num_threads", "omp_set_num_threads"})
    if (void* found = ::dlsym(RTLD_DEFAULT, name)) {
      void (*set)(int) = nullptr;
      std::memcpy(&set, &found, sizeof set);
      set(1);
    }
}

bool Session::launched() {
  return std::ranges::any_of(std::array{"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"},
                             [](const char* name) { return std::getenv(name) != nullptr; });
}

// A rank that polls for messages keeps its core from the rank that it waits for: where ranks outnumber idle cores that
// is the difference between seconds and minutes. A rank alone waits for nobody, and would give its core away at every
// poll. The daemon would start processes for MPI_Comm_spawn, which nobody calls, and takes 0.2 s.
void Session::prepare_mpi() {
  const char* size = std::getenv("OMPI_COMM_WORLD_SIZE");
  if (size && std::atoi(size) > 1) (void)::setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0);
  if (!launched()) (void)::setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
}

namespace {

// Where its working memory cannot be had, OpenBLAS asks for it again and again, for ever. It asks once: here, where it
// is known whether there is that much, and keeps what it has got. Its buffer has 128 MB of addresses, of which little
// is touched.
void claim_blas_buffer() {
  constexpr std::size_t enough = std::size_t{192} << 20;
  void* there = ::mmap(nullptr, enough, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (there == MAP_FAILED) throw Error("out of memory: the process may not have the 192 MB that it starts with");
  (void)::munmap(there, enough);
  std::array<PetscScalar, 4> matrix = {1, 0, 0, 1};
  std::array<PetscBLASInt, 2> pivots{};
  PetscBLASInt n = 2, info = 0;
  LAPACKgetrf_(&n, &n, matrix.data(), &n, pivots.data(), &info);
}

}  // namespace

Session::Session(int argc, char** argv) {
  one_blas_thread();
  prepare_mpi();
  claim_blas_buffer();
  // PETSc would read `.petscrc` and `petscrc` of the working folder, too.
  std::string program = argc > 0 ? argv[0] : "whirl", skip = no_files;
  std::array<char*, 3> words = {program.data(), skip.data(), nullptr};
  char** first = words.data();
  int count = 2;
  const std::string own = own_file();
  check(SlepcInitialize(&count, &first, own.empty() ? nullptr : own.c_str(), nullptr));
  check(PetscPushErrorHandler(keep_text, nullptr));
  // A reader who has seen enough (`whirl describe | head`) is no error to report.
  (void)std::signal(SIGPIPE, SIG_DFL);
}

Session::~Session() {
  (void)PetscPopErrorHandler();
  (void)SlepcFinalize();
}

void Session::set_options(const std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!names_option(words[i])) {
      InputError wrong(fmt::format("'{}' behind '--' is neither an option of PETSc (-NAME) nor the value of one{}",
                                   words[i], i == 0 ? "; did you mean '-" + words[i] + "'?" : ""));
      wrong.mark_agreed();  // all ranks have the same words
      throw wrong;
    }
    const std::string& name = words[i];
    const bool has_value = i + 1 < words.size() && !names_option(words[i + 1]);
    check(PetscOptionsSetValue(nullptr, name.c_str(), has_value ? words[++i].c_str() : nullptr));
    given_options().push_back(plain_option(name));
    // PETSc counts from its start on, where it has not seen these words yet.
    if (name == "-log_view") check(PetscLogDefaultBegin());
  }
}

// Later sources win: ~/.petscrc, the environment, the command line.
std::vector<OptionInForce> Session::options_in_force() {
  std::vector<OptionInForce> all = options_of(nullptr);
  const auto say = [&](const std::vector<OptionInForce>& some, const std::string& source) {
    for (const auto& o : some)
      for (auto& known : all)
        if (known.name == o.name) known.source = source;
  };
  std::erase_if(all, [](const OptionInForce& o) { return o.name == no_files; });
  if (const std::string path = own_file(); !path.empty())
    say(options_of(
            [&](PetscOptions o) { check(PetscOptionsInsertFile(PETSC_COMM_SELF, o, path.c_str(), PETSC_FALSE)); }),
        "~/.petscrc");
  if (const char* text = std::getenv("PETSC_OPTIONS"))
    say(options_of([&](PetscOptions o) { check(PetscOptionsInsertString(o, text)); }), "PETSC_OPTIONS");
  for (auto& known : all)
    if (std::find(given_options().begin(), given_options().end(), known.name) != given_options().end())
      known.source = "command line";
  return all;
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

std::string Session::impossible_option(int code, const std::string& trace) {
  const bool wish = code == PETSC_ERR_ARG_UNKNOWN_TYPE || code == PETSC_ERR_MISSING_FACTOR ||
                    trace.find("SetFromOptions") != std::string::npos;
  if (!wish) return {};
  std::string given;
  for (const OptionInForce& o : options_in_force())
    given += fmt::format("{}{}{}{}", given.empty() ? "" : " ", o.name, o.value.empty() ? "" : " ", o.value);
  if (given.empty()) return {};
  // The innermost line: `  function (file:line): message`.
  std::string what = trace.substr(0, trace.find('\n'));
  if (const std::size_t at = what.find("): "); at != std::string::npos) what = what.substr(at + 3);
  return fmt::format("PETSc cannot do what its options ask ({}): {}", given, what);
}

std::string Session::take_trace() {
  return std::exchange(trace(), std::string());
}

}  // namespace whirl::core
