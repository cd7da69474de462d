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
# libmatio's own dependency, serial HDF5, is not linked, because a program with parallel HDF5 must not link it.
list(FILTER MATIO_LINK_LIBRARIES INCLUDE REGEX "libmatio\\.")
set_target_properties(PkgConfig::MATIO PROPERTIES INTERFACE_LINK_LIBRARIES "${MATIO_LINK_LIBRARIES}")
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
pkg_check_modules(CRYPTO REQUIRED IMPORTED_TARGET libcrypto)

# HDF5 of the programs without MPI. Debian's serial and parallel builds have the same C interface: hid_t, hsize_t and
# all functions that mpi/store calls are equal. Their headers differ only in H5pubconf.h. With the parallel H5pubconf.h,
# the headers include mpi.h and declare the MPI-IO driver (H5Pset_fapl_mpio). Therefore mpi/store is compiled once, with
# the serial headers, and each program links one of the two builds (mpi/CMakeLists.txt).
pkg_check_modules(HDF5_SERIAL hdf5-serial)
if(NOT TARGET swingbank::hdf5)
  add_library(swingbank::hdf5 INTERFACE IMPORTED GLOBAL)
  if(HDF5_SERIAL_FOUND)
    # Debian's library is a symbolic link; its target is linked, because the folder of the link is in no search path.
    file(REAL_PATH ${HDF5_SERIAL_LINK_LIBRARIES} library)
    target_include_directories(swingbank::hdf5 SYSTEM INTERFACE ${HDF5_SERIAL_INCLUDE_DIRS})
    target_link_libraries(swingbank::hdf5 INTERFACE ${library})
  else() # system with only one HDF5, serial or parallel
    find_package(HDF5 REQUIRED COMPONENTS C)
    target_include_directories(swingbank::hdf5 SYSTEM INTERFACE ${HDF5_INCLUDE_DIRS})
    target_link_libraries(swingbank::hdf5 INTERFACE ${HDF5_LIBRARIES})
    if(HDF5_IS_PARALLEL)
      find_package(MPI REQUIRED COMPONENTS C)
      target_link_libraries(swingbank::hdf5 INTERFACE MPI::MPI_C)
    endif()
  endif()
endif()
