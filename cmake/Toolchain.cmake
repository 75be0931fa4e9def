# Compiler flags, ccache and the linker. Warnings are errors in our own code.
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # ccache takes precompiled headers only if it may be sloppy about them, and should not read these 190 MB for every file.
  set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
      CCACHE_INODECACHE=1 ${CCACHE_PROGRAM})
endif()

add_library(whirl_flags INTERFACE)
target_compile_options(whirl_flags INTERFACE -Wall -Wextra -Wpedantic -Wnon-virtual-dtor -Wold-style-cast -Werror)
# In a batch a local name may hide one of another file. GCC can tell the two apart, Clang cannot.
if(NOT WHIRL_UNITY)
  target_compile_options(whirl_flags INTERFACE -Wshadow)
elseif(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(whirl_flags INTERFACE -Wshadow=local)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 reports its own AVX-512 intrinsics as uninitialised.
  target_compile_options(whirl_flags INTERFACE -Wno-uninitialized -Wno-maybe-uninitialized)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC collects garbage from a few MB on, which costs a tenth of its time. Without that a batch takes up to 2.3 GB.
  target_compile_options(whirl_flags INTERFACE --param=ggc-min-heapsize=1500000)
endif()
if(WHIRL_NATIVE)
  target_compile_options(whirl_flags INTERFACE -march=native)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
# Cold rooms call the loops of others: with -O2 they take half as long again to compile, and run as fast. Hot rooms spend their
# time in loops that GCC vectorises only with -O3.
set(WHIRL_COLD_FLAGS $<$<CONFIG:Release>:-Og>)
set(WHIRL_HOT_FLAGS $<$<NOT:$<CONFIG:Debug>>:-O3>)
if(WHIRL_SANITIZE)
  target_compile_options(whirl_flags INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(whirl_flags INTERFACE -fsanitize=address,undefined)
endif()
