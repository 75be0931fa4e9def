// libFuzzer's door to the deck room.

#include <mpi.h>

#include <cstddef>
#include <cstdint>

#include "target.hpp"

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  return MPI_Init(argc, argv);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  whirl::fuzz::try_deck({reinterpret_cast<const char*>(data), size});
  return 0;
}
