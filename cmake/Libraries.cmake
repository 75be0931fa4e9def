# Every library is a Debian 12 package; scripts/setup installs them.
find_package(PkgConfig REQUIRED)
find_package(MPI REQUIRED COMPONENTS C CXX)
find_package(fmt REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)

# The headers of these libraries are theirs: as system headers they do not fail our warnings.
function(whirl_pkg name module)
  pkg_check_modules(${name} REQUIRED IMPORTED_TARGET ${module})
  get_target_property(dirs PkgConfig::${name} INTERFACE_INCLUDE_DIRECTORIES)
  add_library(${name}::${name} INTERFACE IMPORTED)
  target_link_libraries(${name}::${name} INTERFACE PkgConfig::${name})
  if(dirs)
    target_include_directories(${name}::${name} SYSTEM INTERFACE ${dirs})
  endif()
endfunction()

whirl_pkg(PETSc PETSc)
whirl_pkg(SLEPc SLEPc)
whirl_pkg(HDF5 hdf5-openmpi)
whirl_pkg(UDUNITS udunits)
whirl_pkg(OpenBLAS openblas)
whirl_pkg(FFTW fftw3)
find_library(KLU_LIBRARY klu REQUIRED)
find_path(KLU_INCLUDE_DIR suitesparse/klu.h REQUIRED)
add_library(KLU::KLU INTERFACE IMPORTED)
target_link_libraries(KLU::KLU INTERFACE ${KLU_LIBRARY})
target_include_directories(KLU::KLU SYSTEM INTERFACE ${KLU_INCLUDE_DIR})
target_link_libraries(PETSc::PETSc INTERFACE MPI::MPI_CXX)
# Open MPI's C++ bindings are gone from the standard and drag in a second library.
target_compile_definitions(PETSc::PETSc INTERFACE OMPI_SKIP_MPICXX MPICH_SKIP_MPICXX)
target_link_libraries(HDF5::HDF5 INTERFACE MPI::MPI_CXX)

# PETSc, MUMPS and SuperLU_DIST call whatever libblas.so.3 is at run time. Debian's reference BLAS is several times slower.
find_file(LIBBLAS_FILE libblas.so.3 PATHS /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE} NO_DEFAULT_PATH)
if(LIBBLAS_FILE)
  file(REAL_PATH ${LIBBLAS_FILE} blas_target)
  if(NOT blas_target MATCHES "openblas")
    message(WARNING "libblas.so.3 is ${blas_target}, not OpenBLAS: results are right, but dense algebra is slow. As root:\n"
            "  update-alternatives --auto libblas.so.3-${CMAKE_LIBRARY_ARCHITECTURE}\n"
            "  update-alternatives --auto liblapack.so.3-${CMAKE_LIBRARY_ARCHITECTURE}")
  endif()
endif()
