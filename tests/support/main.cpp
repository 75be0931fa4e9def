#include <gtest/gtest.h>
#include <mpi.h>

#include "whirl/core/petsc.hpp"
#include "whirl/core/session.hpp"

// Only rank 0 prints; a failure on any rank fails the program.
int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  whirl::core::Session session(argc, argv);
  if (whirl::core::rank_of(MPI_COMM_WORLD) != 0) {
    auto& listeners = ::testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
  }
  int mine = RUN_ALL_TESTS(), any = 0;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  return any;
}
