// The end of the program where memory runs out.
#include <cxxabi.h>
#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>
#include <new>
#include <typeinfo>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"

#ifndef __SANITIZE_ADDRESS__
// std::bad_alloc is not thrown: Eigen frees what a matrix holds before it asks for more, and once again where it gets
// none, so that an exception would meet a broken heap on its way out, and what Open MPI does about that waits for ever.
// What earlier studies have found is in their files by then.
extern "C" void __cxxabiv1::__cxa_throw(void* object, std::type_info* type, void (*destroy)(void*)) {
  if (*type == typeid(std::bad_alloc)) {
    (void)std::fflush(stdout);
    (void)std::fprintf(stderr, "whirl: %s\n", whirl::core::out_of_memory);
    std::_Exit(static_cast<int>(whirl::core::Exit::failure));
  }
  using Throw = void (*)(void*, std::type_info*, void (*)(void*));
  static const auto next = reinterpret_cast<Throw>(::dlsym(RTLD_NEXT, "__cxa_throw"));
  next(object, type, destroy);
  std::abort();
}
#endif
