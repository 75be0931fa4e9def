// libFuzzer's door to the deck room.

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "target.hpp"

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  // Open MPI would catch the abort of a finding, and the input would not be kept.
  setenv("OMPI_MCA_opal_signal", "", 1);
  return MPI_Init(argc, argv);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  whirl::fuzz::try_deck({reinterpret_cast<const char*>(data), size});
  return 0;
}
