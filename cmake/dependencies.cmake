# Dependencies of the libraries, all from Debian 12; packages.txt lists the packages to install. An installed
# swingbankConfig.cmake also reads this file.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(SUNDIALS 6.4 REQUIRED)
find_package(spdlog REQUIRED)
find_package(fmt REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(Ceres 2.1 REQUIRED)
find_package(Boost 1.74 REQUIRED) # headers of Boost.Math
find_package(OpenMP REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(MATIO REQUIRED IMPORTED_TARGET matio)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
pkg_check_modules(CRYPTO REQUIRED IMPORTED_TARGET libcrypto)

set(MPI_CXX_SKIP_MPICXX ON)
find_package(MPI REQUIRED COMPONENTS C CXX)
set(HDF5_PREFER_PARALLEL ON) # without it CMake finds the serial library
find_package(HDF5 REQUIRED COMPONENTS C)
if(NOT HDF5_IS_PARALLEL)
  message(FATAL_ERROR "HDF5 found is serial: install libhdf5-openmpi-dev")
endif()
if(NOT TARGET swingbank::hdf5)
  add_library(swingbank::hdf5 INTERFACE IMPORTED GLOBAL)
  target_include_directories(swingbank::hdf5 SYSTEM INTERFACE ${HDF5_INCLUDE_DIRS})
  target_link_libraries(swingbank::hdf5 INTERFACE ${HDF5_LIBRARIES} MPI::MPI_CXX)
  target_compile_definitions(swingbank::hdf5 INTERFACE OMPI_SKIP_MPICXX)
endif()
