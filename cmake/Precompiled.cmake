# The headers of libraries, read once for all rooms and once for all tests instead of by each of 640 files. GCC takes the level
# of optimisation from the precompiled file, whatever the command line of its user says: each level needs a file of its own.
# Without WHIRL_PRECOMPILED a file that forgets an #include does not compile.
set(can_precompile OFF)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_BUILD_TYPE STREQUAL "Release")
  set(can_precompile ON)
endif()
option(WHIRL_PRECOMPILED "precompile the headers of libraries" ${can_precompile})

# whirl_precompile(NAME LINK targets HEADERS headers [OPTIONS flags]): a library NAME whose precompiled headers other targets use.
function(whirl_precompile name)
  if(NOT WHIRL_PRECOMPILED)
    return()
  endif()
  cmake_parse_arguments(P "" "" "LINK;HEADERS;OPTIONS" ${ARGN})
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp "")
  add_library(${name} STATIC ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(${name} PRIVATE ${P_LINK} whirl_flags)
  target_compile_options(${name} PRIVATE ${P_OPTIONS})
  target_precompile_headers(${name} PRIVATE ${P_HEADERS})
endfunction()

# whirl_use_precompiled(TARGET NAME): TARGET is compiled with the headers of NAME.
function(whirl_use_precompiled target name)
  if(WHIRL_PRECOMPILED)
    target_precompile_headers(${target} REUSE_FROM ${name})
    # ccache reads the precompiled file in place of its headers.
    target_compile_options(${target} PRIVATE -fpch-preprocess)
    target_link_libraries(${target} PRIVATE Eigen3::Eigen)
  endif()
endfunction()

set(WHIRL_HEADERS <algorithm> <array> <charconv> <cmath> <complex> <filesystem> <functional> <limits> <map> <memory> <numbers>
    <numeric> <optional> <set> <span> <string> <utility> <variant> <vector> <fmt/core.h> <fmt/ranges.h> <petscsnes.h>
    <Eigen/LU> <Eigen/SparseLU> <core/eigen_kernels.hpp>)
# The same headers for each level of optimisation of the rooms: whirl_headers, whirl_cold_headers, whirl_hot_headers.
foreach(level "" cold_ hot_)
  string(TOUPPER "WHIRL_${level}FLAGS" flags)
  whirl_precompile(whirl_${level}headers LINK SLEPc::SLEPc PETSc::PETSc fmt::fmt Eigen3::Eigen HEADERS ${WHIRL_HEADERS}
                   OPTIONS ${${flags}})
endforeach()
