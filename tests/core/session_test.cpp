// Threads of BLAS and words for PETSc.

#include "whirl/core/session.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <mpi.h>
#include <petscsys.h>

#include <cstdlib>
#include <cstring>
#include <optional>

#include "whirl/core/error.hpp"

namespace {

using whirl::core::OptionInForce;
using whirl::core::Session;

template <class Function>
Function* find(const char* name) {
  Function* f = nullptr;
  void* found = ::dlsym(RTLD_DEFAULT, name);
  std::memcpy(&f, &found, sizeof f);
  return f;
}

// A variable of the environment for the length of a test.
class Variable {
public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    value ? ::setenv(name, value, 1) : ::unsetenv(name);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;
  ~Variable() { old_ ? ::setenv(name_, old_->c_str(), 1) : ::unsetenv(name_); }

private:
  const char* name_;
  std::optional<std::string> old_;
};

const OptionInForce* option(const std::vector<OptionInForce>& all, const std::string& name) {
  for (const auto& o : all)
    if (o.name == name) return &o;
  return nullptr;
}

}  // namespace

TEST(Session, BlasHasOneThreadUnlessTheUserSaysHowMany) {
  auto* set = find<void(int)>("openblas_set_num_threads");
  auto* get = find<int()>("openblas_get_num_threads");
  if (!set || !get) GTEST_SKIP() << "another BLAS";
  const int before = get();
  set(2);
  if (get() != 2) GTEST_SKIP() << "a BLAS of one thread";
  {
    const Variable a("OPENBLAS_NUM_THREADS", nullptr), b("GOTO_NUM_THREADS", nullptr), c("OMP_NUM_THREADS", "2");
    Session::one_blas_thread();
    EXPECT_EQ(get(), 2);
    ::unsetenv("OMP_NUM_THREADS");
    Session::one_blas_thread();
    EXPECT_EQ(get(), 1);
  }
  set(before);
}

// One rank that yields gives its core away at each poll of MPI; two that do not keep each other waiting.
TEST(Session, RanksYieldToOthersOnly) {
  const char* chosen = std::getenv("OMPI_MCA_mpi_yield_when_idle");
  int size = 0, provided = 0, index = 0, n = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (size == 1 && chosen) GTEST_SKIP() << "the environment decides";
  ASSERT_EQ(MPI_T_init_thread(MPI_THREAD_SINGLE, &provided), MPI_SUCCESS);
  if (MPI_T_cvar_get_index("mpi_yield_when_idle", &index) != MPI_SUCCESS) GTEST_SKIP() << "not Open MPI";
  MPI_T_cvar_handle handle = nullptr;
  ASSERT_EQ(MPI_T_cvar_handle_alloc(index, nullptr, &handle, &n), MPI_SUCCESS);
  bool yields = false;
  EXPECT_EQ(MPI_T_cvar_read(handle, &yields), MPI_SUCCESS);
  EXPECT_EQ(MPI_T_cvar_handle_free(&handle), MPI_SUCCESS);
  EXPECT_EQ(MPI_T_finalize(), MPI_SUCCESS);
  if (size == 1) {
    EXPECT_FALSE(yields);
  } else {
    ASSERT_NE(chosen, nullptr);
    EXPECT_EQ(yields, std::string(chosen) == "1");
  }
}

TEST(Session, WordsForPetscAreOptionsWithTheirValues) {
  Session::set_options({"-whirl_test_number", "-1e-3", "-whirl_test_flag", "--whirl_test_word", "lu"});
  const auto all = Session::options_in_force();
  ASSERT_NE(option(all, "-whirl_test_number"), nullptr);
  EXPECT_EQ(option(all, "-whirl_test_number")->value, "-1e-3");
  EXPECT_EQ(option(all, "-whirl_test_number")->source, "command line");
  ASSERT_NE(option(all, "-whirl_test_flag"), nullptr);
  EXPECT_EQ(option(all, "-whirl_test_flag")->value, "");
  ASSERT_NE(option(all, "-whirl_test_word"), nullptr);
  EXPECT_EQ(option(all, "-whirl_test_word")->value, "lu");
  for (const char* name : {"-whirl_test_number", "-whirl_test_flag", "-whirl_test_word"})
    EXPECT_EQ(PetscOptionsClearValue(nullptr, name), 0);
}

// It comes after PETSc's start, which is where PETSc looks for it.
TEST(Session, LogViewHasCountedWhenItIsAskedAtTheEnd) {
  ASSERT_EQ(PetscLogPLB, nullptr);
  Session::set_options({"-log_view", ":/dev/null"});
  EXPECT_NE(PetscLogPLB, nullptr);
  EXPECT_EQ(PetscOptionsClearValue(nullptr, "-log_view"), 0);
}

TEST(Session, AForgottenDashIsAWrongInput) {
  EXPECT_THROW(Session::set_options({"newton_snes_rtol", "1e-3"}), whirl::core::InputError);
  EXPECT_THROW(Session::set_options({"-whirl_test", "1", "2"}), whirl::core::InputError);
  EXPECT_EQ(PetscOptionsClearValue(nullptr, "-whirl_test"), 0);
}
